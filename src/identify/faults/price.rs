//! What a reading costs under a working and under a faulty sensor, as logarithms of densities, and how often an event
//! of a kind begins.

use crate::estimation::{UNLIKELY, log_sum};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_SQRT_PI, TAU};

/// Scatter of a faulty sensor in stds of a working one: what is nearer costs about the same under either.
pub const SCATTER: f64 = 3.0;

/// A reading this many std off is as far as any.
const FAR: f64 = 1e100;

/// Mean time between two events of a kind, s: what nothing is known of happens as often as a false alarm is allowed.
const SELDOM: f64 = 1e6;

/// Probability that an event of a kind begins in an interval of `dt` s: unlikely even in the longest.
pub fn event(dt: f64) -> f64 {
    (dt / SELDOM).min(UNLIKELY)
}

/// Probability that a channel begins to come late in an interval of `dt` s: delays are set with a rig and its clocks,
/// and change in mid-stream a hundred times less often than a law or a reading.
pub fn delay_changes(dt: f64) -> f64 {
    1e-2 * event(dt)
}

/// Log-density of a Gaussian residual.
pub fn working(residual: f64, variance: f64) -> f64 {
    -0.5 * (residual * residual / variance + (TAU * variance).ln())
}

/// Log-density of a residual that may be of any size: 1 ÷ (2 s (1 + u) (1 + ln(1 + u))²), u = |residual| ÷ s, which
/// integrates to one and has no scale of its own beyond s. `std` is the working sensor's, whatever the hypothesis: one
/// that expects little would else pay less for every reading.
pub fn faulty(residual: f64, std: f64) -> f64 {
    let scale = SCATTER * std;
    let beyond = (residual.abs() / scale).min(f64::MAX).ln_1p();
    -(2.0 * scale).ln() - beyond - 2.0 * beyond.ln_1p()
}

/// Whether a channel works or is in a burst of faulty readings: a chain of two states.
///
/// How wide a burst's readings are nobody knows before its first; that one has the density [`faulty`]. Of those after
/// it the burst knows: Laplace draws of a size whose logarithm is uniform have, after n of them with the sum A of their
/// magnitudes, the predictive density n Aⁿ ÷ (2 (A + |residual|)ⁿ⁺¹). One in n + 2 is of another size all the same.
/// Where they lie to one side A is the sum of their distances from the mean of those before, one less than they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Burst {
    /// Probability of the burst after the last reading.
    pub probability: f64,
    /// Readings that it has had.
    age: f64,
    /// Sum of their distances from what they lie about, in std of a working sensor.
    sum: f64,
    /// Where that is, where they lie to one side.
    mean: f64,
}

/// Readings to one side from which on they are no burst's any more but an offset.
const LONGEST: f64 = 30.0;

/// Mean distance of a working sensor's readings from what they are about, std: √(2 ÷ π).
const NEAR: f64 = FRAC_2_SQRT_PI * FRAC_1_SQRT_2;

impl Burst {
    /// Takes a reading by its log-density under a working sensor and its residual, in a channel of that std; `start` is
    /// the probability that a burst begins with a reading. One that has lasted for n readings ends with the next at 1 ÷
    /// (n + 2). `to_one_side`: whether its readings lie about their own mean; what it has had then counts from where it
    /// most likely began, whether it is on or not. Returns the reading's log-density.
    pub fn take(&mut self, working: f64, residual: f64, std: f64, start: f64, to_one_side: bool) -> f64 {
        let (burst, ends) = (self.probability, (self.age + 2.0).recip());
        let size = (residual / std).clamp(-FAR, FAR);
        let begins = faulty(residual, std) + ((1.0 - burst) * start).ln();
        let goes_on = self.density(size, std, to_one_side) + (burst * (1.0 - ends)).ln();
        let faulty = log_sum(begins, goes_on);
        let working = working + ((1.0 - burst) * (1.0 - start) + burst * ends).ln();
        let total = log_sum(working, faulty);
        self.probability = (faulty - total).exp();
        if to_one_side && begins > goes_on {
            (self.age, self.sum, self.mean) = (1.0, 0.0, size);
        } else if to_one_side || self.is_on() {
            self.age += 1.0;
            self.sum += (size - self.mean).abs();
            self.mean += if to_one_side { (size - self.mean) / self.age } else { 0.0 };
        } else {
            (self.age, self.sum) = (0.0, 0.0);
        }
        total
    }

