//! A law with numbers, arranged for speed.
//!
//! Every term is a product of one factor of q, one of q̇ and a power of F: the factors that the terms share, powers
//! foremost, are evaluated once at a point into a [`Table`], and a term is three places in it. Effects with inner
//! parameters get the places that are left. Terms whose coefficient is 0 cost nothing where only the force is wanted.
//! The order of a sum, and so its last bits, depend on nothing but terms and coefficients.

use super::effect::Effect;
use super::expression::Expression;
use super::motion::{Motion, State};
use super::term::{Monomial, Term};
use serde::{Deserialize, Serialize};

/// Factors of q or q̇: the powers, then the effects'; a power of two, so that a place is never out of range.
const FACTORS: usize = 16;

const MASK: usize = FACTORS - 1;

/// First place behind the powers.
const EFFECTS: u8 = Monomial::MAX_POWER + 1;

/// A term as places of its factors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Places {
    q: u8,
    qd: u8,
    excitation: u8,
}

/// First places of the effects with inner parameters.
const SHAPED_Q: u8 = EFFECTS + OF_Q.len() as u8;
const SHAPED_QD: u8 = EFFECTS + OF_QD.len() as u8;

/// Which effects with inner parameters stand at the last places of q's table and of q̇'s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Shapes {
    q: [Option<Effect>; FACTORS - SHAPED_Q as usize],
    qd: [Option<Effect>; FACTORS - SHAPED_QD as usize],
}

impl Shapes {
    /// The effect's place among those of q (or of q̇), its own or the next free one.
    fn place(slots: &mut [Option<Effect>], first: u8, effect: Effect) -> Option<u8> {
        let index = slots.iter().position(|slot| slot.is_none_or(|other| other == effect))?;
        slots[index] = Some(effect);
        Some(first + index as u8)
    }

    /// Of the part of the term that does not multiply q̈; none for the inertia, for an effect with memory and where
    /// there is no place left.
    fn places(&mut self, term: Term) -> Option<Places> {
        match term {
            Term::Effect(
                effect @ (Effect::DeadZoneStiffness { .. } | Effect::OneSidedStop { .. } | Effect::Cogging { .. }),
            ) => Shapes::place(&mut self.q, SHAPED_Q, effect).map(|q| Places { q, ..Places::default() }),
            Term::Effect(effect @ Effect::StribeckFriction { .. }) => {
                Shapes::place(&mut self.qd, SHAPED_QD, effect).map(|qd| Places { qd, ..Places::default() })
            }
            Term::Expression(own) if own.place() < Compiled::MAX_OWN => {
                Some(Places { excitation: OWN + own.place() as u8, ..Places::default() })
            }
            Term::Effect(Effect::ExcitationGainNonlinearity { power }) => {
                Some(Places { excitation: power.value() as u8, ..Places::default() })
            }
            _ => Places::of(term),
        }
    }
}

impl Places {
    /// Of the part of the term that does not multiply q̈; none for the inertia and for an effect that has no fixed
    /// place.
    fn of(term: Term) -> Option<Places> {
        let places = |q, qd| Some(Places { q, qd, excitation: 0 });
        match term {
            Term::Inertia => None,
            Term::Monomial(powers) => Some(Places { q: powers.q, qd: powers.qd, excitation: powers.excitation }),
            Term::Effect(Effect::CoulombFriction) => places(0, EFFECTS),
            Term::Effect(Effect::QuadraticDamping) => places(0, EFFECTS + 1),
            Term::Effect(Effect::AsymmetricDamping) => places(0, EFFECTS + 2),
            Term::Effect(Effect::PositionDependentFriction { power }) => places(power.value() as u8, EFFECTS),
            Term::Effect(Effect::LoadDependentFriction) => Some(Places { q: 0, qd: EFFECTS, excitation: SIZE }),
            Term::Effect(Effect::PendulumRestoring) => places(EFFECTS, 0),
            Term::Effect(Effect::SignedQuadraticStiffness) => places(EFFECTS + 1, 0),
            Term::Effect(Effect::BilinearStiffness) => places(EFFECTS + 2, 0),
            Term::Effect(Effect::PositionDependentInertia) => places(1, 2),
            Term::Effect(_) | Term::Expression(_) => None,
        }
    }
}

/// Effects whose factor stands at a place of q's table, and of q̇'s.
const OF_Q: [Effect; 3] = [Effect::PendulumRestoring, Effect::SignedQuadraticStiffness, Effect::BilinearStiffness];
const OF_QD: [Effect; 3] = [Effect::CoulombFriction, Effect::QuadraticDamping, Effect::AsymmetricDamping];

