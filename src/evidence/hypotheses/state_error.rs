//! The state that a hypothesis starts from, as the law in use has it: off by what that law errs.
//!
//! Until the start the law in use erred by δ₀ in its coefficients, which leaves the state off by Sδ₀, S being the run's
//! sensitivity there. With η the response of the innovations to the state at the start, and ψ that to coefficients
//! from the start on, "no switch" is ε = (ψ + ηS)δ₀ + white: the error acts on. Where the motion is unstable for a
//! while, or the filter remembers long, ηS is the larger part.

use crate::estimation::{Information, Lane, Matrix, WIDTH};
use serde::{Deserialize, Serialize};

/// What an interval and its measurements do to a state, whatever its coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Passage {
    /// The state after them by that before.
    pub(super) state: Matrix<2>,
    /// What is expected to be measured, by channel, by the state before.
    pub(super) rows: Matrix<2>,
}

/// What the innovations since the start say of the state there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct StateError {
    /// S, of q and q̇, each n long and filled up with zeros.
    of_law: [Vec<Lane>; 2],
    /// The state now by that at the start, its columns.
    response: [[f64; 2]; 2],
    /// Σ ηψᵀ/s, of q and q̇ at the start, as `of_law`.
    crossed: [Vec<Lane>; 2],
    /// Σ ηηᵀ/s.
    squares: Matrix<2>,
    /// Σ ηε/s.
    score: [f64; 2],
}

impl StateError {
    /// Room for `n` coefficients.
    pub(super) fn none(n: usize) -> StateError {
        let lanes = || vec![[0.0; WIDTH]; n.div_ceil(WIDTH)];
        StateError {
            of_law: [lanes(), lanes()],
            response: [[0.0; 2]; 2],
            crossed: [lanes(), lanes()],
            squares: [[0.0; 2]; 2],
            score: [0.0; 2],
        }
    }

    /// Starts where the law in use has this sensitivity of (q, q̇), n.
    pub(super) fn begin(&mut self, sensitivity: &[[f64; 2]]) {
        for (component, slots) in self.of_law.iter_mut().enumerate() {
            let slots = slots.as_flattened_mut().iter_mut();
            slots.zip(sensitivity).for_each(|(slot, sensitivity)| *slot = sensitivity[component]);
        }
        self.crossed.iter_mut().for_each(|sums| sums.fill([0.0; WIDTH]));
        (self.response, self.squares, self.score) = ([[1.0, 0.0], [0.0, 1.0]], [[0.0; 2]; 2], [0.0; 2]);
    }

    /// Takes a sample whose measurements have these rows of ψ, residuals, and 1 ÷ variances.
    #[inline]
    pub(super) fn step(&mut self, passage: &Passage, rows: &[Vec<Lane>; 2], residuals: [f64; 2], weights: [f64; 2]) {
        let applied = |matrix: &Matrix<2>, [q, qd]: [f64; 2]| matrix.map(|row| row[0] * q + row[1] * qd);
        let seen = self.response.map(|column| applied(&passage.rows, column));
        self.response = self.response.map(|column| applied(&passage.state, column));
        let [q_row, qd_row] = rows;
        for (component, [q, qd]) in seen.into_iter().enumerate() {
            let (q, qd) = (q * weights[0], qd * weights[1]);
            self.score[component] += q * residuals[0] + qd * residuals[1];
            self.squares[component] =
                [0, 1].map(|other| self.squares[component][other] + q * seen[other][0] + qd * seen[other][1]);
            let rows = q_row.iter().zip(qd_row);
            for (sums, (q_row, qd_row)) in self.crossed[component].iter_mut().zip(rows) {
                *sums = std::array::from_fn(|lane| sums[lane] + q * q_row[lane] + qd * qd_row[lane]);
            }
        }
    }

    /// Σ ψ(ψ + ηS)ᵀ/s: entry of the coefficient that changes and of the one that errs, `since` being Σ ψψᵀ/s.
    pub(super) fn shared(&self, since: &Information, changed: usize, erring: usize) -> f64 {
        let [q, qd] = self.at(changed, erring);
        since.entry(changed, erring) + q + qd
    }

    /// Information and score of an error that acts on, `since` being those of one that acts from the start on.
    pub(super) fn of_unbroken(&self, since: &Information, whole: &mut Information) {
        let n = since.n;
        for row in 0..n {
            let from = [0, 1].map(|component| self.of_law[component].as_flattened()[row]);
            let pulled =
                [0, 1].map(|component| from[0] * self.squares[0][component] + from[1] * self.squares[1][component]);
            for column in row..n {
                let to = [0, 1].map(|component| self.of_law[component].as_flattened()[column]);
                let [q, qd] = self.at(column, row);
                let crossed = self.shared(since, row, column) + q + qd;
                whole.matrix[row * n + column] = crossed + pulled[0] * to[0] + pulled[1] * to[1];
            }
            whole.score[row] = since.score[row] + from[0] * self.score[0] + from[1] * self.score[1];
        }
    }

