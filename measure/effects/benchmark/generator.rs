//! Random numbers by seed.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::ops::Range;

/// A source of random numbers.
pub struct Generator(ChaCha8Rng);

impl Generator {
    /// The source of that seed.
    pub fn new(seed: u64) -> Generator {
        Generator(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in the range.
    pub fn uniform(&mut self, range: Range<f64>) -> f64 {
        self.0.random_range(range)
    }

    /// Uniform in the logarithm.
    pub fn decades(&mut self, range: Range<f64>) -> f64 {
        self.uniform(range.start.ln()..range.end.ln()).exp()
    }

    /// True with that probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.0.random_bool(probability)
    }

    /// −1 or 1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// One of the choices.
    pub fn choose<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.0.random_range(0..choices.len())]
    }

    /// Gaussian with mean 0 and std 1.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A seed for another source.
    pub fn seed(&mut self) -> u64 {
        self.0.random_range(0..1 << 53)
    }
}
