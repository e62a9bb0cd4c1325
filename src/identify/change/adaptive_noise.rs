//! How loud the sensors are now, in terms of what the law's record knows of them: noise that changes is followed at
//! once.
//!
//! Noise differs from sample to sample; what a switch adds to the innovations lasts. Half the mean square of successive
//! differences (von Neumann, *Ann. Math. Stat.* 12 (1941), 367) hears the one and hardly the other.

use crate::estimation::{Innovation, Noise};
use serde::{Deserialize, Serialize};

/// Samples that count for what is weighed now: their variance is known to an eighth, √(2 ÷ 150).
const NOW: f64 = 150.0;

/// Samples that count for what is published: their variance is known to 4.5 %, √(2 ÷ 1000).
const LATELY: f64 = 1000.0;

/// Below this ratio of variances the noise counts as unchanged when switches are weighed: by chance it is exceeded once
/// in 2000 samples.
const LOUDER: f64 = 1.5;

/// A variance that differs by less than this part lately, three of its stds, is unchanged.
const UNCHANGED: f64 = 0.15;

/// A single innovation counts for no more than this many times its variance: ten stds, so that one reading moves the
/// mean of 150 by two thirds at most.
const MOST: f64 = 100.0;

/// A reading that was left out counts for so many times its variance: the square of the six stds from which on it is.
const LEFT_OUT: f64 = 36.0;

/// Running means of half of (ε − the one before)²/s by channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdaptiveNoise {
    /// The last innovations ÷ their std.
    last: [f64; 2],
    now: [f64; 2],
    lately: [f64; 2],
}

impl AdaptiveNoise {
    /// Nothing but what the record knows.
    pub const USUAL: AdaptiveNoise = AdaptiveNoise { last: [0.0; 2], now: [1.0; 2], lately: [1.0; 2] };

    /// What is published is what the record knows.
    pub fn forget_lately(&mut self) {
        self.lately = [1.0; 2];
    }

    /// Takes innovations that were weighed with the sensors' variances times [`AdaptiveNoise::factor`].
    #[inline]
    pub fn add(&mut self, innovations: &[Option<Innovation>; 2], measured: &[Option<f64>; 2]) {
        for channel in (0..2).filter(|channel| measured[*channel].is_some()) {
            let factor = self.factor(channel);
            let Some(said) = innovations[channel] else {
                self.now[channel] += (LEFT_OUT - self.now[channel]) / NOW;
                continue;
            };
            let innovation = said.residual * (factor * said.precision).sqrt();
            let last = std::mem::replace(&mut self.last[channel], innovation);
            let square = (0.5 * (innovation - last).powi(2)).min(MOST);
            self.now[channel] += (square - self.now[channel]) / NOW;
            self.lately[channel] += (square - self.lately[channel]) / LATELY;
        }
    }

    /// By how much the channel's variance is larger now.
    #[inline]
    pub fn factor(&self, channel: usize) -> f64 {
        if self.now[channel] > LOUDER { self.now[channel] } else { 1.0 }
    }

    /// By how much the channel's variance has differed lately; none where it has not.
    pub fn lately(&self, channel: usize) -> Option<f64> {
        Some(self.lately[channel]).filter(|lately| (lately - 1.0).abs() > UNCHANGED)
    }

    /// From now on everything is in terms of another noise.
    pub fn refer(&mut self, old: &Noise, new: &Noise) {
        for channel in 0..2 {
            let ratio = old.sensor[channel] / new.sensor[channel];
            self.now[channel] *= ratio;
            self.lately[channel] *= ratio;
        }
    }
}
