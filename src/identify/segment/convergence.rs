//! How much more of such a record a law needs before its coefficients are known.
//!
//! The information of a record grows about linearly with its length, at first faster. Over its recent half, from T/2 to
//! T, the variance that the record alone leaves fell by some power p of the length; the variance v with all that is
//! known is taken to fall by one that is a third of the way to 1:
//!
//! ```text
//! v(T′) = v(T) (T ÷ T′)^((2p + 1) ÷ 3),   p = ln(u(T/2) ÷ u(T)) ÷ ln 2,   u of the record alone
//! ```
//!
//! A coefficient is known when its variance is one n-th of what e of eq. (8) allows, or the law is; a law when e is,
//! and it has moved by no more while its record grew by a tenth.

use crate::estimation::{Information, Solution};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Powers of the record's length by which variances fall: half of what an information of constant rate gives, up to
/// where a few more samples finish it.
const POWERS: RangeInclusive<f64> = 0.5..=8.0;

/// Trials that are looked ahead: 40 records longer by a tenth each are one 45 times as long.
const TRIALS: i32 = 40;

/// How much longer the record has to get, coefficient by coefficient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Convergence {
    /// Information at half the record.
    half: Information,
    /// What it and the whole record leave open.
    solutions: [Solution; 2],
    /// Number of the sample there.
    at: u64,
    /// Lengths at which each coefficient is known, in those of the record; 1 where it is, infinite where nothing can be
    /// said.
    factors: Vec<f64>,
}

/// A record whose pass is closed.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Number of its first sample and of the last.
    pub range: [u64; 2],
    /// What it says.
    pub information: &'a Information,
    /// Which coefficients the law has.
    pub active: &'a [bool],
    /// Their covariance now.
    pub solution: &'a Solution,
    /// Sum of their variances that makes the law known.
    pub allowed: f64,
    /// Samples from which on the law is on trial; none where it has stood.
    pub trial: Option<u64>,
    /// By which factor the record grows in a trial.
    pub growth: f64,
}

impl Convergence {
    /// Room for `n` coefficients, of which nothing can be said.
    pub fn new(n: usize) -> Convergence {
        Convergence {
            half: Information::none(n),
            solutions: [(); 2].map(|()| Solution::none(n)),
            at: 0,
            factors: vec![f64::INFINITY; n],
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.factors.fill(f64::INFINITY);
    }

    /// A pass over a record of `length` samples from `start` begins.
    pub fn begin(&mut self, start: u64, length: u64) {
        self.at = start + (length / 2).max(2);
    }

    /// Takes the pass's information up to sample `next`.
    #[inline]
    pub fn step(&mut self, next: u64, information: &Information) {
        if next == self.at {
            self.half.clone_from_slices(information);
        }
    }

    /// The pass is closed.
    pub fn renew(&mut self, record: &Record) {
        let [half, whole] = &mut self.solutions;
        half.solve(&self.half, record.active);
        whole.solve(record.information, record.active);
        let [start, end] = record.range;
        let growth = (end - start) as f64 / (self.at - start) as f64;
        let active = || (0..record.active.len()).filter(|index| record.active[*index]);
        let sum = |solution: &Solution| active().map(|index| variance(solution, index)).sum::<f64>();
        let power = |[before, now]: [f64; 2]| (before / now).ln() / growth.ln();
        let law = Fall { now: sum(record.solution), power: power([sum(half), sum(whole)]) };
        let trial = record.trial.map(|from| (from - start).max(1) as f64 / (end - start) as f64);
        let known = |fall: Fall, allowed: f64| match trial {
            Some(trial) => fall.length_after_trial(allowed, trial, record.growth),
            None => fall.length(allowed),
        };
        let law = known(law, record.allowed);
        let share = record.allowed / active().count().max(1) as f64;
        for (index, factor) in self.factors.iter_mut().enumerate() {
            let power = power([variance(half, index), variance(whole, index)]);
            let alone = Fall { now: variance(record.solution, index), power };
            *factor = if record.active[index] { known(alone, share).min(law) } else { 1.0 };
        }
    }

    /// By which factor the record has to grow until the coefficient is known; infinite where nothing can be said.
    pub fn factor(&self, index: usize) -> f64 {
        self.factors[index]
    }
}

fn variance(solution: &Solution, index: usize) -> f64 {
    if solution.determined[index] { solution.variance(index) } else { f64::INFINITY }
}

/// A variance, and by which power of the record's length it falls.
struct Fall {
    now: f64,
    power: f64,
}

impl Fall {
    /// Length, in those of the record, at which it is `allowed`.
    fn length(&self, allowed: f64) -> f64 {
        match self.now <= allowed {
            true => 1.0,
            false if self.is_known() => (self.now / allowed).powf(self.bounded().recip()),
            false => f64::INFINITY,
        }
    }

    /// The same where it has to have fallen by no more than `allowed` since the trial began; trials follow each other
    /// from the length `trial` on.
    fn length_after_trial(&self, allowed: f64, trial: f64, growth: f64) -> f64 {
        if !self.is_known() {
            return f64::INFINITY;
        }
        let at = |length: f64| self.now * length.powf(-self.bounded());
        let ends = (1..TRIALS).map(|number| trial * growth.powi(number));
        let stands = |end: &f64| *end >= 1.0 && at(*end).max(at(end / growth) - at(*end)) <= allowed;
        ends.into_iter().find(stands).unwrap_or(f64::INFINITY)
    }

    fn is_known(&self) -> bool {
        self.now.is_finite() && self.power > *POWERS.start()
    }

    /// The power from now on: a third of the way to that of a record that is long.
    fn bounded(&self) -> f64 {
        ((2.0 * self.power + 1.0) / 3.0).min(*POWERS.end())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forecast(count: usize, allowed: f64) -> f64 {
        let mut forecast = Convergence::new(2);
        let mut information = Information::none(2);
        forecast.begin(0, count as u64);
        for k in 0..count {
            information.add(&[1.0, (0.7 * k as f64).sin()], 0.0, 1.0);
            forecast.step(k as u64 + 1, &information);
        }
        let mut solution = Solution::none(2);
        solution.solve(&information, &[true, true]);
        let range = [0, count as u64];
        let (active, solution) = (&[true, true], &solution);
        forecast.renew(&Record {
            range,
            information: &information,
            active,
            solution,
            allowed,
            trial: None,
            growth: 1.25,
        });
        count as f64 * forecast.factor(0)
    }

    #[test]
    fn the_length_that_is_foretold_suffices_and_is_not_far_off() {
        let foretold = forecast(400, 2e-3);
        assert!((400.0..40_000.0).contains(&foretold), "{foretold}");
        let later = |count: usize| forecast(count, 2e-3) <= count as f64;
        assert!(!later((0.7 * foretold) as usize) && later((1.4 * foretold) as usize), "{foretold}");
    }
}
