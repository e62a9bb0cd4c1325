//! How smooth a measured motion is and how noisy its sensor: the largest likelihood of (R, Q) over a grid of Q ÷ R.
//!
//! Both variances scale with R, so that for each ratio R = mean e²/s is the maximum in closed form (concentrated
//! likelihood, Harvey, *Forecasting, Structural Time Series Models and the Kalman Filter*, 1989, 3.4.1).

use super::filter::{Kinematics, advance, begin};
use crate::estimation::filter::Channel;
use crate::estimation::symmetric::LogSum;
use serde::{Deserialize, Serialize};

/// Ratios that are tried: of the filter's corner frequency from 0.003 rad per sample on …
const RATIOS: usize = 12;
/// … the lowest, a period of 2000 samples …
const LOWEST: f64 = 3e-3;
/// … by factors of √√10, up to 1.7 rad, beyond half of Nyquist's π.
const FACTOR: f64 = 1.778_279_410_038_922_8;

/// Readings that only say where the motion begins: more than twice the three unknowns of the state.
const SETTLING: u32 = 8;

/// Noise ÷ RMS of the readings below which it is rounding.
const ROUNDING: f64 = 1e-9;

/// Log-likelihood below the largest, nats, up to which a ratio is not refuted: the profile's one-sided 95 % bound,
/// χ²₁(0.9) ÷ 2.
const PLAUSIBLE: f64 = 1.35;

/// One ratio and how well it predicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Rival {
    /// Q ÷ R.
    ratio: f64,
    filter: Kinematics,
    squares: f64,
    logarithms: LogSum,
}

/// The noise of q and of q̇; none of what is not measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionNoise {
    channels: [Option<ChannelNoise>; 2],
}

/// The noise of one channel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ChannelNoise {
    channel: Channel,
    rivals: Vec<Rival>,
    /// Readings since the motion began, those that count, and those since the last interruption.
    begun: u32,
    count: u32,
    since: u32,
    last: [f64; 2],
    /// Mean square of the readings.
    power: f64,
}

/// Variance of a sensor, and intensity of the jerk as this sensor sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Smoothness {
    /// R.
    pub variance: f64,
    /// Q, (m/s³)² s.
    pub intensity: f64,
}

impl MotionNoise {
    /// No reading yet of the channels that are `measured`, about every `sample_time` s.
    pub fn new(measured: [bool; 2], sample_time: f64) -> MotionNoise {
        let of = |channel: Channel| measured[channel as usize].then(|| ChannelNoise::new(channel, sample_time));
        MotionNoise { channels: Channel::ALL.map(of) }
    }

    /// Takes what q and q̇ are read to be at time t, s.
    pub fn add(&mut self, t: f64, readings: [f64; 2]) {
        for (noise, value) in self.channels.iter_mut().zip(readings) {
            noise.iter_mut().for_each(|noise| noise.add(t, value));
        }
    }

    /// The next sample is not the last one's neighbour.
    pub fn interrupt(&mut self) {
        self.channels.iter_mut().flatten().for_each(|noise| noise.since = 0);
    }

    /// Whether every channel has so many readings since the motion began.
    pub fn has_seen(&self, readings: u32) -> bool {
        self.channels.iter().flatten().all(|noise| noise.begun >= readings)
    }

    /// What each channel that is measured tells, with the variance that is `given` where one is; none before enough
    /// readings.
    pub fn likeliest(&self, given: [Option<f64>; 2]) -> Option<[Option<Smoothness>; 2]> {
        let mut found = [None; 2];
        for ((slot, noise), given) in found.iter_mut().zip(&self.channels).zip(given) {
            if let Some(noise) = noise {
                let Smoothness { variance, intensity } = noise.likeliest()?;
                *slot = Some(Smoothness { variance: given.unwrap_or(variance), intensity });
            }
        }
        Some(found)
    }
}

impl ChannelNoise {
    /// For a channel read about every `sample_time` s.
    fn new(channel: Channel, sample_time: f64) -> ChannelNoise {
        let rival = |index: i32| {
            let corner = LOWEST * FACTOR.powi(index) / sample_time;
            let ratio = corner.powi(6 - 2 * channel as i32) * sample_time;
            Rival { ratio, filter: Kinematics::default(), squares: 0.0, logarithms: LogSum::default() }
        };
        let rivals = (0..RATIOS as i32).map(rival).collect();
        ChannelNoise { channel, rivals, begun: 0, count: 0, since: 0, last: [0.0; 2], power: 0.0 }
    }

    /// Takes a reading at time t, s.
    fn add(&mut self, t: f64, value: f64) {
        let [before, last] = self.last;
        let (dt, channel) = (t - before, self.channel);
        self.last = [t, value];
        if self.begun == 1 && value == last {
            // before it moves a motion tells neither noise nor smoothness
            return;
        }
        self.begun = self.begun.saturating_add(1);
        self.since = self.since.saturating_add(1);
        self.count = self.count.saturating_add(u32::from(self.since > SETTLING));
        self.power += (value * value - self.power) / f64::from(self.begun);
        for rival in &mut self.rivals {
            match self.since {
                1 => {}
                2 => rival.filter = begin(channel, [last, value], dt, 1.0),
                since => rival.add(dt, channel, value, since > SETTLING),
            }
        }
    }

    /// The roughest motion that the readings do not refute; none before enough readings.
    fn likeliest(&self) -> Option<Smoothness> {
        let count = f64::from(Some(self.count).filter(|count| *count > 0)?);
        let floor = ROUNDING * ROUNDING * self.power.max(f64::MIN_POSITIVE);
        let loss = |rival: &Rival| (rival.squares / count).max(floor).ln() + rival.logarithms.total() / count;
        let least = self.rivals.iter().map(loss).fold(f64::INFINITY, f64::min);
        // a motion taken for too rough is known less well than it could be, one taken for too smooth is another motion
        let best = self.rivals.iter().rev().find(|rival| count * (loss(rival) - least) <= 2.0 * PLAUSIBLE)?;
        let variance = (best.squares / count).max(floor);
        Some(Smoothness { variance, intensity: best.ratio * variance })
    }
}

impl Rival {
    fn add(&mut self, dt: f64, channel: Channel, value: f64, counts: bool) {
        advance(&mut self.filter, dt, self.ratio);
        let innovation = self.filter.update(channel, value, 1.0);
        if counts {
            self.squares += innovation.residual * innovation.residual * innovation.precision;
            self.logarithms.add(innovation.variance);
        }
    }
}
