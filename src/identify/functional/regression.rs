//! Coefficients from block moments, with std from how they scatter between blocks of time.
//!
//! Least squares states a std that holds for white errors alone. What real records leave unexplained is coloured, so
//! the covariance is the sandwich M⁻¹ (Σ s sᵀ) M⁻¹ over the scores s of contiguous blocks (White, Econometrica 48,
//! 1980; Liang and Zeger, Biometrika 73, 1986), with the largest std of several lengths of block: those shorter than
//! the error's correlation state too little. White sensor noise takes its known share out of the moments (errors in
//! variables; Fuller, *Measurement Error Models*, 1987).

use super::blocks::Blocks;
use crate::estimation::System;
use serde::{Deserialize, Serialize};

/// Fewest blocks, and how many of each length are tried: the number that a variance needs for its own error to be below
/// a half.
const PARTITIONS: [usize; 3] = [usize::MAX, 16, FEWEST];
/// Fewest blocks of which a variance is told: its own error is then a half, √(2 ÷ 8).
pub(super) const FEWEST: usize = 8;

/// Beyond this variance inflation an unknown is a combination of the others, but for rounding.
const INFLATION: f64 = 1e8;

/// Share of a column that is added to it, so that of columns that rounding alone tells apart both are inflated, not the
/// later one lost.
const RIDGE: f64 = 1e-12;

/// A column of which white noise makes more than this share says nothing that a correction could mend.
const NOISE: f64 = 0.5;

/// What one octave's rows say of the free coefficients.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Estimate {
    pub(super) coefficients: Vec<f64>,
    /// Infinite where the rows leave it open.
    pub(super) std: Vec<f64>,
    /// RMS residual ÷ std of the column that carries the error.
    pub(super) error: f64,
}

impl Estimate {
    pub(super) fn new(n: usize) -> Estimate {
        Estimate { coefficients: vec![0.0; n], std: vec![f64::INFINITY; n], error: f64::INFINITY }
    }

    pub(super) fn clear(&mut self) {
        self.std.fill(f64::INFINITY);
        self.error = f64::INFINITY;
    }

    pub(super) fn is_known(&self) -> bool {
        self.error.is_finite()
    }
}

/// What is known of the errors in the columns of a row.
pub(super) struct Errors<'a> {
    /// What sensors add to each column's square.
    pub(super) noise: &'a [f64],
    /// Mean square of the right side about its mean.
    pub(super) variance: f64,
}

/// Room for a regression of rows [free terms…, right side].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Regression {
    n: usize,
    total: Vec<f64>,
    part: Vec<f64>,
    system: System,
    scale: Vec<f64>,
    unknowns: Vec<usize>,
    solution: Vec<f64>,
    right: Vec<f64>,
    inverse: Vec<f64>,
    /// Σ law · row is the residual: 1 or −1 at the right side, coefficients elsewhere.
    law: Vec<f64>,
    score: Vec<f64>,
    square: Vec<f64>,
}

impl Regression {
    pub(super) fn new(n: usize) -> Regression {
        let width = n + 1;
        Regression {
            n,
            total: vec![0.0; width * width],
            part: vec![0.0; width * width],
            system: System::new(n),
            scale: vec![0.0; n],
            unknowns: vec![0; n],
            solution: vec![0.0; n],
            right: vec![0.0; n],
            inverse: vec![0.0; n * n],
            law: vec![0.0; width],
            score: vec![0.0; n],
            square: vec![0.0; n],
        }
    }

    /// Solves the rows of `blocks`; `inertia` is the place of a free one. The error is taken to be in the right side or
    /// in the inertia term, whichever is the larger: errors of gain, lag and law go with the signals, and least squares
    /// is biased by those of its regressors.
    pub(super) fn solve(&mut self, blocks: &Blocks, errors: &Errors, inertia: Option<usize>, best: &mut Estimate) {
        let noise = errors.noise;
        best.clear();
        let rows = blocks.rows() * blocks.count() as f64;
        blocks.sum(0, blocks.count(), &mut self.total);
        if blocks.count() < FEWEST.max(self.n + 1) || self.take_noise_out(noise, rows) {
            return;
        }
        for target in [Some(self.n), inertia].into_iter().flatten() {
            let total = if target == self.n { rows * errors.variance } else { self.total[target * (self.n + 2)] };
            let error = self.fit(target).map(|left| (left / total).sqrt());
            if let Some(error) = error.filter(|error| *error < best.error) {
                best.error = error;
                self.scatter(blocks, noise, target, &mut best.std);
                let right = self.law[self.n];
                for (value, own) in best.coefficients.iter_mut().zip(&self.law) {
                    *value = -own / right;
                }
            }
        }
    }

