//! Sensor noise from the differences of neighbouring samples, while no law is known.
//!
//! A smooth motion leaves third differences small; under a rough excitation, held from sample to sample, they follow from it:
//! Δ³q̇ ≈ (F₂ − 2F₁ + F₀) dt/m and Δ³q ≈ (F₂ − F₀) dt²/2m. What a regression on these leaves is noise, of 20 times the sensor's variance. A
//! difference far off holds an outlier and is left out.

use super::identifier::Sample;
use serde::{Deserialize, Serialize};

/// Variance of a third difference of white noise of variance 1.
const GAIN: f64 = 20.0;

/// Samples that count.
const MEMORY: f64 = 4000.0;

/// Differences from which on outliers can be told …
const ENOUGH: f64 = 64.0;

/// … by lying this many stds off.
const FAR: f64 = 4.5;

/// So many of them in a row are a change of the noise.
const LASTS: u32 = 40;

/// Intervals that differ by less than this part are alike.
const ALIKE: f64 = 0.2;

/// Mean products of a channel's differences d and of what the excitation explains of them, r.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Moments {
    count: f64,
    dd: f64,
    dr: f64,
    rr: f64,
    far: u32,
}

impl Moments {
    fn add(&mut self, difference: f64, explaining: f64) {
        let slope = if self.rr > 0.0 { self.dr / self.rr } else { 0.0 };
        let rest = difference - slope * explaining;
        if self.count > ENOUGH && rest * rest > FAR * FAR * self.rest() {
            self.far += 1;
            if self.far > LASTS {
                *self = Moments::default();
            }
            return;
        }
        self.far = 0;
        self.count = (self.count + 1.0).min(MEMORY);
        let share = self.count.recip();
        self.dd += share * (difference * difference - self.dd);
        self.dr += share * (difference * explaining - self.dr);
        self.rr += share * (explaining * explaining - self.rr);
    }

    /// Mean square of what the excitation does not explain.
    fn rest(&self) -> f64 {
        let explained = if self.rr > 0.0 { self.dr * self.dr / self.rr } else { 0.0 };
        (self.dd - explained).max(0.0)
    }
}

/// Running estimates of both sensors' noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Roughness {
    moments: [Moments; 2],
}

impl Roughness {
    /// Takes the last four samples.
    pub fn add(&mut self, samples: [&Sample; 4]) {
        let [a, b, c, d] = samples;
        let intervals = [b.t - a.t, c.t - b.t, d.t - c.t];
        if intervals.iter().any(|interval| (interval / intervals[0] - 1.0).abs() > ALIKE) {
            return;
        }
        let third = |value: fn(&Sample) -> f64| value(d) - 3.0 * value(c) + 3.0 * value(b) - value(a);
        let [q, qd] = &mut self.moments;
        q.add(third(|sample| sample.q), c.excitation - a.excitation);
        qd.add(third(|sample| sample.qd), c.excitation - 2.0 * b.excitation + a.excitation);
    }

    /// Variance of the sensors' noise by channel, (m)² and (m/s)²; none from too few samples.
    pub fn variance(&self) -> Option<[f64; 2]> {
        let enough = self.moments.iter().all(|moments| moments.count > ENOUGH);
        enough.then(|| self.moments.map(|moments| moments.rest() / GAIN))
    }
}
