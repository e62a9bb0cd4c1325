//! Odds at which a question counts as decided, and sizes of samples that tell a variance.

/// Log-odds, nats, at which one of two hypotheses is taken for the right one: twenty to one, the 5 % that are usual.
pub const TWENTY_TO_ONE: f64 = 3.0;

/// Probability below which something counts as not being so: the same odds.
pub const UNLIKELY: f64 = 0.05;

/// Stds that chance hardly ever lets a Gaussian value be off: one in two million.
pub const BEYOND_CHANCE: f64 = 5.0;

/// Samples that a mean square is taken over: its std is then √(2 ÷ 4000), 2 % of it.
pub const SAMPLES_OF_A_VARIANCE: f64 = 4000.0;

/// ln(eᵃ + eᵇ).
pub fn log_sum(a: f64, b: f64) -> f64 {
    let (most, least) = if a > b { (a, b) } else { (b, a) };
    if least == f64::NEG_INFINITY { most } else { most + (least - most).exp().ln_1p() }
}
