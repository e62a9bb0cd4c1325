//! How well coefficients that are known beforehand explain a record.
//!
//! A record's information I and score g about a point θ₀ make its likelihood Gaussian there: ln L(θ₀ + δ) = g·δ − ½
//! δᵀIδ. A prior of the coefficients, δ normal about μ with precision Λ, then has the log-evidence (MacKay,
//! *Information Theory, Inference, and Learning Algorithms*, ch. 28)
//!
//! ```text
//! ln ∫ L p dδ − ln L(θ₀) = g·μ − ½ μᵀIμ + ½ hᵀ(I + Λ)⁻¹h − ½ ln det(I + Λ) + ½ ln det Λ,   h = g − Iμ
//! ```
//!
//! A law seen before and "some law that switches may lead to" are two such beliefs: their difference says, in nats,
//! which of them the record speaks for. The wider belief pays for what it leaves open.

use super::single_change::SingleChange;
use crate::estimation::Information;
use crate::estimation::{System, WIDTH};
use serde::{Deserialize, Serialize};

/// Pivots this far below their diagonal are rounding.
pub(super) const TOLERANCE: f64 = 1e-13;

/// What is believed of n coefficients before a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GaussianPrior {
    /// Where they lie, about the point at which the record's score is taken, n.
    pub offset: Vec<f64>,
    /// Λ, as [`Information::matrix`].
    precision: Vec<f64>,
    /// Coefficients that are open; the others are exactly at their offset.
    open: Vec<bool>,
    log_determinant: f64,
}

/// Room for the elimination.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BayesFactor {
    record: Information,
    system: System,
    single: SingleChange,
}

impl GaussianPrior {
    /// Certainty that `n` coefficients are at the point.
    pub fn none(n: usize) -> GaussianPrior {
        GaussianPrior {
            offset: vec![0.0; n],
            precision: vec![0.0; n * n + WIDTH],
            open: vec![false; n],
            log_determinant: 0.0,
        }
    }

    /// Independent coefficients with these variances; 0 is certainty.
    pub fn set_variances(&mut self, variances: impl Iterator<Item = f64>) {
        let n = self.open.len();
        self.precision.fill(0.0);
        self.log_determinant = 0.0;
        for (index, variance) in variances.enumerate() {
            self.open[index] = variance > 0.0;
            if self.open[index] {
                self.precision[index * n + index] = variance.recip();
                self.log_determinant -= variance.ln();
            }
        }
    }

    /// The precision that information has on the coefficients `open`, the others held.
    pub fn set_information(&mut self, information: &Information, open: &[bool], weighing: &mut BayesFactor) {
        self.precision.copy_from_slice(&information.matrix);
        self.open.copy_from_slice(open);
        weighing.system.load(&self.precision, None);
        weighing.system.set_right(std::iter::repeat_n(0.0, open.len()));
        weighing.isolate(open);
        weighing.system.eliminate(TOLERANCE);
        for (index, slot) in self.open.iter_mut().enumerate() {
            *slot &= weighing.system.is_solved(index);
        }
        self.log_determinant = weighing.system.log_determinant();
    }
}

impl BayesFactor {
    /// Room for `n` coefficients.
    pub fn new(n: usize) -> BayesFactor {
        BayesFactor { record: Information::none(n), system: System::new(n), single: SingleChange::new(n, n) }
    }

    /// Log-evidence of the belief, nats, against certainty that the coefficients are at the record's point.
    pub fn evidence(&mut self, record: &Information, belief: &GaussianPrior) -> f64 {
        self.record.clone_from_slices(record);
        let at_offset = likelihood(record, &belief.offset);
        self.record.shift(&belief.offset);
        self.system.load(&record.matrix, Some(&belief.precision));
        self.system.set_right(self.record.score.iter().copied());
        self.isolate(&belief.open);
        self.system.eliminate(TOLERANCE);
        at_offset + 0.5 * (self.system.squares() - self.system.log_determinant() + belief.log_determinant)
    }

