//! Bounds of the error that a law states for itself, as e of eq. (8).

use crate::limits::SETTLED_ERROR;

/// A law is in use, and weighed against switches, when it states e below this: half of the bound, since what is stated
/// is an expectation.
pub const VALIDATED: f64 = 0.5 * SETTLED_ERROR;

/// It is called valid when it states e below this: chance leaves a coefficient within three of its std.
pub const SURE: f64 = SETTLED_ERROR / 9.0;

/// It is called valid once it is unlikely that an effect which it lacks makes its e too large, and not any more from
/// this probability on. In between it stays what it was called, as between the two thresholds of a sequential test
/// (Wald, *Ann. Math. Statist.* 16, 1945): each new run is one more look at the same record.
pub const DOUBTED: f64 = 0.25;

/// A law that states e below this is good enough to weigh switches against: coefficients within 20 % of their size
/// together.
pub const TRUSTED: f64 = 0.2 * 0.2;

/// e of eq. (8) between two laws, relative to the first.
pub(super) fn relative_error(new: &[f64], old: &[f64]) -> f64 {
    let change: f64 = new.iter().zip(old).map(|(new, old)| (new - old).powi(2)).sum();
    change / new.iter().map(|value| value * value).sum::<f64>()
}
