//! What a machine's motion was, a few samples ago: (q, q̇) given all readings up to now, with its covariance.
//!
//! Fixed-lag smoothing by the covariance of each past state with the present one, M = Cov(x_j, x_k): it travels with
//! the motion, M ← M Aᵀ, and every reading corrects x_j by M h e/s (Anderson and Moore, *Optimal Filtering*, 1979,
//! 7.3).

use super::filter::{Kinematics, advance, begin, carried};
use super::noise::Smoothness;
use crate::estimation::filter::{Channel, Innovation};
use serde::{Deserialize, Serialize};

/// Longest lag, samples.
pub const LONGEST: usize = 32;

/// The motion at an instant, as Gaussian belief, and the force measured there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Instant {
    /// Time, s.
    pub t: f64,
    /// Expected displacement and velocity.
    pub state: [f64; 2],
    /// Variance of q, covariance, variance of q̇.
    pub covariance: [f64; 3],
    /// The measured force.
    pub force: f64,
}

/// A past instant and Cov(its state, the present state).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Past {
    instant: Instant,
    across: [[f64; 3]; 2],
}

/// The present state and those of the last samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FixedLagSmoother {
    present: Kinematics,
    /// Variances of the noise of q and q̇; none of what is not measured.
    noise: [Option<f64>; 2],
    intensity: f64,
    past: Vec<Past>,
    /// Samples so far; the last ones stand in `past` at their number modulo its length.
    count: u64,
    last: Instant,
}

impl FixedLagSmoother {
    /// No sample yet.
    pub fn new() -> FixedLagSmoother {
        FixedLagSmoother {
            present: Kinematics::default(),
            noise: [None; 2],
            intensity: 0.0,
            past: vec![Past::default(); LONGEST + 1],
            count: 0,
            last: Instant::default(),
        }
    }

    /// Takes what the sensors' noise and the motion's smoothness are from now on; a channel without noise is not
    /// measured.
    pub fn believe(&mut self, channels: [Option<Smoothness>; 2]) {
        self.noise = channels.map(|channel| channel.map(|channel| channel.variance));
        // the smoother of two beliefs would round off what the other channel resolves
        self.intensity = channels.into_iter().flatten().map(|channel| channel.intensity).fold(0.0, f64::max);
    }

    /// Std of the noise of q and q̇.
    pub fn noise(&self) -> [Option<f64>; 2] {
        self.noise.map(|variance| variance.map(f64::sqrt))
    }

    /// Samples so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Takes a sample.
    pub fn add(&mut self, t: f64, readings: [f64; 2], force: f64) {
        match self.count {
            0 => self.present.mean = [readings[0], readings[1], 0.0],
            1 => self.begin_moving(t - self.last.t, readings),
            _ => self.go_on(t - self.last.t, readings),
        }
        let Kinematics { mean, covariance } = self.present;
        let seen = [covariance[0][0], covariance[0][1], covariance[1][1]];
        self.last = Instant { t, state: [mean[0], mean[1]], covariance: seen, force };
        let slot = (self.count % self.past.len() as u64) as usize;
        self.past[slot] = Past { instant: self.last, across: [covariance[0], covariance[1]] };
        self.count += 1;
    }

    /// The motion `lag` samples ago; none of the first sample, whose velocity the second one tells, and where there
    /// was no sample.
    pub fn at(&self, lag: usize) -> Option<Instant> {
        let number = self.count.checked_sub(1 + lag as u64)?;
        let length = self.past.len();
        (number > 0 && lag < length).then(|| self.past[(number % length as u64) as usize].instant)
    }

    /// The second sample tells where the motion goes.
    fn begin_moving(&mut self, dt: f64, readings: [f64; 2]) {
        match self.noise {
            [Some(noise), of_velocity] => {
                self.present = begin(Channel::Q, [self.last.state[0], readings[0]], dt, noise);
                of_velocity.into_iter().for_each(|noise| self.measure(Channel::Qd, readings[1], noise));
            }
            [None, Some(noise)] => {
                self.present = begin(Channel::Qd, [self.last.state[1], readings[1]], dt, noise);
            }
            [None, None] => {}
        }
    }

    fn go_on(&mut self, dt: f64, readings: [f64; 2]) {
        advance(&mut self.present, dt, self.intensity);
        for past in self.held() {
            past.across = past.across.map(|row| carried(row, dt));
        }
        for (channel, reading) in Channel::ALL.into_iter().zip(readings) {
            if let Some(noise) = self.noise[channel as usize] {
                self.measure(channel, reading, noise);
            }
        }
    }

    fn measure(&mut self, channel: Channel, value: f64, noise: f64) {
        let own = self.present.covariance[channel as usize];
        let Innovation { residual, variance, precision, .. } = self.present.update(channel, value, noise);
        for Past { instant, across } in self.held() {
            let gain = [0, 1].map(|row: usize| across[row][channel as usize] * precision);
            (0..2).for_each(|row| instant.state[row] += gain[row] * residual);
            let pairs = [(0, 0), (0, 1), (1, 1)];
            for (entry, (row, column)) in instant.covariance.iter_mut().zip(pairs) {
                *entry -= gain[row] * gain[column] * variance;
            }
            for (row, gain) in across.iter_mut().zip(gain) {
                row.iter_mut().zip(own).for_each(|(entry, own)| *entry -= gain * own);
            }
        }
    }

    fn held(&mut self) -> impl Iterator<Item = &mut Past> {
        let held = self.count.min(self.past.len() as u64) as usize;
        self.past[..held].iter_mut()
    }
}
