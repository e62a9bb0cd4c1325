//! The evidence of a switch that the law in use meets without one.
//!
//! Under the right law it stays below what the false-alarm interval asks. A real record has error that no law models:
//! its evidence rises again and again, and only what stands out from that is a switch. What chance brings in the time
//! gone by does not count, nor what rose once while the law was still young and has not come again since.

use serde::{Deserialize, Serialize};

/// Samples in a block; what fell within the last two may be a switch that is just being noticed.
const BLOCK: u64 = 1000;

/// A rise is past when the evidence has fallen to this part of it: that of a switch stays.
const PAST: f64 = 0.5;

/// A switch has this many times the largest evidence seen before it.
const STANDS_OUT: f64 = 2.0;

/// Chance rises above what it brings once in the time gone by, by less than this in nineteen cases of twenty, nats.
const LUCK: f64 = 3.0;

/// Largest evidence that came and went in blocks of the stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EmpiricalNull {
    /// Until the stage had its length of the last doubling, and since then.
    before: [f64; 2],
    /// Samples at the last doubling.
    doubled: u64,
    last: f64,
    present: f64,
    /// Largest evidence of the rise that is not past yet.
    rise: f64,
    count: u64,
}

impl EmpiricalNull {
    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = EmpiricalNull::default();
    }

    /// Takes the largest evidence at a sample, nats.
    pub fn add(&mut self, evidence: f64) {
        self.rise = self.rise.max(evidence);
        if evidence < PAST * self.rise {
            self.present = self.present.max(std::mem::take(&mut self.rise));
        }
        self.count += 1;
        if self.count.is_multiple_of(BLOCK) {
            self.before[1] = self.before[1].max(self.last);
            (self.last, self.present) = (self.present, 0.0);
            if self.count >= 2 * self.doubled {
                (self.before, self.doubled) = ([self.before[1], 0.0], self.count);
            }
        }
    }

    /// The evidence that stands out, nats: `asked` under the right law, which meets `chance` once in a sample.
    pub fn level(&self, asked: f64, chance: f64) -> f64 {
        let expected = (chance + (self.count.max(1) as f64).ln() + LUCK).max(0.0);
        let before = self.before[0].max(self.before[1]);
        let excess = (before - expected).max(0.0);
        asked.max((STANDS_OUT * before).min(asked + STANDS_OUT * excess))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_counts_only_when_it_is_past() {
        let mut usual = EmpiricalNull::default();
        (0..5 * BLOCK).for_each(|_| usual.add(30.0));
        assert_eq!(usual.level(15.0, -4.4), 15.0);
        (0..2 * BLOCK).for_each(|_| usual.add(1.0));
        assert_eq!(usual.level(15.0, -4.4), 60.0);
    }

    #[test]
    fn what_fell_just_now_does_not_count_yet() {
        let mut usual = EmpiricalNull::default();
        (0..BLOCK).for_each(|_| usual.add(30.0));
        (0..BLOCK / 2).for_each(|_| usual.add(1.0));
        assert_eq!(usual.level(15.0, -4.4), 15.0);
    }

    #[test]
    fn what_does_not_come_again_counts_until_the_record_is_four_times_as_long_at_most() {
        let mut usual = EmpiricalNull::default();
        (0..BLOCK).for_each(|_| usual.add(30.0));
        (0..4 * BLOCK).for_each(|_| usual.add(1.0));
        assert_eq!(usual.level(15.0, -4.4), 60.0);
        (0..20 * BLOCK).for_each(|_| usual.add(1.0));
        assert_eq!(usual.level(15.0, -4.4), 15.0);
    }

    #[test]
    fn a_little_more_than_chance_brings_raises_the_level_a_little() {
        let mut usual = EmpiricalNull::default();
        (0..3 * BLOCK).for_each(|_| usual.add(9.0));
        (0..3 * BLOCK).for_each(|_| usual.add(0.0));
        let level = usual.level(15.0, -4.4);
        assert!(15.0 < level && level < 18.5, "{level}");
    }

    #[test]
    fn what_chance_brings_does_not_count() {
        let mut usual = EmpiricalNull::default();
        (0..3 * BLOCK).for_each(|_| usual.add(6.0));
        (0..3 * BLOCK).for_each(|_| usual.add(0.0));
        assert_eq!(usual.level(15.0, -4.4), 15.0);
    }
}
