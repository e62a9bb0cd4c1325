//! A change of one coefficient alone.
//!
//! A law has many coefficients and a switch may move but one of them: to leave all of them open costs the evidence what
//! each could have been. That one of n has changed and nothing else is a hypothesis of its own. Under the law as it was
//! its error has a posterior of precision A = M₀ + Λ and mean x = A⁻¹(g₀ + Λμ), M₀ and g₀ being the information and
//! score that the record gives on it. Beside it a change of coefficient k has the information and score
//!
//! ```text
//! i = Mₖₖ − Cₖ A⁻¹ Cₖᵀ,   s = gₖ − Cₖ x,
//! ```
//!
//! C being what a change shares with the law's error, M where both act from the start on; and, with variance τ² before
//! the record, the log-evidence ½ s²τ²/(1 + iτ²) − ½ ln(1 + iτ²) against no change.

use crate::estimation::{Information, Lane, System, WIDTH, log_sum};
use serde::{Deserialize, Serialize};

/// What a change has of its own beside the law's uncertainty, relative to all that it has; less is rounding.
pub const OWN: f64 = 1e-9;

/// Room for the changes of n coefficients, one at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SingleChange {
    /// C through the elimination of A: a row for each coefficient that errs, of as many lanes as those need.
    crossed: Vec<Lane>,
    /// ½ s²τ²/(1 + iτ²) and 1 + iτ² of each.
    changes: Vec<[f64; 2]>,
}

impl SingleChange {
    /// Room for changes of `n` coefficients of a law that errs in `erring`, those the first.
    pub fn new(n: usize, erring: usize) -> SingleChange {
        SingleChange { crossed: vec![[0.0; WIDTH]; erring * erring.div_ceil(WIDTH)], changes: vec![[0.0; 2]; n] }
    }

    /// Log-evidence, nats, of a change of one coefficient, each as likely as the others, against none. `record` is what
    /// the data say of changes, `shared` what they share with the law's error by the coefficients of both. `system` is
    /// A and g + Λμ, eliminated, with what is not `open` isolated; `precision` is 1/τ² of each coefficient.
    pub fn evidence(
        &mut self,
        record: &Information,
        shared: impl Fn(usize, usize) -> f64,
        system: &System,
        open: &[bool],
        precision: &[f64],
    ) -> f64 {
        let n = record.n;
        self.cross(n, shared, system, open);
        for (k, (slot, precision)) in self.changes.iter_mut().zip(precision).enumerate() {
            let [own, pulled] = system.products(&self.crossed, k);
            let information = record.matrix[k * n + k] - own;
            let score = record.score[k] - pulled;
            let shrunk = 1.0 + information / precision;
            let clear = information > OWN * record.matrix[k * n + k];
            *slot = if clear { [0.5 * score * score / (precision * shrunk), shrunk] } else { [0.0, 1.0] };
        }
        let largest = self.changes.iter().map(|[gain, _]| *gain).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = self.changes.iter().map(|[gain, shrunk]| (gain - largest).exp() / shrunk.sqrt()).sum();
        largest + (sum / n as f64).ln()
    }

    /// What is shared, through the elimination; what is not open was not in it.
    fn cross(&mut self, n: usize, shared: impl Fn(usize, usize) -> f64, system: &System, open: &[bool]) {
        for (erring, target) in self.crossed.chunks_exact_mut(open.len().div_ceil(WIDTH)).enumerate() {
            let target = &mut target.as_flattened_mut()[..n];
            let entries = target.iter_mut().enumerate();
            entries.for_each(|(changed, entry)| *entry = if open[erring] { shared(changed, erring) } else { 0.0 });
        }
        system.forward(&mut self.crossed);
    }
}

