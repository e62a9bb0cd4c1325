//! Coefficients that move: put on trial at an alarm, followed until they rest and a constant law is found again.

use super::regime::{Event, Follower};
use super::state::{Fitting, Setup, Tracker};
use crate::estimation::KnownEffect;
use crate::evidence::SWITCH_SIZE;
use crate::identify::drift::{Before, INSTANTS};
use crate::identify::problem::Problem;
use crate::identify::validation::TRUSTED;
use std::f64::consts::TAU;

/// A trial begins this many natural periods before the switch that an alarm found.
const BEFORE: f64 = 2.0;

/// Natural periods after which a constant law that explains them is no chance: what moves as slowly is no drift yet.
const OUTLASTS: f64 = 3.0;

impl Tracker {
    /// Puts a drift on trial: instead of a switch at one of these samples the coefficients may have wandered.
    pub(super) fn try_drift(&mut self, problem: &Problem, switch: [u64; INSTANTS]) {
        let law = &self.monitor.law;
        if self.augmented_drift.is_on_trial() || self.augmented_drift.is_following() || !law.explains {
            return;
        }
        let last = self.last_interval();
        let period = (TAU * self.segment.scales.natural_time() / last).min(self.window.capacity() as f64 / 8.0);
        let earliest = self.segment.start.max(self.window.oldest());
        let start = switch[0].saturating_sub((BEFORE * period) as u64).max(earliest);
        let belief = &mut self.belief;
        for (index, (reach, spread)) in belief.from.iter_mut().zip(&belief.spread).enumerate() {
            *reach = if law.active[index] { spread / SWITCH_SIZE } else { 0.0 };
        }
        let before = Before {
            terms: &law.terms,
            all: &law.all,
            reach: &belief.from,
            noise: law.noise,
            parts: law.run.parts,
            period,
            switch: switch.map(|number| number.max(start + 1)),
            start,
        };
        self.augmented_drift.begin(problem, &self.window, &before);
    }

    /// Whether an alarm says that coefficients which have moved before move again.
    pub(super) fn moves_again(&self) -> Option<Follower> {
        match self.augmented_drift.is_following() {
            true => Some(Follower::AugmentedFilters),
            false => (self.drifted.is_some() && self.weak_row_drift.is_moving()).then_some(Follower::WeakRows),
        }
    }

    /// From now on no constant law is in use.
    pub(super) fn begin_drift(&mut self, by: Follower) {
        self.monitor.law.running = false;
        self.monitor.bank.clear();
        self.monitor.prediction.clear();
        self.library.end_trials();
        self.published.missing = None;
        self.enter(Event::DriftFound(by));
    }

    /// Goes on with a trial of filters with coefficients in their state, and follows what it found until a constant law
    /// is validated.
    pub(super) fn track_augmented(&mut self, setup: Setup) {
        if self.augmented_drift.is_following() && !self.regime.is_drifting() {
            self.augmented_drift.end();
            self.weak_row_drift.restart(self.window.end());
        }
        let followed = self.augmented_drift.is_following();
        if !self.augmented_drift.step(setup.problem, &self.window) {
            if followed {
                self.enter(Event::DriftLost);
                self.lose();
            }
            return;
        }
        let drift = &self.augmented_drift;
        let explained = self.segment.effect() != 0.0 && self.segment.settled() && self.segment.is_beyond_doubt();
        if drift.found_drift() && !self.regime.is_drifting() && !explained {
            self.augmented_drift.follow();
            self.begin_drift(Follower::AugmentedFilters);
        }
        if self.augmented_drift.is_following() {
            let drift = &self.augmented_drift;
            self.published.set(setup.problem, |free, _| Some(drift.coefficient(free)));
            let known = drift.stated_error() < TRUSTED;
            self.enter(Event::DriftValidated(known));
            let level = self.false_alarm_level(setup.settings);
            if let Some(instant) = self.augmented_drift.switched_since(level) {
                return self.switch_within_drift(setup.problem, instant);
            }
            match (self.is_resting(), self.augmented_drift.rests_since()) {
                (true, None) => self.enter(Event::DriftRests(false)),
                (false, Some(since)) => self.seek_rest(setup.problem, since),
                _ => {}
            }
        }
    }

    /// Follows coefficients that move by weak rows, and finds that they do.
    pub(super) fn track_weak_rows(&mut self, setup: Setup) {
        if self.augmented_drift.is_following() {
            return;
        }
        let problem = setup.problem;
        let thorough = self.regime.is_drifting() || !self.regime.is_valid();
        let sensor = self.likely_noise(setup);
        if !problem.channels.q || !self.weak_row_drift.step(problem, &self.window, sensor, thorough) {
            return;
        }
        let drift = &self.weak_row_drift;
        let moves = drift.is_moving() && drift.predicts();
        if !self.regime.is_drifting() && moves && self.is_sure_of_drift() && drift.stated_error() < TRUSTED {
            self.drifted = self.drifted.or(Some(self.window.end()));
            self.begin_drift(Follower::WeakRows);
        }
        if self.regime.is_drifting() {
            self.publish_weak_rows(problem);
        }
    }

