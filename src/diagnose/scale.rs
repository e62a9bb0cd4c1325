//! How large and how fast a motion is, and between which values of an inner parameter it can tell.

use super::piece::Piece;
use crate::law::{Effect, State};
use std::f64::consts::PI;

/// How large and how fast the recorded motion is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Largest |q|.
    pub displacement: f64,
    /// Largest distance of q from its mean.
    pub excursion: f64,
    /// Largest |q̇|.
    pub velocity: f64,
    /// RMS q̇ ÷ RMS q, of q about its mean, and RMS q̈ ÷ RMS q̇, rad/s: where the motion's power lies.
    pub frequency: [f64; 2],
    /// Shortest time between samples, s.
    pub sample_time: f64,
    /// Longest time without a gap, s.
    pub duration: f64,
}

impl Scale {
    /// The scale of smoothed motions.
    pub fn of(pieces: &[Piece], states: &[Vec<State>]) -> Scale {
        let all = || states.iter().flatten();
        let largest = |value: fn(&State) -> f64| all().map(|state| value(state).abs()).fold(0.0, f64::max);
        let power = |value: fn(&State) -> f64| all().map(|state| value(state).powi(2)).sum::<f64>();
        let steps = pieces.iter().zip(states).flat_map(|(piece, states)| {
            piece.t.windows(2).zip(states.windows(2)).map(|(t, s)| ((s[1].qd - s[0].qd) / (t[1] - t[0])).powi(2))
        });
        let accelerations: f64 = steps.sum();
        let times = pieces.iter().flat_map(|piece| piece.t.windows(2).map(|t| t[1] - t[0]));
        let count = all().count().max(1) as f64;
        let mean = all().map(|state| state.q).sum::<f64>() / count;
        let excursion = all().map(|state| (state.q - mean).abs()).fold(0.0, f64::max);
        let [q, qd] = [power(|state| state.q) - count * mean * mean, power(|state| state.qd)];
        Scale {
            displacement: largest(|state| state.q),
            excursion,
            velocity: largest(|state| state.qd),
            frequency: [(qd / q).sqrt(), (accelerations / qd).sqrt()],
            sample_time: times.fold(f64::INFINITY, f64::min),
            duration: pieces.iter().map(|piece| piece.t[piece.t.len() - 1] - piece.t[0]).fold(0.0, f64::max),
        }
    }

    /// Whether the record shows such an effect as what it is. A resonance whose half-power width 2ζω is less than the
    /// record's resolution 2π ÷ its duration is a single line of its spectrum: any disturbance of that frequency, too.
    pub fn resolves(&self, effect: Effect) -> bool {
        match effect {
            Effect::HiddenResonator { frequency, damping_ratio } => {
                damping_ratio.value() * frequency.value() * self.duration >= PI
            }
            _ => true,
        }
    }

    /// Between which values of an inner parameter the motion can tell: beyond them the effect is another of the
    /// catalogue, or none.
    pub fn limits(&self, effect: Effect, parameter: usize) -> [f64; 2] {
        let [slow, fast] = self.frequency;
        let times = |scale: f64, from: f64, to: f64| [from * scale, to * scale];
        match (effect, parameter) {
            (Effect::StribeckFriction { .. }, _) => times(self.velocity, 1e-3, 2.0),
            (Effect::DeadZoneStiffness { .. } | Effect::OneSidedStop { .. }, _) => times(self.displacement, 1e-3, 1.0),
            (Effect::ExcitationDelay { .. }, _) => [1e-3 * self.sample_time, 3.0 / slow],
            (Effect::Hysteresis { .. }, 0) => times(self.excursion, 1e-3, 4.0),
            (Effect::Hysteresis { .. }, 1) => [0.5, 4.0],
            (Effect::Hysteresis { .. }, _) => [1.0, 8.0],
            (Effect::PreslidingFriction { .. } | Effect::FrictionWithBacklash { .. }, 0) => {
                times(self.excursion, 1e-3, 4.0)
            }
            (Effect::FrictionWithBacklash { .. }, _) => times(self.excursion, 1e-3, 1.0),
            // from a half to as many ripples as four samples each show at full speed
            (Effect::Cogging { .. }, 0) => [0.5 * PI / self.excursion, 0.5 * PI / (self.velocity * self.sample_time)],
            (Effect::Cogging { .. }, _) => [f64::NEG_INFINITY, f64::INFINITY],
            (Effect::Relaxation { .. }, _) => [0.1 / fast, 10.0 / slow],
            (Effect::ActuatorLag { .. }, _) => [1e-3 * self.sample_time, 3.0 / slow],
            (Effect::HiddenResonator { .. }, 0) => [0.1 * slow, 3.0 / self.sample_time],
            (Effect::HiddenResonator { .. }, _) => [5e-3, 2.0],
            _ => [0.0, f64::INFINITY],
        }
    }
}
