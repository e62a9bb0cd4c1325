//! Candidates that the screen found, each in the law: refitted, and compared by likelihood.
//!
//! A candidate joins the law, all coefficients and the noise are fitted anew, and the log-likelihood gained is its evidence: twice that
//! gain is χ² distributed where it is not there (Wilks 1938), the level being shared among all that were tried (Bonferroni). Two that
//! gain the same cannot be told apart on this record: the difference must exceed [`TIE`] nats, and by a multiple of the scatter with
//! which it comes from one stretch of the record to the next (Vuong 1989).

use super::fit::{Fit, refit};
use super::means;
use super::piece::Piece;
use super::screen::{self, Gain};
use super::variants::{Variant, is_continuous};
use crate::law::{State, Term};

/// Difference of log-likelihood, nats, below which two candidates are equally good.
const TIE: f64 = 3.0;

/// Standard errors by which one candidate must be better than another, stretch by stretch.
const CLEAR: f64 = 2.0;

/// Gauss–Newton steps on the inner parameters of a candidate.
const POLISHES: usize = 4;

/// Gain in log-likelihood, nats, for which another is taken.
const GAIN: f64 = 0.05;

/// Relative change of an inner parameter from which its slope is taken.
const DIFFERENCE: f64 = 0.01;

/// Largest step, in the logarithm of an inner parameter.
const LARGEST_STEP: f64 = 0.3;

/// A candidate in the law.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The candidate.
    pub term: Term,
    /// The law with it as its last term, fitted.
    pub fit: Fit,
    /// Log-likelihood gained.
    pub gain: f64,
    /// Log-likelihood by stretch of the record.
    pub by_stretch: Vec<f64>,
}

impl Trial {
    /// Fits the law of `base` with the candidate in it.
    pub fn of(base: &Fit, pieces: &[Piece], variant: Variant, expected: &Gain) -> Option<Trial> {
        let form = base.form.with(variant.term);
        let mut coefficients = base.coefficients.clone();
        coefficients.push(expected.coefficient);
        let fit = refit(&form, pieces, &coefficients, base.noise)?;
        Some(Trial { term: variant.term, gain: fit.log_likelihood - base.log_likelihood, fit, by_stretch: Vec::new() })
    }

    /// Fits the inner parameters too, and takes the record apart into stretches.
    pub fn polish(&mut self, pieces: &[Piece]) {
        for _ in 0..POLISHES {
            match polished(&self.fit, pieces) {
                Some(better) if better.log_likelihood > self.fit.log_likelihood + GAIN => {
                    self.gain += better.log_likelihood - self.fit.log_likelihood;
                    self.term = better.form.terms.last().copied().unwrap_or(self.term);
                    self.fit = better;
                }
                _ => break,
            }
        }
        self.by_stretch = by_stretch(&self.fit, pieces);
    }

    /// What a screen would have said of it.
    pub fn as_gain(&self) -> Gain {
        Gain { coefficient: self.coefficient(), std: self.std(), gain: self.gain }
    }

    /// Gain less what its fitted inner parameters would gain by chance, ½ ln N each (Schwarz 1978).
    pub fn merit(&self) -> f64 {
        let inner = Variant { term: self.term, spacing: 1.0 }.fitted();
        self.gain - 0.5 * inner as f64 * self.fit.measurements.max(1.0).ln()
    }

    /// The candidate's coefficient.
    pub fn coefficient(&self) -> f64 {
        self.fit.coefficients.last().copied().unwrap_or(0.0)
    }

    /// Std of it.
    pub fn std(&self) -> f64 {
        self.fit.std(self.fit.coefficients.len() - 1)
    }

    /// Probability of a gain this large by chance, were the candidate not there and `tried` of them looked at; what its inner
    /// parameters would gain by chance is no gain.
    pub fn p_value(&self, tried: usize) -> f64 {
        (tried as f64 * chance(2.0 * self.merit())).min(1.0)
    }