    /// The coefficients in use have become those plus `step`, in the past too; `since` are the sums of ψ.
    pub(super) fn shift(&mut self, step: &[f64], since: &mut Information) {
        let dot = |row: &[Lane]| -> f64 { row.as_flattened().iter().zip(step).map(|(entry, step)| entry * step).sum() };
        let moved = self.of_law.each_ref().map(|row| dot(row));
        let crossed = self.crossed.each_ref().map(|row| dot(row));
        since.shift(step);
        for (index, score) in since.score.iter_mut().enumerate() {
            *score -=
                (0..2).map(|component| moved[component] * self.crossed[component].as_flattened()[index]).sum::<f64>();
        }
        for (component, score) in self.score.iter_mut().enumerate() {
            let [q, qd] = self.squares[component];
            *score -= crossed[component] + q * moved[0] + qd * moved[1];
        }
    }

    /// The two products in an entry of CᵀS, C being Σ ηψᵀ/s.
    fn at(&self, changed: usize, erring: usize) -> [f64; 2] {
        [0, 1].map(|component| {
            self.crossed[component].as_flattened()[changed] * self.of_law[component].as_flattened()[erring]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::{Innovation, IntervalMap};
    use crate::evidence::hypotheses::{Bank, Law};

    const SAMPLES: u64 = 300;

    /// An unstable motion under a law whose one coefficient errs by `error`, without noise and with std 0.1 stated;
    /// from half way on that coefficient hardly acts. What a run of the filter is told from there on, and the
    /// hypothesis of a switch there.
    fn halfway(error: f64) -> (Information, Bank) {
        let (mut run, mut bank) = (Information::none(1), Bank::new(1, 4));
        bank.set_spread(&[30.0]);
        let transition = [[1.0, 0.02], [0.02, 1.0]];
        let (mut sensitivity, mut state) = ([0.0; 2], [0.0; 2]);
        for number in 1..=SAMPLES {
            let push = if number > SAMPLES / 2 { 1e-4 } else { 0.02 };
            let carried = |[q, qd]: [f64; 2], push: f64| [q + 0.02 * qd, 0.02 * q + qd + push];
            (sensitivity, state) = (carried(sensitivity, push), carried(state, error * push));
            let said = Innovation { residual: state[0], variance: 0.01, precision: 100.0, gain: [0.05, 0.05] };
            run.add(&[sensitivity[0]], said.residual, said.variance);
            let map = IntervalMap { transition, input: vec![[0.0, push]], push: [0.0; 2] };
            bank.step(&map, &[Some(said), None]);
            for carried in [&mut sensitivity, &mut state] {
                let seen = carried[0];
                carried.iter_mut().zip(said.gain).for_each(|(entry, gain)| *entry -= gain * seen);
            }
            if number == SAMPLES / 2 {
                let sensitivity = &[sensitivity];
                bank.spawn(
                    number,
                    &Law { information: &run, sensitivity, open: &[true], own: &[true], explains: true },
                );
                run.clear();
            }
        }
        (run, bank)
    }

    #[test]
    fn an_error_that_acts_on_is_told_as_by_the_run_itself() {
        let (run, bank) = halfway(0.3);
        let (hypothesis, mut whole) = (&bank.hypotheses[0], Information::none(1));
        hypothesis.state.of_unbroken(&hypothesis.information, &mut whole);
        assert!((whole.matrix[0] / run.matrix[0] - 1.0).abs() < 1e-9, "{} {}", whole.matrix[0], run.matrix[0]);
        assert!((whole.score[0] / run.score[0] - 1.0).abs() < 1e-9, "{} {}", whole.score[0], run.score[0]);
        let part = hypothesis.information.matrix[0] / run.matrix[0];
        assert!((part - 1.0).abs() > 0.1, "the error of before does not matter: {part}");
    }

    /// Without the state's part it would speak for one with 18 nats.
    #[test]
    fn an_error_of_the_law_is_no_switch() {
        let (_, mut bank) = halfway(0.3);
        bank.look_at_all();
        let evidence = bank.suspect().unwrap().evidence;
        assert!(evidence < 0.0, "{evidence}");
    }

    #[test]
    fn with_the_error_taken_off_nothing_is_left_to_explain() {
        let (_, mut bank) = halfway(0.3);
        bank.shift(&[0.3]);
        let hypothesis = &bank.hypotheses[0];
        let scores = [hypothesis.information.score[0], hypothesis.state.score[0], hypothesis.state.score[1]];
        assert!(scores.iter().all(|score| score.abs() < 1e-9), "{scores:?}");
    }
}
