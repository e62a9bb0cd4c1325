//! The free motion of a law with memory, delay or a user's expression.
//!
//! Where the memory stands at an instant within the record is told by the motion up to there: it is carried along the
//! smoothed states, from rest at the first. Sensitivities to the state at the start are differences of two motions.

use super::rows::Prepared;
use crate::law::{Dynamics, Expression, MAX_MEMORY, Motion, Phase, Samples, State};

/// Part of the largest reading by which a state is moved to see what it does.
const NUDGE: f64 = 1e-5;

/// A law with memory over a piece.
pub(super) struct MemoryRun<'a> {
    dynamics: Dynamics<'a>,
    excitation: Samples<'a>,
    /// Internal states at every sample.
    memories: Vec<[f64; MAX_MEMORY]>,
    nudge: [f64; 2],
}

/// Where a motion is, and where it would be from a little further in q and in q̇.
pub(super) struct Beside {
    phases: [Phase; 3],
    nudge: [f64; 2],
}

impl<'a> MemoryRun<'a> {
    /// Over a piece whose readings are at most this large; none where the law cannot be integrated.
    pub(super) fn new(
        prepared: &'a Prepared,
        motion: Motion<'a>,
        expressions: &'a [Expression],
        largest: [f64; 2],
    ) -> Option<MemoryRun<'a>> {
        let dynamics = Dynamics::new(motion.with(expressions)).ok()?;
        let piece = &prepared.piece;
        let excitation = Samples { t: &piece.t, excitation: &piece.excitation, hold: piece.hold };
        let smoothed = |k: usize| State { q: prepared.motion.q[k], qd: prepared.motion.qd[k] };
        let mut phase = dynamics.rest(smoothed(0));
        let mut memories = vec![phase.memory];
        for (k, times) in piece.t.windows(2).enumerate() {
            phase = dynamics.step(&phase, times[0], times[1] - times[0], &excitation);
            phase.state = smoothed(k + 1);
            memories.push(phase.memory);
        }
        let nudge = largest.map(|value| (NUDGE * value).max(f64::MIN_POSITIVE));
        Some(MemoryRun { dynamics, excitation, memories, nudge })
    }

    /// From a state at the sample of that number.
    pub(super) fn begin(&self, state: State, index: usize) -> Beside {
        let memory = self.memories[index];
        let moved = |dq: f64, dqd: f64| Phase { state: State { q: state.q + dq, qd: state.qd + dqd }, memory };
        Beside { phases: [moved(0.0, 0.0), moved(self.nudge[0], 0.0), moved(0.0, self.nudge[1])], nudge: self.nudge }
    }

    /// Over the interval of that number.
    pub(super) fn advance(&self, motion: &mut Beside, interval: usize) {
        let (from, to) = (self.excitation.t[interval], self.excitation.t[interval + 1]);
        motion.phases = motion.phases.map(|phase| self.dynamics.step(&phase, from, to - from, &self.excitation));
    }
}

impl Beside {
    /// The state, and its sensitivity to that at the start.
    pub(super) fn state(&self) -> (State, [[f64; 2]; 2]) {
        let [state, from_q, from_qd] = self.phases.map(|phase| phase.state);
        let column = |other: State, nudge: f64| [(other.q - state.q) / nudge, (other.qd - state.qd) / nudge];
        let [first, second] = [column(from_q, self.nudge[0]), column(from_qd, self.nudge[1])];
        (state, [[first[0], second[0]], [first[1], second[1]]])
    }
}
