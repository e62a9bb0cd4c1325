//! Coefficients that wander: a Kalman filter whose state is the coefficients θ and whose measurements are weak rows,
//!
//! ```text
//! θ⁺ = θ + w,  w ~ N(0, Q)        h·θ = r + v,  v ~ N(0, R)
//! ```
//!
//! Q is diagonal: each coefficient wanders by a given part of its *reach*, the value at which its term alone would be
//! as large as the right side, per length of the variation. R is what the sensors leave in the residual, and a part of
//! the row's own size: error of the law. Noise in h biases least squares; its expectation is taken out of the score
//! (errors in variables; Fuller, *Measurement Error Models*, 1987, 1.2).

use serde::{Deserialize, Serialize};

/// No coefficient is looked for beyond this many times its reach, as a std: the other terms would have to cancel what
/// its force exceeds the right side by.
const WIDEST: f64 = 3.0;

/// One weak row h·θ = r.
#[derive(Clone, Copy, Debug)]
pub struct Equation<'a> {
    /// h, n.
    pub left: &'a [f64],
    /// r.
    pub right: f64,
    /// Variance that the sensors leave in h·θ − r.
    pub variance: f64,
    /// Covariance of that noise with h, n.
    pub bias: &'a [f64],
    /// Mean square of r of late.
    pub size: f64,
}

/// A filter with one intensity of wandering and one error of the law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RandomWalk {
    /// Std of the wandering over the length of a variation, relative to the reach.
    pub intensity: f64,
    /// Std of the law's error, relative to the row's size.
    pub error: f64,
    /// The coefficient that does not wander.
    pub fixed: Option<usize>,
    /// θ, n.
    pub coefficients: Vec<f64>,
    /// Logarithm of its probability among its rivals, up to a constant.
    pub log_weight: f64,
    covariance: Vec<f64>,
    gain: Vec<f64>,
}

impl RandomWalk {
    /// Knows nothing of `n` coefficients.
    pub fn new(n: usize, intensity: f64, error: f64, fixed: Option<usize>) -> RandomWalk {
        let mut walk = RandomWalk {
            intensity,
            error,
            fixed,
            coefficients: vec![0.0; n],
            log_weight: 0.0,
            covariance: vec![0.0; n * n],
            gain: vec![0.0; n],
        };
        walk.clear();
        walk
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        let n = self.coefficients.len();
        self.coefficients.fill(0.0);
        self.covariance.fill(0.0);
        self.covariance.iter_mut().step_by(n + 1).for_each(|entry| *entry = f64::MAX.sqrt());
        self.log_weight = 0.0;
    }

    /// Variance of the coefficient.
    pub fn variance(&self, index: usize) -> f64 {
        self.covariance[index * (self.coefficients.len() + 1)]
    }

    /// By how much the coefficient's variance grows over the length of a variation.
    pub fn step(&self, index: usize, reach: f64) -> f64 {
        if self.fixed == Some(index) { 0.0 } else { (self.intensity * reach).powi(2) }
    }

    /// Lets the coefficients wander for this part of a variation's length.
    pub fn wander(&mut self, reach: &[f64], part: f64) {
        let n = reach.len();
        for (index, reach) in reach.iter().enumerate() {
            self.covariance[index * (n + 1)] += self.step(index, *reach) * part;
            let narrower = WIDEST * reach / self.variance(index).sqrt();
            if narrower < 1.0 {
                self.covariance[index * n..(index + 1) * n].iter_mut().for_each(|entry| *entry *= narrower);
                self.covariance[index..].iter_mut().step_by(n).for_each(|entry| *entry *= narrower);
            }
        }
    }

    /// Takes a row; returns the logarithm of its probability density, for r in units of its usual size and up to a
    /// constant.
    pub fn learn(&mut self, row: &Equation) -> f64 {
        let noise = row.variance + self.error * self.error * row.size.max(row.right * row.right);
        self.set_gain(row.left);
        let known: f64 = row.left.iter().zip(&self.gain).map(|(left, gain)| left * gain).sum();
        let variance = known.max(0.0) + noise;
        let expected: f64 = row.left.iter().zip(&self.coefficients).map(|(left, value)| left * value).sum();
        let innovation = row.right - expected;
        let n = row.left.len();
        for index in 0..n {
            let covariance = &self.covariance[index * n..(index + 1) * n];
            let unbiased: f64 = covariance.iter().zip(row.bias).map(|(entry, bias)| entry * bias).sum();
            self.coefficients[index] += (self.gain[index] * innovation + unbiased) / variance;
        }
        for (covariance, first) in self.covariance.chunks_exact_mut(n).zip(&self.gain) {
            for (entry, second) in covariance.iter_mut().zip(&self.gain) {
                *entry -= first * second / variance;
            }
        }
        -0.5 * (innovation * innovation / variance + (variance / row.size).ln())
    }

    /// P h.
    fn set_gain(&mut self, left: &[f64]) {
        for (gain, covariance) in self.gain.iter_mut().zip(self.covariance.chunks_exact(left.len())) {
            *gain = covariance.iter().zip(left).map(|(entry, left)| entry * left).sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of q̈ + k q = 0 about a k that wanders; returns the mean of (k − k̂)² ÷ its stated variance.
    fn normalised_error(intensity: f64) -> f64 {
        let mut walk = RandomWalk::new(1, intensity, 0.02, None);
        let (mut stiffness, mut seed, mut sum, mut count) = (30.0, 1_u64, 0.0, 0.0);
        let mut noise = move || {
            let uniform = (0..12).map(|_| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (seed >> 11) as f64 / (1_u64 << 53) as f64
            });
            uniform.sum::<f64>() - 6.0
        };
        for k in 0..4000 {
            stiffness += intensity * 30.0 * noise();
            let left = (0.9 * f64::from(k)).sin();
            let right = stiffness * left + 0.02 * 30.0 * noise();
            walk.wander(&[30.0], 1.0);
            walk.learn(&Equation { left: &[left], right, variance: 0.0, bias: &[0.0], size: 900.0 });
            if k > 20 {
                sum += (stiffness - walk.coefficients[0]).powi(2) / walk.variance(0);
                count += 1.0;
            }
        }
        sum / count
    }

    #[test]
    fn the_stated_variance_is_that_of_the_error() {
        for intensity in [0.003, 0.03] {
            let error = normalised_error(intensity);
            assert!((0.8..1.2).contains(&error), "at {intensity}: {error}");
        }
    }
}
