//! Which of the "maybe" terms a law has.
//!
//! At the maximum of the likelihood, dropping a term of coefficient θ_j with variance v_j costs θ_j²/v_j in twice the
//! log-likelihood. The cheapest term goes while that is below its price, 2 ln N for N scalar measurements; the rest is
//! solved anew. That is greedy: a term that goes first may leave several that stand in for it, so that each one that
//! went is kept in turn and the likeliest of all these structures is taken. After a switch the old structure is the
//! likelier one: a term that the old law had is cheaper by [`PRIOR_LOG_ODDS`], one that it had not dearer. Where the
//! information is too near to singular for that, the search starts from the terms of the law as it is, and adds before
//! it drops.

use super::information::{Information, Solution};
use serde::{Deserialize, Serialize};

/// Prior log-odds of a term that the law before had, in twice nats: a switch that changes the structure is one in e¹⁰
/// for each term (docs/decisions/structure.md).
const PRIOR_LOG_ODDS: f64 = 20.0;

/// Smallest share of its own that a term must have beside the others, for the information to be trusted with all of
/// them: a thousand times what rounding leaves of a pivot.
const CLEAR: f64 = 1e-9;

/// Structures that differ by less than this in twice nats are as likely: where two terms have done the same so far,
/// rounding would choose between them anew at every run.
const ALIKE: f64 = 1.0;

/// The terms of the law as it was, once there was one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Present(Vec<bool>);

impl Present {
    /// Takes the flags; returns whether they are a choice at all.
    fn clone_from_flags(&mut self, active: &[bool]) -> bool {
        self.0.copy_from_slice(active);
        !active.iter().all(|active| *active)
    }
}

/// Room for the elimination.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TermSelection {
    information: Information,
    values: Vec<f64>,
    /// What the price of each term adds to 2 ln N.
    surcharge: Vec<f64>,
    present: Present,
    /// Relative error of eq. (8) that the last solution with all terms states, and what it has of the dropped ones.
    pub full_error: f64,
    /// What the law that was selected adds to twice the log-likelihood, less what its terms cost.
    pub worth: f64,
    /// That solution's values.
    full: Vec<f64>,
    /// What elimination leaves, the likeliest structure so far, and room for the step to the values of one.
    greedy: Vec<bool>,
    best: Vec<bool>,
    step: Vec<f64>,
}

/// What is selected from.
#[derive(Clone, Copy, Debug)]
struct Record<'a> {
    /// About `from`.
    information: &'a Information,
    from: &'a [f64],
    /// Which terms may go.
    maybe: &'a [bool],
    /// Twice the log-likelihood that a term must add.
    price: f64,
}

impl TermSelection {
    /// Room for `n` coefficients.
    pub fn new(n: usize) -> TermSelection {
        TermSelection {
            information: Information::none(n),
            values: vec![0.0; n],
            surcharge: vec![0.0; n],
            present: Present(vec![true; n]),
            full_error: f64::INFINITY,
            worth: 0.0,
            full: vec![0.0; n],
            greedy: vec![true; n],
            best: vec![true; n],
            step: vec![0.0; n],
        }
    }

    /// Nothing is known of the structure.
    pub fn forget(&mut self) {
        self.surcharge.fill(0.0);
    }

    /// The structure is likely to be that of a law with these terms.
    pub fn remember(&mut self, active: &[bool]) {
        for (surcharge, active) in self.surcharge.iter_mut().zip(active) {
            *surcharge = if *active { -PRIOR_LOG_ODDS } else { PRIOR_LOG_ODDS };
        }
    }

    /// Eliminates terms. `information` is taken about `coefficients`; `active` says which terms remain, `solution` is
    /// theirs, and `coefficients` become its values, 0 for what was dropped.
    pub fn select(
        &mut self,
        information: &Information,
        maybe: &[bool],
        measurements: f64,
        coefficients: &mut [f64],
        active: &mut [bool],
        solution: &mut Solution,
    ) {
        let record = Record { information, from: coefficients, maybe, price: price_of_a_term(measurements) };
        let present = self.present.clone_from_flags(active);
        active.fill(true);
        self.solve(&record, active, solution);
        self.full_error = stated(&self.values, solution);
        self.full.copy_from_slice(&self.values);
        let clear = solution.smallest_pivot() > CLEAR;
        if !clear && present {
            active.copy_from_slice(&self.present.0);
            self.add_missing(&record, active, solution);
        }
        self.drop_needless(&record, None, active, solution);
        if clear {
            self.keep_in_turn(&record, active, solution);
        }
        // a term may be large and yet too uncertain for its price: without it the law would be another one
        let dropped = self.full.iter().zip(active.iter()).filter(|(_, active)| !**active);
        self.full_error += dropped.map(|(value, _)| value * value).sum::<f64>() / sum_of_squares(&self.full);
        self.worth = self.worth(&record, active);
        coefficients.copy_from_slice(&self.values);
    }

