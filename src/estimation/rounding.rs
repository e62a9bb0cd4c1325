//! What a sensor rounds its readings to, from the readings themselves.
//!
//! All moves of a channel that is rounded are multiples of one step: their greatest common divisor, found as in
//! Euclid's algorithm. A reading rounded to steps of δ errs by δ ÷ √12 at least (Widrow, Kollár and Liu, *IEEE Trans.
//! Instrum. Meas.* 45 (1996), 353), however quiet its differences are. Readings that repeat one another err alike: all
//! of them together tell what one of them does, so that each has its variance times how many there are.

use super::odds::SAMPLES_OF_A_VARIANCE;
use serde::{Deserialize, Serialize};

/// A move that lies within this part of a step of a multiple is one: values of single precision, up to ten thousand
/// steps large, are.
const NEAR: f64 = 1e-3;

/// Moves in a row that are multiples before the step is believed: by chance one in 500 is.
const CERTAIN: u32 = 20;

/// The step of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rounding {
    last: Option<f64>,
    /// The greatest common divisor of all moves so far; 0 before the first.
    step: f64,
    /// Moves in a row that were multiples of it.
    multiples: u32,
    /// Readings since the last move.
    alike: u32,
    /// Mean logarithm of how many readings are alike, in which a rest counts once.
    log_alike: f64,
    moves: f64,
}

impl Rounding {
    /// Takes a reading; one that repeats the last says nothing.
    pub fn take(&mut self, value: f64) {
        let Some(last) = self.last.replace(value) else { return };
        let moved = (value - last).abs();
        self.alike = self.alike.saturating_add(1);
        if moved == 0.0 || !moved.is_finite() {
            return;
        }
        self.moves = (self.moves + 1.0).min(SAMPLES_OF_A_VARIANCE);
        self.log_alike += (f64::from(std::mem::take(&mut self.alike)).ln() - self.log_alike) / self.moves;
        let steps = (moved / self.step).round();
        let rest = (moved - steps * self.step).abs();
        match steps {
            _ if self.step == 0.0 => self.step = moved,
            1.0.. if rest < NEAR * self.step => self.multiples = self.multiples.saturating_add(1),
            1.0.. => (self.step, self.multiples) = (rest, 0),
            _ => (self.step, self.multiples) = (moved, 0),
        }
    }

    /// Least variance of a reading; 0 of a channel that is not known to be rounded.
    pub fn variance(&self) -> f64 {
        if self.multiples < CERTAIN { 0.0 } else { self.step * self.step / 12.0 * self.log_alike.exp() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(readings: impl Iterator<Item = f64>) -> f64 {
        let mut rounding = Rounding::default();
        readings.for_each(|reading| rounding.take(reading));
        rounding.variance()
    }

    /// A motion over some hundred steps, read in steps of that size.
    fn rounded(step: f64) -> impl Iterator<Item = f64> {
        (0..4000).map(move |k| ((0.7 * f64::from(k)).sin() / step).round() * step)
    }

    #[test]
    fn a_rounded_channel_errs_by_its_step() {
        for step in [0.01, 0.0375, 1.0 / 256.0] {
            let expected = step * step / 12.0;
            let single = rounded(step).map(|reading| f64::from(reading as f32));
            // a few of these readings repeat the one before by chance
            for found in [of(rounded(step)), of(single)] {
                assert!((0.999..1.05).contains(&(found / expected)), "{step}: {}", found / expected);
            }
        }
    }

    #[test]
    fn readings_that_repeat_one_another_are_one() {
        let held = |times: usize| rounded(0.01).flat_map(move |reading| std::iter::repeat_n(reading, times));
        assert!((of(held(5)) / of(rounded(0.01)) - 5.0).abs() < 0.1, "{}", of(held(5)) / of(rounded(0.01)));
        let rest = std::iter::repeat_n(0.0, 3000).chain(rounded(0.01));
        assert!((of(rest) / of(rounded(0.01)) - 1.0).abs() < 0.02);
    }

    /// Moves of two and of three steps, never of one.
    #[test]
    fn the_step_is_the_common_divisor_of_the_moves() {
        let readings = (0..200).map(|k| 0.1 * f64::from(5 * (k / 2) + 2 * (k % 2)));
        assert!((of(readings) * 12.0 / 0.01 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_not_rounded_has_no_step() {
        let smooth = |k: u32| (0.013 * f64::from(k)).sin();
        assert!(of((0..4000).map(smooth)) < 1e-24);
        // a wild reading, and a rest, change nothing
        let with = (0..4000).map(|k| if k % 500 == 7 { 1e9 } else { smooth(k.max(300)) });
        assert!(of(with) < 1e-12);
    }
}
