//! Sets of one, two and three candidates that would explain most, by the linear score test.
//!
//! The grid of inner parameters is narrowed around the candidates of the best sets, round by round.

use super::fit::{Fit, Parts};
use super::piece::Piece;
use super::screen;
use super::sound;
use super::tableau::{Joint, Tableau};
use super::variants::{Scale, Variant, same_effect, variants};
use crate::law::{Catalogue, State, Term};

/// Rounds in which the grid of inner parameters is narrowed.
const ROUNDS: usize = 3;

/// Sets of one, two and three candidates around which it is narrowed.
const HONED: [usize; 3] = [8, 6, 4];

/// Pairs to which a third candidate is tried.
const EXTENDED: usize = 12;

/// Candidates that would join the law together.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The candidates.
    pub variants: Vec<Variant>,
    /// Linear estimates of the law's coefficients and then theirs.
    pub coefficients: Vec<f64>,
    /// Gain in log-likelihood by the score test, nats.
    pub gain: f64,
    /// Part of the innovations' energy that they leave.
    pub left: f64,
}

/// Sets of each size, best first.
#[derive(Clone, Debug, Default)]
pub struct Proposals {
    /// The best variant of each effect.
    pub single: Vec<Proposal>,
    /// The best variants of each two.
    pub pairs: Vec<Proposal>,
    /// The best variants of three.
    pub triples: Vec<Proposal>,
    /// Candidates looked at, inner parameters counted apart.
    pub tried: usize,
}

/// What the candidates promise that the law does not have.
pub fn propose(base: &Fit, pieces: &[Piece], candidates: &[Term]) -> Proposals {
    let scale = Scale::of(pieces, &base.states);
    let all = variants(candidates, &base.form.terms, &scale);
    let mut found = proposals(base, pieces, &all);
    for _ in 0..ROUNDS {
        let narrowed = found.narrowed();
        let mut next = proposals(base, pieces, &narrowed);
        let absent = |one: &&Proposal| !next.single.iter().any(|other| is_same_set(one, other));
        let kept: Vec<Proposal> = found.single.iter().filter(absent).cloned().collect();
        next.single.extend(kept);
        found = next;
    }
    Proposals { tried: all.len(), ..found }
}

fn is_same_set(one: &Proposal, other: &Proposal) -> bool {
    one.variants.iter().zip(&other.variants).all(|(one, other)| same_effect(one.term, other.term))
}

impl Proposal {
    /// Number of inner parameters of its candidates.
    pub(super) fn inner_count(&self) -> usize {
        self.variants.iter().filter_map(|one| one.term.effect()).map(|effect| effect.inner().len()).sum()
    }
}

impl Proposals {
    /// The sets of that size.
    pub fn of(&self, size: usize) -> &[Proposal] {
        match size {
            1 => &self.single,
            2 => &self.pairs,
            _ => &self.triples,
        }
    }

    /// The candidates of the best sets and their neighbours.
    fn narrowed(&self) -> Vec<Variant> {
        let best = |size: usize| self.of(size).iter().take(HONED[size - 1]);
        let all = best(1).chain(best(2)).chain(best(3)).flat_map(|proposal| &proposal.variants);
        let mut narrowed: Vec<Variant> = Vec::new();
        for variant in all.flat_map(Variant::neighbours) {
            if !narrowed.iter().any(|other| other.term == variant.term) {
                narrowed.push(variant);
            }
        }
        narrowed
    }
}

