//! A law stands trial: what a wrong structure or a wrong minimum makes up does not survive more data.

use super::{Stage, TRUSTED, VOUCHED};
use crate::identify::forecast::Record;
use serde::{Deserialize, Serialize};

/// A law is confirmed when the record has grown by this factor …
const TRIAL: f64 = 1.1;

/// … and the coefficients have moved by less than this, as e of eq. (8).
const STOOD: f64 = 0.05 * 0.05;

/// A law that has stood this many trials in a row, its record grown by 1.1⁹ = 2.4, stands whatever other terms might have done.
const LONG: u32 = 9;

/// All coefficients as they were when the record had some length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Trial {
    pub(super) length: u64,
    pub(super) all: Vec<f64>,
}

impl Stage {
    /// Whether the law would hold with other terms too: with all of them its covariance is small enough, or it has stood long.
    pub fn stands(&self) -> bool {
        self.stood >= LONG || (self.stood > 0 && self.structure.full_error < TRUSTED)
    }

    /// Whether both stages found one law in the same record.
    pub fn agrees_with(&self, other: &Stage) -> bool {
        self.start == other.start && differ_by(&self.all, &other.all) < STOOD
    }

    /// Lets the law stand trial: statistics that a wrong structure or a wrong minimum makes up do not survive more data.
    pub(super) fn confirm(&mut self) {
        let length = self.length(self.next);
        if !self.settled() || (length as f64) < TRIAL * self.trial.length as f64 {
            return;
        }
        let stood = self.trial.length > 0 && differ_by(&self.all, &self.trial.all) < STOOD;
        self.stood = if stood { self.stood + 1 } else { 0 };
        self.trial.length = length;
        self.trial.all.copy_from_slice(&self.all);
    }

    /// How long the record has to get for the law to be known.
    pub(super) fn foretell(&mut self) {
        let squares: f64 = self.all.iter().map(|value| value * value).sum();
        let begun = if self.trial.length > 0 { self.start + self.trial.length } else { self.next };
        let record = Record {
            range: [self.start, self.next],
            information: &self.pass.information,
            active: &self.active,
            solution: &self.solution,
            allowed: VOUCHED * squares / self.overdispersion,
            trial: (!self.stands()).then_some(begun),
            growth: TRIAL,
        };
        self.forecast.renew(&record);
    }

    /// By which factor the record that the last pass ended with has to grow until the coefficient is known; infinite where nothing can be
    /// said.
    pub fn growth_needed(&self, free: usize) -> f64 {
        self.forecast.factor(free)
    }
}

/// e of eq. (8) between two laws.
fn differ_by(new: &[f64], old: &[f64]) -> f64 {
    let change: f64 = new.iter().zip(old).map(|(new, old)| (new - old).powi(2)).sum();
    change / new.iter().map(|value| value * value).sum::<f64>()
}