/// Where |F| stands in the excitation's table.
const SIZE: u8 = EFFECTS;

/// Where the first of the user's own effects stands in the excitation's table: they are functions of all three, and no
/// product.
const OWN: u8 = SIZE + 1;

/// A term that the law has: its places and its coefficient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Part {
    places: Places,
    coefficient: f64,
}

/// A free term: where its force stands, and what of it multiplies q̈ as `mass[0] + mass[1] q²`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Free {
    places: Places,
    /// 0 for the inertia, which has no force.
    force: f64,
    mass: [f64; 2],
}

/// The largest powers that are needed, and whether any effect is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Reach {
    q: u8,
    qd: u8,
    excitation: u8,
}

impl Reach {
    fn include(&mut self, places: Places) {
        self.q = self.q.max(places.q);
        self.qd = self.qd.max(places.qd);
        self.excitation = self.excitation.max(places.excitation);
    }
}

/// A law with numbers and the terms whose coefficients are sought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compiled {
    coefficients: [f64; Compiled::MAX_TERMS],
    parts: [Part; Compiled::MAX_TERMS],
    count: usize,
    free: [Free; Compiled::MAX_TERMS],
    shapes: Shapes,
    /// The user's own effects.
    own: Vec<Expression>,
    reach: Reach,
    free_reach: Reach,
    /// What multiplies q̈: `mass[0] + mass[1] q²`.
    mass: [f64; 2],
    /// 1 ÷ `mass[0]`.
    inverse_mass: f64,
    /// Whether the law has dry friction.
    dry: bool,
}

impl Default for Compiled {
    fn default() -> Compiled {
        Compiled {
            coefficients: [f64::NAN; Compiled::MAX_TERMS],
            parts: [Part::default(); Compiled::MAX_TERMS],
            count: 0,
            free: [Free::default(); Compiled::MAX_TERMS],
            shapes: Shapes::default(),
            own: Vec::new(),
            reach: Reach::default(),
            free_reach: Reach::default(),
            mass: [0.0; 2],
            inverse_mass: 0.0,
            dry: false,
        }
    }
}

/// The factors at one point.
pub(super) struct Table {
    pub(super) q: [f64; FACTORS],
    pub(super) qd: [f64; FACTORS],
    pub(super) excitation: [f64; FACTORS],
}

impl Compiled {
    /// The most terms of a law: its tables have this fixed size, so that no step allocates.
    pub const MAX_TERMS: usize = 32;

    /// The most expressions of a law.
    pub const MAX_OWN: usize = FACTORS - OWN as usize;

    /// The first term that a compiled law cannot have: one with memory, or one more effect with inner parameters than
    /// there are places (3 of q, 3 of q̇), or an expression beyond the first [`Compiled::MAX_OWN`].
    pub fn refused(terms: &[Term]) -> Option<Term> {
        let mut shapes = Shapes::default();
        terms.iter().copied().find(|term| *term != Term::Inertia && shapes.places(*term).is_none())
    }

    /// Takes the free terms, at most [`Compiled::MAX_TERMS`], for `slopes`; the motion is to be compiled after them. A
    /// [refused](Compiled::refused) term makes the slopes, or the acceleration, NaN.
    pub fn seek(&mut self, free: &[Term]) {
        self.free_reach = Reach::default();
        self.shapes = Shapes::default();
        for (slot, term) in self.free.iter_mut().zip(free) {
            let places = self.shapes.places(*term);
            let places_or_one = places.unwrap_or_default();
            let at_zero = term.mass(0.0);
            *slot = Free {
                places: places_or_one,
                force: match (term, places) {
                    (Term::Inertia, _) => 0.0,
                    (_, Some(_)) => 1.0,
                    (_, None) => f64::NAN,
                },
                mass: [at_zero, term.mass(1.0) - at_zero],
            };
            self.free_reach.include(places_or_one);
        }
    }

    /// Takes the motion, whose terms are those of the last time, unless it has its coefficients already.
    #[inline]
    pub fn follow(&mut self, motion: &Motion) {
        let n = motion.coefficients.len().min(Compiled::MAX_TERMS);
        if self.coefficients[..n] != motion.coefficients[..n] {
            self.compile(motion);
        }
    }

