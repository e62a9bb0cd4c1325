//! The stability check of a law: what a wrong structure or a wrong minimum makes up does not survive more data.

use super::bounds::{TRUSTED, relative_error};
use crate::limits::SETTLED_ERROR;
use serde::{Deserialize, Serialize};

/// A law that explains its record is confirmed when the record has grown by this factor …
const GROWTH: f64 = 1.1;

/// … one that does not, by this: it may have all its error in the sensors, and another maximum of the likelihood is the
/// better one. With a tenth for all, a wrong law of a periodic motion (e = 0.41) was validated; with a quarter for all,
/// 11 of 62 switches of van der Pol records at σ = 0.1 came before any law.
const LONGER_GROWTH: f64 = 1.25;

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

impl Stability {
    /// Of a law of `count` coefficients, nothing seen.
    pub fn new(count: usize) -> Stability {
        Stability { stood: false, length: 0, all: vec![0.0; count], stood_from: 0 }
    }

    /// Forgets the record.
    pub fn clear(&mut self) {
        (self.stood, self.length) = (false, 0);
    }

    /// Whether the law would hold with other terms too: with every term that it may have it states an e of eq. (8) that
    /// is good enough, or it has stood long.
    pub fn stands(&self, full_error: f64) -> bool {
        let long = self.length as f64 >= LONG * self.stood_from as f64 && self.length >= SAMPLES;
        self.stood && (full_error < TRUSTED || long)
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
    relative_error(new, old) < SETTLED_ERROR
}
