//! How long an oscillation of the displacement takes, from its swings to one side and the other.

use serde::{Deserialize, Serialize};

/// Samples that its mean and its size are taken over: four periods of the slowest motion that a variation of 2048
/// samples is half of.
const MEMORY: f64 = 16_384.0;

/// A side is reached beyond this part of the RMS: noise about the mean does not count, a sine is beyond it for two
/// thirds of the time.
const BEYOND: f64 = 0.5;

/// Swings to one side and the other, each weighed by the square of how far it went: the noise of a motion that is still
/// small swings fast, and is none of the oscillation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Oscillation {
    count: f64,
    mean: f64,
    square: f64,
    above: bool,
    swing: Swing,
    /// Σ of the squares of complete swings.
    weight: f64,
    /// Σ of their durations by these, samples.
    duration: f64,
}

/// The swing under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Swing {
    samples: f64,
    /// Largest square of the distance from the mean.
    square: f64,
}

impl Oscillation {
    /// Takes a displacement.
    pub fn step(&mut self, q: f64) {
        let kept = 1.0 - MEMORY.recip();
        self.count = self.count * kept + 1.0;
        self.mean += (q - self.mean) / self.count;
        let away = q - self.mean;
        self.square += (away * away - self.square) / self.count;
        (self.weight, self.duration) = (self.weight * kept, self.duration * kept);
        let reached = if self.above { -away } else { away };
        if reached > BEYOND * self.square.sqrt() {
            (self.weight, self.duration) = self.with_swing();
            (self.above, self.swing) = (!self.above, Swing::default());
        }
        self.swing.samples += 1.0;
        self.swing.square = self.swing.square.max(away * away);
    }

    fn with_swing(&self) -> (f64, f64) {
        let Swing { samples, square } = self.swing;
        (self.weight + square, self.duration + square * samples)
    }

    /// Samples in half a period; of the first, all so far.
    pub fn half_period(&self) -> f64 {
        let (weight, duration) = self.with_swing();
        if weight > 0.0 { duration / weight } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_period_is_found_beside_an_offset_and_noise() {
        let mut oscillation = Oscillation::default();
        for k in 0..20_000 {
            let noise = 0.1 * f64::from(k * 7919 % 101 - 50) / 50.0;
            oscillation.step(3.0 + (f64::from(k) * std::f64::consts::PI / 250.0).sin() + noise);
        }
        assert!((oscillation.half_period() / 250.0 - 1.0).abs() < 0.05, "{}", oscillation.half_period());
    }

    #[test]
    fn noise_before_the_motion_has_begun_is_no_oscillation() {
        let mut oscillation = Oscillation::default();
        for k in 0..3000 {
            let noise = 0.001 * f64::from(k * 7919 % 101 - 50) / 50.0;
            oscillation.step(0.5 - 1.5 * (f64::from(k) * std::f64::consts::PI / 3000.0).sin().powi(2) + noise);
        }
        assert!(oscillation.half_period() > 1000.0, "{}", oscillation.half_period());
    }
}
