//! When F acted, against when it is taken to have: by the motion, in the stream.
//!
//! A lag is one more coefficient beside a run, as in the score test of effects: its force is what F was a sample
//! before, less what it is.

use super::filter::Innovation;
use super::one_more_coefficient::{OwnTerms, Sums};
use super::pass::{Pass, gains};
use super::track::Track;
use crate::law::Motion;
use serde::{Deserialize, Serialize};

/// When F acted, by the motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lag {
    /// By how many samples F acted later than it is taken to.
    pub samples: f64,
    /// Std of that; infinite where the motion says nothing.
    pub std: f64,
    /// Log-likelihood that it gains over none, nats.
    pub evidence: f64,
}

impl Lag {
    /// Nothing is said.
    pub const UNKNOWN: Lag = Lag { samples: 0.0, std: f64::INFINITY, evidence: 0.0 };

    /// What a record of Gaussian scatter says.
    pub fn of(samples: f64, std: f64) -> Lag {
        Lag { samples, std, evidence: 0.5 * (samples / std).powi(2) }
    }

    /// What it says where whatever is assumed is known to that std only.
    pub fn blurred(&self, std: f64) -> Lag {
        let variance = self.std * self.std + std * std;
        let share = if self.std.is_finite() { self.std * self.std / variance } else { 1.0 };
        Lag { std: variance.sqrt(), evidence: share * self.evidence, ..*self }
    }

    /// Log-likelihood that a lag of so many samples gains over none, nats.
    pub fn evidence_of(&self, samples: f64) -> f64 {
        self.evidence - 0.5 * ((self.samples - samples) / self.std).powi(2)
    }
}

/// What a run says of when F acted, and how well it explains its record with its coefficients at the maximum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToldLag {
    /// The lag, against none in the same run.
    pub lag: Lag,
    /// What one of a sample makes of the free coefficients, n.
    pub slope: Vec<f64>,
    /// Log-likelihood without a lag, nats.
    pub without: f64,
}

impl ToldLag {
    /// Nothing, of `n` free terms.
    pub fn none(n: usize) -> ToldLag {
        ToldLag { lag: Lag::UNKNOWN, slope: vec![0.0; n], without: 0.0 }
    }

    /// Forgets what was told.
    pub fn clear(&mut self) {
        (self.lag, self.without) = (Lag::UNKNOWN, 0.0);
        self.slope.fill(0.0);
    }

    /// Takes over what another run says.
    pub fn copy_from(&mut self, other: &ToldLag) {
        (self.lag, self.without) = (other.lag, other.without);
        self.slope.copy_from_slice(&other.slope);
    }

    /// Log-likelihood with the lag, nats.
    pub fn with(&self) -> f64 {
        self.without + self.lag.evidence
    }
}

/// When F acted, beside a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LagTest {
    /// F as it was a sample before and as it is a sample later, each less what it is: their coefficients are F's lag,
    /// and by how much it acts too early.
    lags: [Sums; 2],
}

impl LagTest {
    /// Beside `n` free terms.
    pub fn new(n: usize) -> LagTest {
        LagTest { lags: [Sums::new(n), Sums::new(n)] }
    }

    /// Begins beside a run.
    pub fn begin(&mut self) {
        self.lags.iter_mut().for_each(Sums::clear);
    }

    /// Takes the sample that the run has just taken, under the law `motion`; `shifts` is what F was a sample before and
    /// will be a sample later, less what it is; `beside` is what the coefficient of the effect added to the law makes
    /// of the innovations.
    pub fn step(
        &mut self,
        motion: &Motion,
        pass: &Pass,
        shifts: [f64; 2],
        innovations: &[Option<Innovation>; 2],
        beside: [f64; 2],
    ) {
        let inverse_mass = motion.mass(pass.filter.mean[0]).recip();
        let gains = gains(innovations);
        for (sums, shift) in self.lags.iter_mut().zip(shifts) {
            sums.take(pass, shift * inverse_mass, &gains, innovations, beside);
        }
    }

    /// The coefficients have become those plus `step`.
    pub fn shift(&mut self, step: &[f64]) {
        self.lags.iter_mut().for_each(|sums| sums.shift(step));
    }

    /// The coefficient of the effect added to the law has become that plus `step`.
    pub fn shift_beside(&mut self, step: f64) {
        self.lags.iter_mut().for_each(|sums| sums.shift_beside(step));
    }

    /// Tells when F acted against when it is taken to have, by a run of that track which says `own` of the law's terms.
    pub fn tell(&self, own: &OwnTerms, track: &Track, overdispersion: f64, told: &mut ToldLag) {
        let track = track.no_quieter();
        let solved = self.lags.each_ref().map(|sums| sums.gain(own));
        let (place, sign) = if solved[0].1 >= solved[1].1 { (0, 1.0) } else { (1, -1.0) };
        let (samples, gain, information) = solved[place];
        for (row, slope) in told.slope.iter_mut().enumerate() {
            *slope = if own.active[row] { -sign * self.lags[place].shared(row, own) } else { 0.0 };
        }
        // what the coefficients' step and the lag take off the squares, from which the noise is known
        let step = own.gain();
        let squares = (track.squares[0] + track.squares[1]).max(f64::MIN_POSITIVE);
        let left = |gain: f64| (1.0 - 2.0 * gain / squares).max(f64::MIN_POSITIVE);
        let gained = |gain: f64| -0.5 * track.total() * left(gain).ln();
        let overdispersion = overdispersion.max(1.0);
        let variance = overdispersion * left(step + gain) * squares / (track.total() * information);
        let evidence = (gained(step + gain) - gained(step)) / overdispersion;
        let lag = Lag { samples: sign * samples, std: variance.sqrt(), evidence };
        told.lag = if information > 0.0 { lag } else { Lag::UNKNOWN };
        told.without = track.log_likelihood() + gained(step);
    }
}
