//! A law stands trial: what a wrong structure or a wrong minimum makes up does not survive more data.

use super::{Stage, TRUSTED, VOUCHED};
use crate::identify::forecast::Record;
use serde::{Deserialize, Serialize};

/// A law that explains its record is confirmed when the record has grown by this factor …
const TRIAL: f64 = 1.1;

/// … one that does not, by this: it may have all its error in the sensors, and another maximum of the likelihood is the better one.
const DOUBTED: f64 = 1.25;

/// A law that has stood for less than the longer trial must be this sure with all terms, as e of eq. (8) squared.
const SURE: f64 = 0.5 * TRUSTED;

/// One with the terms of the law before must be known at least so well with all terms.
const OPEN: f64 = 1.0;

/// Meanwhile the coefficients have moved by less than this, as e of eq. (8).
const STOOD: f64 = 0.05 * 0.05;

/// A law that has stood while its record grew by this factor stands whatever other terms might have done …
const LONG: f64 = 2.4;

/// … if that has so many samples: within a small part of a motion other terms do nothing.
const SAMPLES: u64 = 2000;

/// All coefficients as they were when the record had some length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Trial {
    pub(super) length: u64,
    pub(super) all: Vec<f64>,
    /// Length from which on they have stood.
    pub(super) stood_from: u64,
}

impl Stage {
    /// Whether the law would hold with other terms too: with all of them it is sure enough, it has stood long, or it explains its record
    /// with the terms of the law before.
    pub fn stands(&self) -> bool {
        let grown = self.trial.length as f64 / self.trial.stood_from as f64;
        let allowed = if grown < DOUBTED { SURE } else { TRUSTED };
        let sure = self.structure.full_error < allowed;
        let long = grown >= LONG && self.trial.length >= SAMPLES;
        let as_before = self.explains && self.structure.is_as_before(&self.active);
        self.stood && (sure || long || as_before && self.structure.full_error < OPEN)
    }

    /// Whether the law is known.
    pub fn is_vouched(&self) -> bool {
        self.stands() && self.stated_error() < VOUCHED
    }

    /// Whether both stages found one law in the same record.
    pub fn agrees_with(&self, other: &Stage) -> bool {
        self.start == other.start && differ_by(&self.all, &other.all) < STOOD
    }

    /// Whether the fit has come to rest, explains its record, and is another law than these coefficients make.
    pub fn contradicts(&self, all: &[f64]) -> bool {
        self.settled() && self.explains && differ_by(&self.all, all) > STOOD
    }

    fn trial_growth(&self) -> f64 {
        if self.explains { TRIAL } else { DOUBTED }
    }

    /// Lets the law stand trial: statistics that a wrong structure or a wrong minimum makes up do not survive more data.
    pub(super) fn confirm(&mut self) {
        let length = self.length(self.next);
        if !self.settled() || (length as f64) < self.trial_growth() * self.trial.length as f64 {
            return;
        }
        let stood = self.trial.length > 0 && differ_by(&self.all, &self.trial.all) < STOOD;
        self.stood = stood;
        self.trial.stood_from = if stood { self.trial.stood_from } else { length };
        self.trial.length = length;
        self.trial.all.copy_from_slice(&self.all);
    }

    /// Compares the estimate with those of shorter records, once it is one.
    pub(super) fn compare(&mut self) {
        if !(self.settled() && self.explains) {
            return;
        }
        let length = self.length(self.next);
        let Stage { constancy, coefficients, active, solution, overdispersion, .. } = self;
        constancy.take(length, |free| {
            let std = if active[free] { solution.std(free, *overdispersion) } else { f64::INFINITY };
            (coefficients[free], std)
        });
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
            growth: self.trial_growth(),
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