    /// Adds terms one by one while the best of them gains more than its price.
    fn add_missing(&mut self, record: &Record, active: &mut [bool], solution: &mut Solution) {
        for _ in 0..active.len() {
            self.solve(record, active, solution);
            let excess = |index: usize| self.gain(index, active, solution) - self.surcharge[index];
            let candidates = (0..active.len()).filter(|index| !active[*index]);
            let best = candidates.map(|index| (index, excess(index))).max_by(|a, b| a.1.total_cmp(&b.1));
            match best {
                Some((index, excess)) if excess > record.price => active[index] = true,
                _ => break,
            }
        }
    }

    /// Drops terms one by one, but for the one that is `kept`, while the cheapest of them costs less than its price;
    /// leaves the solution of the rest.
    fn drop_needless(&mut self, record: &Record, kept: Option<usize>, active: &mut [bool], solution: &mut Solution) {
        loop {
            self.solve(record, active, solution);
            match self.cheapest(record, kept, active, solution) {
                Some((index, excess)) if excess < record.price => active[index] = false,
                _ => break,
            }
        }
    }

    /// Eliminates once more for each term that has gone, with that one kept; leaves the likeliest structure, that of
    /// the first elimination where others are as likely.
    fn keep_in_turn(&mut self, record: &Record, active: &mut [bool], solution: &mut Solution) {
        self.greedy.copy_from_slice(active);
        self.best.copy_from_slice(active);
        let mut most = self.worth(record, active) + ALIKE;
        for kept in 0..active.len() {
            if self.greedy[kept] {
                continue;
            }
            active.fill(true);
            self.drop_needless(record, Some(kept), active, solution);
            let worth = self.worth(record, active);
            if worth > most {
                most = worth;
                self.best.copy_from_slice(active);
            }
        }
        active.copy_from_slice(&self.best);
        self.solve(record, active, solution);
    }

    /// What the law with these terms and the values of the last solution adds to twice the log-likelihood, less what
    /// its terms cost.
    fn worth(&mut self, record: &Record, active: &[bool]) -> f64 {
        for (step, (value, from)) in self.step.iter_mut().zip(self.values.iter().zip(record.from)) {
            *step = value - from;
        }
        let Record { information, maybe, price, .. } = record;
        let gained: f64 = self.step.iter().zip(&information.score).map(|(step, score)| step * score).sum();
        let paid = (0..active.len()).filter(|index| maybe[*index] && active[*index]);
        let prices: f64 = paid.map(|index| price + self.surcharge[index]).sum();
        2.0 * gained - information.quadratic(&self.step) - prices
    }

    /// What a term that is not active would add to twice the log-likelihood; 0 where rounding hides what it has of its
    /// own.
    fn gain(&self, index: usize, active: &[bool], solution: &Solution) -> f64 {
        let n = active.len();
        let entry = |a: usize, b: usize| self.information.matrix[a.min(b) * n + a.max(b)];
        let others = || (0..n).filter(|other| active[*other]);
        let explained: f64 = others().map(|k| entry(index, k) * solution.step[k]).sum();
        let shared: f64 = others()
            .map(|row| {
                let sum: f64 =
                    others().map(|column| solution.covariance[row * n + column] * entry(index, column)).sum();
                entry(index, row) * sum
            })
            .sum();
        let own = entry(index, index) - shared;
        if own > CLEAR * entry(index, index) { (self.information.score[index] - explained).powi(2) / own } else { 0.0 }
    }

    /// Solves with the terms that are not active at 0.
    fn solve(&mut self, record: &Record, active: &[bool], solution: &mut Solution) {
        let Record { information, from, .. } = *record;
        self.information.clone_from_slices(information);
        for ((value, from), active) in self.values.iter_mut().zip(from).zip(active) {
            *value = if *active { 0.0 } else { -from };
        }
        self.information.shift(&self.values);
        solution.solve(&self.information, active);
        for index in 0..self.values.len() {
            self.values[index] = if active[index] { from[index] + solution.step[index] } else { 0.0 };
        }
    }

