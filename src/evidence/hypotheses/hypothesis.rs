//! One hypothesis: since its start the law has been another one.

use super::no_change::NoChange;
use super::state_error::StateError;
use crate::estimation::{Information, Lane, System, WIDTH};
use crate::evidence::bayes_factor::TOLERANCE;
use serde::{Deserialize, Serialize};

/// What the law in use knows of its coefficients when a hypothesis starts.
#[derive(Clone, Copy, Debug)]
pub struct Law<'a> {
    /// Information on the coefficients from the stage so far.
    pub information: &'a Information,
    /// ∂(q, q̇)/∂θ of the state that it has come to, n.
    pub sensitivity: &'a [[f64; 2]],
    /// Which of them it may have.
    pub open: &'a [bool],
    /// Which of those it has.
    pub own: &'a [bool],
    /// Whether it explains its record down to the sensors' noise.
    pub explains: bool,
}

/// A law that does not explain its record is trusted with this fraction of its information: what it leaves comes and
/// goes with the motion.
const CAUTION: f64 = 0.03;

/// No law is trusted to be constant more exactly than to this part of what a switch moves: below lies what the
/// integration errs by.
const FINEST: f64 = 1e-7;

/// Looks at a hypothesis this much older come half as often, samples.
const AGING: f64 = 20.0;

/// A law of this probability is none, as a logarithm.
const NEGLIGIBLE: f64 = -60.0;

/// A hypothesis whose innovations together hold less than this cannot speak for a switch, nats.
const SILENT: f64 = 4.0;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Hypothesis {
    pub(super) start: u64,
    pub(super) age: u32,
    /// Age at the last look.
    pub(super) looked: u32,
    pub(super) evidence: f64,
    /// ½ Σ ε²/s since the start: no change explains more.
    pub(super) unexplained: f64,
    /// The same at the last look.
    pub(super) unexplained_then: f64,
    /// ∂q/∂δ and ∂q̇/∂δ, each n long and filled up with zeros.
    pub(super) sensitivity: [Vec<Lane>; 2],
    pub(super) information: Information,
    pub(super) state: StateError,
    /// Λ of "no switch", as [`Information::matrix`]: the record's, and of terms that the law has dropped what they
    /// could be.
    prior: Vec<f64>,
    /// Λμ of "no switch": what the stage up to the start says about the coefficients in use.
    pull: Vec<f64>,
    /// "No switch" with every coefficient that the law may have.
    full: NoChange,
    /// With its own alone, where it has dropped others.
    own: NoChange,
}

impl Hypothesis {
    /// Room for `n` coefficients.
    pub(super) fn none(n: usize) -> Hypothesis {
        let lanes = || vec![[0.0; WIDTH]; n.div_ceil(WIDTH)];
        Hypothesis {
            start: 0,
            age: 0,
            looked: 0,
            evidence: 0.0,
            unexplained: 0.0,
            unexplained_then: 0.0,
            sensitivity: [lanes(), lanes()],
            information: Information::none(n),
            state: StateError::none(n),
            prior: Information::none(n).matrix,
            pull: vec![0.0; n],
            full: NoChange::none(n),
            own: NoChange::none(n),
        }
    }

    /// The law switches after sample `start`; `precision` is 1/τ² of each coefficient.
    pub(super) fn begin(&mut self, start: u64, law: &Law, precision: &[f64], system: &mut System) {
        let n = precision.len();
        (self.start, self.age, self.looked) = (start, 0, 0);
        (self.evidence, self.unexplained, self.unexplained_then) = (0.0, 0.0, 0.0);
        self.sensitivity.iter_mut().for_each(|channel| channel.fill([0.0; WIDTH]));
        self.information.clear();
        self.state.begin(law.sensitivity);
        let sharpest = (0..n).map(|k| law.information.matrix[k * n + k] / precision[k]).fold(0.0, f64::max);
        let trust = if law.explains { 1.0 } else { CAUTION }.min((FINEST * FINEST * sharpest).recip());
        self.prior.iter_mut().zip(&law.information.matrix).for_each(|(slot, entry)| *slot = trust * entry);
        self.pull.iter_mut().zip(&law.information.score).for_each(|(pull, score)| *pull = trust * score);
        for (index, (slot, open)) in self.full.active.iter_mut().zip(law.open).enumerate() {
            *slot = *open && law.information.matrix[index * n + index] > 0.0;
        }
        // a term that was dropped is 0 within what it could be, whatever the record leaves open
        for index in (0..n).filter(|index| self.full.active[*index] && !law.own[*index]) {
            self.prior[index * n + index] += precision[index];
        }
        self.full.settle(&self.prior, &self.pull, system);
        for ((slot, full), own) in self.own.active.iter_mut().zip(&self.full.active).zip(law.own) {
            *slot = *full && *own;
        }
        if self.own.active == self.full.active {
            (self.full.log_weight, self.own.log_weight) = (0.0, f64::NEG_INFINITY);
        } else {
            self.own.settle(&self.prior, &self.pull, system);
            self.full.share(&mut self.own, precision);
        }
        self.pull.iter_mut().zip(&self.full.active).filter(|(_, active)| !**active).for_each(|(pull, _)| *pull = 0.0);
    }

