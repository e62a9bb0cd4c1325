//! Errors of a law by window length, before and after, beside what the sensors alone would leave.

use crate::diagnose::judge::{COUNT, HeldOut, Record};

/// Score, for each window length, by which two candidates are equally good: 5 % of the error.
pub(in crate::diagnose) const TIE: f64 = 0.05;

/// Error ÷ what the sensors alone would leave, up to which a law is adequate.
pub const ADEQUATE: f64 = 1.25;

/// Errors over windows of one length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowError {
    /// Length, s.
    pub window: f64,
    /// Held-out error before.
    pub before: f64,
    /// … and after.
    pub after: f64,
    /// What the sensors alone would leave.
    pub floor: f64,
}

impl WindowError {
    /// By what factor the error falls.
    pub fn ratio(&self) -> f64 {
        self.after / self.before
    }
}

pub(in crate::diagnose) fn errors(
    record: &Record,
    before: &HeldOut,
    after: &HeldOut,
    floor: &[f64; COUNT],
) -> [WindowError; COUNT] {
    std::array::from_fn(|which| WindowError {
        window: record.windows[which].length,
        before: before.errors[which],
        after: after.errors[which],
        floor: floor[which],
    })
}

/// Whether errors are what the sensors alone would leave, in every window that tells.
pub fn are_adequate(errors: &[WindowError; COUNT]) -> bool {
    let told = || errors.iter().filter(|error| error.after.is_finite());
    told().count() > 0 && told().all(|error| error.after <= ADEQUATE * error.floor && error.after < 1.0)
}