    fn cheapest(
        &self,
        record: &Record,
        kept: Option<usize>,
        active: &[bool],
        solution: &Solution,
    ) -> Option<(usize, f64)> {
        let cost = |index: usize| match solution.determined[index] {
            true => self.values[index].powi(2) / solution.variance(index),
            false => 0.0,
        };
        let may_go = |index: &usize| record.maybe[*index] && active[*index] && kept != Some(*index);
        let candidates = (0..active.len()).filter(may_go);
        candidates.map(|index| (index, cost(index) - self.surcharge[index])).min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// What a term must add to twice the log-likelihood of N scalar measurements, 2 ln N: twice Schwarz's price (Annals of
/// Statistics 6 (1978), 461), for the one that is asked about is the cheapest of several.
pub fn price_of_a_term(measurements: f64) -> f64 {
    2.0 * measurements.max(2.0).ln()
}

/// tr Cov ÷ Σθ²; infinite where a coefficient is not determined.
fn stated(values: &[f64], solution: &Solution) -> f64 {
    if !solution.determined.iter().all(|determined| *determined) {
        return f64::INFINITY;
    }
    (0..values.len()).map(|index| solution.variance(index)).sum::<f64>() / sum_of_squares(values)
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_term_that_the_data_do_not_need_goes_and_the_others_are_solved_anew() {
        let mut information = Information::none(3);
        let truth = [2.0, 0.0, -1.0];
        for k in 0..2000 {
            let x = 0.01 * f64::from(k);
            let row = [x.sin(), (x + 0.3).sin(), (1.7 * x).cos()];
            let noise = 0.1 * (f64::from(k) * 12.9898).sin();
            let residual: f64 = row.iter().zip(truth).map(|(a, b)| a * b).sum::<f64>() + noise;
            information.add(&row, residual, 0.005);
        }
        let (mut coefficients, mut active) = ([0.0; 3], [false; 3]);
        let mut solution = Solution::none(3);
        TermSelection::new(3).select(&information, &[true; 3], 2000.0, &mut coefficients, &mut active, &mut solution);
        assert_eq!(active, [true, false, true]);
        assert_eq!(coefficients[1], 0.0);
        assert!((coefficients[0] - 2.0).abs() < 0.02 && (coefficients[2] + 1.0).abs() < 0.02, "{coefficients:?}");
    }

    /// The third term is nearly the sum of the two others, and alone in truth; of its own part the record says 0.3 with
    /// the std 0.35 in place of 1, so that it is the first to go.
    #[test]
    fn a_term_that_two_stand_in_for_is_found() {
        let mut information = Information::none(3);
        information.add(&[1.0, 0.0, 1.0], 1.0, 1e-4);
        information.add(&[0.0, 1.0, 1.0], 1.0, 1e-4);
        information.add(&[0.0, 0.0, 0.1], 0.03, 0.035 * 0.035);
        let (mut coefficients, mut active, mut solution) = ([0.0; 3], [false; 3], Solution::none(3));
        TermSelection::new(3).select(&information, &[true; 3], 200.0, &mut coefficients, &mut active, &mut solution);
        assert_eq!(active, [false, false, true]);
        assert!((coefficients[2] - 1.0).abs() < 0.01 && solution.determined == [false, false, true]);
    }

    /// Two coefficients about 0, both 0.3 in truth and known to 0.1 and to 0.01: the first is dropped.
    #[test]
    fn a_dropped_term_that_may_be_large_leaves_the_law_open() {
        let mut information = Information::none(2);
        information.add(&[1.0, 0.0], 0.3, 0.01);
        information.add(&[0.0, 1.0], 0.3, 0.0001);
        let mut selection = TermSelection::new(2);
        let (mut coefficients, mut active, mut solution) = ([0.0; 2], [false; 2], Solution::none(2));
        selection.select(&information, &[true; 2], 200.0, &mut coefficients, &mut active, &mut solution);
        assert_eq!(active, [false, true]);
        let expected = 0.01 / 0.18 + 0.0001 / 0.18 + 0.5;
        assert!((selection.full_error - expected).abs() < 1e-9, "{}", selection.full_error);
    }
}