    /// Takes the motion.
    pub fn compile(&mut self, motion: &Motion) {
        if !motion.own.is_empty() {
            self.take(motion);
        }
        self.count = 0;
        self.mass = [0.0; 2];
        self.reach = Reach::default();
        self.dry = false;
        for ((term, coefficient), kept) in motion.terms.iter().zip(motion.coefficients).zip(&mut self.coefficients) {
            *kept = *coefficient;
            let at_zero = term.mass(0.0);
            self.mass[0] += coefficient * at_zero;
            self.mass[1] += coefficient * (term.mass(1.0) - at_zero);
            if *term != Term::Inertia && *coefficient != 0.0 {
                self.parts[self.count] = match self.shapes.places(*term) {
                    Some(places) => Part { places, coefficient: *coefficient },
                    None => Part { places: Places::default(), coefficient: f64::NAN },
                };
                self.reach.include(self.parts[self.count].places);
                self.dry |= term.effect().is_some_and(Effect::is_dry);
                self.count += 1;
            }
        }
        self.inverse_mass = self.mass[0].recip();
    }

    /// Takes the formulas, each with the inner parameters of the term that stands for it.
    fn take(&mut self, motion: &Motion) {
        if self.own.len() != motion.own.len() {
            self.own = motion.own.to_vec();
        }
        for term in motion.terms {
            if let Term::Expression(named) = term
                && let Some(own) = self.own.get_mut(named.place())
            {
                own.set(&named.inner());
            }
        }
    }

    /// Whether the law has dry friction, so that a step is to be cut where the velocity reverses.
    #[inline]
    pub(super) fn is_dry(&self) -> bool {
        self.dry
    }

    /// Overwrites the factors of dry friction by those of a motion that slides in a direction.
    #[inline]
    pub(super) fn slide(&self, table: &mut Table, qd: f64, direction: f64) {
        table.qd[usize::from(EFFECTS)] = direction;
        let slots = &mut table.qd[usize::from(SHAPED_QD)..];
        let state = State { q: 0.0, qd };
        fill_shapes(&self.shapes.qd, slots, |effect| effect.sliding(state, 0.0, direction).unwrap_or_default());
    }

    /// Writes the law's factors at a point.
    #[inline]
    pub(super) fn fill(&self, table: &mut Table, state: State, excitation: f64) {
        table.fill(&self.shapes, &self.own, self.reach, state, excitation);
    }

    /// Writes the law's and the free terms' factors at a point.
    #[inline]
    pub(super) fn fill_all(&self, table: &mut Table, state: State, excitation: f64) {
        let (law, free) = (self.reach, self.free_reach);
        let excited = law.excitation.max(free.excitation);
        let reach = Reach { q: law.q.max(free.q), qd: law.qd.max(free.qd), excitation: excited };
        table.fill(&self.shapes, &self.own, reach, state, excitation);
    }

    /// (q̈, 1 ÷ mass).
    #[inline]
    pub(super) fn acceleration(&self, table: &Table, excitation: f64) -> (f64, f64) {
        let force: f64 = self.parts[..self.count].iter().map(|part| part.coefficient * table.force(part.places)).sum();
        let inverse = match self.mass[1] {
            0.0 => self.inverse_mass,
            by_square => (self.mass[0] + by_square * table.q[2]).recip(),
        };
        ((excitation - force) * inverse, inverse)
    }

    /// \[∂/∂q, ∂/∂q̇\] of the law's force.
    #[inline]
    pub(super) fn gradient(&self, table: &Table, state: State, excitation: f64) -> [f64; 2] {
        let (mut by_q, mut by_qd) = ([0.0; FACTORS], [0.0; FACTORS]);
        differentiate(&mut by_q, &table.q, self.reach.q);
        differentiate(&mut by_qd, &table.qd, self.reach.qd);
        if self.reach.q >= EFFECTS {
            let slots = &mut by_q[usize::from(EFFECTS)..];
            OF_Q.iter().zip(slots).for_each(|(effect, slot)| *slot = effect.gradient(state.q, 0.0).0);
        }
        if self.reach.qd >= EFFECTS {
            let slots = &mut by_qd[usize::from(EFFECTS)..];
            OF_QD.iter().zip(slots).for_each(|(effect, slot)| *slot = effect.gradient(0.0, state.qd).1);
        }
        if self.reach.q >= SHAPED_Q {
            let slots = &mut by_q[usize::from(SHAPED_Q)..];
            fill_shapes(&self.shapes.q, slots, |effect| effect.gradient(state.q, 0.0).0);
        }
        if self.reach.qd >= SHAPED_QD {
            let slots = &mut by_qd[usize::from(SHAPED_QD)..];
            fill_shapes(&self.shapes.qd, slots, |effect| effect.gradient(0.0, state.qd).1);
        }
        let mut gradient = [0.0; 2];
        for Part { places, coefficient } in &self.parts[..self.count] {
            let scaled = coefficient * table.excitation[usize::from(places.excitation) & MASK];
            let (q, qd) = (usize::from(places.q) & MASK, usize::from(places.qd) & MASK);
            gradient[0] += scaled * by_q[q] * table.qd[qd];
            gradient[1] += scaled * table.q[q] * by_qd[qd];
            if let Some(own) = places.excitation.checked_sub(OWN).and_then(|place| self.own.get(usize::from(place))) {
                let (own_by_q, own_by_qd) = own.gradient(state.q, state.qd, excitation);
                gradient = [gradient[0] + coefficient * own_by_q, gradient[1] + coefficient * own_by_qd];
            }
        }
        gradient
    }

