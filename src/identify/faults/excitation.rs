//! A reading of F that leaves its course and returns may be a glitch of its sensor or have acted; one that nothing can
//! have exerted is replaced.

use crate::estimation::SAMPLES_OF_A_VARIANCE;
use crate::identify::reading::Reading;
use crate::identify::sample::Sample;
use serde::{Deserialize, Serialize};

/// A reading of F further from the last one than so many times what F usually moves by leaves its course: Gaussian
/// excitation does so once in 10¹⁵ readings.
const JUMP: f64 = 8.0;

/// Readings after which it is known what F usually is …
const KNOWN: f64 = 100.0;

/// No actuator exerts this many times the RMS of what it has exerted.
const ABSURD: f64 = 1e6;

/// What is usual for F, and whether it has just left that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ExcitationGate {
    /// The last sample.
    last: Sample,
    /// Where F was before it left its course with the last reading.
    course: Option<f64>,
    /// Whether the last reading was replaced, or one before it was a glitch.
    faulty: bool,
    /// Intensity of the white force that a glitch just ended may not have been, N² s.
    glitch: f64,
    /// Mean squares of F, and of what it moves by.
    squares: [f64; 2],
    count: f64,
}

impl ExcitationGate {
    /// Takes a sample. The reading holds the white force that is left open for the interval: where the last F was
    /// replaced, and what was `missed` of one that moved by so much over so long.
    pub fn take(&mut self, sample: Sample, missed: impl Fn(f64, f64) -> f64) -> Reading {
        let (before, replaced) = (self.last, self.faulty && self.course.is_none());
        let force = sample.excitation;
        let absurd = self.count > KNOWN && (force.is_nan() || force.abs() > ABSURD * self.size());
        let force = if absurd { before.excitation } else { force };
        let moved = force - before.excitation;
        let leaves = self.leaves(moved);
        let returned = self.course.filter(|course| leaves && !self.leaves(force - course));
        let glitch = returned.map_or(0.0, |course| before.excitation - course);
        let scatter = if replaced { self.squares[1] } else { 0.0 };
        self.course = (leaves && returned.is_none()).then_some(before.excitation);
        self.faulty = absurd || returned.is_some();
        let sample = Sample { excitation: force, ..sample };
        self.learn(force, moved);
        self.last = sample;
        let dt = if self.count > 1.0 { sample.t - before.t } else { 0.0 };
        self.glitch = glitch * glitch * dt;
        Reading { unseen: scatter * dt + missed(dt, moved), ..Reading::from(sample) }
    }

    /// Intensity of the white force, N² s, that F was over the interval before, if it was a glitch of its sensor; 0
    /// where F kept its course.
    pub fn glitch(&self) -> f64 {
        self.glitch
    }

    /// RMS of F.
    pub fn size(&self) -> f64 {
        self.squares[0].sqrt()
    }

    /// Whether the last reading of F was replaced, or a glitch has just ended.
    pub fn is_faulty(&self) -> bool {
        self.faulty
    }

    fn leaves(&self, moved: f64) -> bool {
        self.count > KNOWN && moved * moved > JUMP * JUMP * self.squares[1]
    }

    /// A reading that leaves its course tells little of what is usual.
    fn learn(&mut self, force: f64, moved: f64) {
        self.count = (self.count + 1.0).min(SAMPLES_OF_A_VARIANCE);
        let moved = if self.count > 1.0 { moved * moved } else { 0.0 };
        let most = if self.count > KNOWN { JUMP * JUMP * self.squares[1] } else { f64::INFINITY };
        for (square, value) in self.squares.iter_mut().zip([force * force, moved.min(most)]) {
            *square += (value - *square) / self.count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(index: usize, excitation: f64) -> Sample {
        Sample { t: 1e-3 * index as f64, excitation, ..Sample::default() }
    }

    fn through(forces: &[f64]) -> Vec<Reading> {
        let mut gate = ExcitationGate::default();
        forces.iter().enumerate().map(|(index, force)| gate.take(sample(index, *force), |_, _| 0.0)).collect()
    }

    fn sine() -> Vec<f64> {
        (0..500).map(|index| (0.0015 * f64::from(index)).sin()).collect()
    }

    #[test]
    fn a_glitch_leaves_the_interval_after_it_open() {
        let mut forces = sine();
        forces[300] += 5.0;
        let mut gate = ExcitationGate::default();
        let glitches: Vec<f64> = (0..500)
            .map(|index| {
                assert_eq!(gate.take(sample(index, forces[index]), |_, _| 0.0).sample.excitation, forces[index]);
                gate.glitch()
            })
            .collect();
        let open: Vec<usize> = (0..500).filter(|index| glitches[*index] > 0.0).collect();
        assert_eq!(open, [301]);
        assert!((glitches[301] / (25.0 * 1e-3) - 1.0).abs() < 0.01);
    }

    #[test]
    fn what_nothing_can_exert_is_replaced_by_the_force_before_it() {
        for size in [1e100, -f64::MAX] {
            let mut forces = sine();
            forces[300] = size;
            let seen: Vec<f64> = through(&forces).iter().map(|reading| reading.sample.excitation).collect();
            forces[300] = forces[299];
            assert_eq!(seen, forces);
        }
    }

    #[test]
    fn a_step_is_no_glitch() {
        let mut forces = sine();
        forces[300..].iter_mut().for_each(|force| *force += 0.5);
        let mut gate = ExcitationGate::default();
        forces.iter().enumerate().for_each(|(index, force)| {
            gate.take(sample(index, *force), |_, _| 0.0);
            assert!(gate.glitch() == 0.0 && !gate.is_faulty());
        });
    }
}