/// Log-evidence of either of two hypotheses, each as likely beforehand.
pub fn either(first: f64, second: f64) -> f64 {
    log_sum(first, second) - std::f64::consts::LN_2
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thirty readings of a x + b + c x², std 0.1.
    fn record() -> Information {
        let mut information = Information::none(3);
        for k in 0..30 {
            let x = 0.1 * f64::from(k) - 1.0;
            let residual = 0.04 * x - 0.3 * x * x + 0.1 * (12.9898 * f64::from(k)).sin();
            information.add(&[x, 1.0, x * x], residual, 0.01);
        }
        information
    }

    fn prior() -> Information {
        let mut information = Information::none(3);
        for k in 0..40 {
            let x = (7.1 * f64::from(k)).sin();
            information.add(&[x, 1.0, 0.3 * x * x], 0.02 * x, 0.04);
        }
        information
    }

    /// ln of the normal integral exp(b·x − ½ xᵀAx) over as many unknowns as A has, without what all such integrals
    /// share.
    fn log_integral(matrix: &[f64], right: &[f64]) -> f64 {
        let n = right.len();
        let mut system = System::new(n);
        system.load(&[matrix, &[0.0; WIDTH]].concat(), None);
        system.set_right(right.iter().copied());
        system.eliminate(0.0);
        0.5 * (system.squares() - system.log_determinant())
    }

    /// The change of coefficient k as a fourth unknown beside the three, of which `open` are open.
    fn by_a_larger_system(k: usize, precision: f64, open: [bool; 3]) -> f64 {
        let (record, prior) = (record(), prior());
        let entry = |sums: &Information, a: usize, b: usize| sums.matrix[3 * a.min(b) + a.max(b)];
        let with = |change: bool| {
            let unknowns: Vec<Option<usize>> =
                (0..3).filter(|index| open[*index]).map(Some).chain(change.then_some(None)).collect();
            let n = unknowns.len();
            let (mut matrix, mut right) = (vec![0.0; n * n], vec![0.0; n]);
            for (row, a) in unknowns.iter().enumerate() {
                for (column, b) in unknowns.iter().enumerate() {
                    let own = match (a, b) {
                        (Some(a), Some(b)) => entry(&prior, *a, *b),
                        (None, None) => precision,
                        _ => 0.0,
                    };
                    matrix[row * n + column] = own + entry(&record, a.unwrap_or(k), b.unwrap_or(k));
                }
                right[row] = record.score[a.unwrap_or(k)] + a.map_or(0.0, |a| prior.score[a]);
            }
            log_integral(&matrix, &right)
        };
        with(true) - with(false) + 0.5 * precision.ln()
    }

    fn found(open: [bool; 3], precision: [f64; 3]) -> f64 {
        let (record, prior) = (record(), prior());
        let mut system = System::new(3);
        system.load(&record.matrix, Some(&prior.matrix));
        system.set_right(record.score.iter().zip(&prior.score).map(|(a, b)| a + b));
        (0..3).filter(|index| !open[*index]).for_each(|index| system.isolate(index));
        system.eliminate(1e-13);
        SingleChange::new(3, 3).evidence(
            &record,
            |changed, erring| record.entry(changed, erring),
            &system,
            &open,
            &precision,
        )
    }

    #[test]
    fn a_change_is_one_more_unknown() {
        let precision = [2.0, 5.0, 0.5];
        for open in [[true; 3], [true, true, false], [false, true, true]] {
            let each = (0..3).map(|k| by_a_larger_system(k, precision[k], open));
            let expected = (each.map(f64::exp).sum::<f64>() / 3.0).ln();
            let found = found(open, precision);
            assert!((found - expected).abs() < 1e-9, "{found} against {expected}");
        }
    }

    #[test]
    fn either_of_two_is_half_as_likely_as_the_sum_of_both() {
        let (first, second) = (1.3, -0.4);
        let expected = (0.5 * (f64::exp(first) + f64::exp(second))).ln();
        assert!((either(first, second) - expected).abs() < 1e-12 && (either(second, first) - expected).abs() < 1e-12);
        assert!((either(900.0, 0.0) - 900.0 + 2.0_f64.ln()).abs() < 1e-12);
    }
}
