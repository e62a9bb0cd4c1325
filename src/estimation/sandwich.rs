//! Whether innovations are as independent as the filter says.
//!
//! Under the right law the scores of separate blocks of a record are independent, each with its block's information as
//! covariance. Error that the law does not model lasts: the blocks' scores are then larger, and so is the covariance of
//! the coefficients, by the same factor (the sandwich estimate of White, Econometrica 50, 1982, here as one factor for
//! all).

use super::information::Information;
use serde::{Deserialize, Serialize};

/// Blocks in a record: the largest ratio of one coefficient is then 1 ± 0.35 under the right law, √(2 ÷ 16).
const BLOCKS: u64 = 16;

/// Sums of squared block scores.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SandwichFactor {
    length: u64,
    left: u64,
    before: Vec<f64>,
    squares: Vec<f64>,
}

impl SandwichFactor {
    /// For `n` coefficients.
    pub fn new(n: usize) -> SandwichFactor {
        SandwichFactor { length: 1, left: 1, before: vec![0.0; n], squares: vec![0.0; n] }
    }

    /// Begins a record of about `samples` samples.
    pub fn begin(&mut self, samples: u64) {
        self.length = (samples / BLOCKS).max(1);
        self.left = self.length;
        self.before.fill(0.0);
        self.squares.fill(0.0);
    }

    /// Takes the sums as they are after one more sample.
    pub fn step(&mut self, information: &Information) {
        self.left -= 1;
        if self.left > 0 {
            return;
        }
        self.left = self.length;
        for ((square, before), score) in self.squares.iter_mut().zip(&mut self.before).zip(&information.score) {
            *square += (score - *before).powi(2);
            *before = *score;
        }
    }

    /// The largest over the coefficients of Σ (block score)² ÷ information: about 1 under the right law.
    pub fn overdispersion(&self, information: &Information) -> f64 {
        let n = information.n;
        let ratio = |index: usize| self.squares[index] / information.matrix[index * n + index];
        (0..n).map(ratio).filter(|ratio| ratio.is_finite()).fold(1.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overdispersion(residual: impl Fn(usize) -> f64) -> f64 {
        let mut information = Information::none(2);
        let mut blocks = SandwichFactor::new(2);
        blocks.begin(6400);
        for k in 0..6400 {
            information.add(&[(0.01 * k as f64).sin(), 1.0], residual(k), 1.0);
            blocks.step(&information);
        }
        blocks.overdispersion(&information)
    }

    #[test]
    fn white_residuals_are_not_overdispersed_and_lasting_ones_are() {
        let scrambled = |k: usize| ((k as f64 * 12.9898).sin() * 43758.5453).fract() * f64::sqrt(3.0);
        assert!(overdispersion(scrambled) < 3.0, "{}", overdispersion(scrambled));
        let lasting = |k: usize| scrambled(k / 200);
        assert!(overdispersion(lasting) > 30.0, "{}", overdispersion(lasting));
    }
}
