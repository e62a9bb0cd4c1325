//! What measures a motion: ideal sensors, or those of a usual rig.

use super::drive::{low_passed, rms, std};
use super::generator::Generator;
use super::plant::Track;
use std::f64::consts::{PI, SQRT_2, TAU};
use switchid::law::Hold;

/// Kinds of sensors, and how fast the motion is for them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Sensors {
    /// 35 to 80 samples per natural period, q̇ measured by itself or not at all, F in time, nothing lost or disturbed.
    #[default]
    Ideal,
    /// An encoder, q̇ from its differences, F late, lost samples, a disturbance; 400 samples per natural period.
    Slow,
    /// The same sensors; 50 samples per natural period.
    Fast,
}

/// Sample time of a usual rig, s.
const SAMPLE_TIME: f64 = 5e-3;

/// Natural period of a slow and of a fast motion, s.
const PERIODS: [f64; 2] = [2.0, 0.25];

/// Encoder steps in the amplitude of q.
const STEPS: f64 = 500.0;

/// Cut-off of the low-pass behind the differences ÷ half the sampling frequency.
const CUTOFF: f64 = 0.2;

/// Delay of F, samples: 5 ms.
const LATE: usize = 1;

/// Share of samples that are lost.
const LOST: f64 = 0.03;

/// RMS of the unmeasured disturbance ÷ RMS of F.
const DISTURBANCE: f64 = 0.05;

/// What the sensors show.
#[derive(Clone, Debug)]
pub struct Readings {
    pub t: Vec<f64>,
    pub q: Vec<f64>,
    pub qd: Option<Vec<f64>>,
    pub excitation: Vec<f64>,
    /// The excitation less the force that no term gives.
    pub relieved: Vec<f64>,
}

impl Sensors {
    /// Angular natural frequency of a plant, rad/s.
    pub fn omega(self, generator: &mut Generator) -> f64 {
        match self {
            Sensors::Ideal => generator.decades(2.0..40.0),
            Sensors::Slow => TAU / (PERIODS[0] * generator.uniform(0.9..1.1)),
            Sensors::Fast => TAU / (PERIODS[1] * generator.uniform(0.9..1.1)),
        }
    }

    /// Sample time for a plant of that natural frequency, s.
    pub fn sample_time(self, generator: &mut Generator, omega: f64) -> f64 {
        match self {
            Sensors::Ideal => TAU / omega / generator.uniform(35.0..80.0),
            Sensors::Slow | Sensors::Fast => SAMPLE_TIME,
        }
    }

    /// What the excitation does between samples, where the plant is no scenario.
    pub fn hold(self, generator: &mut Generator) -> Hold {
        match self {
            Sensors::Ideal => Hold::Linear,
            Sensors::Slow | Sensors::Fast => generator.choose(&[Hold::Zero, Hold::Linear]),
        }
    }

    /// A force at samples that nothing measures, ÷ RMS of F; empty where there is none.
    pub fn disturbance(self, generator: &mut Generator, omega: f64, count: usize) -> Vec<f64> {
        if self == Sensors::Ideal {
            return Vec::new();
        }
        // from well below the natural frequency to above it
        let cutoff = generator.decades(0.3..3.0) * omega * SAMPLE_TIME;
        let noise = low_passed(generator, cutoff, count);
        let scale = DISTURBANCE / rms(&noise);
        noise.into_iter().map(|value| value * scale).collect()
    }

    /// Measures a motion, whose samples before `lead` are not recorded, with Gaussian noise of `noise` times each
    /// channel's std.
    pub fn read(self, generator: &mut Generator, noise: f64, track: Track, lead: usize) -> Readings {
        match self {
            Sensors::Ideal => Readings::ideal(generator, noise, track.from(lead)),
            Sensors::Slow | Sensors::Fast => Readings::usual(generator, noise, &track, lead),
        }
    }
}

impl Readings {
    fn ideal(generator: &mut Generator, noise: f64, track: Track) -> Readings {
        let (q, qd) = (noisy(generator, noise, &track.q), noisy(generator, noise, &track.qd));
        let velocity = generator.chance(0.5);
        let relieved = relieved(&track);
        Readings { t: track.t, q, qd: velocity.then_some(qd), excitation: track.excitation, relieved }
    }

    fn usual(generator: &mut Generator, noise: f64, track: &Track, lead: usize) -> Readings {
        let q = stepped(&noisy(generator, noise, &track.q), generator.uniform(0.0..1.0));
        let qd = smoothed(&differences(&q, SAMPLE_TIME));
        let (excitation, relieved) = (late(&track.excitation), late(&relieved(track)));
        let kept: Vec<usize> = (lead..track.t.len()).filter(|_| !generator.chance(LOST)).collect();
        let only = |signal: &[f64]| kept.iter().map(|index| signal[*index]).collect::<Vec<f64>>();
        let (t, relieved) = (only(&track.t), only(&relieved));
        Readings { t, q: only(&q), qd: Some(only(&qd)), excitation: only(&excitation), relieved }
    }
}

fn noisy(generator: &mut Generator, noise: f64, signal: &[f64]) -> Vec<f64> {
    let deviation = noise * std(signal);
    signal.iter().map(|value| value + deviation * generator.normal()).collect()
}

fn relieved(track: &Track) -> Vec<f64> {
    track.excitation.iter().zip(&track.outside).map(|(force, outside)| force - outside).collect()
}

