//! Coefficients that move: they are followed until they rest and a constant law is found again.

use super::{Phase, Tracker};
use crate::identify::identifier::{Coefficient, Output, Status};
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use crate::identify::stage::TRUSTED;

/// A constant law is sought in the record from this many variations back on.
const REST: u64 = 4;

impl Tracker {
    /// Follows coefficients that move, and says so where the record does.
    pub(super) fn track_drift(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        published: &mut [Coefficient],
        output: &mut Output,
    ) {
        let thorough = output.drifting || !output.valid;
        if !problem.channels.q || !self.drift.step(problem, settings, &self.window, thorough) {
            return;
        }
        let moves = self.drift.is_moving() && self.drift.sees();
        if !output.drifting && moves && !output.valid && self.drift.stated_error() < TRUSTED {
            self.begin_drift(output);
        }
        if output.drifting {
            self.publish_drift(problem, published, output);
            match self.resting {
                true if moves => self.resting = false,
                false if self.drift.is_at_rest() => self.seek_rest(),
                _ => {}
            }
        }
    }

    /// From now on no constant law is monitored.
    pub(super) fn begin_drift(&mut self, output: &mut Output) {
        output.drifting = true;
        self.resting = false;
        self.live.running = false;
        self.bank.clear();
        self.deviation.clear();
        self.forget_trials(output);
        output.missing = None;
    }

    /// The coefficients have come to rest: a constant law is sought in the latest record.
    fn seek_rest(&mut self) {
        let end = self.window.end();
        let since = end.saturating_sub(REST * self.drift.length()).max(self.window.oldest());
        self.resting = true;
        self.start.begin(since);
        (self.phase, self.challenging, self.challenged_from) = (Phase::Gathering, false, since);
        (self.next_guess, self.next_noise_challenge) = (0, 0);
    }

    fn publish_drift(&mut self, problem: &Problem, published: &mut [Coefficient], output: &mut Output) {
        for (index, coefficient) in published.iter_mut().enumerate() {
            match problem.free.iter().position(|free| *free == index) {
                None => (coefficient.value, coefficient.std) = (problem.known[index], Some(0.0)),
                Some(free) if self.drift.determines(free) => {
                    (coefficient.value, coefficient.std) =
                        (self.drift.coefficients()[free], Some(self.drift.std(free)));
                }
                Some(_) => coefficient.std = None,
            }
        }
        output.valid = self.drift.sees() && self.drift.stated_error() < TRUSTED;
        output.status = if output.valid { Status::Tracking } else { Status::Acquiring };
        if output.valid {
            output.identified_time.get_or_insert(self.now());
        }
    }
}