    /// Whether noise is too much of any column.
    fn take_noise_out(&mut self, noise: &[f64], rows: f64) -> bool {
        let width = self.n + 1;
        let mut drowned = false;
        for (column, noise) in noise.iter().enumerate() {
            let slot = &mut self.total[column * width + column];
            drowned |= rows * noise > NOISE * *slot;
            *slot -= rows * noise;
        }
        drowned
    }

    /// Fits the column `target` by all others; returns the residual's square, none where it cannot be computed.
    fn fit(&mut self, target: usize) -> Option<f64> {
        let (n, width) = (self.n, self.n + 1);
        let others = (0..width).filter(|column| *column != target);
        self.unknowns.iter_mut().zip(others).for_each(|(slot, column)| *slot = column);
        for (scale, column) in self.scale.iter_mut().zip(&self.unknowns) {
            let square = self.total[column * width + column];
            *scale = if square > 0.0 { square.sqrt().recip() } else { 0.0 };
        }
        for row in 0..n {
            let from = self.unknowns[row];
            for column in row..n {
                let entry = self.total[from * width + self.unknowns[column]];
                self.system.row(row)[column] = entry * self.scale[row] * self.scale[column];
            }
            self.system.row(row)[row] += RIDGE;
            self.right[row] = self.total[from * width + target] * self.scale[row];
        }
        self.system.set_right(self.right.iter().copied());
        self.system.eliminate(0.1 * RIDGE);
        self.system.solve(&mut self.solution);
        self.system.invert(&mut self.inverse);
        self.law[target] = -1.0;
        for (index, column) in self.unknowns.iter().enumerate() {
            self.law[*column] = self.solution[index] * self.scale[index];
        }
        let square = self.total[target * width + target];
        let left = square - self.solution.iter().zip(&self.right).map(|(a, b)| a * b).sum::<f64>();
        let finite = self.law.iter().all(|value| value.is_finite()) && self.law[n] != 0.0;
        (finite && square > 0.0).then_some(left.max(0.0))
    }

    /// Std of the coefficients, the largest over the partitions.
    fn scatter(&mut self, blocks: &Blocks, noise: &[f64], target: usize, std: &mut [f64]) {
        std.fill(0.0);
        for parts in PARTITIONS.map(|parts| parts.min(blocks.count())) {
            if parts > self.n {
                self.scatter_between(blocks, noise, target, parts);
                let correction = parts as f64 / (parts - self.n) as f64;
                for (std, square) in std.iter_mut().zip(&self.square) {
                    *std = std.max((correction * square).sqrt());
                }
            }
        }
        for (index, column) in self.unknowns.iter().enumerate() {
            let open = !self.system.is_solved(index) || self.inverse[index * self.n + index] > INFLATION;
            if open && *column < self.n {
                std[*column] = f64::INFINITY;
            }
        }
    }

    /// Writes into `square` the sum of squares of what each of `parts` parts of the record moves the coefficients by.
    fn scatter_between(&mut self, blocks: &Blocks, noise: &[f64], target: usize, parts: usize) {
        let (n, width) = (self.n, self.n + 1);
        self.square.fill(0.0);
        for part in 0..parts {
            let (from, to) = (part * blocks.count() / parts, (part + 1) * blocks.count() / parts);
            blocks.sum(from, to, &mut self.part);
            let rows = blocks.rows() * (to - from) as f64;
            for (index, column) in self.unknowns.iter().enumerate() {
                let row = &self.part[column * width..(column + 1) * width];
                let residual: f64 = row.iter().zip(&self.law).map(|(entry, value)| entry * value).sum();
                self.score[index] = (rows * noise[*column] * self.law[*column] - residual) * self.scale[index];
            }
            for row in 0..n {
                let entries = &self.inverse[row * n..(row + 1) * n];
                let step: f64 = entries.iter().zip(&self.score).map(|(a, b)| a * b).sum();
                self.right[row] = step * self.scale[row];
            }
            self.add_squares(target);
        }
    }

    /// A step of the regression's unknowns as one of the law's coefficients, −law ÷ law of the right side.
    fn add_squares(&mut self, target: usize) {
        let right = self.law[self.n];
        let step_of =
            |column: usize| self.unknowns.iter().position(|unknown| *unknown == column).map(|at| self.right[at]);
        let right_step = step_of(self.n).unwrap_or(0.0);
        for (column, square) in self.square.iter_mut().enumerate() {
            let own = if column == target { 0.0 } else { step_of(column).unwrap_or(0.0) };
            *square += ((self.law[column] * right_step / right - own) / right).powi(2);
        }
    }
}