/// An encoder with [`STEPS`] in the amplitude, its zero at that part of a step.
fn stepped(q: &[f64], zero: f64) -> Vec<f64> {
    let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(*q), high.max(*q)));
    let step = 0.5 * (high - low) / STEPS;
    q.iter().map(|q| (q / step + zero).floor() * step).collect()
}

/// Differences to the sample before, per second.
fn differences(q: &[f64], sample_time: f64) -> Vec<f64> {
    let before = q.iter().take(1).chain(q);
    q.iter().zip(before).map(|(now, before)| (now - before) / sample_time).collect()
}

/// Butterworth's causal low-pass of second order at [`CUTOFF`], by the bilinear transform.
fn smoothed(signal: &[f64]) -> Vec<f64> {
    let k = (0.5 * PI * CUTOFF).tan();
    let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let (gain, first, second) = (k * k * scale, 2.0 * (k * k - 1.0) * scale, (1.0 - SQRT_2 * k + k * k) * scale);
    let mut state = [0.0; 2];
    let mut next = |value: &f64| {
        let output = gain * value + state[0];
        state = [2.0 * gain * value - first * output + state[1], gain * value - second * output];
        output
    };
    signal.iter().map(&mut next).collect()
}

/// The signal [`LATE`] samples late; before its start it is 0.
fn late(signal: &[f64]) -> Vec<f64> {
    std::iter::repeat_n(&0.0, LATE).chain(signal).take(signal.len()).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of that period, s, with a force that no term gives.
    fn track(period: f64, count: usize) -> Track {
        let t: Vec<f64> = (0..count).map(|k| k as f64 * SAMPLE_TIME).collect();
        let of = |wave: &dyn Fn(f64) -> f64| t.iter().map(|t| wave(TAU / period * t)).collect::<Vec<f64>>();
        let (q, qd) = (of(&|angle| 3.0 * angle.sin()), of(&|angle| 3.0 * TAU / period * angle.cos()));
        Track { q, qd, excitation: of(&|angle| angle.cos()), outside: vec![0.25; count], t }
    }

    #[test]
    fn a_usual_rig_loses_samples_and_keeps_their_times() {
        let readings = Sensors::Slow.read(&mut Generator::new(1), 0.0, track(2.0, 20_000), 100);
        let share = 1.0 - readings.t.len() as f64 / 19_900.0;
        assert!((0.025..0.035).contains(&share), "{share}");
        assert!(readings.t[0] >= 0.5);
        let whole = |t: &f64| (t / SAMPLE_TIME - (t / SAMPLE_TIME).round()).abs() < 1e-6;
        assert!(readings.t.iter().all(whole));
    }

    #[test]
    fn an_encoder_has_its_steps_in_the_amplitude() {
        let readings = Sensors::Fast.read(&mut Generator::new(2), 0.0, track(0.25 * SQRT_2, 20_000), 0);
        let step = 3.0 / STEPS;
        let beside = |q: &f64| (q / step - (q / step).round()).abs();
        assert!(readings.q.iter().all(|q| beside(q) < 0.01), "all readings are whole steps");
        let mut values = readings.q.clone();
        values.sort_by(f64::total_cmp);
        values.dedup_by(|a, b| (*a - *b).abs() < 0.1 * step);
        assert!((900..1010).contains(&values.len()), "{} steps from end to end", values.len());
    }

    #[test]
    fn the_velocity_is_filtered_and_late() {
        let readings = Sensors::Slow.read(&mut Generator::new(3), 0.0, track(2.0, 20_000), 2000);
        let Some(qd) = readings.qd else { panic!("no velocity") };
        let omega = TAU / 2.0;
        // phase of the fundamental: half a sample of the difference, √2 ÷ the cut-off's angular frequency of the filter
        let angle = |signal: &[f64]| {
            let sum = |wave: &dyn Fn(f64) -> f64| -> f64 {
                readings.t.iter().zip(signal).map(|(t, value)| value * wave(omega * t)).sum()
            };
            sum(&f64::sin).atan2(sum(&f64::cos))
        };
        let delay = angle(&qd) / omega;
        let expected = 0.5 * SAMPLE_TIME + SQRT_2 * SAMPLE_TIME / (PI * CUTOFF);
        assert!((delay / expected - 1.0).abs() < 0.05, "{delay} s, expected {expected} s");
        let late = |(t, force): (&f64, &f64)| (force - (omega * (t - SAMPLE_TIME)).cos()).abs();
        let worst = readings.t.iter().zip(&readings.excitation).map(late).fold(0.0, f64::max);
        assert!(worst < 1e-9, "F is not 5 ms late: {worst}");
        let share = readings.relieved.iter().zip(&readings.excitation).map(|(less, force)| force - less);
        assert!(share.fold(0.0, |worst: f64, share| worst.max((share - 0.25).abs())) < 1e-12);
    }

    #[test]
    fn a_disturbance_has_its_share_of_the_force() {
        let disturbance = Sensors::Fast.disturbance(&mut Generator::new(4), 25.0, 5000);
        assert!((rms(&disturbance) - DISTURBANCE).abs() < 1e-12);
        assert!(Sensors::Ideal.disturbance(&mut Generator::new(4), 25.0, 5000).is_empty());
    }
}
