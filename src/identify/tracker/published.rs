//! What a stage makes known, once its law is worth showing.

use super::{Phase, Tracker, YOUNG};
use crate::identify::identifier::{Coefficient, Output, Status};
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use crate::identify::stage::{GROWTH, TRUSTED};

impl Tracker {
    /// What the record since the stage's start leaves open: combinations of terms while the weak rows of a first law are
    /// gathered, then single terms whose std is larger than anything plausible.
    pub fn unidentifiable(&self, problem: &Problem) -> Vec<String> {
        let name = |free: &usize| problem.free_terms[*free].name();
        let shown = self.stage.settled() && self.stage.stated_error() < TRUSTED;
        if self.phase == Phase::Refining && shown {
            let open =
                (0..problem.n()).filter(|free| self.stage.active[*free] && self.stage.std(*free) >= self.spread[*free]);
            return open.map(|free| name(&free)).collect();
        }
        let directions = self.start.open_directions();
        directions.iter().map(|direction| problem.together(direction)).collect()
    }

    pub(super) fn publish(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        published: &mut [Coefficient],
        output: &mut Output,
    ) {
        let physical = self.is_physical(problem, self.stage.all[problem.inertia]);
        let vouched = self.stage.is_vouched() && physical;
        if output.drifting && !vouched {
            return;
        }
        for (index, coefficient) in published.iter_mut().enumerate() {
            match problem.free.iter().position(|free| *free == index) {
                None => (coefficient.value, coefficient.std) = (problem.known[index], Some(0.0)),
                Some(free) => self.publish_free(free, coefficient),
            }
        }
        // of a law that does not explain its record, or that several share, the std is that of none
        if !physical || !(vouched || self.stage.is_beyond_doubt() || self.recognised.is_some()) {
            problem.free.iter().for_each(|index| published[*index].std = None);
            return;
        }
        self.noise_known = true;
        let std = |channel: usize| {
            let lately = self.live.loudness.lately(channel).filter(|_| self.live.running);
            let louder = lately.map(|lately| lately * self.live.noise.sensor[channel]);
            louder.unwrap_or(self.stage.noise.sensor[channel]).sqrt()
        };
        output.noise_q = problem.channels.q.then(|| std(0));
        output.noise_qd = problem.channels.qd.then(|| std(1));
        if vouched {
            (output.valid, output.drifting) = (true, false);
            if self.stage.explains {
                self.moving.end_trial(self.stage.length(self.window.ready()));
            }
            self.number_law(settings, output);
            self.get_acquainted(output);
            output.identified_time.get_or_insert(self.now());
            if output.status != Status::SwitchSuspected {
                output.status = Status::Tracking;
            }
        }
    }

    /// Whether the inertia, where it is sought, is one that a motion can have.
    pub(super) fn is_physical(&self, problem: &Problem, inertia: f64) -> bool {
        problem.free_inertia().is_none() || self.weak_form.resolves(inertia)
    }

    /// How long a law takes to be known, and what it leaves unexplained then.
    fn get_acquainted(&mut self, output: &Output) {
        let length = self.stage.length(self.window.ready());
        // a law that explained its record and does not any more says nothing against it: the record has changed
        if length >= YOUNG && (self.stage.explains || output.identified_time.is_none()) {
            self.explained = self.stage.explains;
        }
        if output.identified_time.is_none() {
            self.acquaintance = length.max(self.acquaintance / 2);
        }
    }

    /// Says of every coefficient how many more seconds of record it needs.
    pub(super) fn foretell(&self, problem: &Problem, published: &mut [Coefficient], output: &Output) {
        published.iter_mut().for_each(|coefficient| coefficient.needed = coefficient.std.map(|_| 0.0));
        if !output.valid {
            for (free, index) in problem.free.iter().enumerate() {
                published[*index].needed = self.needed(free, published[*index].std, output);
            }
        }
    }

    /// As of the last pass.
    fn needed(&self, free: usize, std: Option<f64>, output: &Output) -> Option<f64> {
        let factor = self.stage.growth_needed(free);
        if output.drifting || self.phase == Phase::Gathering || !factor.is_finite() {
            return None;
        }
        let time = |number: u64| self.window.sample(number.clamp(self.window.oldest(), self.window.end() - 1)).t;
        let length = time(self.stage.closed_at()) - time(self.stage.start);
        let least = if std.is_some() { 0.0 } else { GROWTH };
        Some((factor - 1.0).max(least) * length)
    }

    fn publish_free(&self, free: usize, coefficient: &mut Coefficient) {
        let std = self.stage.std(free);
        if !self.stage.active[free] {
            (coefficient.value, coefficient.std) = (0.0, Some(self.recognition_std(free, 0.0)));
        } else if std < self.spread[free] {
            let value = self.stage.coefficients[free];
            (coefficient.value, coefficient.std) = (value, Some(std.hypot(self.recognition_std(free, value))));
        } else {
            coefficient.std = None;
        }
    }
}
