//! How large the motion is, for priors in the data's own units.

use crate::estimation::{Observation, Pass};
use crate::law::Motion;
use serde::{Deserialize, Serialize};

/// Smallest mean square of the law's own acceleration, in terms of the excitation's: one per cent of its RMS.
const LEAST: f64 = 1e-4;

/// Mean squares over a pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionScales {
    /// Σ (∂q̈/∂θ)² by free coefficient.
    slopes: Vec<f64>,
    /// Σ (F ÷ m)².
    force: f64,
    /// Σ q̈² as it would be without an excitation.
    restoring: f64,
    stiffness: f64,
    count: f64,
}

impl MotionScales {
    /// Nothing seen yet of `n` free coefficients.
    pub fn new(n: usize) -> MotionScales {
        MotionScales { slopes: vec![0.0; n], force: 0.0, restoring: 0.0, stiffness: 0.0, count: 0.0 }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.slopes.fill(0.0);
        (self.force, self.restoring, self.stiffness, self.count) = (0.0, 0.0, 0.0, 0.0);
    }

    /// Remembers others as if they had been seen over so many samples.
    pub fn remember(&mut self, others: &MotionScales, count: f64) {
        self.clear();
        if others.count > 0.0 {
            self.merge(others, count / others.count);
        }
    }

    /// Takes others, each sample of theirs counted `weight` times.
    pub fn merge(&mut self, others: &MotionScales, weight: f64) {
        for (sum, slopes) in self.slopes.iter_mut().zip(&others.slopes) {
            *sum += weight * slopes;
        }
        self.force += weight * others.force;
        self.restoring += weight * others.restoring;
        self.stiffness += weight * others.stiffness;
        self.count += weight * others.count;
    }

    /// Takes the interval that the pass has just run over, under the law `motion`.
    pub fn add(&mut self, motion: &Motion, pass: &Pass, observation: &Observation) {
        let state = pass.filter.state();
        for (sum, input) in self.slopes.iter_mut().zip(&pass.map.input) {
            *sum += (input[1] / observation.dt).powi(2);
        }
        self.force += (observation.drive.part(0, 1)[0] / motion.mass(state.q)).powi(2);
        self.restoring += motion.acceleration(state, 0.0).powi(2);
        let stiffness = pass.map.transition[1][0] / observation.dt;
        self.stiffness += stiffness.abs();
        self.count += 1.0;
    }

    /// RMS of the acceleration that the excitation gives, or in free motion the one that the law gives.
    pub fn acceleration(&self) -> f64 {
        let sum = if self.force > 0.0 { self.force } else { self.restoring };
        (sum / self.count.max(1.0)).sqrt()
    }

    /// RMS of the acceleration that a force of the motion gives, as the law's own forces are: of a rough excitation
    /// most acts on the inertia alone.
    pub fn restoring_acceleration(&self) -> f64 {
        let sum = if self.force > 0.0 { self.restoring.clamp(LEAST * self.force, self.force) } else { self.restoring };
        (sum / self.count.max(1.0)).sqrt()
    }

    /// 1 ÷ natural angular frequency of the law about its motion, s; ∞ without stiffness.
    pub fn natural_time(&self) -> f64 {
        (self.count / self.stiffness).sqrt()
    }

    /// RMS of ∂q̈/∂θ of the free coefficient.
    pub fn slope(&self, index: usize) -> f64 {
        (self.slopes[index] / self.count.max(1.0)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_record_counts_for_what_it_is_beside_what_was_before() {
        let before = MotionScales { slopes: vec![4e4], force: 9e4, restoring: 1e4, stiffness: 1e6, count: 1e4 };
        let mut scales = MotionScales { slopes: vec![0.0], force: 1.0, restoring: 0.0, stiffness: 1e3, count: 10.0 };
        let mut known = MotionScales::new(1);
        known.remember(&before, 490.0);
        scales.merge(&known, 1.0);
        assert!((scales.slope(0) - (4.0 * 0.98_f64).sqrt()).abs() < 1e-12);
        assert!((scales.restoring_acceleration() - 0.98_f64.sqrt()).abs() < 1e-12);
        assert!((scales.natural_time() - 0.1).abs() < 1e-12);
        known.remember(&MotionScales::new(1), 490.0);
        assert_eq!(known, MotionScales::new(1));
    }
}
