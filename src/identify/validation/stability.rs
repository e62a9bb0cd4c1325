//! The stability check of a law: what a wrong structure or a wrong minimum makes up does not survive more data.

use super::bounds::{STOOD, TRUSTED, relative_error};
use serde::{Deserialize, Serialize};

/// A law that explains its record is confirmed when the record has grown by this factor …
const GROWTH: f64 = 1.1;

/// … one that does not, by this: it may have all its error in the sensors, and another maximum of the likelihood is the
/// better one. With a tenth for all, a wrong law of a periodic motion (e = 0.41) was validated; with a quarter for all,
/// 11 of 62 switches of van der Pol records at σ = 0.1 came before any law.
const LONGER_GROWTH: f64 = 1.25;

/// A law that has stood for less than the longer growth must be this sure with all terms, as e of eq. (8).
const WHOLE: f64 = 0.5 * TRUSTED;

/// One with the terms of the law before must be known at least so well with all terms, as e of eq. (8).
const OPEN: f64 = 1.0;

/// A law that has stood while its record grew by this factor stands whatever other terms might have done …
const LONG: f64 = 2.4;

/// … if that has so many samples: within a small part of a motion other terms do nothing.
const SAMPLES: u64 = 2000;

/// All coefficients as they were when the record had some length, and since when they have stood.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// Whether the law stood when the record had last grown as the check asks.
    stood: bool,
    length: u64,
    all: Vec<f64>,
    /// Length from which on they have stood.
    stood_from: u64,
}

/// What else the check goes by.
#[derive(Clone, Copy, Debug)]
pub struct Evidence {
    /// Whether the law explains its record down to the sensors' noise.
    pub explains: bool,
    /// e of eq. (8) that the law states with every term that it may have.
    pub full_error: f64,
    /// Whether it has the terms of the law before.
    pub as_before: bool,
}

impl Stability {
    /// Of a law of `count` coefficients, nothing seen.
    pub fn new(count: usize) -> Stability {
        Stability { stood: false, length: 0, all: vec![0.0; count], stood_from: 0 }
    }

    /// Forgets the record.
    pub fn clear(&mut self) {
        (self.stood, self.length) = (false, 0);
    }

    /// Whether the law would hold with other terms too: with all of them it is sure enough, it has stood long, or it
    /// explains its record with the terms of the law before.
    pub fn stands(&self, evidence: &Evidence) -> bool {
        let grown = self.length as f64 / self.stood_from as f64;
        let allowed = if grown < LONGER_GROWTH { WHOLE } else { TRUSTED };
        let sure = evidence.full_error < allowed;
        let long = grown >= LONG && self.length >= SAMPLES;
        let as_before = evidence.explains && evidence.as_before;
        self.stood && (sure || long || as_before && evidence.full_error < OPEN)
    }

    /// By which factor the record has to grow until the law is confirmed.
    pub fn growth(explains: bool) -> f64 {
        if explains { GROWTH } else { LONGER_GROWTH }
    }

    /// Length of the record at the last check; `None` before the first.
    pub fn checked_at(&self) -> Option<u64> {
        (self.length > 0).then_some(self.length)
    }

    /// Takes the settled estimate of a record of this length; checks it where the record has grown enough.
    pub fn check(&mut self, length: u64, all: &[f64], explains: bool) {
        if (length as f64) < Stability::growth(explains) * self.length as f64 {
            return;
        }
        let stood = self.length > 0 && is_one_law(all, &self.all);
        self.stood = stood;
        self.stood_from = if stood { self.stood_from } else { length };
        self.length = length;
        self.all.copy_from_slice(all);
    }
}

/// Whether two estimates are nearer to each other than a known law is to the truth.
pub fn is_one_law(new: &[f64], old: &[f64]) -> bool {
    relative_error(new, old) < STOOD
}
