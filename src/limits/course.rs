//! What a law runs through: times, excitation, motion; and the sensors that look at it.

use super::error::LimitsError;
use crate::law::{Drive, Motion, State};

/// Angle, rad, by which the motion may turn in a step of integration: one of order 4 then errs by 0.2⁵ ÷ 120, 3e-6 of
/// it.
pub const TURN: f64 = 0.2;

/// Most steps of integration between two samples: 51 rad at [`TURN`], eight periods, which no record resolves.
const MOST_PARTS: f64 = 256.0;

/// A stretch of a record without gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// Times of the samples, s.
    pub t: Vec<f64>,
    /// The excitation from sample k to k + 1; one fewer than times.
    pub drives: Vec<Drive>,
    /// The motion at the samples, about which sensitivities are taken; as many as times.
    pub states: Vec<State>,
}

/// Std of the sensors' noise, q in m and q̇ in m/s; `None` for a quantity that is not measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors(pub [Option<f64>; 2]);

impl Sensors {
    /// Checks that there is one, and that each has noise.
    ///
    /// # Errors
    /// [`LimitsError::NothingMeasured`], [`LimitsError::Noise`].
    pub fn check(self) -> Result<(), LimitsError> {
        if self.0 == [None; 2] {
            return Err(LimitsError::NothingMeasured);
        }
        for (std, channel) in self.0.into_iter().zip(["q", "qd"]) {
            match std {
                Some(std) if !(std > 0.0 && std.is_finite()) => return Err(LimitsError::Noise { channel, std }),
                _ => {}
            }
        }
        Ok(())
    }
}

impl Course {
    /// A law's own motion from a state: at the times `t`, s, under one drive fewer than times.
    pub fn own(motion: &Motion, start: State, t: Vec<f64>, drives: Vec<Drive>) -> Course {
        let mut course = Course { t, drives, states: vec![start] };
        for k in 0..course.drives.len() {
            let next = course.advanced(motion, course.states[k], k);
            course.states.push(next);
        }
        course
    }

    /// The state of a law at sample k + 1 that was at `state` at sample k.
    pub(super) fn advanced(&self, motion: &Motion, state: State, k: usize) -> State {
        let dt = self.dt(k);
        let parts = parts(motion, state, self.drives[k].at(0.5), dt);
        let width = dt / parts as f64;
        let edge = |part: usize| self.drives[k].at(part as f64 / parts as f64);
        (0..parts).fold(state, |state, part| motion.step_linear(state, width, edge(part), edge(part + 1)))
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Largest |q| and |q̇|.
    pub(super) fn largest(&self) -> [f64; 2] {
        let largest = |value: fn(&State) -> f64| self.states.iter().map(value).fold(0.0, f64::max);
        [largest(|state| state.q.abs()), largest(|state| state.qd.abs())]
    }

    /// Time from sample k to k + 1, s.
    pub(super) fn dt(&self, k: usize) -> f64 {
        self.t[k + 1] - self.t[k]
    }
}

/// Steps of integration in which a law moves by `dt` from here.
pub(super) fn parts(motion: &Motion, state: State, excitation: f64, dt: f64) -> usize {
    let [by_q, by_qd] = motion.acceleration_gradient(state, excitation);
    let turn = (by_q.abs() * dt * dt).sqrt().max(by_qd.abs() * dt);
    (turn / TURN).ceil().clamp(1.0, MOST_PARTS) as usize
}
