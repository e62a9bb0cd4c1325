//! Fisher information and score of the coefficients, and what follows from them.

use super::symmetric;
use serde::{Deserialize, Serialize};

/// Relative size below which a pivot is rounding: the data say nothing on the unknown beside the others.
const TOLERANCE: f64 = 1e-12;

/// Sums Σ ψψᵀ/s and Σ ψε/s over innovations ε with sensitivity ψ = −∂ε/∂θ and variance s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Information {
    /// Number of unknowns n.
    pub n: usize,
    /// n × n, row-major, lower triangle.
    pub matrix: Vec<f64>,
    /// n.
    pub score: Vec<f64>,
}

/// A maximum of the likelihood, linearised.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// What to add to the coefficients, n.
    pub step: Vec<f64>,
    /// Covariance of the coefficients, n × n, both triangles; meaningless where not determined.
    pub covariance: Vec<f64>,
    /// Whether the data determine the coefficient, n.
    pub determined: Vec<bool>,
    factor: Vec<f64>,
    scale: Vec<f64>,
}

impl Information {
    /// No information on `n` unknowns.
    pub fn none(n: usize) -> Information {
        Information { n, matrix: vec![0.0; n * n], score: vec![0.0; n] }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.matrix.fill(0.0);
        self.score.fill(0.0);
    }

    /// Takes one innovation.
    #[inline]
    pub fn add(&mut self, sensitivity: &[f64], residual: f64, variance: f64) {
        let n = self.n;
        let weight = 1.0 / variance;
        for (row, &psi) in sensitivity.iter().enumerate() {
            let scaled = psi * weight;
            self.score[row] += scaled * residual;
            for (entry, other) in self.matrix[row * n..row * n + row + 1].iter_mut().zip(sensitivity) {
                *entry += scaled * other;
            }
        }
    }

    /// Moves the point about which the score is taken by `step`: score − matrix · step.
    pub fn shift(&mut self, step: &[f64]) {
        for row in 0..self.n {
            self.score[row] -= self.row_times(row, step);
        }
    }

    /// Row `row` of the symmetric matrix times a vector.
    #[inline]
    pub fn row_times(&self, row: usize, vector: &[f64]) -> f64 {
        let n = self.n;
        let lower: f64 = self.matrix[row * n..row * n + row + 1].iter().zip(vector).map(|(a, b)| a * b).sum();
        let upper: f64 = (row + 1..n).map(|column| self.matrix[column * n + row] * vector[column]).sum();
        lower + upper
    }

    /// vᵀ matrix v.
    pub fn quadratic(&self, vector: &[f64]) -> f64 {
        (0..self.n).map(|row| vector[row] * self.row_times(row, vector)).sum()
    }

    /// The other's sums on top of these.
    pub fn merge(&mut self, other: &Information) {
        self.matrix.iter_mut().zip(&other.matrix).for_each(|(a, b)| *a += b);
        self.score.iter_mut().zip(&other.score).for_each(|(a, b)| *a += b);
    }
}

impl Solution {
    /// Room for `n` unknowns.
    pub fn none(n: usize) -> Solution {
        Solution {
            step: vec![0.0; n],
            covariance: vec![0.0; n * n],
            determined: vec![false; n],
            factor: vec![0.0; n * n],
            scale: vec![0.0; n],
        }
    }

    /// Solves for the unknowns that `active` names; the others stay where they are (step 0).
    pub fn solve(&mut self, information: &Information, active: &[bool]) {
        let n = information.n;
        self.equilibrate(information, active);
        symmetric::cholesky(&mut self.factor, n, TOLERANCE);
        for row in 0..n {
            self.step[row] = information.score[row] * self.scale[row];
        }
        symmetric::forward(&self.factor, n, &mut self.step);
        symmetric::backward(&self.factor, n, &mut self.step);
        symmetric::invert(&self.factor, n, &mut self.covariance);
        for row in 0..n {
            self.step[row] *= self.scale[row];
            self.determined[row] = self.factor[row * n + row].is_finite() && self.scale[row] > 0.0;
            for column in 0..n {
                self.covariance[row * n + column] *= self.scale[row] * self.scale[column];
            }
        }
    }

    /// Copies the matrix with a unit diagonal; an unknown without information gets a row of its own.
    fn equilibrate(&mut self, information: &Information, active: &[bool]) {
        let n = information.n;
        for row in 0..n {
            let diagonal = information.matrix[row * n + row];
            self.scale[row] = if active[row] && diagonal > 0.0 { diagonal.sqrt().recip() } else { 0.0 };
            for column in 0..row {
                self.factor[row * n + column] =
                    information.matrix[row * n + column] * self.scale[row] * self.scale[column];
            }
            self.factor[row * n + row] = 1.0;
        }
    }

    /// Variance of the coefficient.
    pub fn variance(&self, index: usize) -> f64 {
        self.covariance[index * self.step.len() + index]
    }

    /// The smallest ratio of a pivot to its diagonal entry: 1 for orthogonal sensitivities, 0 for collinear ones.
    pub fn smallest_pivot(&self) -> f64 {
        let n = self.step.len();
        let pivots = (0..n).map(|row| self.factor[row * n + row]);
        pivots.map(|pivot| if pivot.is_finite() { pivot * pivot } else { 0.0 }).fold(1.0, f64::min)
    }
}
