//! Excitations, as values at the samples, or as a scenario's.

use super::generator::Generator;
use std::f64::consts::TAU;
use switchid::simulate::{Excitation, ExcitationKind};

/// Kinds of excitation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Sines at many frequencies with random phases.
    Multisine,
    /// Gaussian noise, white in a scenario, else with little power above three times the natural frequency.
    Noise,
    /// A sine whose frequency runs up and down.
    Sweep,
}

/// Lowest and highest frequency of multisine and sweep, as parts of the natural frequency.
const BAND: [f64; 2] = [0.15, 2.2];

/// Sines in a multisine.
const SINES: u32 = 14;

/// Times a sweep runs from one end to the other within a record.
const RUNS: f64 = 4.0;

impl Drive {
    /// All kinds.
    pub const ALL: [Drive; 3] = [Drive::Multisine, Drive::Noise, Drive::Sweep];

    /// Unit RMS values at samples `sample_time` apart, natural frequency `omega`.
    pub fn values(self, generator: &mut Generator, omega: f64, sample_time: f64, count: usize) -> Vec<f64> {
        let t = (0..count).map(|index| index as f64 * sample_time);
        let values: Vec<f64> = match self {
            Drive::Multisine => {
                let width = (BAND[1] - BAND[0]) / f64::from(SINES);
                let mut sine = |index: u32| {
                    let place = f64::from(index) + generator.uniform(0.0..1.0);
                    (omega * (BAND[0] + width * place), generator.uniform(0.0..TAU))
                };
                let sines: Vec<(f64, f64)> = (0..SINES).map(&mut sine).collect();
                t.map(|t| sines.iter().map(|(omega, phase)| (omega * t + phase).sin()).sum()).collect()
            }
            Drive::Noise => low_passed(generator, 3.0 * omega * sample_time, count),
            Drive::Sweep => {
                let (from, to, period) = (BAND[0] * omega, BAND[1] * omega, count as f64 * sample_time / RUNS);
                let rate = (to - from) / period;
                let middle = 0.5 * (from + to);
                t.map(|t| {
                    let (rounds, within) = ((t / period).floor(), t % period);
                    let rises = rounds % 2.0 == 0.0;
                    let (start, slope) = if rises { (from, rate) } else { (to, -rate) };
                    (rounds * middle * period + (start + 0.5 * slope * within) * within).sin()
                })
                .collect()
            }
        };
        let rms = rms(&values);
        values.into_iter().map(|value| value / rms).collect()
    }

    /// The excitation of a scenario of unit RMS.
    pub fn of_scenario(self, omega: f64, sample_time: f64, count: usize) -> Excitation {
        let kind = match self {
            Drive::Multisine => ExcitationKind::Multisine,
            Drive::Noise => ExcitationKind::WhiteNoise,
            Drive::Sweep => ExcitationKind::Sweep,
        };
        Excitation {
            kind,
            intensity: sample_time,
            sample_time,
            from: BAND[0] * omega,
            to: BAND[1] * omega,
            count: SINES,
            rms: 1.0,
            period: count as f64 * sample_time / RUNS,
        }
    }
}

/// White noise through two low-pass filters of that cut-off, radians per sample.
pub fn low_passed(generator: &mut Generator, cutoff: f64, count: usize) -> Vec<f64> {
    let share = 1.0 - (-cutoff).exp();
    let mut stages = [0.0; 2];
    let mut next = || {
        stages[0] += share * (generator.normal() - stages[0]);
        stages[1] += share * (stages[0] - stages[1]);
        stages[1]
    };
    (0..count).map(|_| next()).collect()
}

/// √ of the mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Standard deviation.
pub fn std(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    rms(&values.iter().map(|value| value - mean).collect::<Vec<f64>>())
}
