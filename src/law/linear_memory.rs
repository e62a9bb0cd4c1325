//! Memories that are linear in the motion or in the excitation, between samples: a hidden mass, a Maxwell element, an
//! actuator that lags.

use super::effect::Effect;
use super::history::History;
use super::hold::Hold;
use super::memory::{LARGEST, lagged};
use super::series::Trajectory;

/// Mean of a force over an interval, and its first moment about the middle, the interval being 1.
pub(super) type Moments = [f64; 2];

/// Angle, rad, below which sin x ÷ x and cos x are taken as 1: what is left out, x² ÷ 2, is 5e-13.
const SMALL_ANGLE: f64 = 1e-6;

impl Effect {
    /// Moments over every interval of a motion that begins with these internal states; `bends` is by how much q̈
    /// changes, m/s². None of an effect without a linear memory.
    pub(super) fn linear_moments(
        self,
        trajectory: &Trajectory,
        bends: &[f64],
        memory: [f64; LARGEST],
    ) -> Option<Vec<Moments>> {
        match self {
            Effect::Relaxation { time } => Some(relaxed(time.value(), trajectory, bends, memory[0])),
            Effect::ActuatorLag { time } => Some(actuated(time.value(), trajectory, memory[0])),
            Effect::HiddenResonator { frequency, damping_ratio } => {
                let mass = HiddenMass { frequency: frequency.value(), damping_ratio: damping_ratio.value() };
                Some(mass.carried(trajectory, bends, memory))
            }
            _ => None,
        }
    }
}

/// A mass that the coordinate carries on a spring. With w = y − q, ẅ + 2ζΩ ẇ + Ω² w = −q̈, which is solved exactly
/// where q̈ is a straight line over an interval; mean and first moment of ÿ follow from y and ẏ at its ends.
struct HiddenMass {
    frequency: f64,
    damping_ratio: f64,
}

impl HiddenMass {
    fn carried(&self, trajectory: &Trajectory, bends: &[f64], [y, yd]: [f64; LARGEST]) -> Vec<Moments> {
        let Trajectory { t, q, qd, .. } = *trajectory;
        let mut relative = [y - q[0], yd - qd[0]];
        let (mut width, mut propagator) = (f64::NAN, [[0.0; 2]; 2]);
        let interval = |k: usize| {
            let dt = t[k + 1] - t[k];
            if dt != width {
                (width, propagator) = (dt, self.propagator(dt));
            }
            let slope = bends[k] / dt;
            let next = self.step(relative, propagator, [(qd[k + 1] - qd[k]) / dt - 0.5 * bends[k], slope], dt);
            let (from, to) = ([q[k] + relative[0], qd[k] + relative[1]], [q[k + 1] + next[0], qd[k + 1] + next[1]]);
            relative = next;
            [(to[1] - from[1]) / dt, 0.5 * (to[1] + from[1]) / dt - (to[0] - from[0]) / (dt * dt)]
        };
        (0..t.len() - 1).map(interval).collect()
    }

    /// (w, ẇ) after an interval in which q̈ is `line[0] + line[1] t`.
    fn step(&self, [w, wd]: [f64; 2], [[a, b], [c, d]]: [[f64; 2]; 2], line: [f64; 2], dt: f64) -> [f64; 2] {
        let stiffness = self.frequency * self.frequency;
        let slope = -line[1] / stiffness;
        let offset = -(line[0] + 2.0 * self.damping_ratio * self.frequency * slope) / stiffness;
        let (w, wd) = (w - offset, wd - slope);
        [a * w + b * wd + offset + slope * dt, c * w + d * wd + slope]
    }

    /// What a free motion of that length does to (w, ẇ).
    fn propagator(&self, dt: f64) -> [[f64; 2]; 2] {
        let stiffness = self.frequency * self.frequency;
        let decay = self.damping_ratio * self.frequency;
        let left = stiffness - decay * decay;
        let rate = left.abs().sqrt();
        let (even, odd) = match rate * dt {
            small if small < SMALL_ANGLE => (1.0, dt),
            angle if left > 0.0 => (angle.cos(), angle.sin() / rate),
            angle => (angle.cosh(), angle.sinh() / rate),
        };
        let shrunk = (-decay * dt).exp();
        [[even + decay * odd, odd], [-stiffness * odd, even - decay * odd]].map(|row| row.map(|entry| shrunk * entry))
    }
}

/// w with τ ẇ = q̇ − w: its mean and first moment follow from those of q̇ and from w at both ends.
fn relaxed(time: f64, trajectory: &Trajectory, bends: &[f64], mut w: f64) -> Vec<Moments> {
    let Trajectory { t, q, qd, .. } = *trajectory;
    let interval = |k: usize| {
        let dt = t[k + 1] - t[k];
        let bend = 0.5 * bends[k] / dt;
        let next = lagged(w, time, [qd[k], (qd[k + 1] - qd[k]) / dt - bend * dt, bend], dt);
        let mean = (q[k + 1] - q[k] - time * (next - w)) / dt;
        let moment = (qd[k + 1] - qd[k]) / 12.0 - time * (0.5 * (w + next) - mean) / dt;
        w = next;
        [mean, moment]
    };
    (0..t.len() - 1).map(interval).collect()
}

/// F − F_a = τ Ḟ_a, F the parabola through its values at both ends of an interval and in its middle.
fn actuated(time: f64, trajectory: &Trajectory, mut acting: f64) -> Vec<Moments> {
    let (t, samples) = (trajectory.t, trajectory.samples());
    let interval = |k: usize| {
        let dt = t[k + 1] - t[k];
        let [from, middle, to] = match trajectory.hold {
            Hold::Zero => [trajectory.excitation[k]; 3],
            _ => samples.over(t[k], t[k + 1]),
        };
        let bend = 2.0 * (from + to - 2.0 * middle) / (dt * dt);
        let next = lagged(acting, time, [from, (to - from) / dt - bend * dt, bend], dt);
        let rise = next - acting;
        let mean = (from + 4.0 * middle + to) / 6.0 - time * rise / dt;
        let moment = time * (0.5 * (acting + next) - mean) / dt;
        acting = next;
        [time * rise / dt, moment]
    };
    (0..t.len() - 1).map(interval).collect()
}