    /// Whether a constant law carries the state through its record, down to the sensors' noise and for so long that
    /// nothing moves: weak rows know the coefficients less well.
    pub(super) fn refutes_drift(&self, problem: &Problem) -> bool {
        let segment = &self.segment;
        let law = segment.settled() && segment.is_validated() && segment.is_beyond_doubt();
        let long = OUTLASTS * self.there_and_back(f64::INFINITY) < 1.0;
        law && long && self.is_physical(problem, segment.all[problem.inertia])
    }

    /// The coefficients have come to rest; where the law explains what came before they were said to move as well, they
    /// never did.
    pub(super) fn leave_drift(&mut self) {
        self.drifted = self.drifted.filter(|said| *said <= self.segment.start);
        if self.drifted.is_none() {
            self.weak_row_drift.restart(self.window.end());
        }
    }

    /// Coefficients that have drifted before do so again. Where they have not and a law of this record was validated,
    /// they never do; where none was, they have to have moved for so long that a constant law would have been found,
    /// and none has been, nor is one on trial with the effect that it lacks most: such coefficients move with the
    /// motion. A constant law that explains the record does not move.
    fn is_sure_of_drift(&self) -> bool {
        let drift = &self.weak_row_drift;
        let had_a_law = self.regime.is_valid() || self.history.refuted_at > self.segment.start;
        let explained = self.is_refining() && self.segment.settled() && self.segment.fit.explains;
        let first = || {
            let known = had_a_law || self.history.explained || self.has_effect_on_trial();
            !known && drift.has_no_rest(&self.window) && drift.spans_half()
        };
        !explained && (self.drifted.is_some() || first())
    }

    /// The sensors' variances. Differences of q tell its noise by themselves; those of q̇ may hold more than that: what
    /// the law in use says is less, where there is one.
    fn likely_noise(&self, setup: Setup) -> [f64; 2] {
        let [q, qd] = setup.first_noise(&self.difference_noise);
        let settled = self.is_refining() && self.segment.settled();
        [q, if settled { qd.min(self.segment.noise.sensor[1]) } else { qd }]
    }

    fn is_resting(&self) -> bool {
        self.regime.followed().is_some_and(|drift| drift.resting)
    }

    /// The coefficients have come to rest: a constant law is sought in the record since then, from those that have.
    fn seek_rest(&mut self, problem: &Problem, since: u64) {
        let effect = self.augmented_drift.resting_law(problem, &mut self.belief.from);
        self.enter(Event::DriftRests(true));
        self.begin_law_after_drift(problem, since, effect);
    }

    /// The law has switched at this sample or somewhat later, while its coefficients moved: only what comes now is the
    /// new one's for sure.
    fn switch_within_drift(&mut self, problem: &Problem, instant: u64) {
        let effect = self.augmented_drift.switched_law(problem, &mut self.belief.from);
        self.begin_law_after_drift(problem, self.window.ready() - 1, effect);
        self.count_switch(instant, None);
        self.enter(Event::SwitchFound(None));
    }

    /// A constant law is sought in the record from sample `start` on, from the coefficients believed.
    fn begin_law_after_drift(&mut self, problem: &Problem, start: u64, effect: Option<KnownEffect>) {
        let start = start.max(self.window.oldest());
        self.belief.effect = effect;
        self.belief.centre.copy_from_slice(&self.belief.from);
        self.set_spread(problem);
        self.begin_new_law(problem, start);
        self.fitting = Fitting::Refining;
        self.begin_weak_rows(start);
    }

    fn publish_weak_rows(&mut self, problem: &Problem) {
        let drift = &self.weak_row_drift;
        // what the rows say nothing of keeps its value, as uncertain as its term may be large
        self.published.set(problem, |free, before| match drift.determines(free) {
            true => Some((drift.coefficients()[free], drift.std(free))),
            false => Some((before, drift.reach(free))),
        });
        let physical = self.is_physical(problem, self.published.coefficients[problem.inertia].value);
        if !physical {
            self.published.forget_stds(problem);
        }
        let drift = &self.weak_row_drift;
        let known = physical && drift.predicts() && drift.whole_error() < TRUSTED;
        self.enter(Event::DriftValidated(known));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::sample::Sample;
    use crate::identify::settings::Settings;
    use crate::law::Model;
    use crate::simulate::{Builtin, record};

    /// A full library's weak rows wander without end: a first law was lost to them for 130 s, and six switches with it.
    #[test]
    fn a_drift_that_a_constant_law_explains_is_left_and_a_switch_after_it_seen() {
        let (model, settings) = (Model::cubic_library(), Settings::default());
        let problem = Problem::new(&model, &settings);
        let mut tracker = Tracker::new(&problem, &settings);
        let mut scenario = Builtin::VanDerPolSine.random(7582).with_noise(0.001);
        scenario.stages.truncate(2);
        let switch = scenario.stages[1].start;
        scenario.duration = switch + 5.0;
        for (index, reading) in record(&scenario).unwrap().iter().enumerate() {
            if index == 3000 {
                tracker.drifted = Some(index as u64);
                tracker.begin_drift(Follower::WeakRows);
            }
            let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
            tracker.step(&problem, &settings, sample);
            let left = tracker.regime.law().is_some();
            assert!(left || reading.t < switch - 0.5 || reading.t > switch, "{:?}", tracker.regime);
            let count = tracker.published.switches.count;
            assert!(count == 0 && reading.t < switch + 0.1 || count == 1 && reading.t > switch, "{count}");
        }
    }
}