    /// The laws that there may have been until the start.
    pub(super) fn likely_laws(&self) -> impl Iterator<Item = &NoChange> {
        [&self.full, &self.own].into_iter().filter(|law| law.log_weight > NEGLIGIBLE)
    }

    /// Log-evidence of no switch from `law`, of whose error the data since the start say `told`; leaves the eliminated
    /// system behind.
    pub(super) fn unswitched(&self, law: &NoChange, told: &Information, system: &mut System) -> f64 {
        system.load(&told.matrix, Some(&self.prior));
        system.set_right(told.score.iter().zip(&self.pull).map(|(score, pull)| score + pull));
        law.isolate_inactive(system);
        system.eliminate(TOLERANCE);
        0.5 * (system.squares() - law.at_mean - (system.log_determinant() - law.log_determinant))
    }

    /// Evidence at the last look, and what has come since.
    pub(super) fn promise(&self) -> f64 {
        let fresh = self.unexplained - self.unexplained_then;
        if fresh > 0.0 && self.unexplained > SILENT { self.evidence + fresh } else { f64::NEG_INFINITY }
    }

    /// Samples since the last look, in terms of how often one is due at this age; 0 where none can find anything.
    pub(super) fn wait(&self) -> f64 {
        let wait = f64::from(self.age - self.looked) / (1.0 + f64::from(self.age) / AGING);
        if self.unexplained > SILENT { wait } else { 0.0 }
    }

    /// Moves the point about which δ is counted: Λμ becomes Λ(μ − step).
    pub(super) fn shift(&mut self, step: &[f64]) {
        let (n, active) = (step.len(), &self.full.active);
        self.state.shift(step, &mut self.information);
        let before: f64 = (0..n).filter(|row| active[*row]).map(|row| step[row] * self.pull[row]).sum();
        for row in (0..n).filter(|row| active[*row]) {
            self.pull[row] -= self.prior[row * n + row] * step[row];
            for column in (row + 1..n).filter(|column| active[*column]) {
                let entry = self.prior[row * n + column];
                self.pull[row] -= entry * step[column];
                self.pull[column] -= entry * step[row];
            }
        }
        let after: f64 = (0..n).filter(|row| active[*row]).map(|row| step[row] * self.pull[row]).sum();
        self.full.at_mean -= before + after;
        self.own.at_mean -= before + after;
        // what it did not have moves: its terms are others now
        if (0..n).any(|row| step[row] != 0.0 && !self.own.active[row]) {
            (self.full.log_weight, self.own.log_weight) = (0.0, f64::NEG_INFINITY);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The probabilities of a law with both of two coefficients and with the first alone, the second told to the std
    /// 1/√`told`.
    fn weights(told: f64) -> [f64; 2] {
        let mut information = Information::none(2);
        information.add(&[10.0, 0.0], 0.0, 1.0);
        information.add(&[0.0, told.sqrt()], 0.0, 1.0);
        let (open, own, sensitivity) = (&[true, true], &[true, false], &[[0.0; 2]; 2]);
        let law = Law { information: &information, sensitivity, open, own, explains: true };
        let mut hypothesis = Hypothesis::none(2);
        hypothesis.begin(7, &law, &[4.0, 4.0], &mut System::new(2));
        [hypothesis.full.log_weight.exp(), hypothesis.own.log_weight.exp()]
    }

    /// The odds are those of the std after and before the record.
    #[test]
    fn a_dropped_term_of_which_the_record_says_nothing_is_as_likely_there_as_not() {
        for told in [1e-4, 1.0, 4000.0] {
            let [full, own] = weights(told);
            let expected = (1.0_f64 + told / 4.0).sqrt();
            assert!((own / full / expected - 1.0).abs() < 1e-9, "{told}: {} for {expected}", own / full);
        }
    }
}
