//! First coefficients from weak rows of one length: what they say, and how well.
//!
//! Nothing is known of a system's time scale at first, so that rows are formed with variations of many lengths, each
//! length a regression of its own. The length whose predicted error is smallest is the best: short ones average too
//! little noise, long ones have too few rows.

use crate::weak::{Fit, Regression, Row, Variation};
use serde::{Deserialize, Serialize};

/// Rows begin this fraction of a variation apart: rows within a quarter of one share what they say, more of them would
/// tell nothing new.
pub const OVERLAP: usize = 8;

/// Smooth enough that the trapezoidal rule is exact to far below the noise, wide enough to average.
pub const VARIATION: Variation = Variation::Polynomial { power: 6 };

/// A regression over weak rows of one length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowsOfLength {
    /// Intervals between samples in a row's variation.
    pub length: usize,
    regression: Regression,
    /// Σ (right side)² over the rows.
    norm: f64,
    /// Σ over the rows of what noise of std 1 in (q, q̇) adds to the square of each entry.
    noise: Vec<[f64; 2]>,
}

impl RowsOfLength {
    /// No rows, for `n` unknowns.
    pub fn new(length: usize, n: usize) -> RowsOfLength {
        RowsOfLength { length, regression: Regression::new(n), norm: 0.0, noise: vec![[0.0; 2]; n] }
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.regression.clear();
        self.norm = 0.0;
        self.noise.fill([0.0; 2]);
    }

    /// Samples between the beginnings of two rows.
    pub fn stride(&self) -> usize {
        (self.length / OVERLAP).max(1)
    }

    /// Takes the equation `left` · unknowns = `right` that was formed of a row, whose term `free[i]` multiplies unknown
    /// i; `left` is room that is written over. Divided by the root of ∫ φ², rows of white noise scatter alike.
    pub fn add(&mut self, row: &Row, free: &[usize], left: &mut [f64], right: f64) {
        let weight = row.norm.sqrt().recip();
        left.iter_mut().for_each(|entry| *entry *= weight);
        self.regression.add(left, right * weight);
        self.norm += (right * weight).powi(2);
        for (sum, index) in self.noise.iter_mut().zip(free) {
            let [by_q, by_qd] = row.noise[*index];
            sum[0] += by_q * weight * weight;
            sum[1] += by_qd * weight * weight;
        }
    }

    /// Solves for the unknowns; None, and nothing done, with fewer than twice as many rows as unknowns and two.
    ///
    /// Returns the RMS of the predicted error of the law's force ÷ RMS of the right sides. Overlapping rows share their
    /// noise: only one in [`OVERLAP`] ÷ 2 counts as independent.
    pub fn solve(&self, fit: &mut Fit) -> Option<f64> {
        let rows = self.regression.rows();
        if (rows as usize) < 2 * self.noise.len() + 2 {
            return None;
        }
        self.regression.solve(fit);
        let rows = f64::from(rows);
        let unknowns = fit.rank as f64;
        let independent = (rows / (OVERLAP as f64 / 2.0) - unknowns).max(0.5);
        let right = (self.norm / rows).sqrt();
        let tells_nothing = fit.rank == 0 && !self.noise.is_empty();
        Some(match tells_nothing || right == 0.0 {
            true => f64::INFINITY,
            // a law of numbers alone leaves what it leaves
            false => fit.residual / right * (unknowns.max(1.0) / independent).sqrt(),
        })
    }

    /// Std of each unknown of that solution, of noise that overlapping rows share.
    pub fn std<'a>(&self, fit: &'a Fit) -> impl Iterator<Item = f64> + 'a {
        fit.spread.iter().map(|spread| (spread * OVERLAP as f64 / 2.0).sqrt() * fit.residual)
    }

    /// The share of noise in what an unknown's column has of its own, under sensor noise of these variances: least
    /// squares takes the coefficient for that much too small (errors in variables).
    pub fn attenuation(&self, fit: &Fit, unknown: usize, sensor: [f64; 2]) -> f64 {
        fit.spread[unknown] * (self.noise[unknown][0] * sensor[0] + self.noise[unknown][1] * sensor[1])
    }
}
