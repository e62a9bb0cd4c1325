//! Fisher information and score of the coefficients, and what follows from them.

use super::symmetric::{Lane, System, WIDTH, dot};
use crate::limits::ROUNDING;
use serde::{Deserialize, Serialize};

/// Sums Σ ψψᵀ/s and Σ ψε/s over innovations ε with sensitivity ψ = −∂ε/∂θ and variance s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Information {
    /// Number of unknowns n.
    pub n: usize,
    /// n × n, row-major, upper triangle, and room for the last row's lane; what stands below the diagonal means
    /// nothing.
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
    system: System,
    scale: Vec<f64>,
}

impl Information {
    /// No information on `n` unknowns.
    pub fn none(n: usize) -> Information {
        Information { n, matrix: vec![0.0; n * n + WIDTH], score: vec![0.0; n] }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.matrix.fill(0.0);
        self.score.fill(0.0);
    }

    /// Copies the other's sums into this room.
    pub fn clone_from_slices(&mut self, other: &Information) {
        self.matrix.copy_from_slice(&other.matrix);
        self.score.copy_from_slice(&other.score);
    }

    /// Copies what these sums say of the first unknowns into that room for fewer.
    pub fn lead(&self, fewer: &mut Information) {
        let n = fewer.n;
        for row in 0..n {
            fewer.matrix[row * n + row..(row + 1) * n]
                .copy_from_slice(&self.matrix[row * self.n + row..row * self.n + n]);
        }
        fewer.score.copy_from_slice(&self.score[..n]);
    }

    /// Copies these sums into that room for one more unknown, the last, of which they say nothing.
    pub fn widen(&self, wider: &mut Information) {
        let n = self.n;
        wider.clear();
        for row in 0..n {
            wider.matrix[row * (n + 1) + row..][..n - row].copy_from_slice(&self.matrix[row * n + row..(row + 1) * n]);
        }
        wider.score[..n].copy_from_slice(&self.score);
    }

    /// That is said of the last unknown: with each of the others, of itself, and its score.
    pub(super) fn tell_last(&mut self, cross: &[f64], information: f64, score: f64) {
        let n = self.n;
        let column = cross.iter().take(n - 1).chain([&information]);
        column.enumerate().for_each(|(row, entry)| self.matrix[row * n + n - 1] = *entry);
        self.score[n - 1] = score;
    }

    /// Multiplies all sums.
    pub fn scale(&mut self, factor: f64) {
        self.matrix.iter_mut().chain(&mut self.score).for_each(|entry| *entry *= factor);
    }

    /// Takes one innovation.
    #[inline]
    pub fn add(&mut self, sensitivity: &[f64], residual: f64, variance: f64) {
        let n = self.n;
        let weight = 1.0 / variance;
        for (row, &psi) in sensitivity.iter().enumerate() {
            let scaled = psi * weight;
            self.score[row] += scaled * residual;
            for (entry, other) in self.matrix[row * n + row..(row + 1) * n].iter_mut().zip(&sensitivity[row..]) {
                *entry += scaled * other;
            }
        }
    }

    /// Takes two innovations at once: their sensitivities, each n long and filled up with zeros, residuals, and 1 ÷
    /// variances.
    #[inline]
    pub fn add_pair(&mut self, sensitivities: [&[Lane]; 2], residuals: [f64; 2], weights: [f64; 2]) {
        let [first, second] = sensitivities;
        for block in 0..first.len() {
            let (first, second) = (&first[block..], &second[block..]);
            // loops of a length that the compiler knows have neither counters nor checks
            match first.len() {
                1 => self.add_lanes::<1>(block, [first, second], residuals, weights),
                2 => self.add_lanes::<2>(block, [first, second], residuals, weights),
                3 => self.add_lanes::<3>(block, [first, second], residuals, weights),
                _ => self.add_rows(block, [first, second], residuals, weights),
            }
        }
    }

    #[inline]
    fn add_lanes<const L: usize>(
        &mut self,
        block: usize,
        [first, second]: [&[Lane]; 2],
        residuals: [f64; 2],
        weights: [f64; 2],
    ) {
        if let (Some(first), Some(second)) = (first.first_chunk::<L>(), second.first_chunk::<L>()) {
            self.add_rows(block, [first, second], residuals, weights);
        }
    }

