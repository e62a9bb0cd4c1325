//! Whether a segment's law may be shown, validated, or replaced by another one.

use super::convergence::Record;
use super::state::Segment;
use crate::estimation::TWENTY_TO_ONE;
use crate::identify::validation::{SURE, Stability, VALIDATED, is_one_law};

/// Largest Gauss–Newton decrement, in units of the number of coefficients, of an estimate that has settled: a step of
/// one std in each of them, which is what the record leaves open.
pub(super) const SETTLED: f64 = 1.0;

/// Runs in a row that may leave what can be integrated: each is repeated with a thousand times the process noise.
const LOST: u32 = 6;

impl Segment {
    /// Whether the last runs agree: the estimate is at the likelihood's maximum, to within a fraction of its std.
    pub fn settled(&self) -> bool {
        self.runs.calm >= 2
    }

    /// Whether the last run changed little, by its own standard.
    pub fn is_calm(&self) -> bool {
        self.runs.closed >= 2
            && self.fit.decrement.abs() < SETTLED * self.fit.overdispersion
            && self.fit.gain < TWENTY_TO_ONE
    }

    /// Whether no process noise keeps the run where it can be integrated: the coefficients are beyond repair.
    pub fn is_lost(&self) -> bool {
        self.runs.astray >= LOST
    }

    /// Whether the law has stood its stability check, and would hold with other terms too.
    pub fn stands(&self) -> bool {
        self.stability.stands(self.selection.full_error)
    }

    /// Whether the law is known as well as one that is validated has to be.
    pub fn is_validated(&self) -> bool {
        self.stands() && self.stated_error() < VALIDATED
    }

    /// Whether nothing speaks against the law: no error that lasts, no estimate that a longer record contradicted.
    pub fn is_beyond_doubt(&self) -> bool {
        self.fit.explains && self.fit.overdispersion == 1.0 && !self.constancy.broken
    }

    /// Probability that an effect that the law lacks, or has wrongly, makes e larger than a valid law's may be.
    pub fn doubt(&self) -> f64 {
        self.score_test.posterior.wrong
    }

    /// Whether its law has left what a shorter part of the record said, by more than that left open.
    pub fn has_left_itself(&self) -> bool {
        self.constancy.broken
    }

    /// Whether both fits found one law in the same record.
    pub fn agrees_with(&self, other: &Segment) -> bool {
        self.start == other.start && is_one_law(self.own(), other.own())
    }

    /// Lets the law stand its stability check, once it has settled.
    pub(super) fn confirm(&mut self) {
        if self.settled() {
            let own = self.all.len() - 1;
            self.stability.check(self.samples(), &self.all[..own], self.fit.explains);
        }
    }

    /// Compares the estimate with those of shorter records, once it is one.
    pub(super) fn compare(&mut self) {
        if !(self.settled() && self.fit.explains) {
            return;
        }
        let samples = self.samples();
        let Segment { constancy, coefficients, active, solution, fit, .. } = self;
        constancy.take(samples, |free| {
            let std = if active[free] { solution.std(free, fit.overdispersion) } else { f64::INFINITY };
            (coefficients[free], std)
        });
    }

    /// How long the record has to get for the law to be known.
    pub(super) fn forecast_convergence(&mut self) {
        let squares: f64 = self.own().iter().map(|value| value * value).sum();
        let checked = |samples: u64| self.start + samples.saturating_sub(self.known.folded);
        let begun = self.stability.checked_at().map_or(self.run.next, checked);
        let record = Record {
            range: [self.start, self.run.next],
            information: &self.run.filter_run.information,
            active: &self.active,
            solution: &self.solution,
            allowed: SURE * squares / self.fit.overdispersion,
            trial: (!self.stands()).then_some(begun),
            growth: Stability::growth(self.fit.explains),
        };
        self.convergence.renew(&record);
    }

    /// By which factor the record that the last run ended with has to grow until the coefficient is known; infinite
    /// where nothing can be said.
    pub fn growth_needed(&self, free: usize) -> f64 {
        self.convergence.factor(free)
    }
}
