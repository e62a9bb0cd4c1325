//! A law of the past: its coefficients θ and their precision Λ on the terms that it has.

use crate::estimation::{Information, Noise, Solution};
use serde::{Deserialize, Serialize};

/// A segment's law, as the library takes it.
#[derive(Clone, Copy, Debug)]
pub struct Estimate<'a> {
    /// Free coefficients, n.
    pub coefficients: &'a [f64],
    /// Which of the free terms the law has.
    pub active: &'a [bool],
    /// Noise levels under it.
    pub noise: Noise,
    /// What record and prior say about the coefficients.
    pub information: &'a Information,
    /// Factor by which the covariance is larger than the information states.
    pub overdispersion: f64,
}

/// A law of the past.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnownLaw {
    /// Its number, 1 for the first law of all.
    pub number: u32,
    /// Free coefficients, n.
    pub coefficients: Vec<f64>,
    /// Which of the free terms it has.
    pub active: Vec<bool>,
    /// Λ on the terms that it has, 0 elsewhere; no score.
    pub information: Information,
    /// Covariance of the free coefficients, n × n.
    pub covariance: Vec<f64>,
    /// Noise levels.
    pub noise: Noise,
    /// How far a switch from it moves each free coefficient, std.
    pub spread: Vec<f64>,
    /// Samples that it is known from.
    pub samples: u64,
    pub(super) used: u64,
}

impl KnownLaw {
    /// Room for `n` free coefficients.
    pub fn none(n: usize) -> KnownLaw {
        KnownLaw {
            number: 0,
            coefficients: vec![0.0; n],
            active: vec![false; n],
            information: Information::none(n),
            covariance: vec![0.0; n * n],
            noise: Noise { sensor: [1.0; 2], process: 1.0 },
            spread: vec![1.0; n],
            samples: 0,
            used: 0,
        }
    }

    /// Variance of a free coefficient; 0 where the law does not have its term.
    pub fn variance(&self, free: usize) -> f64 {
        self.covariance[free * self.coefficients.len() + free]
    }

    pub(super) fn clone_from_law(&mut self, other: &KnownLaw) {
        self.number = other.number;
        self.coefficients.copy_from_slice(&other.coefficients);
        self.active.copy_from_slice(&other.active);
        self.information.clone_from_slices(&other.information);
        self.covariance.copy_from_slice(&other.covariance);
        self.noise = other.noise;
        self.spread.copy_from_slice(&other.spread);
        (self.samples, self.used) = (other.samples, other.used);
    }

    /// Takes the law that a segment has found.
    pub(super) fn take(&mut self, estimate: &Estimate, spread: &[f64], solution: &mut Solution) {
        let n = self.coefficients.len();
        self.coefficients.copy_from_slice(estimate.coefficients);
        self.active.copy_from_slice(estimate.active);
        self.noise = estimate.noise;
        self.spread.copy_from_slice(spread);
        self.information.clone_from_slices(estimate.information);
        self.information.scale(estimate.overdispersion.recip());
        self.information.score.fill(0.0);
        for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
            if !(self.active[row] && self.active[column]) {
                self.information.matrix[row * n + column] = 0.0;
            }
        }
        solution.solve(&self.information, &self.active);
        self.covariance.copy_from_slice(&solution.covariance);
    }

    /// Adds what an earlier segment of the same law knew.
    pub(super) fn add(&mut self, earlier: &KnownLaw, solution: &mut Solution) {
        for (index, step) in solution.step.iter_mut().enumerate() {
            *step = self.coefficients[index] - earlier.coefficients[index];
        }
        for row in 0..self.active.len() {
            let pull = if self.active[row] { earlier.information.row_times(row, &solution.step) } else { 0.0 };
            self.information.score[row] = -pull;
        }
        self.information.matrix.iter_mut().zip(&earlier.information.matrix).for_each(|(sum, entry)| *sum += entry);
        solution.solve(&self.information, &self.active);
        self.information.score.fill(0.0);
        self.coefficients.iter_mut().zip(&solution.step).for_each(|(value, step)| *value += step);
        self.covariance.copy_from_slice(&solution.covariance);
    }
}