    /// The rows of one lane, from the lane on the diagonal.
    #[inline(always)]
    fn add_rows(&mut self, block: usize, [first, second]: [&[Lane]; 2], residuals: [f64; 2], weights: [f64; 2]) {
        let (n, from) = (self.n, WIDTH * block);
        let pairs = first[0].iter().zip(second[0]).zip(&mut self.score[from..]);
        for (((a, b), score), row) in pairs.zip(from..) {
            let (a, b) = (a * weights[0], b * weights[1]);
            *score += a * residuals[0] + b * residuals[1];
            let entries = &mut self.matrix[row * n + from..][..WIDTH * first.len()];
            let columns = first.iter().zip(second);
            for (entries, (first, second)) in entries.as_chunks_mut::<WIDTH>().0.iter_mut().zip(columns) {
                *entries = std::array::from_fn(|column| entries[column] + (a * first[column] + b * second[column]));
            }
        }
    }

    /// What is known of one unknown before the data: its precision, and that times how far it is expected away.
    pub fn add_prior(&mut self, index: usize, precision: f64, score: f64) {
        *self.entry_mut(index, index) += precision;
        self.score[index] += score;
    }

    /// The same with that part of each unknown's own information added to it: a shorter step (Marquardt, SIAM Journal
    /// 11 (1963), 431).
    pub fn damped(&self, part: f64) -> Information {
        let mut damped = self.clone();
        (0..self.n).for_each(|index| *damped.entry_mut(index, index) *= 1.0 + part);
        damped
    }

    /// An entry of the symmetric matrix.
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        self.matrix[row.min(column) * self.n + row.max(column)]
    }

    /// The same, to be changed.
    pub fn entry_mut(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.matrix[row.min(column) * self.n + row.max(column)]
    }

    /// Whether all sums are finite numbers.
    pub fn is_finite(&self) -> bool {
        let rows = (0..self.n).flat_map(|row| &self.matrix[row * self.n + row..(row + 1) * self.n]);
        rows.chain(&self.score).all(|value| value.is_finite())
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
        let upper = dot(&self.matrix[row * n + row..(row + 1) * n], &vector[row..]);
        let lower: f64 = (0..row).map(|column| self.matrix[column * n + row] * vector[column]).sum();
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
            system: System::new(n),
            scale: vec![0.0; n],
        }
    }

    /// Solves for the unknowns that `active` names; the others stay where they are (step 0).
    pub fn solve(&mut self, information: &Information, active: &[bool]) {
        let n = information.n;
        self.equilibrate(information, active);
        self.system.eliminate(ROUNDING);
        self.system.solve(&mut self.step);
        self.system.invert(&mut self.covariance);
        for row in 0..n {
            self.step[row] *= self.scale[row];
            self.determined[row] = self.system.is_solved(row) && self.scale[row] > 0.0;
            for (entry, scale) in self.covariance[row * n..(row + 1) * n].iter_mut().zip(&self.scale) {
                *entry *= self.scale[row] * scale;
            }
        }
    }

    /// Copies the system with a unit diagonal; an unknown without information gets a row of its own.
    fn equilibrate(&mut self, information: &Information, active: &[bool]) {
        let n = information.n;
        for (row, (scale, active)) in self.scale.iter_mut().zip(active).enumerate() {
            let diagonal = information.matrix[row * n + row];
            *scale = if *active && diagonal > 0.0 { diagonal.sqrt().recip() } else { 0.0 };
        }
        for (row, scale) in self.scale.iter().enumerate() {
            let target = self.system.row(row);
            let entries = information.matrix[row * n..(row + 1) * n].iter().zip(&self.scale);
            for (slot, (entry, other)) in target.iter_mut().zip(entries).skip(row + 1) {
                *slot = entry * scale * other;
            }
            target[row] = 1.0;
            target[n] = information.score[row] * scale;
        }
    }

    /// Variance of the coefficient.
    pub fn variance(&self, index: usize) -> f64 {
        self.covariance[index * self.step.len() + index]
    }

    /// Std of the coefficient under `overdispersion` times this covariance; infinite where it is not determined.
    pub fn std(&self, index: usize, overdispersion: f64) -> f64 {
        match self.determined[index] {
            true => (overdispersion * self.variance(index)).sqrt(),
            false => f64::INFINITY,
        }
    }

    /// The smallest ratio of a pivot to its diagonal entry: 1 for orthogonal sensitivities, 0 for collinear ones.
    pub fn smallest_pivot(&self) -> f64 {
        (0..self.step.len()).map(|row| self.system.pivot(row)).fold(1.0, f64::min)
    }
}
