//! Laws that were validated, kept for the day they come back.
//!
//! A law is kept as its coefficients θ and their precision Λ on the terms that it has. One that comes back adds its
//! information: Λ = Λ₁ + Λ₂, Λθ = Λ₁θ₁ + Λ₂θ₂. There is room for [`ROOM`] laws; when it is full the one that was least
//! recently in use goes.

use super::known_law::{Estimate, KnownLaw};
use crate::estimation::{Information, Solution};
use crate::evidence::{Bank, BayesFactor, GaussianPrior, either};
use crate::identify::problem::Problem;
use serde::{Deserialize, Serialize};

/// Laws that are kept: each costs a filter while laws are on trial, and steps are bounded.
pub const ROOM: usize = 16;

/// A change of the law is known to this fraction of itself where its effect is linearised about the law before, as a
/// std.
const BEND: f64 = 0.05;

/// What a record says on a law, nats, against certainty that the coefficients are at the record's point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// Log-evidence of the law, its uncertainty counted.
    pub known: f64,
    /// Log-evidence of whatever law a switch may lead to.
    pub any: f64,
}

/// The laws that are known, and room for more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnownLaws {
    laws: Vec<KnownLaw>,
    count: usize,
    next_number: u32,
    clock: u64,
    latest: KnownLaw,
    solution: Solution,
    belief: GaussianPrior,
    weighing: BayesFactor,
    precision: Vec<f64>,
}

impl KnownLaws {
    /// No laws yet, room for [`ROOM`] of `n` free coefficients.
    pub fn new(n: usize) -> KnownLaws {
        KnownLaws {
            laws: vec![KnownLaw::none(n); ROOM],
            count: 0,
            next_number: 1,
            clock: 0,
            latest: KnownLaw::none(n),
            solution: Solution::none(n),
            belief: GaussianPrior::none(n),
            weighing: BayesFactor::new(n),
            precision: vec![1.0; n],
        }
    }

    /// No law is known any more; those to come are numbered on.
    pub fn forget(&mut self) {
        self.count = 0;
    }

    /// The laws, each at the place that it keeps while it is known.
    pub fn laws(&self) -> &[KnownLaw] {
        &self.laws[..self.count]
    }

    /// The place of the law of that number.
    pub fn position(&self, number: u32) -> Option<usize> {
        self.laws().iter().position(|law| law.number == number)
    }

    /// A number that no law has had.
    pub fn new_number(&mut self) -> u32 {
        self.next_number += 1;
        self.next_number - 1
    }

    /// Adds a law known from elsewhere.
    pub fn push(&mut self, law: &KnownLaw) {
        self.next_number = self.next_number.max(law.number.saturating_add(1));
        self.latest.clone_from_law(law);
        self.store();
    }

    /// Keeps the law of a segment that has ended under `number`. What was known of it is added, unless the segment
    /// began with that.
    pub fn keep(&mut self, number: u32, estimate: &Estimate, samples: u64, spread: &[f64], began_with_it: bool) {
        self.latest.take(estimate, spread, &mut self.solution);
        (self.latest.number, self.latest.samples) = (number, samples);
        if let Some(place) = self.position(number) {
            self.latest.samples += self.laws[place].samples;
            if !began_with_it {
                self.latest.add(&self.laws[place], &mut self.solution);
            }
        }
        self.store();
    }

    fn store(&mut self) {
        self.clock += 1;
        self.latest.used = self.clock;
        let place = self.position(self.latest.number).unwrap_or_else(|| self.free_place());
        self.laws[place].clone_from_law(&self.latest);
    }

    /// A new place, or that of the law least recently used.
    fn free_place(&mut self) -> usize {
        if self.count < self.laws.len() {
            self.count += 1;
            return self.count - 1;
        }
        let oldest = self.laws.iter().enumerate().min_by_key(|(_, law)| law.used);
        oldest.map_or(0, |(place, _)| place)
    }

    /// Weighs the law at `place` by a record whose score is taken about the coefficients `point`.
    pub fn weigh(&mut self, place: usize, point: Option<&[f64]>, record: &Information) -> Weighed {
        let KnownLaws { laws, belief, weighing, .. } = self;
        let law = &laws[place];
        let point = point.unwrap_or(&law.coefficients);
        for (offset, (known, point)) in belief.offset.iter_mut().zip(law.coefficients.iter().zip(point)) {
            *offset = known - point;
        }
        belief.set_variances(law.spread.iter().map(|spread| spread * spread));
        let any = weighing.evidence(record, belief);
        belief.set_information(&law.information, &law.active, weighing);
        Weighed { known: weighing.evidence(record, belief), any }
    }

    /// The same about the law's own coefficients, where it is the one that has just been left: what it may lead to is a
    /// law that differs from it in one coefficient alone, or any.
    pub fn weigh_left(&mut self, place: usize, record: &Information) -> Weighed {
        let Weighed { known, any } = self.weigh(place, None, record);
        let KnownLaws { laws, belief, weighing, precision, .. } = self;
        precision.iter_mut().zip(&laws[place].spread).for_each(|(slot, spread)| *slot = (spread * spread).recip());
        let changed = known + weighing.evidence_of_a_change(belief, precision);
        Weighed { known, any: either(any, changed) }
    }

    /// The number of the known law that a segment has found again, if there is one whose evidence passes `level`, nats.
    pub fn same_as(&mut self, estimate: &Estimate, level: f64) -> Option<u32> {
        let mut best = (level, None);
        for place in 0..self.count {
            let weighed = self.weigh(place, Some(estimate.coefficients), estimate.information);
            let evidence = (weighed.known - weighed.any) / estimate.overdispersion;
            if evidence > best.0 {
                best = (evidence, Some(self.laws[place].number));
            }
        }
        best.1
    }

    /// Weighs the law at `place` by the hypotheses of a switch from the law in use, about which they are linear. A
    /// change of the inertia is told to them by what it does to the acceleration.
    pub fn at_a_switch(&mut self, place: usize, problem: &Problem, in_use: &[f64], bank: &mut Bank) -> Weighed {
        let KnownLaws { laws, belief, weighing, .. } = self;
        let law = &laws[place];
        let inertia = problem.free_inertia().map_or(1.0, |free| in_use[problem.inertia] / law.coefficients[free]);
        for (free, index) in problem.free.iter().enumerate() {
            belief.offset[free] = inertia * (law.coefficients[free] - in_use[*index]);
        }
        let bent = |free: usize| (BEND * (law.coefficients[free] - in_use[problem.free[free]])).powi(2);
        belief.set_variances((0..problem.n()).map(|free| inertia * inertia * (law.variance(free) + bent(free))));
        let [known, any] = bank.of_known_law(belief, weighing);
        Weighed { known, any }
    }
}
