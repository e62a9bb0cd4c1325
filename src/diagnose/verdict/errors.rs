//! Errors of a law by window length, before and after, beside what the sensors alone would leave.

use crate::diagnose::judge::{COUNT, HeldOut, Record};

/// Score, for each window length, by which two laws are equally good: 5 % of the error.
pub(in crate::diagnose) const TIE: f64 = 0.05;

/// Error ÷ what the sensors alone would leave, up to which a law is as good as right.
pub const ADEQUATE: f64 = 1.25;

/// Stds of the errors of a right law within which chance leaves 95 of 100 of them.
const CHANCE: f64 = 1.645;

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
    /// Error up to which a law is adequate: a quarter above the floor, or what chance makes of the floor in so few
    /// windows.
    pub limit: f64,
}

impl WindowError {
    /// By what factor the error falls.
    pub fn ratio(&self) -> f64 {
        self.after / self.before
    }

    /// Energy that is left beyond what the sensors alone would leave.
    pub(super) fn beyond(&self) -> f64 {
        (self.after * self.after - self.floor * self.floor).max(0.0)
    }
}

pub(in crate::diagnose) fn errors(
    record: &Record,
    before: &HeldOut,
    after: &HeldOut,
    floor: &[f64; COUNT],
) -> [WindowError; COUNT] {
    std::array::from_fn(|which| {
        let window = record.windows[which].length;
        let (before, after, floor) = (before.errors[which], after.errors[which], floor[which]);
        WindowError { window, before, after, floor, limit: floor * scatter(record.duration / window) }
    })
}

/// Error ÷ floor up to which a law is adequate, by how many windows there are side by side: the RMS of n values has a
/// std of 1 ÷ √2n of it.
fn scatter(windows: f64) -> f64 {
    ADEQUATE.max(1.0 + CHANCE / (2.0 * windows).sqrt())
}

/// Whether errors are what the sensors alone would leave, in every window that tells.
pub fn are_adequate(errors: &[WindowError; COUNT]) -> bool {
    let told = || errors.iter().filter(|error| error.after.is_finite());
    told().count() > 0 && told().all(|error| error.after <= error.limit && error.after < 1.0)
}
