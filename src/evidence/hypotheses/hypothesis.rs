//! One hypothesis: since its start the law has been another one.
//!
//! Until the start the law in use erred by δ₀ in its coefficients, which leaves the state there off by Sδ₀, S being the
//! run's sensitivity. With ψ the response of the innovations to coefficients from the start on, and η that to the state
//! there, "no switch" is ε = (ψ + ηS)δ₀ + white: the error acts on. Where the motion is unstable for a while, or the
//! filter remembers long, ηS is the larger part. The sums are those of (ψ, η), n + 2 unknowns.

use super::no_change::NoChange;
use crate::estimation::{Information, Lane, System, WIDTH};
use crate::evidence::bayes_factor::TOLERANCE;
use serde::{Deserialize, Serialize};

/// What the law in use knows of its coefficients when a hypothesis starts.
#[derive(Clone, Copy, Debug)]
pub struct Law<'a> {
    /// Information on the n coefficients from the stage so far, and last on that of an effect beside them.
    pub information: &'a Information,
    /// ∂(q, q̇)/∂θ of the state that it has come to, n.
    pub sensitivity: &'a [[f64; 2]],
    /// The same of the effect's coefficient.
    pub effect: [f64; 2],
    /// Which of its own it may have.
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
    /// ∂q and ∂q̇ by δ and by the state at the start, each n + 2 long and filled up with zeros.
    pub(super) sensitivity: [Vec<Lane>; 2],
    /// What has been measured since the start says of these.
    pub(super) information: Information,
    /// S, n.
    of_law: Vec<[f64; 2]>,
    /// Λ and Λμ of "no switch": what the stage up to the start says about the coefficients in use, and of terms that
    /// the law has dropped what they could be.
    prior: Information,
    /// "No switch" with every coefficient that the law may have.
    full: NoChange,
    /// With its own alone, where it has dropped others.
    own: NoChange,
}

impl Hypothesis {
    /// Room for `n` coefficients.
    pub(super) fn none(n: usize) -> Hypothesis {
        let lanes = || vec![[0.0; WIDTH]; (n + 2).div_ceil(WIDTH)];
        Hypothesis {
            start: 0,
            age: 0,
            looked: 0,
            evidence: 0.0,
            unexplained: 0.0,
            unexplained_then: 0.0,
            sensitivity: [lanes(), lanes()],
            information: Information::none(n + 2),
            of_law: vec![[0.0; 2]; n],
            prior: Information::none(n),
            full: NoChange::none(n),
            own: NoChange::none(n),
        }
    }

    /// The law switches after sample `start`; `precision` is 1/τ² of each coefficient.
    pub(super) fn begin(&mut self, start: u64, law: &Law, precision: &[f64], system: &mut System) {
        let (n, own) = (self.of_law.len(), precision.len());
        (self.start, self.age, self.looked) = (start, 0, 0);
        (self.evidence, self.unexplained, self.unexplained_then) = (0.0, 0.0, 0.0);
        for (component, channel) in self.sensitivity.iter_mut().enumerate() {
            channel.fill([0.0; WIDTH]);
            channel.as_flattened_mut()[n + component] = 1.0;
        }
        self.information.clear();
        self.of_law.iter_mut().zip(law.sensitivity.iter().chain([&law.effect])).for_each(|(slot, of)| *slot = *of);
        let sharpest = (0..own).map(|k| law.information.matrix[k * n + k] / precision[k]).fold(0.0, f64::max);
        let trust = if law.explains { 1.0 } else { CAUTION }.min((FINEST * FINEST * sharpest).recip());
        self.prior.clone_from_slices(law.information);
        self.prior.scale(trust);
        for (index, (slot, open)) in self.full.active.iter_mut().zip(law.open.iter().chain([&true])).enumerate() {
            *slot = *open && law.information.matrix[index * n + index] > 0.0;
        }
        // a term that was dropped is 0 within what it could be, whatever the record leaves open
        for index in (0..own).filter(|index| self.full.active[*index] && !law.own[*index]) {
            self.prior.add_prior(index, precision[index], 0.0);
        }
        self.full.settle(&self.prior, system);
        for ((slot, full), own) in self.own.active.iter_mut().zip(&self.full.active).zip(law.own.iter().chain([&true]))
        {
            *slot = *full && *own;
        }
        if self.own.active == self.full.active {
            (self.full.log_weight, self.own.log_weight) = (0.0, f64::NEG_INFINITY);
        } else {
            self.own.settle(&self.prior, system);
            self.full.share(&mut self.own, precision);
        }
        for unknown in (0..n).filter(|unknown| !self.full.active[*unknown]) {
            (0..n).for_each(|other| *self.prior.entry_mut(unknown, other) = 0.0);
            self.prior.score[unknown] = 0.0;
        }
    }

