//! Laws seen before: recognised at an alarm or soon after it, left again when the record contradicts them.
//!
//! At the alarm the bank of hypotheses has seen the switch already, with the state carried on from before: each known
//! law is weighed by it at once. Where that does not decide, the laws go on trial over the record since the segment's
//! start.

use super::regime::{Event, PostAlarm, Recognition};
use super::state::{Fitting, Setup, Tracker};
use crate::identify::library::{ROOM, SavedLaw, SavedLaws, SavedLawsError, Verdict, Weighed};
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use crate::identify::validation::VALIDATED;

/// Evidence against any other law that makes a known one recognised in the step of the alarm, in false-alarm levels: it
/// is more likely beforehand than all others together, and it is taken back when it was wrong.
const AT_ALARM: f64 = 0.05;

/// The same on trial, where the state is known from the new record alone.
const ON_TRIAL: f64 = 0.25;

/// The bank goes on after an alarm for this many times as long as it had watched the switch.
const POST_ALARM: u64 = 3;

/// Samples of known laws' trials in a step, all together: the budget of a law that has yet to converge.
pub(super) const TRIAL_BUDGET: usize = 40;

impl Tracker {
    /// The time after an alarm in which the bank of hypotheses goes on, as long as it has watched the switch, about the
    /// law that was in use until then: it carries the state over the switch, which the new record alone does not know.
    pub(super) fn post_alarm(&mut self, since: u64) -> Option<PostAlarm> {
        let end = self.window.ready();
        let left = self.regime.law();
        let others = self.library.known.laws().iter().any(|law| Some(law.number) != left);
        if !others {
            self.monitor.bank.clear();
        }
        others.then_some(PostAlarm { until: end + POST_ALARM * (end - since), left })
    }

    /// Weighs every known law by the bank after an alarm.
    fn weigh_after_alarm(&mut self, setup: Setup) {
        let Some(post_alarm) = self.regime.post_alarm() else { return };
        let monitor = &mut self.monitor;
        while monitor.law.next < self.window.ready() {
            let number = monitor.law.next;
            let (observation, shifts) = (self.window.observation(number), self.window.shifts(number));
            let innovations = monitor.law.step(setup.problem, &observation, shifts);
            monitor.bank.step(&monitor.law.run.map, monitor.law.effect_input(), &innovations);
            monitor.law.next += 1;
        }
        match self.in_sight(setup, post_alarm.left) {
            Some(verdict) => self.recognise(setup.problem, verdict),
            None if self.window.ready() >= post_alarm.until => self.end_post_alarm(),
            None => {}
        }
    }

    pub(super) fn end_post_alarm(&mut self) {
        self.enter(Event::PostAlarmEnded);
        self.monitor.bank.clear();
    }

    /// What the bank's hypotheses say on the known law that they speak for, other than the one of that number.
    fn in_sight(&mut self, setup: Setup, number: Option<u32>) -> Option<Verdict> {
        let (mut best, mut next) = (None, None);
        let Tracker { library, monitor, .. } = self;
        for place in 0..library.known.laws().len() {
            if Some(library.known.laws()[place].number) == number {
                continue;
            }
            let own = library.known.at_a_switch(place, setup.problem, &monitor.law.all, &mut monitor.bank);
            let is_more =
                |than: Option<(usize, Weighed)>| own.known > than.map_or(f64::NEG_INFINITY, |than| than.1.known);
            match is_more(best) {
                true => (best, next) = (Some((place, own)), best),
                false if is_more(next) => next = Some((place, own)),
                false => {}
            }
        }
        let (place, own) = best?;
        let rival = next.map(|(rival, other)| (rival, own.known - other.known));
        let verdict = Verdict { place, against_any: own.known - own.any, rival };
        Some(verdict).filter(|verdict| verdict.stands_out(AT_ALARM * self.false_alarm_level(setup.settings)))
    }

