//! Sensor noise from the differences of neighbouring samples, while no law is known.
//!
//! A smooth motion leaves third differences small; under a rough excitation, held from sample to sample, they follow
//! from it: Δ³q̇ ≈ (F₂ − 2F₁ + F₀) dt/m and Δ³q ≈ (F₂ − F₀) dt²/2m. What a regression on these leaves is noise, of 20
//! times the sensor's variance. A difference far off holds an outlier and is left out, and so are its neighbours: the
//! outlier is in them too, a third as large.

use super::odds::SAMPLES_OF_A_VARIANCE;
use serde::{Deserialize, Serialize};

/// Variance of a third difference of white noise of variance 1: 1² + 3² + 3² + 1².
const GAIN: f64 = 20.0;

/// Differences from which on outliers can be told, their variance being known to a quarter; the first so many tell no
/// more than that, for they may hold some (15 % too much after 4 s, docs/decisions/sensor-faults.md) …
const ENOUGH: f64 = 64.0;

/// … by lying this many stds off: by chance one in 150 000 does.
const FAR: f64 = 4.5;

/// So many of them in a row are a change of the noise: an outlier is in four, so that this is ten of them and no gap.
const LASTS: u32 = 40;

/// Intervals that differ by less than this part are alike: hosts jitter, a lost sample doubles one.
const ALIKE: f64 = 0.2;

/// Mean products of a channel's differences d and of what the excitation explains of them, r.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Moments {
    count: f64,
    dd: f64,
    dr: f64,
    rr: f64,
    far: u32,
    /// The last difference and what explains it, until the next one is no outlier either.
    waiting: Option<[f64; 2]>,
    /// Slope, and mean square of what it leaves, of the first differences; none before.
    first: Option<[f64; 2]>,
}

impl Moments {
    fn add(&mut self, difference: f64, explaining: f64) {
        let beyond_numbers = !(difference * difference).is_finite() || !(explaining * explaining).is_finite();
        if beyond_numbers || self.is_far(difference, explaining) {
            (self.far, self.waiting) = (self.far + 1, None);
            if self.far > LASTS {
                *self = Moments::default();
            }
            return;
        }
        let follows = std::mem::take(&mut self.far) > 0;
        let next = (!follows).then_some([difference, explaining]);
        if let Some([difference, explaining]) = std::mem::replace(&mut self.waiting, next) {
            self.count_in(difference, explaining);
        }
    }

    fn count_in(&mut self, difference: f64, explaining: f64) {
        self.count = (self.count + 1.0).min(SAMPLES_OF_A_VARIANCE);
        let share = self.count.recip();
        self.dd += share * (difference * difference - self.dd);
        self.dr += share * (difference * explaining - self.dr);
        self.rr += share * (explaining * explaining - self.rr);
        if self.first.is_none() && self.count >= ENOUGH {
            *self = Moments { first: Some([self.slope(), self.rest()]), ..Moments::default() };
        }
    }

    /// Whether the difference holds an outlier, as far as that can be told.
    fn is_far(&self, difference: f64, explaining: f64) -> bool {
        self.usual().is_some_and(|[slope, rest]| (difference - slope * explaining).powi(2) > FAR * FAR * rest)
    }

    /// Slope, and mean square of what it leaves.
    fn usual(&self) -> Option<[f64; 2]> {
        if self.count > ENOUGH { Some([self.slope(), self.rest()]) } else { self.first }
    }

    fn slope(&self) -> f64 {
        if self.rr > 0.0 { self.dr / self.rr } else { 0.0 }
    }

    /// Mean square of what the excitation does not explain.
    fn rest(&self) -> f64 {
        let explained = if self.rr > 0.0 { self.dr * self.dr / self.rr } else { 0.0 };
        (self.dd - explained).max(0.0)
    }
}

/// Running estimates of both sensors' noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DifferenceNoise {
    moments: [Moments; 2],
}

impl DifferenceNoise {
    /// Takes the last four samples: their times, s, their values by channel, and the excitation.
    pub fn add(&mut self, t: [f64; 4], measured: [[f64; 4]; 2], excitation: [f64; 4]) {
        let intervals = [t[1] - t[0], t[2] - t[1], t[3] - t[2]];
        if intervals.iter().any(|interval| (interval / intervals[0] - 1.0).abs() > ALIKE) {
            return;
        }
        let third = |[a, b, c, d]: [f64; 4]| d - 3.0 * c + 3.0 * b - a;
        let [a, b, c, _] = excitation;
        let [q, qd] = &mut self.moments;
        q.add(third(measured[0]), c - a);
        qd.add(third(measured[1]), c - 2.0 * b + a);
    }

    /// Variance of the sensors' noise by channel, (m)² and (m/s)²; none from too few samples.
    pub fn variance(&self) -> Option<[f64; 2]> {
        let [q, qd] = self.moments.map(|moments| moments.usual());
        Some([q?[1] / GAIN, qd?[1] / GAIN])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// A slow motion with noise of std 0.01, one sample in 200 off by this, the first of them soon, under an excitation
    /// that pushes q̇ from sample to sample.
    fn found(push: f64, outlier: f64) -> f64 {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let mut white = || generator.sample::<f64, _>(StandardNormal);
        let (mut roughness, mut samples, mut qd) = (DifferenceNoise::default(), Vec::new(), 0.0);
        for k in 0..4000 {
            let t = 0.001 * f64::from(k);
            let excitation = push * white();
            let off = if k % 200 == 37 { outlier } else { 0.0 };
            let noise = 0.01 * white() + off;
            samples.push([t, t.sin() + noise, qd + t.cos() + noise, excitation]);
            qd += 0.5 * excitation;
        }
        for four in samples.as_slice().windows(4) {
            let [t, q, qd, excitation] = [0, 1, 2, 3].map(|column| [0, 1, 2, 3].map(|row: usize| four[row][column]));
            roughness.add(t, [q, qd], excitation);
        }
        roughness.variance().map_or(f64::NAN, |[_, qd]| qd.sqrt())
    }

    #[test]
    fn neither_outliers_nor_a_rough_excitation_count_as_noise() {
        for push in [0.0, 2.0] {
            assert!((found(push, 0.3) / 0.01 - 1.0).abs() < 0.08, "{push}: {}", found(push, 0.3));
        }
    }

    /// An outlier of 20 stds is in four differences, in the first and the last of them as one of 4.5.
    #[test]
    fn the_ends_of_an_outlier_s_differences_do_not_count_either() {
        let (with, without) = (found(0.0, 0.2), found(0.0, 0.0));
        assert!((with / without - 1.0).abs() < 0.01, "{with} against {without}");
    }
}
