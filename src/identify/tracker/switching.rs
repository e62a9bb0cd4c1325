//! Whether the law has switched, and what happens when it has.

use super::regime::Event;
use super::state::{Fitting, Setup, Tracker};
use crate::estimation::TWENTY_TO_ONE;
use crate::evidence::Suspect;
use crate::identify::change::Decision;
use crate::identify::drift::INSTANTS;
use crate::identify::faults::DECISIVE;
use crate::identify::problem::Problem;

/// A linear estimate of a change that moves a coefficient by more stds of a switch than this is none to begin with. The
/// inertia's std being 0.3 of it, what is left keeps its sign.
const PLAUSIBLE: f64 = 2.0;

impl Tracker {
    /// Alarm, suspicion, or neither.
    pub(super) fn judge(&mut self, setup: Setup, suspect: &Suspect) {
        let decision = self.decision();
        let threshold = decision.threshold(setup.settings, self.window.pace());
        let monitor = &mut self.monitor;
        let end = self.window.end();
        let unusual = suspect.evidence > decision.unusual(threshold);
        monitor.unusual_since = unusual.then(|| monitor.unusual_since.unwrap_or(end));
        let deviates = self.monitor.prediction.deviates(setup.settings, self.now());
        let alarms = suspect.evidence > threshold || deviates;
        let asks = alarms || self.intake.after_outage.lead() > DECISIVE;
        self.intake.undecided &= asks;
        // in nats of a law that is known for sure, as those are of an effect or a lag
        let excess = (suspect.evidence - threshold) / decision.caution();
        let is_none = asks && self.is_offset(suspect)
            || alarms
                && (self.is_fault(setup.problem, suspect)
                    || self.is_lag(setup.problem, excess)
                    || self.is_effect(excess));
        if is_none {
            return;
        }
        if alarms {
            match self.moves_again() {
                Some(follower) => self.begin_drift(follower),
                None => self.switch(setup.problem, suspect, threshold),
            }
        } else {
            let raised = suspect.evidence > 0.5 * threshold;
            self.enter(if raised { Event::SuspicionRaised } else { Event::SuspicionCleared });
        }
    }

    /// Whether F acted at another time than is assumed, by all that the law in use has followed: that is told rather
    /// than a switch where it stands out more than that is above its threshold.
    fn is_lag(&mut self, problem: &Problem, excess: f64) -> bool {
        self.monitor.law.tell_lag();
        let told = &self.monitor.law.told;
        let stands_out = problem.timing.odds(&told.lag) > excess;
        let is_lag = stands_out && self.corrected_timing(problem, &told.lag).is_some();
        if is_lag {
            self.segment.timing.told.copy_from(told);
        }
        is_lag
    }

    /// Whether an effect that the law in use lacks, by all that it has followed, stands out more than a switch: the law
    /// is tried with it first. An alarm that the user's own deviation threshold asks for does not wait.
    fn is_effect(&mut self, excess: f64) -> bool {
        let Tracker { monitor, segment, .. } = self;
        let asked = (excess > 0.0).then(|| TWENTY_TO_ONE.max(excess));
        let lacked = asked.and_then(|least| monitor.law.likeliest_effect(least, &mut segment.untried_step));
        if lacked.is_some() && self.fitting == Fitting::Refining {
            segment.untried = lacked;
        }
        lacked.is_some()
    }

    /// What the law in use has to its credit.
    pub(super) fn decision(&self) -> Decision {
        // what the segment leaves tells more than the law in use did when it began; not where one like it explained its
        // record: a switch may be in this one already
        let lately = if self.history.explained { 1.0 } else { self.segment.fit.overdispersion };
        let overdispersion = self.monitor.law.overdispersion.max(lately);
        Decision {
            overdispersion,
            proven: self.regime.is_valid() || self.monitor.law.proven,
            explains: self.explains(),
            youth: self.youth(),
        }
    }

    /// Ends the segment; only data from after the switch enters the new law.
    fn switch(&mut self, problem: &Problem, suspect: &Suspect, threshold: f64) {
        let bank = &mut self.monitor.bank;
        bank.look_at_all();
        let suspect = bank.suspect().unwrap_or(*suspect);
        let last = self.window.ready() - 1;
        if self.regime.is_unconfirmed() {
            return self.take_back(problem);
        }
        let brought = self.take_back_offset();
        let bank = &self.monitor.bank;
        let instant = brought.unwrap_or_else(|| bank.likeliest_start(&suspect, threshold));
        let start = brought.unwrap_or_else(|| (bank.after(&suspect, threshold) + 1).min(last));
        let time = |number: u64| self.window.sample(number).t;
        let distance = bank.distance_of_switch(time(instant), self.now(), time);
        self.intake.after_outage.end();
        self.keep_law(problem);
        self.set_spread(problem);
        self.belief.scales.remember(&self.segment.scales, 1.0);
        self.believe_effect();
        if self.regime.is_valid() {
            let mut instants = [0; INSTANTS];
            self.monitor.bank.likeliest_starts(&mut instants);
            self.try_drift(problem, instants);
        }
        self.believe_change(problem, &suspect);
        self.begin_new_law(problem, start);
        self.library.trials.left = self.regime.law().and_then(|number| self.library.known.position(number));
        self.begin_trials(start, self.monitor.law.noise.sensor.map(Some));
        self.begin_weak_rows(start);
        self.weak_row_drift.restart(start);
        let post_alarm = self.post_alarm(instant);
        self.monitor.stop();
        self.monitor.prediction.forget_usual();
        self.count_switch(instant, distance);
        self.enter(Event::SwitchFound(post_alarm));
    }

    /// The new law is looked for from the most plausible change, about the law that was in use.
    fn believe_change(&mut self, problem: &Problem, suspect: &Suspect) {
        let Tracker { monitor, belief, .. } = self;
        monitor.bank.change(suspect, &mut belief.from);
        let mut changes = belief.from.iter().zip(&belief.spread);
        let plausible = changes.all(|(change, spread)| change.abs() < PLAUSIBLE * spread);
        for (index, (change, centre)) in belief.from.iter_mut().zip(&mut belief.centre).enumerate() {
            *centre = monitor.law.all[problem.free[index]];
            *change = if plausible { *centre + *change } else { *centre };
        }
    }

    pub(super) fn count_switch(&mut self, instant: u64, distance: Option<f64>) {
        let interval = self.last_interval();
        let switches = &mut self.published.switches;
        switches.count += 1;
        switches.time = self.window.sample(instant).t;
        switches.time_std = distance.map(|distance| distance.hypot(interval));
        switches.named_time = Some(self.intake.quarantine.now());
        switches.detection_time = Some(self.window.sample(self.window.end() - 1).t);
        self.published.missing = None;
    }
}