    /// Carries the trial of the known laws on; returns how many samples it ran, of [`TRIAL_BUDGET`] at most.
    pub(super) fn try_known(&mut self, setup: Setup) -> usize {
        self.weigh_after_alarm(setup);
        let place = self.regime.recognition().map(|recognition| recognition.place);
        let library = &mut self.library;
        let used = library.trials.advance(&library.known, setup.problem, &self.window, place, TRIAL_BUDGET);
        self.run_recognised(setup.problem);
        let verdict = self.library.trials.weigh(&mut self.library.known, &self.window);
        self.heed(setup, verdict);
        used
    }

    /// What the trials say is followed.
    fn heed(&mut self, setup: Setup, verdict: Option<Verdict>) {
        let level = ON_TRIAL * self.false_alarm_level(setup.settings);
        let found = verdict.filter(|verdict| verdict.stands_out(level));
        match (self.regime.recognition().map(|recognition| recognition.place), found) {
            (Some(place), Some(found)) if place == found.place => self.enter(Event::RecognitionWeighed(None)),
            (Some(place), _) if self.is_contradicted(place, verdict.is_some()) => {
                self.withdraw(setup.problem, self.segment.start);
                found.into_iter().for_each(|found| self.recognise(setup.problem, found));
            }
            (Some(place), _) if verdict.is_some() => {
                if let Some(verdict) = self.library.trials.on(place, &self.library.known) {
                    self.enter(Event::RecognitionWeighed(Some(verdict.doubt())));
                }
            }
            (None, Some(found)) if !self.regime.is_valid() => self.recognise(setup.problem, found),
            _ => {}
        }
    }

    /// Whether the record rules the recognised law out, or what has just been weighed speaks for another one.
    fn is_contradicted(&self, place: usize, weighed: bool) -> bool {
        let Tracker { library, .. } = self;
        let verdict = library.trials.on(place, &library.known);
        library.trials.is_running() && verdict.is_none_or(|verdict| weighed && verdict.is_against())
    }

    /// The law in sight is the law in use from now on, until the segment's own estimate takes over from it.
    fn recognise(&mut self, problem: &Problem, verdict: Verdict) {
        let place = verdict.place;
        self.end_post_alarm();
        let law = &self.library.known.laws()[place];
        let noise = self.library.trials.noise(place);
        self.segment.begin_known(problem, &self.window, self.segment.start, law, noise, &self.belief.scales);
        self.segment.add_effect(self.belief.effect);
        self.fitting = Fitting::Refining;
        self.monitor.law.running = false;
        self.belief.spread.copy_from_slice(&law.spread);
        self.monitor.bank.set_spread(&self.belief.spread);
        let recognition = Recognition { place, doubt: Some(verdict.doubt()) };
        let (library, spread) = (&self.library, &self.belief.spread);
        self.published.set(problem, |free, _| {
            let value = law.coefficients[free];
            let doubt = library.recognition_std(Some(recognition), free, value, spread[free]);
            Some((value, law.variance(free).sqrt().hypot(doubt)))
        });
        let number = law.number;
        self.enter(Event::LawRecognised(number, recognition));
        self.run_recognised(problem);
    }

    /// Once the recognised law's run has caught up with the stream it is the law in use.
    fn run_recognised(&mut self, problem: &Problem) {
        let Some(Recognition { place, .. }) = self.regime.recognition() else { return };
        let Tracker { library, monitor, segment, window, .. } = self;
        if !monitor.law.running && library.trials.has_caught_up(place, window) {
            let law = &library.known.laws()[place];
            monitor.law.adopt_known(problem, law, &mut library.trials, place, &segment.scales, window);
            monitor.prediction.restart(monitor.law.run.filter.state(), window.sample(window.ready() - 1).t);
        }
    }

