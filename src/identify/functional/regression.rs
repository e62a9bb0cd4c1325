//! Coefficients from block moments, with std from how they scatter between blocks of time.
//!
//! Least squares states a std that holds for white errors alone. What real records leave unexplained is coloured, so
//! the covariance is the sandwich M⁻¹ (Σ s sᵀ) M⁻¹ over the scores s of contiguous blocks (White, Econometrica 48,
//! 1980; Liang and Zeger, Biometrika 73, 1986), with the largest std of several lengths of block: those shorter than
//! the error's correlation state too little. White sensor noise takes its known share out of the moments (errors in
//! variables; Fuller, *Measurement Error Models*, 1987).

use crate::estimation::{FEWEST, Moments, System, dot};
use crate::identify::problem::Problem;
use crate::law::Term;
use serde::{Deserialize, Serialize};

/// How many parts of the record are tried: all blocks, and fewer, longer ones, down to the fewest that tell a variance.
const PARTITIONS: [usize; 3] = [usize::MAX, 16, FEWEST];

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

/// Room for a regression of rows [free terms…, right side].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Regression {
    /// What sensors add to each column's square.
    noise: Vec<f64>,
    total: Moments,
    part: Moments,
    system: System,
    /// 1 ÷ root of each column's square, 0 of the target's.
    scale: Vec<f64>,
    /// Of the scaled system.
    inverse: Vec<f64>,
    /// −1 at the target, coefficients elsewhere: row · law is what is left of a row.
    law: Vec<f64>,
    score: Vec<f64>,
    step: Vec<f64>,
    square: Vec<f64>,
}

impl Regression {
    pub(super) fn new(n: usize) -> Regression {
        let width = n + 1;
        Regression {
            noise: vec![0.0; width],
            total: Moments::none(width),
            part: Moments::none(width),
            system: System::new(width),
            scale: vec![0.0; width],
            inverse: vec![0.0; width * width],
            law: vec![0.0; width],
            score: vec![0.0; width],
            step: vec![0.0; width],
            square: vec![0.0; n],
        }
    }

    /// Solves the rows of `blocks`, to whose integrals of q̇ and q̈ the sensors add these variances, and whose right
    /// side has the given one. The error is taken to be in the right side or in the inertia term, whichever is the
    /// larger: errors of gain, lag and law go with the signals, and least squares is biased by those of its regressors.
    pub(super) fn solve(
        &mut self,
        problem: &Problem,
        blocks: &[Moments],
        sensors: [f64; 2],
        variance: f64,
        best: &mut Estimate,
    ) {
        let n = self.square.len();
        best.clear();
        self.total.sum(blocks);
        self.set_noise(problem, sensors);
        if blocks.len() < FEWEST.max(n + 1) || self.is_drowned() {
            return;
        }
        self.total.take_out(&self.noise);
        for target in [Some(n), problem.free_inertia()].into_iter().flatten() {
            let square = self.total.entry(target, target);
            let total = if target == n { self.total.count * variance } else { square };
            let error = self.fit(target).map(|left| (left / total).sqrt());
            if let Some(error) = error.filter(|error| *error < best.error) {
                best.error = error;
                self.scatter(blocks, target, &mut best.std);
                let right = self.law[n];
                for (value, own) in best.coefficients.iter_mut().zip(&self.law) {
                    *value = -own / right;
                }
            }
        }
    }

    fn set_noise(&mut self, problem: &Problem, [of_velocity, of_acceleration]: [f64; 2]) {
        for (noise, term) in self.noise.iter_mut().zip(&problem.free_terms) {
            *noise = match term {
                Term::Inertia => of_acceleration,
                term if *term == Term::power(0, 1) => of_velocity,
                _ => 0.0,
            };
        }
    }

    /// Whether noise is too much of any column.
    fn is_drowned(&self) -> bool {
        let mut columns = self.noise.iter().enumerate();
        columns.any(|(column, noise)| self.total.count * noise > NOISE * self.total.entry(column, column))
    }

    /// Fits the column `target` by all others; returns the residual's square, none where it cannot be computed.
    fn fit(&mut self, target: usize) -> Option<f64> {
        let width = self.law.len();
        let Regression { total, system, scale, law, .. } = self;
        for (column, scale) in scale.iter_mut().enumerate() {
            let square = total.entry(column, column);
            *scale = if column != target && square > 0.0 { square.sqrt().recip() } else { 0.0 };
        }
        for row in 0..width {
            let entries = system.row(row);
            (row..width).for_each(|column| entries[column] = total.entry(row, column) * scale[row] * scale[column]);
            entries[row] += RIDGE;
            entries[width] = total.entry(row, target) * scale[row];
        }
        system.eliminate(0.1 * RIDGE);
        system.solve(law);
        system.invert(&mut self.inverse);
        law.iter_mut().zip(scale).for_each(|(value, scale)| *value *= *scale);
        law[target] = -1.0;
        let square = total.entry(target, target);
        let finite = law.iter().all(|value| value.is_finite()) && law[width - 1] != 0.0;
        (finite && square > 0.0).then_some((square - system.squares()).max(0.0))
    }

    /// Std of the coefficients, the largest over the partitions.
    fn scatter(&mut self, blocks: &[Moments], target: usize, std: &mut [f64]) {
        let (n, width) = (self.square.len(), self.law.len());
        std.fill(0.0);
        for parts in PARTITIONS.map(|parts| parts.min(blocks.len())).into_iter().filter(|parts| *parts > n) {
            self.scatter_between(blocks, parts);
            let correction = parts as f64 / (parts - n) as f64;
            for (std, square) in std.iter_mut().zip(&self.square) {
                *std = std.max((correction * square).sqrt());
            }
        }
        for (column, std) in std.iter_mut().enumerate().filter(|(column, _)| *column != target) {
            if !self.system.is_solved(column) || self.inverse[column * (width + 1)] > INFLATION {
                *std = f64::INFINITY;
            }
        }
    }

    /// Writes into `square` the sum of squares of what each of `parts` parts of the record moves the coefficients by.
    fn scatter_between(&mut self, blocks: &[Moments], parts: usize) {
        let width = self.law.len();
        let from = |part: usize| part * blocks.len() / parts;
        self.square.fill(0.0);
        for part in 0..parts {
            self.part.sum(&blocks[from(part)..from(part + 1)]);
            self.part.take_out(&self.noise);
            for (column, score) in self.score.iter_mut().enumerate() {
                *score = self.part.row_times(column, &self.law) * self.scale[column];
            }
            for (row, step) in self.step.iter_mut().enumerate() {
                *step = dot(&self.inverse[row * width..(row + 1) * width], &self.score) * self.scale[row];
            }
            self.add_squares();
        }
    }

    /// A step of the law as one of the coefficients, −law ÷ law of the right side.
    fn add_squares(&mut self) {
        let n = self.square.len();
        let (right, right_step) = (self.law[n], self.step[n]);
        for ((square, value), step) in self.square.iter_mut().zip(&self.law).zip(&self.step) {
            *square += ((value * right_step / right - step) / right).powi(2);
        }
    }
}