/// What these candidates promise, the best variant of each effect.
pub(super) fn proposals(base: &Fit, pieces: &[Piece], variants: &[Variant]) -> Proposals {
    let terms: Vec<Term> = variants.iter().map(|variant| variant.term).collect();
    let own = |(piece, states): (&Piece, &Vec<State>)| screen::columns(&terms, &base.form.expressions, piece, states);
    let columns: Vec<Vec<Vec<f64>>> = pieces.iter().zip(&base.states).map(own).collect();
    let Some(tableau) = screen::tableau(base, pieces, &columns) else { return Proposals::default() };
    let largest = sound::forces(base, pieces).into_iter().fold(0.0, f64::max);
    let bounds = sound::rms_of(&columns).into_iter().map(|rms| sound::CANCELLING * largest / rms).collect();
    let sets = Sets { base, tableau: &tableau, variants, effects: effects(variants), bounds };
    let single = sets.best((0..tableau.len()).map(|one| [one]), false);
    let count = tableau.len();
    let pairs = sets.best((0..count).flat_map(|one| (one + 1..count).map(move |other| [one, other])), true);
    let extended = pairs.iter().take(EXTENDED).map(|(set, _)| *set).collect::<Vec<_>>();
    let triples = sets.best(extended.iter().flat_map(|[a, b]| (0..count).map(|third| [*a, *b, third])), true);
    Proposals {
        single: sets.proposals(&single),
        pairs: sets.proposals(&pairs),
        triples: sets.proposals(&triples),
        tried: count,
    }
}

/// A number for each variant's effect.
fn effects(variants: &[Variant]) -> Vec<usize> {
    let first = |variant: &Variant| variants.iter().position(|other| same_effect(variant.term, other.term));
    variants.iter().map(|variant| first(variant).unwrap_or(0)).collect()
}

struct Sets<'a> {
    base: &'a Fit,
    tableau: &'a Tableau,
    variants: &'a [Variant],
    effects: Vec<usize>,
    /// Coefficients beyond which a force is so large that others must cancel it.
    bounds: Vec<f64>,
}

impl Sets<'_> {
    /// The best set of each combination of effects, best first; `physical` leaves out those with a sign that physics forbids.
    fn best<const N: usize>(
        &self,
        sets: impl Iterator<Item = [usize; N]>,
        physical: bool,
    ) -> Vec<([usize; N], Joint<N>)> {
        let mut best: std::collections::BTreeMap<[usize; N], ([usize; N], Joint<N>)> =
            std::collections::BTreeMap::new();
        for set in sets {
            let mut key = set.map(|index| self.effects[index]);
            key.sort_unstable();
            if key.windows(2).any(|pair| pair[0] == pair[1]) {
                continue;
            }
            let Some(joint) = self.tableau.joint(set) else { continue };
            let better = best.get(&key).is_none_or(|(_, other)| joint.gain > other.gain);
            let bounded = set.iter().zip(&joint.coefficients).all(|(index, value)| value.abs() < self.bounds[*index]);
            if better && bounded && (!physical || self.is_physical(set, &joint)) {
                best.insert(key, (set, joint));
            }
        }
        let mut ranked: Vec<_> = best.into_values().collect();
        ranked.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
        ranked
    }

    fn is_physical<const N: usize>(&self, set: [usize; N], joint: &Joint<N>) -> bool {
        let allowed = |(index, coefficient): (&usize, &f64)| {
            Catalogue::of(self.variants[*index].term).is_none_or(|entry| entry.sign.allows(*coefficient))
        };
        set.iter().zip(&joint.coefficients).all(allowed)
    }

    /// The law's coefficients, moved as far as the candidates' make them, and those.
    fn coefficients(&self, set: &[usize], joining: &[f64]) -> Vec<f64> {
        let shift = self.tableau.shift(set, joining);
        let mut all = self.base.coefficients.clone();
        Parts::of(&self.base.form).unknowns.iter().zip(shift.iter()).for_each(|(index, step)| all[*index] += step);
        all.extend(joining);
        all
    }

    fn proposals<const N: usize>(&self, sets: &[([usize; N], Joint<N>)]) -> Vec<Proposal> {
        let proposal = |(set, joint): &([usize; N], Joint<N>)| Proposal {
            variants: set.iter().map(|index| self.variants[*index]).collect(),
            coefficients: self.coefficients(set, &joint.coefficients),
            gain: joint.gain,
            left: (1.0 - 2.0 * joint.gain / self.tableau.energy).max(0.0),
        };
        sets.iter().map(proposal).collect()
    }
}
