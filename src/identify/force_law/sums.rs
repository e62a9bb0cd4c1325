//! Sums of a weighted linear regression: Λ = Σ w φφᵀ, b = Σ w φ F, Σ w F², and how many samples.
//!
//! They add and subtract, so that any stretch of a record is the difference of two sums.

use crate::estimation::System;
use serde::{Deserialize, Serialize};

/// Part of a pivot's diagonal entry below which it is rounding: what the others leave of its term is nothing.
pub const ROUNDING: f64 = 1e-10;

/// What a sample counts.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    /// w.
    pub value: f64,
    /// Expectation of w (F − φᵀθ)² ÷ σ².
    pub freedom: f64,
}

/// Sums over a stretch of a record, for n unknowns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    /// Λ, row-major, both triangles.
    pub information: Vec<f64>,
    /// b.
    pub right: Vec<f64>,
    /// Σ w F², Σ w F and Σ w.
    pub squares: f64,
    pub force: f64,
    pub weight: f64,
    /// Degrees of freedom: the samples, each with the share of σ² that its weighted residual has.
    pub count: f64,
}

impl Sums {
    /// Of nothing.
    pub fn none(n: usize) -> Sums {
        Sums { information: vec![0.0; n * n], right: vec![0.0; n], squares: 0.0, force: 0.0, weight: 0.0, count: 0.0 }
    }

    /// Number of unknowns.
    pub fn n(&self) -> usize {
        self.right.len()
    }

    /// Takes one sample.
    pub fn add(&mut self, features: &[f64], force: f64, weight: &Weight) {
        let Weight { value: weight, freedom } = *weight;
        for ((row, right), feature) in
            self.information.chunks_exact_mut(features.len().max(1)).zip(&mut self.right).zip(features)
        {
            let scaled = weight * feature;
            row.iter_mut().zip(features).for_each(|(entry, other)| *entry += scaled * other);
            *right += scaled * force;
        }
        self.squares += weight * force * force;
        self.force += weight * force;
        self.weight += weight;
        self.count += freedom;
    }

    /// Copies the other's sums into this room.
    pub fn copy(&mut self, other: &Sums) {
        self.information.copy_from_slice(&other.information);
        self.right.copy_from_slice(&other.right);
        (self.squares, self.force) = (other.squares, other.force);
        (self.weight, self.count) = (other.weight, other.count);
    }

    /// Adds `sign` times the other's sums.
    pub fn merge(&mut self, other: &Sums, sign: f64) {
        self.information.iter_mut().zip(&other.information).for_each(|(own, other)| *own += sign * other);
        self.right.iter_mut().zip(&other.right).for_each(|(own, other)| *own += sign * other);
        self.squares += sign * other.squares;
        self.force += sign * other.force;
        self.weight += sign * other.weight;
        self.count += sign * other.count;
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.information.fill(0.0);
        self.right.fill(0.0);
        (self.squares, self.force, self.weight, self.count) = (0.0, 0.0, 0.0, 0.0);
    }

    /// Σ w (F − φᵀθ)².
    pub fn loss(&self, coefficients: &[f64]) -> f64 {
        let pulled: f64 = self.right.iter().zip(coefficients).map(|(right, value)| right * value).sum();
        (self.squares - 2.0 * pulled + self.quadratic(coefficients)).max(0.0)
    }

    /// Writes the score b − Λθ.
    pub fn score(&self, coefficients: &[f64], score: &mut [f64]) {
        let n = self.n();
        for (row, score) in score.iter_mut().enumerate().take(n) {
            *score = self.right[row] - dot(&self.information[row * n..(row + 1) * n], coefficients);
        }
    }

    /// Σ w (F − F̄)²: what there is to explain.
    pub fn spread(&self) -> f64 {
        if self.weight > 0.0 { (self.squares - self.force * self.force / self.weight).max(0.0) } else { 0.0 }
    }

    /// Eliminates Λ with b; unknowns that `active` leaves out, and those of which nothing is known beside the others,
    /// are fixed to 0.
    pub fn eliminate(&self, active: &[bool], system: &mut System) {
        let n = self.n();
        for row in 0..n {
            let entries = system.row(row);
            entries[..n].copy_from_slice(&self.information[row * n..(row + 1) * n]);
        }
        system.set_right(self.right.iter().copied());
        (0..n).filter(|unknown| !active[*unknown]).for_each(|unknown| system.isolate(unknown));
        system.eliminate(ROUNDING);
    }

    fn quadratic(&self, vector: &[f64]) -> f64 {
        let n = self.n();
        (0..n).map(|row| vector[row] * dot(&self.information[row * n..(row + 1) * n], vector)).sum()
    }
}

/// Σ a b.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
