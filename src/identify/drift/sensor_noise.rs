//! The sensors' noise from fourth differences, which a motion leaves small that is smooth over five samples.

use crate::identify::settings::Settings;
use crate::identify::window::Window;
use serde::{Deserialize, Serialize};

/// Samples that a variance is the mean of: it is then known to 7 %, √(2 Σρ² ÷ N) with Σρ² = 2.6.
const MEMORY: f64 = 1024.0;

/// Variance of a fourth difference of white noise of variance 1: 1² + 4² + 6² + 4² + 1².
const GAIN: f64 = 70.0;

/// A difference counts for at most this many times the variance so far, five stds: a jump of the motion is no noise.
const LARGEST: f64 = 25.0;

/// Running variances of the sensors' noise by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SensorNoise {
    count: f64,
    variance: [f64; 2],
}

impl SensorNoise {
    /// Takes the last five samples of the window.
    pub fn step(&mut self, window: &Window) {
        if window.end() < window.oldest() + 5 {
            return;
        }
        let last: [_; 5] = std::array::from_fn(|back| *window.sample(window.end() - 1 - back as u64));
        let difference = |values: [f64; 5]| {
            let [a, b, c, d, e] = values;
            (a - 4.0 * b + 6.0 * c - 4.0 * d + e).powi(2) / GAIN
        };
        let seen = [difference(last.map(|sample| sample.q)), difference(last.map(|sample| sample.qd))];
        self.count = (self.count + 1.0).min(MEMORY);
        for (variance, seen) in self.variance.iter_mut().zip(seen) {
            let seen = if self.count > 32.0 { seen.min(LARGEST * *variance + f64::MIN_POSITIVE) } else { seen };
            *variance += (seen - *variance) / self.count;
        }
    }

    /// Variances by channel, those given by the user where there are any. They are upper bounds, where an excitation is
    /// rough by far: `most` is a lower one, if there is one.
    pub fn variances(&self, settings: &Settings, most: [f64; 2]) -> [f64; 2] {
        let given = [settings.noise_q, settings.noise_qd];
        let seen = |index: usize| self.variance[index].min(most[index]);
        std::array::from_fn(|index| if given[index] > 0.0 { given[index].powi(2) } else { seen(index) })
    }
}
