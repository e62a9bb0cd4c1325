//! Every candidate of the catalogue, its inner parameters on a grid in the record's own units.
//!
//! The grid is coarse: a screen of it finds the neighbourhood, then [`Variant::neighbours`] narrows it, a third of the
//! spacing at a time.

use crate::diagnose::scale::Scale;
use crate::law::{Catalogue, Effect, Expression, InnerRange, Term};
use std::f64::consts::{FRAC_PI_4, PI};

/// A candidate with numbers for its inner parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// The candidate.
    pub term: Term,
    /// Ratio between neighbouring values of its inner parameters on the grid it comes from.
    pub spacing: f64,
}

impl Scale {
    /// Grids of the effect's inner parameters, one list per parameter, and the ratio between neighbours.
    fn grids(&self, effect: Effect) -> (Vec<Vec<f64>>, f64) {
        let lengths =
            |from: f64, to: f64, ratio: f64| geometric(from * self.displacement, to * self.displacement, ratio);
        let lengths_of = |from: f64, to: f64, ratio: f64| geometric(from * self.excursion, to * self.excursion, ratio);
        let [slow, fast] = self.frequency;
        let highest = 0.5 / self.sample_time;
        match effect {
            Effect::StribeckFriction { .. } => (vec![geometric(0.02 * self.velocity, 0.7 * self.velocity, 2.0)], 2.0),
            Effect::DeadZoneStiffness { .. } => (vec![lengths(0.04, 0.9, 1.5)], 1.5),
            Effect::OneSidedStop { .. } => (vec![lengths(0.04, 0.95, 1.5)], 1.5),
            Effect::ExcitationGainNonlinearity { .. } => (vec![vec![2.0, 3.0]], 1.0),
            Effect::ExcitationDelay { .. } => (vec![geometric(0.3 * self.sample_time, 1.0 / slow, 1.8)], 1.8),
            Effect::Hysteresis { .. } => (vec![lengths_of(0.004, 1.5, 2.0), vec![0.5, 1.0], vec![1.0, 2.0]], 2.0),
            Effect::HiddenResonator { .. } => {
                let frequencies = geometric(0.3 * slow, (3.0 * fast).min(highest), RESONANCE);
                (vec![frequencies, vec![0.02, 0.02 * DAMPING, 0.02 * DAMPING * DAMPING]], RESONANCE)
            }
            Effect::PreslidingFriction { .. } => (vec![lengths_of(0.004, 1.5, 2.0)], 2.0),
            Effect::FrictionWithBacklash { .. } => (vec![lengths_of(0.01, 0.7, 3.0), lengths_of(0.03, 0.7, 2.0)], 2.0),
            Effect::PositionDependentFriction { .. } => (vec![vec![1.0, 2.0]], 1.0),
            Effect::Cogging { .. } => (vec![self.ripples(), quarters()], RIPPLE),
            Effect::Relaxation { .. } => (vec![geometric(0.2 / fast, 5.0 / slow, 2.0)], 2.0),
            Effect::ActuatorLag { .. } => (vec![geometric(0.3 * self.sample_time, 1.0 / slow, 1.8)], 1.8),
            _ => (Vec::new(), 1.0),
        }
    }

    /// Wave numbers of one to [`RIPPLES`] ripples over the way, half a ripple apart: ripples half a ripple apart are as
    /// good as orthogonal.
    fn ripples(&self) -> Vec<f64> {
        (2..=2 * RIPPLES).map(|halves| 0.5 * PI * f64::from(halves) / self.excursion).collect()
    }
}

/// Ratio between neighbouring frequencies of a hidden mass.
const RESONANCE: f64 = 1.15;

/// Ratio between neighbouring damping ratios of it: a resonance of 0.02 to 0.12 is 4 to 24 % wide.
const DAMPING: f64 = 2.45;

/// Most ripples over the way that are sought: each more costs eight columns.
const RIPPLES: u32 = 8;

/// Ratio between neighbouring wave numbers of as many ripples as are sought half-way.
const RIPPLE: f64 = 1.15;

/// Angles of a ripple an eighth of a turn apart: its sign is the coefficient's.
fn quarters() -> Vec<f64> {
    (0..4).map(|eighth| f64::from(eighth) * FRAC_PI_4).collect()
}

/// Every candidate: the catalogue, and the user's own effects.
pub fn candidates(expressions: &[Expression]) -> Vec<Term> {
    let own = expressions.iter().enumerate().map(|(place, own)| own.term(place));
    Catalogue::ENTRIES.iter().map(|entry| entry.term).chain(own).collect()
}

