//! "No switch": the law until a hypothesis starts, with certain terms.

use crate::estimation::{Information, System};
use crate::evidence::bayes_factor::TOLERANCE;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct NoChange {
    /// Which coefficients it has.
    pub(super) active: Vec<bool>,
    /// μᵀΛμ.
    pub(super) at_mean: f64,
    /// ln det Λ.
    pub(super) log_determinant: f64,
    /// Logarithm of its probability when the hypothesis starts.
    pub(super) log_weight: f64,
}

impl NoChange {
    pub(super) fn none(n: usize) -> NoChange {
        NoChange { active: vec![false; n], at_mean: 0.0, log_determinant: 0.0, log_weight: 0.0 }
    }

    /// Takes what its record says of it; a coefficient of which that says nothing is none of its own.
    pub(super) fn settle(&mut self, prior: &Information, system: &mut System) {
        system.load(&prior.matrix, None);
        system.set_right(prior.score.iter().copied());
        self.isolate_inactive(system);
        system.eliminate(TOLERANCE);
        for (index, active) in self.active.iter_mut().enumerate() {
            *active &= system.is_solved(index);
        }
        (self.at_mean, self.log_determinant) = (system.squares(), system.log_determinant());
    }

    /// Shares the probability with the same law without some of its coefficients: what they gain in likelihood, against
    /// how much of what each could have been, 1/√`precision`, the record leaves (Dickey, *Ann. Math. Stat.* 42 (1971),
    /// 204). What it could have been is in the prior that both were settled with.
    pub(super) fn share(&mut self, fewer: &mut NoChange, precision: &[f64]) {
        let dropped =
            self.active.iter().zip(&fewer.active).zip(precision).filter(|((own, fewer), _)| **own && !**fewer);
        let reach: f64 = dropped.map(|(_, precision)| -0.5 * precision.ln()).sum();
        let odds = 0.5 * (fewer.at_mean - self.at_mean + self.log_determinant - fewer.log_determinant) + reach;
        let odds = if odds.is_nan() { f64::NEG_INFINITY } else { odds };
        (fewer.log_weight, self.log_weight) = (-(-odds).exp().ln_1p(), -odds.exp().ln_1p());
    }

    /// Takes what the law does not have out of the system.
    pub(super) fn isolate_inactive(&self, system: &mut System) {
        for (unknown, _) in self.active.iter().enumerate().filter(|(_, active)| !**active) {
            system.isolate(unknown);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::Information;

    /// Fifty readings of 1.2 x + b about (1.2, 0), std 0.1, each coefficient known to some 1/20 of what it could be.
    fn weights(offset: f64) -> [f64; 2] {
        let mut record = Information::none(2);
        for k in 0..50 {
            let x = 0.1 * f64::from(k) - 2.0;
            record.add(&[x, 1.0], offset + 0.1 * (12.9898 * f64::from(k)).sin(), 0.01);
        }
        record.matrix[3] += 4.0;
        let (mut system, mut full, mut own) = (System::new(2), NoChange::none(2), NoChange::none(2));
        full.active = vec![true, true];
        own.active = vec![true, false];
        full.settle(&record, &mut system);
        own.settle(&record, &mut system);
        full.share(&mut own, &[4.0, 4.0]);
        [full.log_weight.exp(), own.log_weight.exp()]
    }

    #[test]
    fn a_term_that_the_record_does_not_speak_for_is_likely_none() {
        let [full, own] = weights(0.0);
        assert!((full + own - 1.0).abs() < 1e-12 && own > 0.9, "{full} {own}");
    }

    #[test]
    fn a_term_that_was_dropped_wrongly_is_likely_there() {
        let [full, own] = weights(0.2);
        assert!((full + own - 1.0).abs() < 1e-12 && full > 0.99, "{full} {own}");
    }
}
