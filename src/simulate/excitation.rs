//! What drives a plant.

use super::noise::{Stream, uniform};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Which excitation acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExcitationKind {
    /// None: free motion.
    None,
    /// P sin ωt with the amplitude and the angular frequency of the stage; the phase is that of the global time.
    #[default]
    Sine,
    /// Gaussian white noise of a given intensity.
    WhiteNoise,
    /// A sum of sines of equal amplitude with phases drawn from the seed, at equidistant angular frequencies.
    Multisine,
    /// A sine whose angular frequency runs linearly from `from` to `to` within `period`, then back, and so on.
    Sweep,
}

/// The excitation and the grid on which it is evaluated and held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Excitation {
    /// Which one.
    pub kind: ExcitationKind,
    /// Intensity 2D of the white noise, N² s: its variance on the grid is 2D ÷ `sample_time`.
    pub intensity: f64,
    /// Time between two points of the grid, s.
    pub sample_time: f64,
    /// Lowest angular frequency of multisine and sweep, rad/s.
    pub from: f64,
    /// Highest angular frequency of multisine and sweep, rad/s.
    pub to: f64,
    /// How many sines a multisine has.
    pub count: u32,
    /// RMS of multisine and sweep, N.
    pub rms: f64,
    /// How long a sweep takes from one end to the other, s.
    pub period: f64,
}

impl Default for Excitation {
    fn default() -> Excitation {
        Excitation {
            kind: ExcitationKind::Sine,
            intensity: 3.0,
            sample_time: 1e-3,
            from: 1.0,
            to: 20.0,
            count: 20,
            rms: 1.0,
            period: 20.0,
        }
    }
}

impl Excitation {
    /// The most sines that a multisine may have.
    pub const MAX_COUNT: u32 = 1000;

    /// The phases of the sines, rad; none for another excitation.
    pub(super) fn phases(&self, seed: u64) -> Vec<f64> {
        let count = if self.kind == ExcitationKind::Multisine { self.count } else { 0 };
        (0..count).map(|index| TAU * uniform(seed, Stream::Phase, index.into())).collect()
    }

    /// The multisine at t, s.
    pub(super) fn multisine(&self, phases: &[f64], t: f64) -> f64 {
        self.multisine_with_slope(phases, t)[0]
    }

    /// The multisine at t, s, and its derivative.
    pub(super) fn multisine_with_slope(&self, phases: &[f64], t: f64) -> [f64; 2] {
        let count = phases.len().max(1) as f64;
        let spacing = (self.to - self.from) / (count - 1.0).max(1.0);
        let scale = self.rms * (2.0 / count).sqrt();
        let frequencies = (0..phases.len()).map(|index| self.from + spacing * index as f64);
        let sums = frequencies.zip(phases).fold([0.0; 2], |[value, slope], (omega, phase)| {
            let angle = omega * t + phase;
            [value + angle.sin(), slope + omega * angle.cos()]
        });
        sums.map(|sum| scale * sum)
    }

    /// The sweep at t, s.
    pub(super) fn sweep(&self, t: f64) -> f64 {
        self.sweep_with_slope(t)[0]
    }

    /// The sweep at t, s, and its derivative.
    pub(super) fn sweep_with_slope(&self, t: f64) -> [f64; 2] {
        let (period, rate) = (self.period, (self.to - self.from) / self.period);
        let rounds = (t / (2.0 * period)).floor();
        let within = t - rounds * 2.0 * period;
        let up = within.min(period);
        let down = within - up;
        let phase = rounds * (self.from + self.to) * period
            + (self.from + 0.5 * rate * up) * up
            + (self.to - 0.5 * rate * down) * down;
        let omega = if down > 0.0 { self.to - rate * down } else { self.from + rate * up };
        let amplitude = 2.0_f64.sqrt() * self.rms;
        [amplitude * phase.sin(), amplitude * omega * phase.cos()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_multisine_has_its_rms_and_only_its_frequencies() {
        let excitation = Excitation {
            kind: ExcitationKind::Multisine,
            from: 2.0,
            to: 8.0,
            count: 7,
            rms: 1.5,
            ..Default::default()
        };
        let phases = excitation.phases(3);
        assert_ne!(phases, excitation.phases(4));
        let count = 4000;
        let t = |index: usize| TAU * index as f64 / count as f64;
        let values: Vec<f64> = (0..count).map(|index| excitation.multisine(&phases, t(index))).collect();
        let rms = (values.iter().map(|value| value * value).sum::<f64>() / count as f64).sqrt();
        assert!((rms - 1.5).abs() < 1e-9, "{rms}");
        for harmonic in 1..12 {
            let wave = |trigonometric: fn(f64) -> f64| {
                let products = values
                    .iter()
                    .enumerate()
                    .map(|(index, value)| value * trigonometric(f64::from(harmonic) * t(index)));
                products.sum::<f64>() * 2.0 / count as f64
            };
            let expected = if (2..=8).contains(&harmonic) { 1.5 * (2.0_f64 / 7.0).sqrt() } else { 0.0 };
            assert!((wave(f64::sin).hypot(wave(f64::cos)) - expected).abs() < 1e-9, "harmonic {harmonic}");
        }
    }

    #[test]
    fn a_sweep_runs_up_and_down_without_a_jump() {
        let sweep = Excitation { kind: ExcitationKind::Sweep, from: 1.0, to: 9.0, period: 5.0, ..Default::default() };
        let (dt, amplitude) = (1e-4, 2.0_f64.sqrt());
        for index in 1..200_000 {
            let t = f64::from(index) * dt;
            let across = (t / 5.0).rem_euclid(2.0);
            let omega = 1.0 + 8.0 * if across < 1.0 { across } else { 2.0 - across };
            let slope = (sweep.sweep(t) - sweep.sweep(t - dt)) / dt;
            assert!(slope.hypot(omega * sweep.sweep(t)) < amplitude * (omega + 0.02), "t = {t}");
            assert!(slope.hypot(omega * sweep.sweep(t)) > amplitude * (omega - 0.02), "t = {t}");
        }
    }
}