    /// Writes ∂q̈/∂θ of the free terms at a point of this acceleration.
    #[inline]
    pub(super) fn slopes(&self, table: &Table, acceleration: f64, inverse_mass: f64, slopes: &mut [f64]) {
        let square = table.q[2];
        for (slope, free) in slopes.iter_mut().zip(&self.free) {
            let mass = free.mass[0] + free.mass[1] * square;
            *slope = -(free.force * table.force(free.places) + mass * acceleration) * inverse_mass;
        }
    }
}

impl Table {
    pub(super) const EMPTY: Table = Table { q: [0.0; FACTORS], qd: [0.0; FACTORS], excitation: [0.0; FACTORS] };

    #[inline]
    fn fill(&mut self, shapes: &Shapes, own: &[Expression], reach: Reach, state: State, excitation: f64) {
        powers(&mut self.q, state.q, reach.q);
        powers(&mut self.qd, state.qd, reach.qd);
        powers(&mut self.excitation, excitation, reach.excitation);
        self.excitation[usize::from(SIZE)] = excitation.abs();
        if reach.excitation >= OWN {
            let slots = &mut self.excitation[usize::from(OWN)..];
            own.iter().zip(slots).for_each(|(own, slot)| *slot = own.value(state.q, state.qd, excitation, f64::NAN));
        }
        if reach.q >= EFFECTS {
            let slots = &mut self.q[usize::from(EFFECTS)..];
            OF_Q.iter().zip(slots).for_each(|(effect, slot)| *slot = effect.force(state.q, 0.0, 0.0));
        }
        if reach.qd >= EFFECTS {
            let slots = &mut self.qd[usize::from(EFFECTS)..];
            OF_QD.iter().zip(slots).for_each(|(effect, slot)| *slot = effect.force(0.0, state.qd, 0.0));
        }
        if reach.q >= SHAPED_Q {
            fill_shapes(&shapes.q, &mut self.q[usize::from(SHAPED_Q)..], |effect| effect.force(state.q, 0.0, 0.0));
        }
        if reach.qd >= SHAPED_QD {
            fill_shapes(&shapes.qd, &mut self.qd[usize::from(SHAPED_QD)..], |effect| effect.force(0.0, state.qd, 0.0));
        }
    }

    #[inline]
    fn force(&self, places: Places) -> f64 {
        let product = self.q[usize::from(places.q) & MASK] * self.qd[usize::from(places.qd) & MASK];
        product * self.excitation[usize::from(places.excitation) & MASK]
    }
}

#[inline]
fn fill_shapes(shapes: &[Option<Effect>], slots: &mut [f64], value: impl Fn(Effect) -> f64) {
    shapes.iter().zip(slots).for_each(|(effect, slot)| *slot = effect.map_or(0.0, &value));
}

/// base⁰ … base^reach, at least up to the cube.
#[inline]
fn powers(slots: &mut [f64; FACTORS], base: f64, reach: u8) {
    let square = base * base;
    (slots[0], slots[1], slots[2], slots[3]) = (1.0, base, square, square * base);
    for power in 4..=usize::from(reach.min(Monomial::MAX_POWER)) {
        slots[power & MASK] = slots[(power - 1) & MASK] * base;
    }
}

