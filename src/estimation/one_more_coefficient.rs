//! What a run of the filter says of one more coefficient than its law has, beside the law's own.

use super::filter::{Channel, Innovation};
use super::information::{Information, Solution};
use super::pass::Pass;
use serde::{Deserialize, Serialize};

/// Share of a candidate's information that must be its own: of less, rounding (1e-12 of the whole) is more than a
/// millionth.
const OWN: f64 = 1e-6;

/// What a run says of the law's own terms, and of an effect added to them, which comes last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OwnTerms {
    pub(super) information: Information,
    pub(super) solution: Solution,
    pub(super) active: Vec<bool>,
}

/// What the innovations say of one more coefficient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Sums {
    /// ∂(q, q̇)/∂ its coefficient.
    pub(super) sensitivity: [f64; 2],
    pub(super) information: f64,
    pub(super) score: f64,
    /// With each free term of the law, and with the effect added to them.
    pub(super) cross: Vec<f64>,
}

impl OwnTerms {
    /// Of `n` free terms of which nothing is known.
    pub fn none(n: usize) -> OwnTerms {
        let all = n + 1;
        OwnTerms { information: Information::none(all), solution: Solution::none(all), active: vec![true; all] }
    }

    /// Forgets what a run said: what is made anew at every question takes no room in a saved state.
    pub fn clear(&mut self) {
        self.information.clear();
        self.solution.solve(&self.information, &self.active);
    }

    /// As a run says it of those that are active, and of the effect beside them that the law may have.
    pub(super) fn solve_beside(&mut self, own: &Information, active: &[bool], effect: Option<&Sums>) {
        let OwnTerms { information, solution, active: all } = self;
        own.widen(information);
        all[..own.n].copy_from_slice(active);
        all[own.n] = effect.is_some();
        if let Some(sums) = effect {
            information.tell_last(&sums.cross, sums.information, sums.score);
        }
        solution.solve(information, all);
    }

    /// Log-likelihood that the law's own terms gain at the maximum, nats.
    pub(super) fn gain(&self) -> f64 {
        0.5 * self.determined().map(|row| self.solution.step[row] * self.information.score[row]).sum::<f64>()
    }

    /// The terms that the law has and its record determines.
    pub(super) fn determined(&self) -> impl Iterator<Item = usize> {
        (0..self.active.len()).filter(|row| self.is_told(*row))
    }

    fn is_told(&self, row: usize) -> bool {
        self.active[row] && self.solution.determined[row]
    }

    /// By how much the coefficient is another one at the maximum.
    pub(super) fn step(&self, row: usize) -> f64 {
        if self.is_told(row) { self.solution.step[row] } else { 0.0 }
    }
}

impl Sums {
    pub(super) fn new(n: usize) -> Sums {
        Sums { sensitivity: [0.0; 2], information: 0.0, score: 0.0, cross: vec![0.0; n + 1] }
    }

    pub(super) fn clear(&mut self) {
        (self.sensitivity, self.information, self.score) = ([0.0; 2], 0.0, 0.0);
        self.cross.fill(0.0);
    }

    /// Copies the other's into this room.
    pub(super) fn copy_from(&mut self, other: &Sums) {
        (self.sensitivity, self.information, self.score) = (other.sensitivity, other.information, other.score);
        self.cross.copy_from_slice(&other.cross);
    }

    /// The law's own coefficients have become those plus `step`.
    pub(super) fn shift(&mut self, step: &[f64]) {
        let moved: f64 = self.cross.iter().zip(step).map(|(cross, step)| cross * step).sum();
        self.score -= moved;
    }

    /// The coefficient of the effect added to the law has become that plus `step`.
    pub(super) fn shift_beside(&mut self, step: f64) {
        self.score -= self.cross[self.cross.len() - 1] * step;
    }

    /// Goes with the run over an interval in which a coefficient of 1 accelerates by `push`, and takes the innovations
    /// of the sample at its end; `beside` is what the effect added to the law makes of them. Returns the same of this
    /// coefficient.
    pub(super) fn take(
        &mut self,
        pass: &Pass,
        push: f64,
        gains: &[[f64; 2]; 2],
        innovations: &[Option<Innovation>; 2],
        beside: [f64; 2],
    ) -> [f64; 2] {
        let (rows, moved) = pass.carry(self.sensitivity, push, gains);
        self.sensitivity = moved;
        let [precision, residual] = [
            innovations.map(|innovation| innovation.map_or(0.0, |innovation| innovation.precision)),
            innovations.map(|innovation| innovation.map_or(0.0, |innovation| innovation.residual)),
        ];
        let [q, qd] = [0, 1].map(|channel| rows[channel] * precision[channel]);
        self.information += q * rows[0] + qd * rows[1];
        self.score += q * residual[0] + qd * residual[1];
        let own = pass.expected(Channel::Q).iter().zip(pass.expected(Channel::Qd));
        let own = own.map(|(q, qd)| [*q, *qd]).chain([beside]);
        self.cross.iter_mut().zip(own).for_each(|(sum, own)| *sum += q * own[0] + qd * own[1]);
        rows
    }

    /// (coefficient, gain in log-likelihood, information of its own) beside the law's own terms.
    pub(super) fn gain(&self, own: &OwnTerms) -> (f64, f64, f64) {
        let told = self.estimate(own, 0.0);
        told.map_or((0.0, 0.0, 0.0), |(value, information)| (value, 0.5 * value * value * information, information))
    }

    /// (coefficient, information of its own) beside the law's own terms, were the score so much larger; none where they
    /// leave next to nothing of it.
    pub(super) fn estimate(&self, own: &OwnTerms, larger: f64) -> Option<(f64, f64)> {
        let (mut information, mut score) = (self.information, self.score + larger);
        for row in own.determined() {
            let shared = self.shared(row, own);
            information -= self.cross[row] * shared;
            score -= shared * own.information.score[row];
        }
        (information > OWN * self.information).then_some((score / information, information))
    }

    /// Row of M⁻¹c: how much of the coefficient is one of the law's own; nothing of one that is not told.
    pub(super) fn shared(&self, row: usize, own: &OwnTerms) -> f64 {
        let n = self.cross.len();
        let product = |column: usize| own.solution.covariance[row * n + column] * self.cross[column];
        if own.is_told(row) { own.determined().map(product).sum() } else { 0.0 }
    }

    /// The law's own terms are told `own` with this coefficient; they become what they are told were it not `value` but
    /// 0.
    pub(super) fn take_out(&self, value: f64, own: &mut Information) {
        own.score.iter_mut().zip(&self.cross).for_each(|(score, cross)| *score += value * cross);
    }
}
