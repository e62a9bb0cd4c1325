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
        if self.moving.is_following() {
            return;
        }
        let thorough = output.drifting || !output.valid;
        let least = self.least_noise();
        if !problem.channels.q || !self.drift.step(problem, settings, &self.window, least, thorough) {
            return;
        }
        let moves = self.drift.is_moving() && self.drift.predicts();
        let alone = || !self.explained && self.drift.has_no_rest(&self.window) && self.drift.spans(1.0);
        let known = output.valid || self.doubted_from > self.stage.start;
        let sure = if known { self.drifted } else { alone() };
        if !output.drifting && moves && sure && self.drift.stated_error() < TRUSTED {
            self.drifted = true;
            self.begin_drift(output);
        }
        if output.drifting {
            self.publish_drift(problem, published, output);
            match self.resting {
                true if moves => self.resting = false,
                false if self.drift.is_at_rest() => self.seek_rest(self.latest_variations()),
                _ => {}
            }
        }
    }

    /// Sensor variances under the law in use, where there is one. Differences of q tell its noise by themselves; those of q̇ hold the
    /// increments of a rough excitation.
    fn least_noise(&self) -> [f64; 2] {
        let settled = self.phase == Phase::Refining && self.stage.settled();
        [f64::INFINITY, if settled { self.stage.noise.sensor[1] } else { f64::INFINITY }]
    }

    /// From now on no constant law is monitored.
    pub(super) fn begin_drift(&mut self, output: &mut Output) {
        output.drifting = true;
        self.resting = false;
        self.live.running = false;
        self.bank.clear();
        self.deviation.clear();
        self.forget_trials(output);
        (output.missing, output.law_number, output.recognised) = (None, None, false);
    }

    fn latest_variations(&self) -> u64 {
        self.window.end().saturating_sub(REST * self.drift.length())
    }

    /// The coefficients have come to rest: a constant law is sought in the record since then.
    pub(super) fn seek_rest(&mut self, since: u64) {
        let since = since.max(self.window.oldest());
        self.resting = true;
        self.phase = Phase::Gathering;
        self.contest_from(since);
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
        let physical = self.is_physical(problem, published[problem.inertia].value);
        if !physical {
            problem.free.iter().for_each(|index| published[*index].std = None);
        }
        output.valid = physical && self.drift.predicts() && self.drift.stated_error() < TRUSTED;
        output.status = if output.valid { Status::Tracking } else { Status::Acquiring };
        if output.valid {
            output.identified_time.get_or_insert(self.now());
        }
    }
}
