//! What a reading costs under a working and under a faulty sensor, as logarithms of densities.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A faulty reading's scale in std of a working one: what is nearer costs about the same as a working one.
const SCALE: f64 = 3.0;

/// Readings that a burst has had when it is found in the record.
const SOME: f64 = 10.0;

/// Log-density of a Gaussian residual.
pub fn working(residual: f64, variance: f64) -> f64 {
    -0.5 * (residual * residual / variance + (TAU * variance).ln())
}

/// Log-density of a residual that may be of any size: 1 ÷ (2 s (1 + u) (1 + ln(1 + u))²), u = |residual| ÷ s, which
/// integrates to one and has no scale of its own beyond s. `std` is the working sensor's, whatever the hypothesis: one
/// that expects little would else pay less for every reading.
pub fn faulty(residual: f64, std: f64) -> f64 {
    let scale = SCALE * std;
    let beyond = (residual.abs() / scale).min(f64::MAX).ln_1p();
    -(2.0 * scale).ln() - beyond - 2.0 * beyond.ln_1p()
}

/// ln(eᵃ + eᵇ).
pub fn log_sum(a: f64, b: f64) -> f64 {
    let (most, least) = if a > b { (a, b) } else { (b, a) };
    if least == f64::NEG_INFINITY { most } else { most + (least - most).exp().ln_1p() }
}

/// Whether a channel works or is in a burst of faulty readings: a chain of two states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Burst {
    /// Probability of the burst after the last reading.
    pub probability: f64,
    /// Readings that it has had.
    age: f64,
}

impl Burst {
    /// A burst that has had some readings already.
    pub fn going_on() -> Burst {
        Burst { probability: 1.0, age: SOME }
    }

    /// Takes a reading by its log-densities under a working and a faulty sensor; `start` is the probability that a
    /// burst begins with a reading. One that has lasted for n readings ends with the next at 1 ÷ (n + 2). Returns the
    /// reading's log-density.
    pub fn take(&mut self, working: f64, faulty: f64, start: f64) -> f64 {
        let (burst, ends) = (self.probability, (self.age + 2.0).recip());
        let faulty = faulty + ((1.0 - burst) * start + burst * (1.0 - ends)).ln();
        let working = working + ((1.0 - burst) * (1.0 - start) + burst * ends).ln();
        let total = log_sum(working, faulty);
        self.probability = (faulty - total).exp();
        self.age = if self.is_on() { self.age + 1.0 } else { 0.0 };
        total
    }

    /// Probability that the burst began with the last reading.
    pub fn begun(&self) -> f64 {
        if self.age <= 1.0 { self.probability } else { 0.0 }
    }

    /// Whether the last reading was more likely faulty than not.
    pub fn is_on(&self) -> bool {
        self.probability > 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_of_a_faulty_reading_integrates_to_one_but_for_its_slow_tail() {
        let (mut sum, mut from) = (0.0, 0.0);
        for step in 0..60_000 {
            let to = 1e-3 * (1.001_f64.powi(step + 1) - 1.0);
            sum += 2.0 * (to - from) * faulty(0.5 * (from + to), 1.0).exp();
            from = to;
        }
        let beyond = 1.0 / (1.0 + (from / SCALE).ln_1p());
        assert!((sum + beyond - 1.0).abs() < 1e-3, "{sum} and {beyond}");
    }

    #[test]
    fn a_burst_begins_with_a_reading_far_off_and_ends_after_some_that_are_not() {
        let mut burst = Burst::default();
        let mut states = Vec::new();
        for residual in [0.5, 9.0, -40.0, 1e300, 0.3, -0.4, 0.2, 0.1, 0.6, -0.7] {
            burst.take(working(residual, 1.0), faulty(residual, 1.0), 1e-9);
            states.push(burst.is_on());
        }
        assert_eq!(states[..4], [false, true, true, true]);
        assert!(!states[9], "{states:?}");
    }

    #[test]
    fn five_stds_are_no_fault_of_a_sensor_that_never_failed() {
        let mut burst = Burst::default();
        burst.take(working(5.0, 1.0), faulty(5.0, 1.0), 1e-9);
        assert!(!burst.is_on());
    }
}
