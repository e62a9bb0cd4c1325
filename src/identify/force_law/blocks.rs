//! Whether what a law leaves is white, and the covariance of its coefficients where it is not.
//!
//! The scores g_b = b_b − Λ_b θ of separate blocks of a record have covariance σ² Λ_b where the law leaves white
//! noise. Error that lasts makes them
//! larger: Cov θ = Λ⁻¹ (Σ g_b g_bᵀ) Λ⁻¹ holds whatever its correlation within a block and, by Bartlett's weight ½,
//! into the next one
//! (Newey and West, *Econometrica* 55, 1987; Cameron and Miller, *J. Human Resources* 50, 2015, for the factor B ÷ (B
//! − 1)).

use super::sums::{Sums, Weight, dot};
use serde::{Deserialize, Serialize};

/// Most blocks; when all are full, neighbours merge and blocks become twice as long. Even.
const MOST: usize = 32;

/// Fewest blocks that tell colour from white.
const FEWEST: usize = 8;

/// Shortest block, samples.
const SHORTEST: f64 = 8.0;

/// Std by which the scores may exceed what white noise gives: one chance in a thousand.
pub const SURPRISE: f64 = 3.1;

/// The record cut into blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Blocks {
    blocks: Vec<Sums>,
    /// Blocks that are full; the next one is being filled.
    full: usize,
    length: f64,
    score: Vec<f64>,
    before: Vec<f64>,
    /// Λ⁻¹ Λ_b, then Σ g gᵀ.
    matrix: Vec<f64>,
    verdict: Verdict,
}

/// What the blocks say of the law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Whether there are blocks enough to say anything.
    pub is_known: bool,
    /// Whether the law leaves more than white noise.
    pub is_coloured: bool,
    /// The sandwich, n × n.
    pub covariance: Vec<f64>,
    /// Largest variance of a coefficient ÷ what it would be were the rest white; 1 where that is not refuted.
    pub inflation: f64,
}

impl Blocks {
    /// For n unknowns.
    pub fn new(n: usize) -> Blocks {
        let verdict = Verdict { is_known: false, is_coloured: false, covariance: vec![0.0; n * n], inflation: 1.0 };
        Blocks {
            blocks: vec![Sums::none(n); MOST + 1],
            full: 0,
            length: SHORTEST,
            score: vec![0.0; n],
            before: vec![0.0; n],
            matrix: vec![0.0; n * n],
            verdict,
        }
    }

    /// Begins a record of which `sums` are known.
    pub fn begin(&mut self, sums: &Sums) {
        self.blocks.iter_mut().for_each(Sums::clear);
        (self.full, self.length) = (0, SHORTEST);
        (self.verdict.is_known, self.verdict.is_coloured, self.verdict.inflation) = (false, false, 1.0);
        self.blocks[0].copy(sums);
    }

    /// Takes one sample; true where that filled a block.
    pub fn add(&mut self, features: &[f64], force: f64, weight: &Weight) -> bool {
        let block = &mut self.blocks[self.full];
        block.add(features, force, weight);
        if block.count < self.length {
            return false;
        }
        self.full += 1;
        if self.full == MOST {
            self.merge();
        }
        true
    }

    fn merge(&mut self) {
        for pair in 0..MOST / 2 {
            let (head, tail) = self.blocks.split_at_mut(2 * pair + 1);
            head[2 * pair].merge(&tail[0], 1.0);
            let (head, tail) = self.blocks.split_at_mut(2 * pair);
            if let Some(target) = head.get_mut(pair) {
                target.copy(&tail[0]);
            }
        }
        self.blocks[MOST / 2..].iter_mut().for_each(Sums::clear);
        (self.full, self.length) = (MOST / 2, 2.0 * self.length);
    }

