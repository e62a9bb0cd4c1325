//! How long an oscillation of the displacement takes, from how often it changes sides.

use serde::{Deserialize, Serialize};

/// Samples that its mean and its size are taken over: four periods of the slowest motion that a variation of 2048
/// samples is half of.
const MEMORY: f64 = 16_384.0;

/// A side is reached beyond this part of the RMS: noise about the mean does not count, a sine is beyond it for two
/// thirds of the time.
const BEYOND: f64 = 0.5;

/// Running count of sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Oscillation {
    count: f64,
    mean: f64,
    square: f64,
    changes: f64,
    above: bool,
}

impl Oscillation {
    /// Takes a displacement.
    pub fn step(&mut self, q: f64) {
        let kept = 1.0 - MEMORY.recip();
        self.count = self.count * kept + 1.0;
        self.mean += (q - self.mean) / self.count;
        let away = q - self.mean;
        self.square += (away * away - self.square) / self.count;
        let reached = if self.above { -away } else { away };
        let changes = reached > BEYOND * self.square.sqrt();
        self.changes = self.changes * kept + f64::from(u8::from(changes));
        self.above ^= changes;
    }

    /// Samples in half a period; infinite before the first is complete.
    pub fn half_period(&self) -> f64 {
        if self.changes > 2.0 { self.count / self.changes } else { f64::INFINITY }
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
}