    /// Log-density of the next reading of the burst, `size` std of a working sensor off.
    fn density(&self, size: f64, std: f64, to_one_side: bool) -> f64 {
        if to_one_side && self.age > LONGEST {
            return faulty(size * std, std);
        }
        let distance = (size - self.mean).abs();
        let wide = faulty(distance * std, std);
        let n = if to_one_side { self.age - 1.0 } else { self.age };
        if n <= 0.0 || self.sum == 0.0 {
            return wide;
        }
        let other = (self.age + 2.0).recip();
        // what is added to the noise makes no reading likelier than it
        let sum = if to_one_side { self.sum.max(NEAR * n) } else { self.sum };
        let own = (0.5 * n / (sum * std)).ln() - (n + 1.0) * (distance / sum).ln_1p();
        log_sum(wide + other.ln(), own + (1.0 - other).ln())
    }

    /// Probability that the burst began with the last reading.
    pub fn begun(&self) -> f64 {
        if self.age <= 1.0 { self.probability } else { 0.0 }
    }

    /// Whether the last reading was faulty too, should the next one be: a burst begins seldom, so that one which is on
    /// had begun with the first reading that is rather a wide draw.
    pub fn may_have_begun(&self, start: f64) -> bool {
        self.probability * (1.0 - (self.age + 2.0).recip()) > (1.0 - self.probability) * start
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
        let beyond = 1.0 / (1.0 + (from / SCATTER).ln_1p());
        assert!((sum + beyond - 1.0).abs() < 1e-3, "{sum} and {beyond}");
    }

    #[test]
    fn a_burst_begins_with_a_reading_far_off_and_ends_after_some_that_are_not() {
        let mut burst = Burst::default();
        let mut states = Vec::new();
        for residual in [0.5, 9.0, -40.0, 1e300, 0.3, -0.4, 0.2, 0.1, 0.6, -0.7] {
            burst.take(working(residual, 1.0), residual, 1.0, 1e-9, false);
            states.push(burst.is_on());
        }
        assert_eq!(states[..4], [false, true, true, true]);
        assert!(!states[9], "{states:?}");
    }

    /// Three stds and a half alone are none of a burst; before forty they were its first reading.
    #[test]
    fn a_reading_rather_wide_is_of_the_burst_that_follows() {
        for (residual, of_burst) in [(3.5, true), (1.0, false)] {
            let mut burst = Burst::default();
            burst.take(working(residual, 1.0), residual, 1.0, 1e-9, false);
            assert!(!burst.is_on() && burst.may_have_begun(1e-9) == of_burst, "{residual}");
        }
    }

    #[test]
    fn a_burst_learns_how_wide_its_readings_are() {
        let mut burst = Burst::default();
        let costs = [3e4, -4.5e4, 2e4, -3e4, 4e4, -1.5e4, 3e4]
            .map(|residual| burst.take(working(residual, 1.0), residual, 1.0, 1e-9, false));
        let known = (2.0 * 3e4_f64).ln() + 1.0;
        assert!(costs[6] > faulty(3e4, 1.0) + 2.0 && costs[6] > -known - 0.5, "{costs:?}");
    }

    /// Once the first have told where the others lie, each costs what a working sensor's scatter does.
    #[test]
    fn a_burst_to_one_side_learns_where_its_readings_lie() {
        let residuals = [30.3, 29.2, 30.8, 29.5, 30.1, 30.6, 29.4, 30.2, 29.9, 30.5];
        let cost = |to_one_side: bool| {
            let mut burst = Burst::default();
            residuals.map(|residual| burst.take(working(residual, 1.0), residual, 1.0, 1e-9, to_one_side))[9]
        };
        assert!(cost(true) > -2.0 && cost(false) < -4.5, "{}, {}", cost(true), cost(false));
    }

    /// An offset that lasts is not a burst's.
    #[test]
    fn a_burst_to_one_side_ends() {
        let mut burst = Burst::default();
        let costs = [4.0; 60].map(|residual| burst.take(working(residual, 1.0), residual, 1.0, 1e-9, true));
        assert!(costs[20] > -1.9 && costs[50] < -2.8, "{costs:?}");
    }

    #[test]
    fn five_stds_are_no_fault_of_a_sensor_that_never_failed() {
        let mut burst = Burst::default();
        burst.take(working(5.0, 1.0), 5.0, 1.0, 1e-9, false);
        assert!(!burst.is_on());
    }
}
