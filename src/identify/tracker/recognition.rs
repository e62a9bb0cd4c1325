//! Laws seen before: recognised at an alarm or soon after it, left again when the record contradicts them.
//!
//! At the alarm the bank of hypotheses has seen the switch already, with the state carried on from before: each known law is weighed
//! by it at once. Where that does not decide, the laws go on trial over the record since the stage's start.

use super::doubt::Doubt;
use super::{Phase, Tracker, alarm_level};
use crate::identify::identifier::{Coefficient, Output, Status};
use crate::identify::known::{KnownLaw, ROOM, Weighed};
use crate::identify::problem::Problem;
use crate::identify::saved::{SavedLaw, SavedLaws, SavedLawsError};
use crate::identify::settings::Settings;
use crate::identify::stage::VOUCHED;
use crate::identify::trials::Verdict;
use serde::{Deserialize, Serialize};

/// Evidence against any other law that makes a known one recognised in the step of the alarm, in alarm levels: it is more likely
/// beforehand than all others together, and it is taken back when it was wrong.
const AT_ALARM: f64 = 0.05;

/// The same on trial, where the state is known from the new record alone.
const ON_TRIAL: f64 = 0.25;

/// Evidence against the next best known law, in alarm levels.
const AMONG_KNOWN: f64 = 0.15;

/// The bank goes on after an alarm for this many times as long as it had watched the switch.
const LINGER: u64 = 3;

/// Evidence of any other law at which a recognised one is left, in alarm levels.
const CONTRADICTED: f64 = 0.15;

/// The time after an alarm in which the bank still speaks for known laws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Lingering {
    /// Number of the sample at which it ends.
    until: u64,
    /// Number of the law that was left.
    number: Option<u32>,
}

/// A known law that stands out, and what speaks against it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Sight {
    place: usize,
    doubt: Doubt,
}

impl From<Verdict> for Sight {
    fn from(verdict: Verdict) -> Sight {
        Sight { place: verdict.place, doubt: Doubt::of(verdict.against_any, verdict.rival) }
    }
}

impl Tracker {
    /// After an alarm the bank of hypotheses goes on for as long as it has watched the switch, about the law that was in use until
    /// then: it carries the state over the switch, which the new record alone does not know.
    pub(super) fn linger(&mut self, since: u64, number: Option<u32>) {
        let end = self.window.ready();
        let until = end + LINGER * (end - since);
        let others = self.known.laws().iter().any(|law| Some(law.number) != number);
        match others {
            true => self.lingering = Some(Lingering { until, number }),
            false => self.end_lingering(),
        }
    }

    /// Weighs every known law by the bank after an alarm.
    pub(super) fn weigh_after_alarm(&mut self, problem: &Problem, settings: &Settings) {
        let Some(lingering) = self.lingering else { return };
        while self.live.next < self.window.ready() {
            let innovations = self.live.step(problem, &self.window.observation(self.live.next));
            self.bank.step(&self.live.pass.map, &innovations);
            self.live.next += 1;
        }
        self.in_sight = self.in_sight(problem, settings, lingering.number);
        if self.in_sight.is_none() && self.window.ready() >= lingering.until {
            self.end_lingering();
        }
    }

    pub(super) fn end_lingering(&mut self) {
        self.lingering = None;
        self.bank.clear();
    }

    /// No known law is on trial or in use any more.
    pub(super) fn forget_trials(&mut self, output: &mut Output) {
        self.trials.end();
        self.lingering = None;
        (self.recognised, self.confirmed, self.in_sight) = (None, false, None);
        (self.trial_due, self.experience) = (None, 0);
        (output.law_number, output.recognised) = (None, false);
    }

    /// The place of the known law that the bank's hypotheses speak for, other than the one of that number.
    fn in_sight(&mut self, problem: &Problem, settings: &Settings, number: Option<u32>) -> Option<Sight> {
        let nobody = (f64::NEG_INFINITY, 0.0, None);
        let (mut best, mut next) = (nobody, nobody);
        for place in 0..self.known.laws().len() {
            if Some(self.known.laws()[place].number) == number {
                continue;
            }
            let Weighed { known, any } = self.known.at_a_switch(place, problem, &self.live.all, &mut self.bank);
            match known > best.0 {
                true => (best, next) = ((known, any, Some(place)), best),
                false if known > next.0 => next = (known, any, Some(place)),
                false => {}
            }
        }
        let (known, any, place) = best;
        let level = alarm_level(settings);
        let place = place.filter(|_| known - any > AT_ALARM * level && known - next.0 > AMONG_KNOWN * level)?;
        Some(Sight { place, doubt: Doubt::of(known - any, next.2.map(|rival| (rival, known - next.0))) })
    }

