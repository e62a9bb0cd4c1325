//! A recording made ready for comparison with a law.

use super::rows::{Prepared, Rows, Windows};
use super::trajectory::Trajectory;
use crate::diagnose::motion::sensor_noise;
use crate::diagnose::piece::Piece;
use crate::identify::Recording;
use crate::law::{Expression, Hold, Term};

/// Windows overlap: one begins every fourth part of its length.
const OVERLAP: usize = 4;

/// A recording with its motion, its noise and the series of the law's terms.
#[derive(Clone, Debug)]
pub struct Record {
    /// Where it came from.
    pub source: String,
    /// Estimated std of the sensors of q and q̇; 0 where not measured.
    pub noise: [f64; 2],
    /// Usual distance of two samples, s.
    pub sample_time: f64,
    /// Whether there is an excitation.
    pub forced: bool,
    /// Its pieces between gaps.
    pub pieces: Vec<Prepared>,
}

/// Sums over windows: what the residual, the force it is compared with and the noise amount to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Σ residual² ÷ ∫φ².
    pub residual: f64,
    /// Σ excitation² ÷ ∫φ², of free motion Σ inertia².
    pub force: f64,
    /// Σ of the residual's variance from the sensors' noise ÷ ∫φ².
    pub noise: f64,
}

impl Record {
    /// Prepares a recording for a law of these terms.
    pub fn new(recording: &Recording, hold: Hold, terms: &[Term], expressions: &[Expression]) -> Record {
        let pieces = Piece::all(recording, hold);
        let noise = sensor_noise(&pieces);
        let motions = Trajectory::all(&pieces, noise);
        let prepared =
            pieces.into_iter().zip(motions).map(|(piece, motion)| Prepared::new(piece, motion, terms, expressions));
        Record {
            source: recording.source().into(),
            noise,
            sample_time: recording.sample_time(),
            forced: recording.channels().excitation,
            pieces: prepared.collect(),
        }
    }

    /// Overlapping windows of `length` s: at least 5 samples, at most the longest piece.
    pub fn windows(&self, length: f64) -> Windows {
        let longest = self.pieces.iter().map(|prepared| prepared.piece.len()).max().unwrap_or(5);
        let samples = ((length / self.sample_time).round() as usize + 1).min(longest).max(5);
        Windows { samples, stride: (samples / OVERLAP).max(1) }
    }

    /// The weak equations of every piece.
    pub fn rows(&self, windows: Windows) -> Vec<Rows> {
        let rows = self.pieces.iter().map(|prepared| prepared.rows(windows));
        rows.filter(|rows| !rows.is_empty()).collect()
    }

    /// Residual, force and noise of the law with these coefficients over windows of one length.
    pub fn balance(&self, windows: Windows, terms: &[Term], coefficients: &[f64]) -> Balance {
        let inertia = terms.iter().position(|term| *term == Term::Inertia);
        let mut balance = Balance::default();
        for prepared in &self.pieces {
            let rows = prepared.rows(windows);
            let residuals = rows.residuals(coefficients);
            let variances = prepared.noise(windows, coefficients, self.noise);
            let force = |index: usize| match inertia {
                Some(inertia) if !self.forced => rows.row(index)[inertia] * coefficients[inertia],
                _ => rows.right[index],
            };
            for (index, (residual, variance)) in residuals.iter().zip(variances).enumerate() {
                balance.residual += residual * residual / rows.norm;
                balance.noise += variance / rows.norm;
                balance.force += force(index).powi(2) / rows.norm;
            }
        }
        balance
    }
}

impl Balance {
    /// Both together.
    pub fn and(self, other: Balance) -> Balance {
        Balance {
            residual: self.residual + other.residual,
            force: self.force + other.force,
            noise: self.noise + other.noise,
        }
    }

    /// RMS residual ÷ RMS force.
    pub fn force_residual(self) -> f64 {
        ratio(self.residual, self.force)
    }

    /// What [`Balance::force_residual`] would be were the law right.
    pub fn noise_floor(self) -> f64 {
        ratio(self.noise, self.force)
    }
}

fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { (part / whole).sqrt() } else { 0.0 }
}
