//! How the record of another law begins.

use super::regime::Event;
use super::state::{Fitting, History, Schedule, Tracker};
use crate::estimation::{Lag, Noise};
use crate::evidence::SWITCH_SIZE;
use crate::identify::problem::Problem;
use crate::identify::segment::NOISE_MEMORY;
use crate::identify::timing::Timing;
use crate::identify::validation::SURE;
use crate::law::Hold;

/// The prior of a new law is this much wider than the switch that is looked for.
pub(super) const PRIOR_WIDTH: f64 = 3.0;

/// Share of the variance of a switch's acceleration that a new law's process noise begins with.
const UNEXPLAINED: f64 = 0.1;

impl Tracker {
    /// The record from sample `start` on is another law's: the weak rows begin with it, and no other fit is under way.
    pub(super) fn begin_weak_rows(&mut self, start: u64) {
        self.start.begin(start);
        self.schedule = Schedule { rows_from: start, ..Schedule::default() };
        if self.fitting == Fitting::Contested {
            self.fitting = Fitting::Refining;
        }
    }

    /// Begins the segment of a law that nobody has seen, from the coefficients believed most, about those before.
    pub(super) fn begin_new_law(&mut self, problem: &Problem, start: u64) {
        let acceleration = self.segment.scales.restoring_acceleration();
        let process = (SWITCH_SIZE * acceleration).powi(2) * UNEXPLAINED;
        let law = &self.monitor.law;
        let noise = Noise { sensor: law.noise.sensor, process: process.max(law.noise.process) };
        self.belief.spread.iter_mut().for_each(|spread| *spread *= PRIOR_WIDTH);
        self.belief.samples = NOISE_MEMORY;
        let prior = self.belief.prior(&self.belief.centre, Some(&law.active));
        self.segment.begin(problem, &self.window, start, &self.belief.from, prior, noise);
    }

    /// The law in use has left what can be computed: everything begins anew with the next samples.
    pub(super) fn lose(&mut self) {
        let end = self.window.end();
        self.monitor.stop();
        self.monitor.bank.clear();
        self.fitting = Fitting::Starting;
        self.begin_weak_rows(end);
        self.library.end_trials();
        self.library.trial_due = Some(end);
        self.enter(Event::StateLost);
    }

    /// What is assumed of when F acted follows what the record of the present law tells.
    pub fn correct_timing(&mut self, problem: &mut Problem) {
        if std::mem::take(&mut self.intake.begin_anew) {
            let before = problem.timing;
            problem.timing = before.anew();
            self.window.set_timing(problem.timing.hold, -before.lag);
            return self.lose();
        }
        self.intake.late = self.intake.late.filter(|_| self.monitor.law.running);
        // what is still held will be in the record as it was read
        if let Some(late) = self.intake.late.filter(|_| self.intake.quarantine.behind() == 0) {
            self.intake.late = None;
            return self.begin_late(problem, &late);
        }
        let Some(corrected) = self.corrected_timing(problem, &self.segment.timing.told.lag) else { return };
        let before = std::mem::replace(&mut problem.timing, corrected);
        self.window.set_timing(corrected.hold, corrected.lag - before.lag);
        self.begin_under_another_timing(problem, corrected.late() - before.late());
    }

    /// When F acted where the record of the present law says `lag`, and no effect that it lacks explains that as well,
    /// by its own evidence or by a trial that is still to end.
    pub(super) fn corrected_timing(&self, problem: &Problem, lag: &Lag) -> Option<Timing> {
        let on_trial = self.has_effect_on_trial() || self.segment.untried.is_some();
        let drifts = self.augmented_drift.evidence().is_some_and(|evidence| evidence > lag.evidence);
        let lacks = self.segment.effect_evidence() > lag.evidence || on_trial || drifts;
        let corrected = problem.timing.corrected(lag, self.record_length());
        // of a force chosen by a whole record's likelihood a short one tells what the law still lacks
        let young = problem.timing.hold == Hold::BandLimited && self.youth() > 1.0;
        corrected.filter(|_| self.is_refining() && !lacks && !young && !self.regime.is_moving())
    }

    /// F acts so many samples later than was assumed: the laws move along, and the record is fitted anew.
    fn begin_under_another_timing(&mut self, problem: &Problem, later: f64) {
        // what moves along is linear over a short way only
        if self.segment.stated_error() + self.segment.error_of_lag(later * later) > SURE {
            self.published.identified = None;
        }
        self.segment.begin_later(problem, &self.window, later);
        self.monitor.law.begin_later(problem, &self.segment.timing.told.slope, later);
        self.monitor.bank.clear();
        self.begin_weak_rows(self.window.end());
        match self.regime.law() {
            Some(_) => self.publish_coefficients(problem),
            None => self.published.forget_stds(problem),
        }
        self.library.known.forget();
        self.library.end_trials();
        self.weak_form.restart();
        self.weak_row_drift.restart(self.window.end());
        self.augmented_drift.end();
        self.intake.after_outage.end();
        self.monitor.late_channels = None;
        (self.history, self.drifted) = (History::default(), None);
    }

    /// A law that was validated does not explain its record any more, and no switch does: it is contested again.
    pub(super) fn refute_law(&mut self) {
        (self.history.refuted_at, self.schedule.next_guess) = (self.window.end(), 0);
        self.enter(Event::LawRefuted);
    }
}