    /// Carries the trial of the known laws on; returns how many samples it ran, of [`super::BUDGET`] at most.
    pub(super) fn try_known(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        published: &mut [Coefficient],
        output: &mut Output,
    ) -> usize {
        self.weigh_after_alarm(problem, settings);
        if let Some(sight) = self.in_sight.take() {
            self.recognise(problem, sight, published, output);
        }
        let Tracker { trials, known, window, .. } = self;
        let used = trials.advance(known, problem, window, self.recognised, super::BUDGET[1]);
        self.run_recognised(problem);
        let verdict = self.trials.weigh(&mut self.known, &self.window);
        let level = alarm_level(settings);
        let stands_out =
            |verdict: &Verdict| verdict.against_any > ON_TRIAL * level && verdict.against_known() > AMONG_KNOWN * level;
        let found = verdict.filter(stands_out).map(Sight::from);
        match (self.recognised, found) {
            (Some(place), Some(found)) if place == found.place => self.confirmed = true,
            (Some(place), _) if self.is_contradicted(place, verdict.is_some(), level) => {
                self.withdraw(problem, self.stage.start, output);
                self.in_sight = found;
            }
            (Some(place), _) if verdict.is_some() => {
                self.doubt =
                    self.trials.on(place, &self.known).map_or(self.doubt, |verdict| Sight::from(verdict).doubt);
            }
            (None, Some(found)) if !output.valid => self.recognise(problem, found, published, output),
            _ => {}
        }
        used
    }

    /// Whether the record rules the recognised law out, or what has just been weighed speaks for another one.
    fn is_contradicted(&self, place: usize, weighed: bool, level: f64) -> bool {
        let against = |verdict: Verdict| verdict.against_any.min(verdict.against_known()) < -CONTRADICTED * level;
        self.trials.is_running() && self.trials.on(place, &self.known).is_none_or(|verdict| weighed && against(verdict))
    }

    /// The law in sight is the law in use from now on, until the stage's own estimate takes over from it.
    fn recognise(&mut self, problem: &Problem, sight: Sight, published: &mut [Coefficient], output: &mut Output) {
        let Sight { place, doubt } = sight;
        (self.recognised, self.confirmed, self.doubt) = (Some(place), false, doubt);
        self.end_lingering();
        let law = &self.known.laws()[place];
        self.stage.begin_known(problem, &self.window, self.stage.start, law, self.trials.noise(place), &self.scales);
        (self.phase, self.challenging) = (Phase::Refining, false);
        self.live.running = false;
        self.spread.copy_from_slice(&law.spread);
        self.bank.set_spread(&self.spread);
        self.experience = law.samples;
        self.publish_known(problem, law, published);
        (output.law_number, output.recognised) = (Some(law.number), true);
        output.valid = true;
        output.identified_time = Some(self.now());
        output.status = Status::Tracking;
        self.run_recognised(problem);
    }

    /// Once the recognised law's run has caught up with the stream it is the law in use.
    fn run_recognised(&mut self, problem: &Problem) {
        let Some(place) = self.recognised else { return };
        if !self.live.running && self.trials.has_caught_up(place, &self.window) {
            let law = &self.known.laws()[place];
            let scales = &self.stage.scales;
            self.live.adopt_known(problem, law, &mut self.trials, place, scales, &self.window);
        }
    }

    /// The record contradicts the recognised law: the stage is that of a new one after all.
    fn withdraw(&mut self, problem: &Problem, start: u64, output: &mut Output) {
        (self.recognised, self.confirmed) = (None, false);
        self.retracted = true;
        self.experience = 0;
        (output.law_number, output.recognised) = (None, false);
        (output.valid, output.identified_time) = (false, None);
        self.live.running = false;
        self.bank.clear();
        self.contest_from(start);
        match self.noise_weight > 0.0 {
            true => {
                output.status = Status::ReIdentifying;
                self.set_spread(problem);
                for ((change, centre), index) in self.change.iter_mut().zip(&mut self.centre).zip(&problem.free) {
                    *centre = self.live.all[*index];
                    *change = *centre;
                }
                self.begin_new_law(problem, start);
            }
            false => {
                self.stage.start = start;
                (output.status, self.phase) = (Status::Acquiring, Phase::Gathering);
            }
        }
    }

    /// An alarm under a law that its trial has not confirmed yet speaks against the law, not for one more switch: the stage goes on as
    /// that of another law.
    pub(super) fn take_back(&mut self, problem: &Problem, output: &mut Output) {
        let (start, wrong) = (self.stage.start, self.recognised);
        self.withdraw(problem, start, output);
        let sensor = self.live.noise.sensor.map(Some);
        self.trials.begin(&self.known, problem, &self.window, start, sensor);
        wrong.into_iter().for_each(|place| self.trials.rule_out(place));
    }

    /// Whether the law in use was recognised and its trial has not confirmed it yet.
    pub(super) fn is_unconfirmed(&self) -> bool {
        self.recognised.is_some() && !self.confirmed
    }

