//! Coefficients that drift away from a law which explained its record: put on trial at an alarm, followed where they do.

use super::{SWITCH_SIZE, Tracker};
use crate::identify::identifier::{Coefficient, Output, Status};
use crate::identify::moving::{Before, INSTANTS};
use crate::identify::problem::Problem;
use crate::identify::stage::TRUSTED;
use std::f64::consts::TAU;

/// A trial begins this many natural periods before the switch that an alarm found.
const BEFORE: f64 = 2.0;

impl Tracker {
    /// Puts a drift on trial: instead of a switch at one of these samples the coefficients may have wandered. `spread` is that of the law
    /// in use.
    pub(super) fn try_drift(&mut self, problem: &Problem, switch: [u64; INSTANTS]) {
        let tried = self.moving.is_on_trial() || self.moving.is_following();
        if tried || !self.live.explains {
            return;
        }
        let last = self.last_interval();
        let period = (TAU * self.stage.scales.natural_time() / last).min(self.window.capacity() as f64 / 8.0);
        let earliest = self.stage.start.max(self.window.oldest());
        let start = switch[0].saturating_sub((BEFORE * period) as u64).max(earliest);
        for (index, reach) in self.change.iter_mut().enumerate() {
            *reach = if self.live.active[index] { self.spread[index] / SWITCH_SIZE } else { 0.0 };
        }
        let before = Before {
            all: &self.live.all,
            reach: &self.change,
            noise: self.live.noise,
            parts: self.live.pass.parts,
            period,
            switch: switch.map(|number| number.max(start + 1)),
            start,
        };
        self.moving.begin(problem, &self.window, &before);
    }

    /// Goes on with a trial, and follows a drift until a constant law is vouched for.
    pub(super) fn track_moving(&mut self, problem: &Problem, published: &mut [Coefficient], output: &mut Output) {
        if self.moving.is_following() && !output.drifting {
            self.moving.end();
            self.drift.restart(self.window.end());
        }
        let followed = self.moving.is_following();
        if !self.moving.step(problem, &self.window) {
            if followed {
                output.drifting = false;
                self.lose(output);
            }
            return;
        }
        if self.moving.found_drift() && !output.drifting && self.moving.stated_error() < TRUSTED {
            self.moving.follow();
            self.begin_drift(output);
        }
        if self.moving.is_following() {
            self.publish_moving(problem, published, output);
            match (self.resting, self.moving.rests_since()) {
                (true, None) => self.resting = false,
                (false, Some(since)) => self.seek_rest(since),
                _ => {}
            }
        }
    }

    fn publish_moving(&mut self, problem: &Problem, published: &mut [Coefficient], output: &mut Output) {
        for (free, place) in problem.free.iter().enumerate() {
            let (value, std) = self.moving.coefficient(free);
            (published[*place].value, published[*place].std) = (value, Some(std));
        }
        output.valid = self.moving.stated_error() < TRUSTED;
        output.status = if output.valid { Status::Tracking } else { Status::Acquiring };
        if output.valid {
            output.identified_time.get_or_insert(self.now());
        }
    }
}
