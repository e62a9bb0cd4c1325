//! A message that is sent again: a sample that repeats the last one in every channel, though the motion goes on, where
//! that is no chance.
//!
//! How often a channel repeats a value by chance is told by the samples that do not repeat as a whole: no more than its
//! smallest step is of its usual one, its resolution, nor than it repeats a value alone.

use crate::identify::sample::Sample;
use serde::{Deserialize, Serialize};

/// Channels that repeat together by chance less often than this, if each goes its own way, have not been read anew.
const CHANCE: f64 = 1e-6;

/// How a channel moves from sample to sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Steps {
    /// Logarithms of the smallest step and, as a mean, of the usual one: a wild reading hardly moves that.
    smallest: f64,
    usual: f64,
    /// Steps, and how often it stood still while another channel moved.
    moved: f64,
    still: f64,
}

/// The samples of a stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Resent {
    last: Option<Sample>,
    channels: [Steps; 3],
}

impl Steps {
    fn take(&mut self, step: f64) {
        if step == 0.0 {
            self.still += 1.0;
            return;
        }
        let size = step.ln();
        self.smallest = if self.moved > 0.0 { self.smallest.min(size) } else { size };
        self.moved += 1.0;
        self.usual += (size - self.usual) / self.moved;
    }

    /// Probability that it repeats a value.
    fn chance(&self) -> f64 {
        let alone = self.still / (self.still + self.moved).max(1.0);
        (self.smallest - self.usual).exp().max(alone)
    }
}

impl Resent {
    /// Takes a sample; returns whether it is the last one again.
    pub fn take(&mut self, sample: &Sample) -> bool {
        let Some(before) = self.last.replace(*sample) else { return false };
        let steps = [sample.q - before.q, sample.qd - before.qd, sample.excitation - before.excitation].map(f64::abs);
        if steps == [0.0; 3] {
            let chance: f64 = self.channels.iter().map(Steps::chance).product();
            return sample.qd != 0.0 && chance < CHANCE;
        }
        self.channels.iter_mut().zip(steps).for_each(|(channel, step)| channel.take(step));
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of 20 000 samples are told to be the last ones again, each channel being rounded to `resolution`.
    fn told(resolution: f64, sent: impl Fn(u32) -> u32) -> usize {
        let rounded = |value: f64| if resolution > 0.0 { (value / resolution).round() * resolution } else { value };
        let sample = |k: u32| {
            let phase = 0.7 * f64::from(sent(k));
            let [q, qd, excitation] = [phase.sin(), phase.cos(), (1.7 * phase).sin()].map(rounded);
            Sample { t: f64::from(k), q, qd, excitation }
        };
        let mut resent = Resent::default();
        (0..20_000).filter(|k| resent.take(&sample(*k))).count()
    }

    #[test]
    fn messages_that_are_sent_twice_are_told() {
        let twice = told(0.0, |k| k / 2);
        assert!((9_500..=10_000).contains(&twice), "{twice}");
        assert_eq!(told(0.0, |k| k), 0);
    }

    #[test]
    fn what_rounding_may_repeat_is_not() {
        assert_eq!(told(0.5, |k| k / 2), 0);
    }
}