    /// Whether the law in use was recognised and never was the record's: it has held for a shorter time than it has been left by now, or
    /// against another law all the while there is no such evidence of a switch as an alarm asks. `beyond` is by how much it passes the level.
    pub(super) fn was_never_right(&mut self, instant: u64, now: u64, beyond: f64) -> bool {
        let Some(place) = self.recognised else { return false };
        let against = self.trials.evidence_against(place, &mut self.known, &self.window);
        self.stage.length(instant) < now - instant || against.is_some_and(|against| against > beyond)
    }

    /// Coefficients of a law that was taken back are not known any more.
    pub(super) fn retract(&mut self, problem: &Problem, published: &mut [Coefficient]) {
        if std::mem::take(&mut self.retracted) {
            problem.free.iter().for_each(|index| published[*index].std = None);
        }
    }

    /// Gives a law that is vouched for its number: that of the known law which it is, or a new one.
    pub(super) fn number_law(&mut self, settings: &Settings, output: &mut Output) {
        if output.law_number.is_none() {
            let found = self.known.same_as(&self.stage, ON_TRIAL * alarm_level(settings));
            output.law_number = Some(found.unwrap_or_else(|| self.known.new_number()));
        }
    }

    /// Takes laws to recognise.
    ///
    /// # Errors
    /// [`SavedLawsError`].
    pub fn learn(&mut self, problem: &Problem, saved: &SavedLaws) -> Result<(), SavedLawsError> {
        for law in &saved.laws {
            let taken = self.known.position(law.number).is_some() || self.known.laws().len() == ROOM;
            if taken {
                return Err(SavedLawsError::TooMany { law: law.number, room: ROOM });
            }
            self.known.push(&law.known(problem)?);
        }
        Ok(())
    }

    /// Every known law, the present one among them where it is vouched for.
    pub fn known_laws(&self, problem: &Problem, output: &Output) -> SavedLaws {
        let mut after = self.clone();
        after.keep_law(problem, output);
        let mut laws: Vec<SavedLaw> = after.known.laws().iter().map(|law| SavedLaw::of(law, problem)).collect();
        laws.sort_by_key(|law| law.number);
        SavedLaws { laws }
    }

    /// Keeps the law that is vouched for, as the stage has it.
    pub(super) fn keep_law(&mut self, problem: &Problem, output: &Output) {
        let known_better = self.recognised.is_none() || self.stage.settled();
        let exact = self.stage.passes > 0 && self.stage.stated_error() < VOUCHED;
        let number = output.law_number.filter(|_| output.valid && exact && known_better);
        if let Some(number) = number {
            self.set_spread(problem);
            let samples = self.stage.length(self.window.ready());
            self.known.keep(number, &self.stage, samples, &self.spread, self.recognised.is_some());
        }
    }

    /// Leaves a recognised law that the stage's own estimate contradicts, once its trial is over; returns whether it did.
    pub(super) fn leave(&mut self, problem: &Problem, settings: &Settings, output: &mut Output) -> bool {
        let Some(place) = self.recognised.filter(|_| !self.trials.is_running()) else { return false };
        let weighed = self.known.weigh(place, Some(&self.stage.coefficients), self.stage.record());
        let against_any = (weighed.known - weighed.any) / self.stage.overdispersion;
        let contradicted = against_any < -CONTRADICTED * alarm_level(settings);
        if contradicted {
            self.withdraw(problem, self.stage.start, output);
        }
        contradicted
    }

    /// Puts the known laws on trial over a record that no alarm began, as soon as it has two samples.
    pub(super) fn begin_trial(&mut self, problem: &Problem, settings: &Settings) {
        let due = self.trial_due.filter(|start| self.window.end() >= start + 2);
        if let Some(start) = due {
            self.trial_due = None;
            let given = [settings.noise_q, settings.noise_qd].map(|std| (std > 0.0).then_some(std * std));
            self.stage.start = start;
            self.trials.begin(&self.known, problem, &self.window, start, given);
            self.trials.set_left(None);
        }
    }

    fn publish_known(&self, problem: &Problem, law: &KnownLaw, published: &mut [Coefficient]) {
        for (coefficient, known) in published.iter_mut().zip(&problem.known) {
            (coefficient.value, coefficient.std) = (*known, Some(0.0));
        }
        for (free, index) in problem.free.iter().enumerate() {
            let (coefficient, value) = (&mut published[*index], law.coefficients[free]);
            let std = law.variance(free).sqrt().hypot(self.recognition_std(free, value));
            (coefficient.value, coefficient.std) = (value, Some(std));
        }
    }

    /// What a free coefficient's std owes to the doubt whether the law was recognised rightly.
    pub(super) fn recognition_std(&self, free: usize, value: f64) -> f64 {
        match self.is_unconfirmed() && self.trials.is_running() {
            true => self.doubt.variance(self.known.laws(), free, value, self.spread[free]).sqrt(),
            false => 0.0,
        }
    }
}
