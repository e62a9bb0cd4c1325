//! Whether what a law leaves is white, and the variances of its coefficients where it is not.
//!
//! The scores g_b = b_b − Λ_b θ of separate blocks of a record have covariance σ² Λ_b where the law leaves white
//! noise. Error that lasts makes them larger: Cov θ = Λ⁻¹ (Σ g_b g_bᵀ) Λ⁻¹ holds whatever its correlation within a
//! block and, by Bartlett's weight ½, into the next one (Newey and West, *Econometrica* 55, 1987; Cameron and Miller,
//! *J. Human Resources* 50, 2015, for the factor B ÷ (B − 1)).

use super::blocks::FEWEST;
use super::moments::Moments;
use crate::estimation::symmetric::dot;
use serde::{Deserialize, Serialize};

/// Std by which the scores may exceed what white noise gives: one chance in a thousand.
pub const SURPRISE: f64 = 3.1;

/// What the blocks of its record say of a law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Whiteness {
    /// Whether there are blocks enough to say anything.
    pub is_known: bool,
    /// Whether the law leaves more than white noise.
    pub is_coloured: bool,
    /// The coefficients' variances by the sandwich, n.
    pub variances: Vec<f64>,
    /// Largest variance of a coefficient ÷ what it would be were the rest white; 1 where that is not refuted.
    pub inflation: f64,
    score: Vec<f64>,
    step: Vec<f64>,
    before: Vec<f64>,
    /// Λ⁻¹ Λ_b.
    product: Vec<f64>,
}

impl Whiteness {
    /// Of a law of n unknowns that no block has been seen of.
    pub fn unknown(n: usize) -> Whiteness {
        Whiteness {
            is_known: false,
            is_coloured: false,
            variances: vec![0.0; n],
            inflation: 1.0,
            score: vec![0.0; n],
            step: vec![0.0; n],
            before: vec![0.0; n],
            product: vec![0.0; n * n],
        }
    }

    /// Forgets what the blocks said.
    pub fn clear(&mut self) {
        (self.is_known, self.is_coloured, self.inflation) = (false, false, 1.0);
    }

    /// Looks at a law that leaves `variance`, and the inverse of whose Λ is given, 0 of terms that it does not have.
    pub fn judge(&mut self, blocks: &[Moments], law: &[f64], inverse: &[f64], variance: f64) {
        self.clear();
        self.is_known = blocks.len() >= FEWEST && variance > 0.0;
        if !self.is_known {
            return;
        }
        let n = self.variances.len();
        self.variances.fill(0.0);
        self.step.fill(0.0);
        let (mut found, mut expected, mut spread) = (0.0, 0.0, 0.0);
        for block in blocks {
            found += self.add(block, law, inverse);
            let [trace, trace_of_square] = self.traces(block, inverse);
            (expected, spread) = (expected + trace, spread + 2.0 * trace_of_square);
        }
        let share = blocks.len() as f64 / (blocks.len() as f64 - 1.0);
        self.variances.iter_mut().for_each(|entry| *entry *= share);
        self.is_coloured = found > variance * (expected + SURPRISE * spread.sqrt());
        if self.is_coloured {
            let ratio = |row: usize| self.variances[row] / (variance * inverse[row * n + row]);
            self.inflation = (0..n).map(ratio).filter(|ratio| ratio.is_finite()).fold(1.0, f64::max);
        }
    }

    /// Adds the square of what a block moves each coefficient by, Λ⁻¹ g_b, with half of what it has in common with the
    /// block before, twice; returns g_bᵀ Λ⁻¹ g_b.
    fn add(&mut self, block: &Moments, law: &[f64], inverse: &[f64]) -> f64 {
        let n = self.variances.len();
        std::mem::swap(&mut self.step, &mut self.before);
        self.score.iter_mut().enumerate().for_each(|(row, score)| *score = block.row_times(row, law));
        for row in 0..n {
            let step = dot(&inverse[row * n..(row + 1) * n], &self.score);
            self.variances[row] += step * (step + self.before[row]);
            self.step[row] = step;
        }
        dot(&self.score, &self.step)
    }

    /// Traces of Λ⁻¹ Λ_b and of its square: mean, and half the variance, of g_bᵀ Λ⁻¹ g_b of white noise of variance 1.
    fn traces(&mut self, block: &Moments, inverse: &[f64]) -> [f64; 2] {
        let n = self.variances.len();
        for (place, entry) in self.product.iter_mut().enumerate() {
            let (row, column) = (place / n, place % n);
            *entry = block.row_times(column, &inverse[row * n..(row + 1) * n]);
        }
        let product = |row: usize, column: usize| self.product[row * n + column];
        let of_square = |row: usize| (0..n).map(|column| product(row, column) * product(column, row)).sum::<f64>();
        [(0..n).map(|row| product(row, row)).sum(), (0..n).map(of_square).sum()]
    }
}
