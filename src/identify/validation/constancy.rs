//! Estimates of one law in a growing record: what the longer record says lies within the std of what the shorter one
//! said.
//!
//! For an efficient estimate Cov(θ_new − θ_old) = Cov(θ_old) − Cov(θ_new) (Hausman, *Econometrica* 46 (1978), 1251). A
//! record that comes to hold another law too may still be explained whole, by a third one, which goes from one to the
//! other a little at a time: the estimate is compared with those of records down to a third as long.

use serde::{Deserialize, Serialize};

/// Stds by which no coefficient of the same law moves: by chance one in 370 does.
const FAR: f64 = 3.0;

/// Least variance of a difference, in terms of that of the shorter record's estimate: what the two share is known
/// roughly, and Hausman's difference of variances may be rounding.
const LEAST: f64 = 0.1;

/// Estimates are kept whose records differ in length by this factor …
const APART: f64 = 1.25;

/// … so many of them: five steps of a quarter reach down to a third of the record (docs/decisions/validation.md).
const KEPT: usize = 5;

/// Estimates of late, and whether they contradict each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Constancy {
    /// The latest first.
    kept: Vec<Estimate>,
    count: usize,
    /// Whether the latest estimate has left one that is kept.
    pub broken: bool,
}

/// Coefficients as a record of some length told them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Estimate {
    length: u64,
    values: Vec<f64>,
    /// Infinite where it was not known.
    std: Vec<f64>,
}

impl Constancy {
    /// Room for the estimates of `n` coefficients.
    pub fn new(n: usize) -> Constancy {
        let estimate = Estimate { length: 0, values: vec![0.0; n], std: vec![f64::INFINITY; n] };
        Constancy { kept: vec![estimate; KEPT], count: 0, broken: false }
    }

    /// Forgets all estimates.
    pub fn clear(&mut self) {
        (self.count, self.broken) = (0, false);
    }

    /// Takes the estimate of a record of this length: value and std of each coefficient.
    pub fn take(&mut self, length: u64, estimate: impl Fn(usize) -> (f64, f64)) {
        self.broken = self.kept[..self.count].iter().any(|old| old.is_left(&estimate));
        if self.count == 0 || length as f64 >= APART * self.kept[0].length as f64 {
            self.kept.rotate_right(1);
            self.count = (self.count + 1).min(KEPT);
            let latest = &mut self.kept[0];
            latest.length = length;
            for (free, (value, std)) in latest.values.iter_mut().zip(&mut latest.std).enumerate() {
                (*value, *std) = estimate(free);
            }
        }
    }
}

impl Estimate {
    fn is_left(&self, estimate: &impl Fn(usize) -> (f64, f64)) -> bool {
        let mut known = self.values.iter().zip(&self.std).enumerate().filter(|(_, (_, std))| std.is_finite());
        known.any(|(free, (old, old_std))| {
            let (value, std) = estimate(free);
            let variance = (old_std * old_std - std * std).max(LEAST * old_std * old_std);
            std.is_finite() && (value - old).powi(2) > FAR * FAR * variance
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn broken(estimates: &[(u64, f64, f64)]) -> bool {
        let mut constancy = Constancy::new(1);
        estimates.iter().for_each(|(length, value, std)| constancy.take(*length, |_| (*value, *std)));
        constancy.broken
    }

    #[test]
    fn what_leaves_its_own_std_is_contradicted() {
        assert!(!broken(&[(100, 50.0, f64::INFINITY), (200, 3.0, 0.1), (300, 3.2, 0.05)]));
        assert!(broken(&[(200, 3.0, 0.1), (300, 3.4, 0.05)]));
    }

    #[test]
    fn a_term_that_is_dropped_contradicts_nothing() {
        assert!(!broken(&[(200, 0.2, 0.1), (300, 0.0, f64::INFINITY)]));
    }

    #[test]
    fn another_stage_is_compared_with_nothing_before() {
        let mut constancy = Constancy::new(1);
        [3.0, 4.0].iter().zip([200, 300]).for_each(|(value, length)| constancy.take(length, |_| (*value, 0.1)));
        assert!(constancy.broken);
        constancy.clear();
        constancy.take(100, |_| (9.0, 0.1));
        assert!(!constancy.broken);
    }

    #[test]
    fn what_leaves_it_little_by_little_is_too() {
        assert!(broken(&[(200, 3.0, 0.1), (260, 3.12, 0.07), (340, 3.22, 0.05), (430, 3.31, 0.03)]));
    }

    #[test]
    fn what_was_contradicted_long_ago_is_forgotten() {
        let later = (0..8).map(|k| (400.0 * 1.3_f64.powi(k), 4.0)).map(|(length, value)| (length as u64, value, 0.05));
        let estimates: Vec<_> = [(200, 3.0, 0.1), (260, 4.0, 0.1)].into_iter().chain(later).collect();
        assert!(broken(&estimates[..3]) && !broken(&estimates));
    }
}