    /// Whether this one is better than the other beyond what the record can tell.
    pub fn is_clearly_better_than(&self, other: &Trial) -> bool {
        let difference = self.gain - other.gain;
        if other.by_stretch.is_empty() {
            return difference > TIE;
        }
        let parts: Vec<f64> = self.by_stretch.iter().zip(&other.by_stretch).map(|(a, b)| a - b).collect();
        let count = parts.len() as f64;
        let mean = parts.iter().sum::<f64>() / count;
        let scatter = parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>() / (count - 1.0);
        difference > TIE && count * mean > CLEAR * (count * scatter).sqrt()
    }
}

/// The fit with the inner parameters of its last term moved by a Gauss–Newton step each; none where it has none.
fn polished(fit: &Fit, pieces: &[Piece]) -> Option<Fit> {
    let Some(Term::Effect(effect)) = fit.form.terms.last().copied() else { return None };
    let values = effect.inner_values();
    let moving: Vec<usize> = (0..values.len()).filter(|index| is_continuous(effect, *index)).collect();
    let coefficient = fit.coefficients.last().copied().unwrap_or(0.0);
    let at = |index: usize, factor: f64| {
        let mut moved = values.clone();
        moved[index] *= factor;
        effect.with_inner(&moved).ok().map(Term::Effect)
    };
    let slopes = |piece: &Piece, states: &[State]| -> Vec<Vec<f64>> {
        let slope = |index: &usize| {
            let sides = [DIFFERENCE.exp(), (-DIFFERENCE).exp()].map(|factor| at(*index, factor));
            let [Some(above), Some(below)] = sides else { return vec![0.0; piece.len() - 1] };
            let pairs =
                means::means(above, &[], piece, states).into_iter().zip(means::means(below, &[], piece, states));
            pairs.map(|(above, below)| coefficient * (above - below) / (2.0 * DIFFERENCE)).collect()
        };
        moving.iter().map(slope).collect()
    };
    let steps = screen::screen_columns(fit, pieces, &slopes);
    let mut moved = values.clone();
    for (index, step) in moving.iter().zip(&steps) {
        moved[*index] *= step.coefficient.clamp(-LARGEST_STEP, LARGEST_STEP).exp();
    }
    let mut form = fit.form.clone();
    *form.terms.last_mut()? = Term::Effect(effect.with_inner(&moved).ok()?);
    if moving.is_empty() { None } else { refit(&form, pieces, &fit.coefficients, fit.noise) }
}

/// Log-likelihood of the fitted law by stretch of the record.
pub(super) fn by_stretch(fit: &Fit, pieces: &[Piece]) -> Vec<f64> {
    screen::sums(fit, pieces, &|_, _| Vec::new()).iter().map(|sums| -0.5 * (sums.energy + sums.log_variance)).collect()
}

/// Probability that χ² with one degree of freedom exceeds x: erfc(√(x/2)).
///
/// The rational approximation of Abramowitz and Stegun 7.1.26 has an absolute error of 1.5e-7, too much for a tail: beyond x = 9 the
/// asymptotic series (7.1.23) takes over.
pub(super) fn chance(x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let z = (0.5 * x).sqrt();
    let tail = (-z * z).exp();
    if x > 9.0 {
        let w = (2.0 * z * z).recip();
        return tail / (z * std::f64::consts::PI.sqrt()) * (1.0 - w * (1.0 - 3.0 * w * (1.0 - 5.0 * w)));
    }
    let t = (1.0 + 0.327_591_1 * z).recip();
    let series = [1.061_405_429, -1.453_152_027, 1.421_413_741, -0.284_496_736, 0.254_829_592];
    tail * t * series.iter().fold(0.0, |sum, coefficient| sum * t + coefficient)
}

#[cfg(test)]
mod tests {
    use super::chance;

    #[test]
    fn chance_is_that_of_tables() {
        for (x, p) in [(0.455, 0.5), (2.706, 0.1), (3.841, 0.05), (6.635, 0.01), (10.828, 0.001), (15.137, 1e-4)] {
            assert!((chance(x) / p - 1.0).abs() < 5e-3, "{x}: {}", chance(x));
        }
    }
}
