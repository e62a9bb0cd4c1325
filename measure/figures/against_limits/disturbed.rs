//! What real sensors do besides Gaussian noise.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use switchid::simulate::Reading;

/// Share of readings that are outliers, and how far off, in σ.
const OUTLIERS: (f64, f64) = (0.005, 20.0);

/// Share of readings that are spikes, and between what they are off, in σ.
const SPIKES: (f64, [f64; 2]) = (0.005, [5.0, 50.0]);

/// Share of samples that are dropped one by one; one gap is this long besides, samples.
const DROPPED: (f64, usize) = (0.05, 100);

/// A disturbance of readings with Gaussian noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// None.
    None,
    /// One reading in 200 is 20 σ off, either way.
    Outliers,
    /// One reading in 200 is 5 to 50 σ off, either way.
    Spikes,
    /// Readings are rounded to multiples of 2σ.
    Quantised,
    /// One sample in 20 is missing, and 100 in a row.
    Dropped,
    /// The noise is three times as loud in the second half of the record.
    Louder,
}

impl Disturbance {
    /// All of them.
    pub const ALL: [Disturbance; 6] = [
        Disturbance::None,
        Disturbance::Outliers,
        Disturbance::Spikes,
        Disturbance::Quantised,
        Disturbance::Dropped,
        Disturbance::Louder,
    ];

    /// Its name in a table.
    pub fn id(self) -> &'static str {
        match self {
            Disturbance::None => "Gaussian",
            Disturbance::Outliers => "0.5 % of readings 20 σ off",
            Disturbance::Spikes => "0.5 % of readings 5 to 50 σ off",
            Disturbance::Quantised => "rounded to 2 σ",
            Disturbance::Dropped => "5 % dropped, a gap of 0.1 s",
            Disturbance::Louder => "3 σ in the second half",
        }
    }

    /// Std of the noise that is then to be found, for Gaussian noise of std σ; an outlier is none of it.
    pub fn std(self, sigma: f64) -> f64 {
        if self == Disturbance::Louder {
            return 3.0 * sigma;
        }
        let step = if self == Disturbance::Quantised { 2.0 * sigma } else { 0.0 };
        (sigma * sigma + step * step / 12.0).sqrt()
    }

    /// Disturbs readings whose noise has std σ.
    pub fn apply(self, readings: &[Reading], sigma: f64, seed: u64) -> Vec<Reading> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let gap = readings.len() / 3..readings.len() / 3 + DROPPED.1;
        let mut disturbed = Vec::with_capacity(readings.len());
        for (index, reading) in readings.iter().enumerate() {
            let rounded = |value: f64| (value / (2.0 * sigma)).round() * 2.0 * sigma;
            match self {
                Disturbance::None => disturbed.push(*reading),
                Disturbance::Outliers => {
                    let mut off = || sigma * outlier(&mut generator);
                    disturbed.push(Reading { q: reading.q + off(), qd: reading.qd + off(), ..*reading });
                }
                Disturbance::Spikes => {
                    let mut off = || sigma * spike(&mut generator);
                    disturbed.push(Reading { q: reading.q + off(), qd: reading.qd + off(), ..*reading });
                }
                Disturbance::Quantised => {
                    disturbed.push(Reading { q: rounded(reading.q), qd: rounded(reading.qd), ..*reading });
                }
                Disturbance::Louder if 2 * index > readings.len() => {
                    let mut more = || 8.0_f64.sqrt() * sigma * normal(&mut generator);
                    disturbed.push(Reading { q: reading.q + more(), qd: reading.qd + more(), ..*reading });
                }
                Disturbance::Louder => disturbed.push(*reading),
                Disturbance::Dropped if gap.contains(&index) || generator.random_bool(DROPPED.0) => {}
                Disturbance::Dropped => disturbed.push(*reading),
            }
        }
        disturbed
    }
}

/// How far off a reading is, in σ; mostly 0.
fn outlier(generator: &mut ChaCha8Rng) -> f64 {
    match generator.random_bool(OUTLIERS.0) {
        true if generator.random_bool(0.5) => OUTLIERS.1,
        true => -OUTLIERS.1,
        false => 0.0,
    }
}

/// The same, as far off as it happens to be.
fn spike(generator: &mut ChaCha8Rng) -> f64 {
    if !generator.random_bool(SPIKES.0) {
        return 0.0;
    }
    let [least, most] = SPIKES.1;
    let size = generator.random_range(least..most);
    if generator.random_bool(0.5) { size } else { -size }
}

fn normal(generator: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(generator)
}