    /// Log-evidence, nats, of a change of one coefficient alone against the belief that has just been weighed;
    /// `precision` is 1/τ² of each.
    pub fn evidence_of_a_change(&mut self, belief: &GaussianPrior, precision: &[f64]) -> f64 {
        let shared = |changed, erring| self.record.entry(changed, erring);
        self.single.evidence(&self.record, shared, &self.system, &belief.open, precision)
    }

    fn isolate(&mut self, open: &[bool]) {
        for (unknown, _) in open.iter().enumerate().filter(|(_, open)| !**open) {
            self.system.isolate(unknown);
        }
    }
}

/// ln L(θ₀ + δ) − ln L(θ₀), nats.
pub fn likelihood(record: &Information, change: &[f64]) -> f64 {
    let slope: f64 = record.score.iter().zip(change).map(|(score, change)| score * change).sum();
    slope - 0.5 * record.quadratic(change)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twenty readings of a line 1.5 x + 0.4, std 0.1, about the point (1, 0).
    fn record() -> Information {
        let mut information = Information::none(2);
        for k in 0..20 {
            let x = 0.1 * f64::from(k);
            let noise = 0.1 * (12.9898 * f64::from(k)).sin();
            information.add(&[x, 1.0], 1.5 * x + 0.4 + noise - x, 0.01);
        }
        information
    }

    fn integrated(record: &Information, offset: [f64; 2], std: [f64; 2]) -> f64 {
        let (count, reach) = (400, 6.0);
        let at_offset = likelihood(record, &offset);
        let place = |k: i32| reach * (2.0 * f64::from(k) / f64::from(count) - 1.0);
        let cell = (2.0 * reach / f64::from(count)).powi(2) / (2.0 * std::f64::consts::PI);
        let term = |a: i32, b: i32| {
            let (a, b) = (place(a), place(b));
            let change = [offset[0] + std[0] * a, offset[1] + std[1] * b];
            (likelihood(record, &change) - at_offset - 0.5 * (a * a + b * b)).exp() * cell
        };
        (0..=count).flat_map(|a| (0..=count).map(move |b| (a, b))).map(|(a, b)| term(a, b)).sum::<f64>().ln()
            + at_offset
    }

    #[test]
    fn the_evidence_of_a_belief_is_the_integral_of_the_likelihood_over_it() {
        let (offset, std) = ([0.45, 0.5], [0.1, 0.2]);
        let mut belief = GaussianPrior::none(2);
        belief.offset.copy_from_slice(&offset);
        belief.set_variances(std.iter().map(|std| std * std));
        let evidence = BayesFactor::new(2).evidence(&record(), &belief);
        let sum = integrated(&record(), offset, std);
        assert!((evidence - sum).abs() < 1e-3, "{evidence} against {sum}");
    }

    #[test]
    fn certainty_has_the_likelihood_of_its_point() {
        let mut belief = GaussianPrior::none(2);
        belief.offset.copy_from_slice(&[0.4, 0.5]);
        let evidence = BayesFactor::new(2).evidence(&record(), &belief);
        assert!((evidence - likelihood(&record(), &belief.offset)).abs() < 1e-9);
    }

    #[test]
    fn a_precision_and_the_same_variances_are_one_belief() {
        let mut precision = Information::none(2);
        (precision.matrix[0], precision.matrix[3]) = (100.0, 25.0);
        let (mut weighing, mut first, mut second) =
            (BayesFactor::new(2), GaussianPrior::none(2), GaussianPrior::none(2));
        first.set_information(&precision, &[true, true], &mut weighing);
        second.set_variances([0.01, 0.04].into_iter());
        let difference = weighing.evidence(&record(), &first) - weighing.evidence(&record(), &second);
        assert!(difference.abs() < 1e-9, "{difference}");
    }
}
