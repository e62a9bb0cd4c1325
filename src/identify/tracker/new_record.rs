//! How the record of another law begins.

use super::regime::Event;
use super::state::{Fitting, SWITCH_SIZE, Schedule, Tracker};
use crate::estimation::Noise;
use crate::identify::problem::Problem;
use crate::identify::segment::{NOISE_MEMORY, Prior};

/// The prior of a new law is this much wider than the switch that is looked for.
pub(super) const PRIOR_WIDTH: f64 = 3.0;

/// Std of the logarithm of an inertia after a switch, or about a first guess: it may be 0.6 to 1.6 times what it was.
pub(super) const INERTIA_SPREAD: f64 = 0.5;

/// Share of the variance of a switch's acceleration that a new law's process noise begins with.
const UNEXPLAINED: f64 = 0.1;

/// An estimate of the inertia that is beyond these times the old one is that of a change too large for its
/// linearisation.
const SAME_INERTIA: std::ops::Range<f64> = 0.3..3.0;

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
        keep_inertia(problem, &law.all, &mut self.belief.from);
        self.belief.samples = NOISE_MEMORY;
        let prior = Prior {
            centre: &self.belief.centre,
            std: &self.belief.spread,
            log_inertia: INERTIA_SPREAD,
            structure: Some(&law.active),
            noise_weight: self.belief.samples,
            scales: &self.belief.scales,
        };
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

    /// A law that was validated does not explain its record any more, and no switch does: it is contested again.
    pub(super) fn refute_law(&mut self) {
        (self.history.refuted_at, self.schedule.next_guess) = (self.window.end(), 0);
        self.enter(Event::LawRefuted);
    }
}

/// A linear estimate of the change may turn the inertia around: it then stays what it was.
fn keep_inertia(problem: &Problem, old: &[f64], new: &mut [f64]) {
    if let Some(index) = problem.free_inertia() {
        let ratio = new[index] / old[problem.inertia];
        if !SAME_INERTIA.contains(&ratio) {
            new[index] = old[problem.inertia];
        }
    }
}
