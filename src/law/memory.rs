//! Internal states of effects with memory, and how they follow a motion.
//!
//! Hysteresis and presliding friction have z (m), friction with backlash e (m), relaxation w (m/s), the actuator F_a
//! (N), the hidden resonator y (m) and ẏ (m/s); the equations stand in [`super::effect`]. At rest z = e = w = 0, F_a is
//! the excitation that has acted so far, and the hidden mass moves with the coordinate.

use super::effect::Effect;
use super::motion::State;
use super::pointwise::sign;

/// The most internal states of one effect.
pub(super) const LARGEST: usize = 2;

impl Effect {
    /// How many internal states the effect has; a delayed excitation remembers the excitation, not the motion, and has
    /// none.
    pub fn memory_length(self) -> usize {
        match self {
            Effect::Hysteresis { .. }
            | Effect::PreslidingFriction { .. }
            | Effect::FrictionWithBacklash { .. }
            | Effect::Relaxation { .. }
            | Effect::ActuatorLag { .. } => 1,
            Effect::HiddenResonator { .. } => 2,
            _ => 0,
        }
    }

    /// Time in which what is stored in a linear memory fades to its e-th part, s; none of a loop, which has none.
    pub(super) fn fading_time(self) -> Option<f64> {
        match self {
            Effect::Relaxation { time } | Effect::ActuatorLag { time } => Some(time.value()),
            Effect::HiddenResonator { frequency, damping_ratio } => {
                Some((frequency.value() * damping_ratio.value()).recip())
            }
            _ => None,
        }
    }

    /// The internal states when nothing is stored in them.
    pub(super) fn rest(self, state: State, excitation: f64) -> [f64; LARGEST] {
        match self {
            Effect::ActuatorLag { .. } => [excitation, 0.0],
            Effect::HiddenResonator { .. } => [state.q, state.qd],
            _ => [0.0; LARGEST],
        }
    }

    /// The feature of an effect with internal states, at a state of the coordinate under an excitation.
    #[inline]
    pub(super) fn feature(self, state: State, excitation: f64, memory: &[f64]) -> f64 {
        match (self, memory) {
            (Effect::Hysteresis { .. }, [z, ..]) => *z,
            (Effect::HiddenResonator { frequency, damping_ratio }, [y, yd, ..]) => {
                let (omega, zeta) = (frequency.value(), damping_ratio.value());
                omega * omega * (state.q - y) + 2.0 * zeta * omega * (state.qd - yd)
            }
            (Effect::PreslidingFriction { slip_length }, [z, ..]) => z / slip_length.value(),
            (Effect::FrictionWithBacklash { slip_length, gap }, [e, ..]) => {
                beyond(*e, gap.value()) / slip_length.value()
            }
            (Effect::Relaxation { .. }, [w, ..]) => *w,
            (Effect::ActuatorLag { .. }, [acting, ..]) => excitation - acting,
            _ => f64::NAN,
        }
    }

    /// The rates of the internal states.
    #[inline]
    pub(super) fn memory_slope(self, state: State, excitation: f64, memory: &[f64]) -> [f64; LARGEST] {
        match (self, memory) {
            (Effect::Hysteresis { yield_displacement, share, exponent }, [z, ..]) => {
                let shape =
                    Shape { limit: yield_displacement.value(), share: share.value(), exponent: exponent.value() };
                [shape.slope(state.qd, *z), 0.0]
            }
            (Effect::HiddenResonator { .. }, [_, yd, ..]) => [*yd, self.feature(state, excitation, memory)],
            (Effect::PreslidingFriction { .. } | Effect::FrictionWithBacklash { .. }, _) => {
                [state.qd - state.qd.abs() * self.feature(state, excitation, memory), 0.0]
            }
            (Effect::Relaxation { time }, [w, ..]) => [(state.qd - w) / time.value(), 0.0],
            (Effect::ActuatorLag { time }, _) => [self.feature(state, excitation, memory) / time.value(), 0.0],
            _ => [0.0; LARGEST],
        }
    }

    /// How fast the internal states change at most at this speed of the coordinate, 1/s.
    pub(super) fn memory_rate(self, qd: f64) -> f64 {
        match self {
            Effect::Hysteresis { yield_displacement, share, exponent } => {
                qd.abs() * exponent.value() * share.value().max(1.0) / yield_displacement.value()
            }
            Effect::HiddenResonator { frequency, damping_ratio } => {
                frequency.value() * (1.0 + 2.0 * damping_ratio.value())
            }
            Effect::PreslidingFriction { slip_length } | Effect::FrictionWithBacklash { slip_length, .. } => {
                qd.abs() / slip_length.value()
            }
            Effect::Relaxation { time } | Effect::ActuatorLag { time } => time.value().recip(),
            _ => 0.0,
        }
    }
}

/// What of a displacement is beyond a gap on both sides.
#[inline]
fn beyond(displacement: f64, gap: f64) -> f64 {
    sign(displacement) * (displacement.abs() - gap).max(0.0)
}

/// y after an interval of τ ẏ = u − y, u = value + slope t + bend t²: y is then u − τ u̇ + τ² ü and a part that fades.
pub(super) fn lagged(y: f64, time: f64, [value, slope, bend]: [f64; 3], dt: f64) -> f64 {
    let own = |t: f64| value + t * (slope + t * bend) - time * (slope + 2.0 * t * bend) + 2.0 * time * time * bend;
    own(dt) + (y - own(0.0)) * (-dt / time).exp()
}

/// A Bouc–Wen loop.
struct Shape {
    limit: f64,
    share: f64,
    exponent: f64,
}

impl Shape {
    /// ż = q̇ − (s |q̇| |z|^(n−1) z + (1 − s) q̇ |z|^n) ÷ x_y^n.
    #[inline]
    fn slope(&self, qd: f64, z: f64) -> f64 {
        let ratio = z / self.limit;
        let filled = if self.exponent == 1.0 { ratio.abs() } else { ratio.abs().powf(self.exponent) };
        qd - filled * (self.share * qd.abs() * sign(z) + (1.0 - self.share) * qd)
    }
}

/// Rate × time of a part: Runge and Kutta's step of order 4 then errs by 0.25⁵ ÷ 120, 8e-6 of what changes.
const PER_PART: f64 = 0.25;

/// Most parts of a step, which bounds its work; a rate beyond belongs to an effect that follows the motion at once.
const MOST_PARTS: f64 = 1000.0;

/// Into how many equal parts a step is cut so that a rate of `rate` (1/s) is followed well.
pub(super) fn parts(rate: f64, dt: f64) -> usize {
    (rate * dt.abs() / PER_PART).ceil().clamp(1.0, MOST_PARTS) as usize
}