    /// Looks at the law with these coefficients, the inverse of whose Λ is given, and that leaves `variance`.
    pub fn judge(&mut self, coefficients: &[f64], inverse: &[f64], active: &[bool], variance: f64) -> &Verdict {
        let n = coefficients.len();
        self.verdict.is_known = self.full >= FEWEST && variance > 0.0;
        if !self.verdict.is_known {
            return &self.verdict;
        }
        let [found, expected, spread] = self.dispersion(coefficients, inverse, active);
        self.verdict.is_coloured = found > variance * (expected + SURPRISE * spread);
        self.verdict.inflation = 1.0;
        self.sandwich(inverse);
        if self.verdict.is_coloured {
            let ratio = |row: usize| self.verdict.covariance[row * n + row] / (variance * inverse[row * n + row]);
            let ratios = (0..n).filter(|row| active[*row]).map(ratio).filter(|ratio| ratio.is_finite());
            self.verdict.inflation = ratios.fold(1.0, f64::max);
        }
        &self.verdict
    }

    /// The present verdict.
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Σ g_bᵀ Λ⁻¹ g_b, what white noise of variance 1 gives, and its std; leaves Σ g gᵀ in `matrix`.
    fn dispersion(&mut self, coefficients: &[f64], inverse: &[f64], active: &[bool]) -> [f64; 3] {
        let n = coefficients.len();
        let (mut found, mut expected, mut variance) = (0.0, 0.0, 0.0);
        for block in &self.blocks[..self.full] {
            block.score(coefficients, &mut self.score);
            keep(&mut self.score, active);
            found += form(inverse, &self.score);
            // Λ⁻¹ Λ_b, whose trace and trace of square are mean and half the variance of that form
            for row in 0..n {
                for column in 0..n {
                    let of_block = &block.information[column * n..(column + 1) * n];
                    self.matrix[row * n + column] =
                        if active[row] { dot(&inverse[row * n..(row + 1) * n], of_block) } else { 0.0 };
                }
            }
            for row in (0..n).filter(|row| active[*row]) {
                expected += self.matrix[row * n + row];
                let others = (0..n).filter(|column| active[*column]);
                variance += 2.0
                    * others.map(|column| self.matrix[row * n + column] * self.matrix[column * n + row]).sum::<f64>();
            }
        }
        self.meat(coefficients, active);
        [found, expected, variance.sqrt()]
    }

    /// Σ g gᵀ with half of what neighbours have in common.
    fn meat(&mut self, coefficients: &[f64], active: &[bool]) {
        let n = coefficients.len();
        self.matrix.fill(0.0);
        self.before.fill(0.0);
        let share = self.full as f64 / (self.full as f64 - 1.0);
        for block in &self.blocks[..self.full] {
            block.score(coefficients, &mut self.score);
            keep(&mut self.score, active);
            for row in 0..n {
                for column in 0..n {
                    let shared = self.score[row] * self.before[column] + self.before[row] * self.score[column];
                    self.matrix[row * n + column] += share * (self.score[row] * self.score[column] + 0.5 * shared);
                }
            }
            self.before.copy_from_slice(&self.score);
        }
    }

    /// Λ⁻¹ (Σ g gᵀ) Λ⁻¹.
    fn sandwich(&mut self, inverse: &[f64]) {
        let n = self.score.len();
        for row in 0..n {
            let outer = &inverse[row * n..(row + 1) * n];
            for (column, entry) in self.score.iter_mut().enumerate() {
                *entry = dot(outer, &self.matrix[column * n..(column + 1) * n]);
            }
            for column in 0..n {
                self.verdict.covariance[row * n + column] = dot(&self.score, &inverse[column * n..(column + 1) * n]);
            }
        }
    }
}

fn keep(score: &mut [f64], active: &[bool]) {
    score.iter_mut().zip(active).filter(|(_, active)| !**active).for_each(|(entry, _)| *entry = 0.0);
}

/// vᵀ A v.
fn form(matrix: &[f64], vector: &[f64]) -> f64 {
    let n = vector.len();
    (0..n).map(|row| vector[row] * dot(&matrix[row * n..(row + 1) * n], vector)).sum()
}