    /// Entry of Σ (ψ, η)(ψ + ηS)ᵀ/s: what a change, or an error of the state from n on, shares with the law's error.
    pub(super) fn shared(&self, changed: usize, erring: usize) -> f64 {
        let (n, [q, qd]) = (self.of_law.len(), self.of_law[erring]);
        let of = |other: usize| self.information.entry(changed, other);
        of(erring) + q * of(n) + qd * of(n + 1)
    }

    /// What has been measured since the start says of an error that acts on.
    pub(super) fn tell_of_error(&self, whole: &mut Information) {
        let n = self.of_law.len();
        for (row, [q, qd]) in self.of_law.iter().enumerate() {
            for column in row..n {
                whole.matrix[row * n + column] =
                    self.shared(row, column) + q * self.shared(n, column) + qd * self.shared(n + 1, column);
            }
            let score = &self.information.score;
            whole.score[row] = score[row] + q * score[n] + qd * score[n + 1];
        }
    }

    /// The laws that there may have been until the start.
    pub(super) fn likely_laws(&self) -> impl Iterator<Item = &NoChange> {
        [&self.full, &self.own].into_iter().filter(|law| law.log_weight > NEGLIGIBLE)
    }

    /// Log-evidence of no switch from `law`, of whose error the data since the start say `told`; leaves the eliminated
    /// system behind.
    pub(super) fn unswitched(&self, law: &NoChange, told: &Information, system: &mut System) -> f64 {
        system.load(&told.matrix, Some(&self.prior.matrix));
        system.set_right(told.score.iter().zip(&self.prior.score).map(|(score, pull)| score + pull));
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

    /// Moves the point about which δ is counted, in the past too: Λμ becomes Λ(μ − step). `moved` begins with the step,
    /// and has room for that of the state.
    pub(super) fn shift(&mut self, moved: &mut [f64]) {
        let n = self.of_law.len();
        for component in 0..2 {
            moved[n + component] = self.of_law.iter().zip(&*moved).map(|(law, step)| law[component] * step).sum();
        }
        self.information.shift(moved);
        let step = &moved[..n];
        let pulled = |prior: &Information| step.iter().zip(&prior.score).map(|(step, pull)| step * pull).sum::<f64>();
        let before = pulled(&self.prior);
        self.prior.shift(step);
        let gained = before + pulled(&self.prior);
        self.full.at_mean -= gained;
        self.own.at_mean -= gained;
        // what it did not have moves: its terms are others now
        if (0..n).any(|row| step[row] != 0.0 && !self.own.active[row]) {
            (self.full.log_weight, self.own.log_weight) = (0.0, f64::NEG_INFINITY);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::{Innovation, IntervalMap};
    use crate::evidence::hypotheses::Bank;

    const SAMPLES: u64 = 300;

    /// The probabilities of a law with both of two coefficients and with the first alone, the second told to the std
    /// 1/√`told`.
    fn weights(told: f64) -> [f64; 2] {
        let mut information = Information::none(3);
        information.add(&[10.0, 0.0, 0.0], 0.0, 1.0);
        information.add(&[0.0, told.sqrt(), 0.0], 0.0, 1.0);
        let (open, own, sensitivity, effect) = (&[true, true], &[true, false], &[[0.0; 2]; 2], [0.0; 2]);
        let law = Law { information: &information, sensitivity, effect, open, own, explains: true };
        let mut hypothesis = Hypothesis::none(3);
        hypothesis.begin(7, &law, &[4.0, 4.0], &mut System::new(3));
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

    /// An unstable motion under a law whose one coefficient errs by `error`, without noise and with std 0.1 stated;
    /// from half way on that coefficient hardly acts. What a run of the filter is told from there on, and the
    /// hypothesis of a switch there.
    fn halfway(error: f64) -> (Information, Bank) {
        let (mut run, mut whole, mut bank) = (Information::none(1), Information::none(2), Bank::new(1, 4));
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
            bank.step(&map, [0.0; 2], &[Some(said), None]);
            for carried in [&mut sensitivity, &mut state] {
                let seen = carried[0];
                carried.iter_mut().zip(said.gain).for_each(|(entry, gain)| *entry -= gain * seen);
            }
            if number == SAMPLES / 2 {
                run.widen(&mut whole);
                let (sensitivity, effect, own) = (&[sensitivity], [0.0; 2], &[true]);
                bank.spawn(number, &Law { information: &whole, sensitivity, effect, open: own, own, explains: true });
                run.clear();
            }
        }
        (run, bank)
    }

    #[test]
    fn an_error_that_acts_on_is_told_as_by_the_run_itself() {
        let (run, bank) = halfway(0.3);
        let (hypothesis, mut whole) = (&bank.hypotheses[0], Information::none(2));
        hypothesis.tell_of_error(&mut whole);
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
        bank.shift([0.3, 0.0].into_iter());
        let scores = &bank.hypotheses[0].information.score;
        assert!(scores.iter().all(|score| score.abs() < 1e-9), "{scores:?}");
    }
}