    /// The record contradicts the recognised law: the segment is that of a new one after all. Its coefficients are not
    /// known any more.
    fn withdraw(&mut self, problem: &Problem, start: u64) {
        self.enter(Event::RecognitionRefuted { after_another: self.follows_a_law() });
        self.published.forget_stds(problem);
        self.monitor.law.running = false;
        self.monitor.bank.clear();
        self.begin_weak_rows(start);
        if !self.follows_a_law() {
            self.segment.start = start;
            self.fitting = Fitting::Starting;
            return;
        }
        self.set_spread(problem);
        let belief = &mut self.belief;
        for ((from, centre), index) in belief.from.iter_mut().zip(&mut belief.centre).zip(&problem.free) {
            *centre = self.monitor.law.all[*index];
            *from = *centre;
        }
        self.begin_new_law(problem, start);
    }

    /// An alarm under a law that its trial has not confirmed yet speaks against the law, not for one more switch: the
    /// segment goes on as that of another law.
    pub(super) fn take_back(&mut self, problem: &Problem) {
        let start = self.segment.start;
        let wrong = self.regime.recognition().map(|recognition| recognition.place);
        self.withdraw(problem, start);
        self.begin_trials(start, self.monitor.law.noise.sensor.map(Some));
        wrong.into_iter().for_each(|place| self.library.trials.rule_out(place));
    }

    /// The number of the known law that the segment's is, or a new one.
    pub(super) fn number_law(&mut self, settings: &Settings) -> u32 {
        let level = ON_TRIAL * self.false_alarm_level(settings);
        let known = &mut self.library.known;
        let found = known.same_as(&self.segment.estimate(), level);
        found.unwrap_or_else(|| known.new_number())
    }

    /// Takes laws to recognise.
    ///
    /// # Errors
    /// [`SavedLawsError`].
    pub fn learn(&mut self, problem: &Problem, saved: &SavedLaws) -> Result<(), SavedLawsError> {
        let known = &mut self.library.known;
        for law in &saved.laws {
            let taken = known.position(law.number).is_some() || known.laws().len() == ROOM;
            if taken {
                return Err(SavedLawsError::TooMany { law: law.number, room: ROOM });
            }
            known.push(&law.known(problem)?);
        }
        Ok(())
    }

    /// Every known law, the present one among them where it is validated.
    pub fn known_laws(&self, problem: &Problem) -> SavedLaws {
        let mut after = self.clone();
        after.keep_law(problem);
        let mut laws: Vec<SavedLaw> = after.library.known.laws().iter().map(|law| SavedLaw::of(law, problem)).collect();
        laws.sort_by_key(|law| law.number);
        SavedLaws { laws }
    }

    /// Keeps the law that is validated, as the segment has it.
    pub(super) fn keep_law(&mut self, problem: &Problem) {
        let recognised = self.regime.recognition().is_some();
        let known_better = !recognised || self.segment.settled();
        let exact = self.segment.runs.closed > 0 && self.segment.stated_error() < VALIDATED;
        if let Some(number) = self.regime.law().filter(|_| exact && known_better) {
            self.set_spread(problem);
            let samples = self.record_length();
            let Tracker { library, segment, belief, .. } = self;
            library.known.keep(number, &segment.estimate(), samples, &belief.spread, recognised);
        }
    }

    /// Puts the known laws on trial over the record from sample `start`, under these variances of the sensors.
    pub(super) fn begin_trials(&mut self, start: u64, sensor: [Option<f64>; 2]) {
        self.library.trials.begin(&self.library.known, &self.window, start, sensor);
    }

    /// The same over a record that no alarm began, as soon as it has two samples.
    pub(super) fn begin_first_trials(&mut self, setup: Setup) {
        let due = self.library.trial_due.filter(|start| self.window.end() >= start + 2);
        if let Some(start) = due {
            self.library.trial_due = None;
            self.segment.start = start;
            self.library.trials.left = None;
            self.begin_trials(start, setup.settings.given_noise());
        }
    }
}