#[inline]
fn differentiate(slots: &mut [f64; FACTORS], powers: &[f64; FACTORS], reach: u8) {
    (slots[1], slots[2], slots[3]) = (1.0, 2.0 * powers[1], 3.0 * powers[2]);
    for power in 4..=usize::from(reach.min(Monomial::MAX_POWER)) {
        slots[power & MASK] = power as f64 * powers[(power - 1) & MASK];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own() -> [Expression; 2] {
        [("drag", "abs(qd)^1.5*sign(qd)*q"), ("push", "F*tanh(3*q) + qd^2")]
            .map(|(name, text)| Expression::parse(name, text).unwrap())
    }

    fn every_kind() -> (Vec<Term>, Vec<f64>) {
        let monomial = |q, qd, excitation| Term::Monomial(Monomial { q, qd, excitation });
        let monomials =
            [(0, 0, 0), (1, 0, 0), (3, 2, 0), (9, 0, 0), (0, 5, 0), (1, 0, 2)].map(|(q, qd, f)| monomial(q, qd, f));
        let effects = Effect::ALL.into_iter().filter(|effect| effect.is_pointwise()).map(Term::Effect);
        let own = own().into_iter().enumerate().map(|(place, own)| own.term(place)).collect::<Vec<_>>();
        let terms: Vec<Term> = [Term::Inertia].into_iter().chain(monomials).chain(effects).chain(own).collect();
        let coefficients = (0..terms.len()).map(|index| 0.3 + 0.17 * index as f64).collect();
        (terms, coefficients)
    }

    #[test]
    fn agrees_with_the_terms_one_by_one() {
        let (terms, mut coefficients) = every_kind();
        coefficients[2] = 0.0;
        let own = own();
        let motion = Motion::new(&terms, &coefficients).with(&own);
        let mut compiled = Compiled::default();
        compiled.seek(&terms);
        compiled.compile(&motion);
        for (q, qd, excitation) in [(0.7, -1.2, 0.4), (-1.1, 0.3, -0.8)] {
            let state = State { q, qd };
            let mut table = Table::EMPTY;
            compiled.fill_all(&mut table, state, excitation);
            let (acceleration, inverse) = compiled.acceleration(&table, excitation);
            let expected = motion.acceleration(state, excitation);
            assert!((acceleration / expected - 1.0).abs() < 1e-13, "{acceleration} against {expected}");
            let gradient = compiled.gradient(&table, state, excitation);
            let mut slopes = vec![0.0; terms.len()];
            compiled.slopes(&table, acceleration, inverse, &mut slopes);
            let mut sums = [0.0; 2];
            for ((term, coefficient), slope) in terms.iter().zip(&coefficients).zip(&slopes) {
                let (by_q, by_qd) = term.gradient_of(&own, state, excitation);
                sums = [sums[0] + coefficient * by_q, sums[1] + coefficient * by_qd];
                let force = term.force_of(&own, state, excitation);
                let expected = -(force + term.mass(q) * acceleration) / motion.mass(q);
                assert!(
                    (slope - expected).abs() < 1e-13 * (1.0 + expected.abs()),
                    "{term}: {slope} against {expected}"
                );
            }
            for (found, expected) in gradient.iter().zip(sums) {
                assert!((found / expected - 1.0).abs() < 1e-13, "{found} against {expected}");
            }
        }
    }

    #[test]
    fn what_cannot_be_compiled_is_named_and_never_silent() {
        let gaps = |count: usize| {
            let stop = |index| Effect::prototype("one_sided_stop").unwrap().with_inner(&[index as f64]).unwrap();
            (0..count).map(|index| Term::Effect(stop(index))).collect::<Vec<_>>()
        };
        assert_eq!(Compiled::refused(&every_kind().0), None);
        assert_eq!(Compiled::refused(&gaps(3)), None);
        assert_eq!(Compiled::refused(&gaps(4)), Some(gaps(4)[3]));
        let own = |place: usize| own()[0].term(place);
        assert_eq!(Compiled::refused(&[own(Compiled::MAX_OWN - 1), own(Compiled::MAX_OWN)]), Some(own(5)));
        let hysteresis = Term::Effect(Effect::prototype("hysteresis").unwrap());
        assert_eq!(Compiled::refused(&[Term::Inertia, hysteresis]), Some(hysteresis));
        let mut compiled = Compiled::default();
        compiled.compile(&Motion::new(&[Term::Inertia, hysteresis], &[1.0, 2.0]));
        let mut table = Table::EMPTY;
        compiled.fill(&mut table, State::default(), 0.0);
        assert!(compiled.acceleration(&table, 0.0).0.is_nan());
    }

    #[test]
    fn follows_only_coefficients_that_have_changed() {
        let (terms, mut coefficients) = every_kind();
        let mut compiled = Compiled::default();
        compiled.follow(&Motion::new(&terms, &coefficients));
        let first = compiled.clone();
        compiled.follow(&Motion::new(&terms, &coefficients));
        assert_eq!(compiled.mass, first.mass);
        coefficients[0] = 2.5;
        compiled.follow(&Motion::new(&terms, &coefficients));
        assert!(compiled.mass[0] != first.mass[0]);
    }
}