/// The candidates that the form does not have already.
pub fn variants(candidates: &[Term], present: &[Term], scale: &Scale) -> Vec<Variant> {
    let absent = candidates.iter().filter(|term| !present.iter().any(|other| same_effect(**term, *other)));
    absent.flat_map(|term| with_grid(*term, scale)).collect()
}

fn with_grid(term: Term, scale: &Scale) -> Vec<Variant> {
    let (grids, spacing) = match term {
        Term::Effect(effect) => scale.grids(effect),
        _ => (around(&term.inner_values()), DECADE_ROOT),
    };
    let mut points = vec![Vec::new()];
    for grid in &grids {
        points = points.iter().flat_map(|point| grid.iter().map(move |value| extended(point, *value))).collect();
    }
    let resolved = |term: &Term| term.effect().is_none_or(|effect| scale.resolves(effect));
    let with = |point: &Vec<f64>| term.with_inner(point).filter(resolved);
    points.iter().filter_map(with).map(|term| Variant { term, spacing }).collect()
}

/// Ratio between neighbouring values of what a user's formula leaves open.
const DECADE_ROOT: f64 = 3.162_277_660_168_379_5;

/// Most points of a grid of what a user's formula leaves open.
const POINTS: f64 = 170.0;

/// Values up to three decades around each start, fewer where there are several: nobody told their scale but the user.
fn around(starts: &[f64]) -> Vec<Vec<f64>> {
    let each = POINTS.powf(1.0 / starts.len() as f64);
    let reach = (0.5 * (each - 1.0)).clamp(1.0, 6.0) as i32;
    starts.iter().map(|start| (-reach..=reach).map(|power| start * DECADE_ROOT.powi(power)).collect()).collect()
}

/// Whether both are the same effect, whatever its inner parameters.
pub fn same_effect(one: Term, other: Term) -> bool {
    match (one, other) {
        (Term::Effect(one), Term::Effect(other)) => one.id() == other.id(),
        (Term::Expression(one), Term::Expression(other)) => one.place() == other.place(),
        _ => one == other,
    }
}

impl Variant {
    /// Grid of an inner parameter, in those of the first one.
    fn stretch(&self, index: usize) -> f64 {
        match (self.term, index) {
            (Term::Effect(Effect::HiddenResonator { .. }), 1) => DAMPING.ln() / RESONANCE.ln(),
            _ => 1.0,
        }
    }

    /// The variant and its neighbours at a third of its spacing: its first two inner parameters together, for a
    /// ripple's wave number and angle, or a resonance's frequency and damping, are not found one by one.
    pub fn neighbours(&self) -> Vec<Variant> {
        let spacing = self.spacing.cbrt();
        let values = self.term.inner_values();
        let range =
            |index: usize| self.term.effect().map_or(InnerRange::Positive, |effect| effect.inner()[index].range);
        let moved = |index: usize, power: i32| match range(index) {
            // an angle
            InnerRange::Any => values[index] + f64::from(power) * FRAC_PI_4 * spacing.ln() / RIPPLE.ln(),
            _ => values[index] * spacing.powf(f64::from(power) * self.stretch(index)),
        };
        let powers = |index: usize| match (index, values.get(index).map(|_| range(index))) {
            // powers are whole numbers
            (_, None | Some(InnerRange::Either(..))) => &[0][..],
            // says where the effect sets in, the others what it is like beyond
            (0, _) => &[0, -2, -1, 1, 2],
            _ => &[0, -1, 1],
        };
        let with = |steps: &[(usize, i32)]| {
            let mut point = values.clone();
            let told = steps.iter().filter(|(_, power)| *power != 0);
            told.for_each(|(index, power)| point[*index] = moved(*index, *power));
            self.term.with_inner(&point).map(|term| Variant { term, spacing })
        };
        let both = powers(0).iter().flat_map(|one| powers(1).iter().map(|other| with(&[(0, *one), (1, *other)])));
        let further = (2..values.len()).flat_map(|index| powers(index)[1..].iter().map(move |power| (index, *power)));
        let all = both.chain(further.map(|step| with(&[step])));
        if values.is_empty() { vec![Variant { spacing, ..*self }] } else { all.flatten().collect() }
    }
}

fn extended(point: &[f64], value: f64) -> Vec<f64> {
    point.iter().copied().chain([value]).collect()
}

fn geometric(from: f64, to: f64, ratio: f64) -> Vec<f64> {
    if !(from > 0.0 && to > from && to.is_finite()) {
        return Vec::new();
    }
    std::iter::successors(Some(from), |value| Some(value * ratio)).take_while(|value| *value <= to).collect()
}
