//! Candidates that the screen found, each in the law: refitted, and compared by likelihood.
//!
//! A candidate joins the law, all coefficients and the noise are fitted anew, and the log-likelihood gained is its evidence: twice that
//! gain is χ² distributed where it is not there (Wilks 1938), the level being shared among all that were tried (Bonferroni). Two that
//! gain the same cannot be told apart on this record: the difference must exceed [`TIE`] nats, and where error of the law is left by a
//! multiple of the scatter with which it comes from one stretch of the record to the next (Vuong 1989).

use super::cooling::cooled;
use super::diagnosis::is_evident;
use super::fit::{Fit, refit};
use super::piece::Piece;
use super::proposal::Proposal;
use super::sound::is_physical;
use crate::law::{Catalogue, Term};

/// Difference of log-likelihood, nats, below which two candidates are equally good.
const TIE: f64 = 3.0;

/// Standard errors by which one candidate must be better than another, stretch by stretch.
const CLEAR: f64 = 2.0;

/// Gain, nats, that an effect must have over one that it contains to be another.
const SAME: f64 = 0.5;

/// Smallest part of the law's process noise with which a fit begins that ought to explain it.
const LEAST_LEFT: f64 = 1e-3;

/// Candidates in the law.
#[derive(Clone, Debug)]
pub struct Trial {
    /// How many they are; they are the last terms of the fitted form.
    pub count: usize,
    /// The law with them, fitted, their inner parameters too.
    pub fit: Fit,
    /// Log-likelihood gained.
    pub gain: f64,
}

impl Trial {
    /// Fits the law of `base` with the candidates in it.
    pub fn of(base: &Fit, pieces: &[Piece], proposal: &Proposal) -> Option<Trial> {
        let form = proposal.variants.iter().fold(base.form.clone(), |form, variant| form.with(variant.term));
        let mut noise = base.noise;
        noise.process *= proposal.left.max(LEAST_LEFT);
        let fit = refit(&form, pieces, &proposal.coefficients, noise)?;
        Some(Trial { count: proposal.variants.len(), gain: fit.log_likelihood - base.log_likelihood, fit })
    }

    /// The candidates, inner parameters fitted.
    pub fn terms(&self) -> &[Term] {
        &self.fit.form.terms[self.fit.form.terms.len() - self.count..]
    }

    /// The first candidate.
    pub fn term(&self) -> Term {
        self.terms()[0]
    }

    /// The same candidates in the law of `base` on its record, of which this one has seen a part.
    pub fn on(&self, base: &Fit, pieces: &[Piece]) -> Option<Trial> {
        let fit = refit(&self.fit.form, pieces, &self.fit.coefficients, self.fit.noise)?;
        Some(Trial { count: self.count, gain: fit.log_likelihood - base.log_likelihood, fit })
    }

    /// The same fitted on a gentler way, where that leads further.
    pub fn cooled(self, base: &Fit, pieces: &[Piece]) -> Trial {
        match cooled(&self.fit, pieces) {
            Some(fit) => Trial { count: self.count, gain: fit.log_likelihood - base.log_likelihood, fit },
            None => self,
        }
    }

    /// The law of `base` where its candidates have led it, without them: none where it was as good before. What it gains there is not theirs.
    pub fn same_without(&self, base: &Fit, pieces: &[Piece]) -> Option<Fit> {
        let own = base.coefficients.len();
        let fits = [&base.coefficients[..], &self.fit.coefficients[..own]];
        let fits = fits.into_iter().filter_map(|coefficients| refit(&base.form, pieces, coefficients, self.fit.noise));
        let best = fits.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood));
        best.filter(|fit| fit.log_likelihood > base.log_likelihood + TIE)
    }

    /// Whether this is one effect that contains the other's and gains no more: the other, at the end of this one's inner parameters.
    pub fn is_at_the_end_of(&self, simpler: &Trial) -> bool {
        let name = |trial: &Trial| trial.fit.form.effect_name(trial.term());
        let alone = self.count == 1 && simpler.count == 1;
        alone && Catalogue::is_contained(&name(simpler), &name(self)) && self.gain < simpler.gain + SAME
    }

    /// Whether physics allows the signs of its candidates.
    pub fn is_physical(&self) -> bool {
        let count = self.fit.form.terms.len();
        (count - self.count..count).all(|index| is_physical(&self.fit, index))
    }

    /// Number of inner parameters that were fitted.
    pub fn inner_count(&self) -> usize {
        self.terms().iter().filter_map(|term| term.effect()).map(|effect| effect.inner().len()).sum()
    }

    /// Gain less what its fitted inner parameters would gain by chance.
    pub fn merit(&self) -> f64 {
        merit(self.gain, self.inner_count(), self.fit.measurements)
    }

    /// The first candidate's coefficient.
    pub fn coefficient(&self) -> f64 {
        self.fit.coefficients.get(self.first()).copied().unwrap_or(0.0)
    }

    /// Std of it.
    pub fn std(&self) -> f64 {
        self.fit.std(self.first())
    }

    fn first(&self) -> usize {
        self.fit.coefficients.len() - self.count
    }

    /// Probability of a gain this large by chance, were the candidates not there and `tried` of them looked at.
    pub fn p_value(&self, tried: usize) -> f64 {
        p_value(self.gain, self.inner_count(), self.fit.measurements, tried)
    }

    /// Whether this one is better than the other beyond what the record can tell. Where it explains the record its likelihood can be
    /// trusted; where it does not, errors of the law may decide, which come and go along the record.
    pub fn is_clearly_better_than(&self, other: &Trial) -> bool {
        let difference = self.merit() - other.merit();
        if !is_evident(&self.fit) {
            return difference > TIE;
        }
        let pairs = self.fit.by_stretch.iter().zip(&other.fit.by_stretch);
        let parts: Vec<f64> = pairs.map(|(own, other)| own.log_likelihood() - other.log_likelihood()).collect();
        let count = parts.len() as f64;
        let mean = parts.iter().sum::<f64>() / count;
        let scatter = parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>() / (count - 1.0);
        difference > TIE && count * mean > CLEAR * (count * scatter).sqrt()
    }
}

/// Gain less what fitted inner parameters would gain by chance, ½ ln N each (Schwarz 1978).
pub(super) fn merit(gain: f64, inner: usize, measurements: f64) -> f64 {
    gain - 0.5 * inner as f64 * measurements.max(1.0).ln()
}

/// Probability of a gain this large by chance, `tried` candidates having been looked at.
pub(super) fn p_value(gain: f64, inner: usize, measurements: f64, tried: usize) -> f64 {
    (tried as f64 * chance(2.0 * merit(gain, inner, measurements))).min(1.0)
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
