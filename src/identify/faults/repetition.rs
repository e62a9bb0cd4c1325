//! How often a channel repeats its last value exactly, and what one more repetition says of a stuck sensor.

use crate::estimation::{BEYOND_CHANCE, SAMPLES_OF_A_VARIANCE, TWENTY_TO_ONE};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A repetition rarer than this says something: of a channel that repeats itself more often a stuck sensor is told by
/// what the law expects.
const RARE: f64 = 0.01;

/// Readings that the rate of repetitions is known from: seconds of most streams.
const MEMORY: f64 = 10_000.0;

/// Variance of the second difference of white noise, in its own.
const BENDS: f64 = 6.0;

/// What a value says of its sensor by repeating the last one or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Repeat {
    /// It is a reading: it does not repeat the last one, or does where rounding may have made it.
    None,
    /// The sensor has not been read: its last value stands for what the channel has gone on to.
    Unread,
    /// It may be stuck.
    Rare {
        /// −ln of how often the channel repeats a value, nats.
        nats: f64,
        /// The same of the repetitions before this one.
        before: f64,
    },
}

/// How often something happens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Rate {
    often: f64,
    of: f64,
}

impl Rate {
    fn count(&mut self, happens: bool) {
        let kept = 1.0 - 1.0 / MEMORY;
        *self = Rate { often: kept * self.often + f64::from(u8::from(happens)), of: kept * self.of + 1.0 };
    }

    /// The mean of its posterior after Jeffreys' prior.
    fn mean(&self) -> f64 {
        (self.often + 0.5) / (self.of + 1.0)
    }
}

/// Repetitions of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Repetition {
    last: Option<f64>,
    /// What it moved by last, and the mean square of what that changes by.
    step: f64,
    bends: f64,
    /// The smallest step that it has made: a rounded channel's resolution.
    resolution: Option<f64>,
    readings: f64,
    /// How often it repeats a reading, and how often it goes on to where that is usual.
    begins: Rate,
    goes_on: Rate,
    /// Repetitions in a row, the most that there have been of them, and what they have cost so far, nats.
    in_a_row: u64,
    longest: u64,
    run: f64,
    /// How many of them are rare.
    length: u64,
}

impl Repetition {
    /// Takes a value. `course` is what the channel has moved by at least since the last one, as far as is known, and
    /// `scatter` the std of its noise under the law: one that moves by less than its resolution may repeat itself, the
    /// likelier the less it scatters. What befalls a sensor in an interval is as rare as `never`, nats: a channel that
    /// usually goes unread for some samples is stuck once it does for so long that this is rarer. It is infinite for
    /// what may stand still by itself.
    pub fn take(&mut self, value: f64, course: f64, scatter: f64, never: f64) -> Repeat {
        let step = self.last.replace(value).map(|last| (value - last).abs());
        let repeats = step == Some(0.0);
        let bends = (self.bends / BENDS).sqrt();
        let of_rounding = |scatter: f64| self.resolution.map_or(1.0, |step| step / (2.0 * PI.sqrt() * scatter));
        // two normal readings of one mean are rounded to the same value
        let chance = match self.resolution {
            Some(resolution) if course >= resolution => 0.0,
            _ => of_rounding(scatter.min(bends)),
        };
        if repeats && chance >= RARE {
            return Repeat::None;
        }
        let of_rounding = of_rounding(bends);
        let moved = step.filter(|step| *step > 0.0);
        self.resolution = self.resolution.into_iter().chain(moved).reduce(f64::min);
        if !repeats {
            self.read(moved);
            return Repeat::None;
        }
        // a working sensor repeats itself as often as ever, one that is not read goes on to
        let rate = if self.in_a_row == 0 || self.length > 0 { self.begins } else { self.goes_on }.mean();
        let usual = -rate.max(chance).ln();
        let (before, nats) = (self.run, usual.max(self.beyond_usual()));
        let is_fault = usual > -RARE.ln() || self.run + nats > never;
        // that a fault goes on does not become usual; that it comes back does, of what cannot stand still itself
        if self.in_a_row == 0 && (never.is_finite() || !is_fault) {
            self.begins.count(true);
        }
        self.run += nats;
        self.in_a_row += 1;
        if is_fault {
            self.length += 1;
            return Repeat::Rare { nats, before };
        }
        if self.in_a_row > 1 {
            self.goes_on.count(true);
        }
        if (rate / of_rounding).ln() > TWENTY_TO_ONE { Repeat::Unread } else { Repeat::None }
    }

    /// A value that repeats nothing, and what it is off the last one.
    fn read(&mut self, moved: Option<f64>) {
        if self.in_a_row == 0 {
            self.begins.count(false);
        } else if self.length == 0 {
            self.goes_on.count(false);
            self.longest = self.longest.max(self.in_a_row);
        }
        (self.run, self.length, self.in_a_row) = (0.0, 0, 0);
        self.readings += 1.0;
        moved.into_iter().for_each(|step| self.follow_scatter(step));
    }

    /// −ln of how seldom one more repetition comes after those in a row where that is more than it ever was: of twice
    /// as many one reading was missed.
    fn beyond_usual(&self) -> f64 {
        let is_usual = self.in_a_row < 2 * (self.longest + 1);
        if is_usual { 0.0 } else { (2.0 * (self.readings + 1.0)).ln() }
    }

    /// What a law leaves may be its own error; no channel scatters by more than its steps change by.
    fn follow_scatter(&mut self, step: f64) {
        let bend = step - std::mem::replace(&mut self.step, step);
        let usual = self.bends.max(self.resolution.map_or(0.0, |resolution| resolution * resolution));
        let most = BEYOND_CHANCE * BEYOND_CHANCE * usual;
        self.bends += ((bend * bend).min(most) - self.bends) / self.readings.min(SAMPLES_OF_A_VARIANCE);
    }

    /// −ln of how seldom the channel repeats a value as often as it just has, nats; 0 where that is usual.
    pub fn run(&self) -> f64 {
        if self.length > 0 { self.run } else { 0.0 }
    }

    /// Rare repetitions in a row.
    pub fn length(&self) -> u64 {
        self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const NEVER: f64 = 20.0;

    fn take(channel: &mut Repetition, value: f64) -> Repeat {
        channel.take(value, 1.0, 0.0, NEVER)
    }

    #[test]
    fn a_channel_that_always_varied_repeats_by_a_fault() {
        let mut channel = Repetition::default();
        (0..1000).for_each(|index| assert_eq!(take(&mut channel, f64::from(index)), Repeat::None));
        assert!(matches!(take(&mut channel, 999.0), Repeat::Rare { nats, before: 0.0 } if nats > 7.0));
        assert_eq!(take(&mut channel, 5.0), Repeat::None);
    }

    #[test]
    fn a_coarse_sensor_repeats_all_the_time() {
        let mut channel = Repetition::default();
        (0..1000).for_each(|index| assert_eq!(take(&mut channel, f64::from(index / 3)), Repeat::None));
    }

    #[test]
    fn a_rounded_channel_repeats_where_it_hardly_moves() {
        let mut channel = Repetition::default();
        (0..1000).for_each(|index| assert_eq!(take(&mut channel, f64::from(index)), Repeat::None));
        (0..20).for_each(|_| assert_eq!(channel.take(999.0, 0.1, 1.0, NEVER), Repeat::None));
        assert!(matches!(take(&mut channel, 999.0), Repeat::Rare { nats, .. } if nats > 7.0));
    }

    /// It is stuck once it goes unread for longer than it ever would.
    #[test]
    fn a_channel_that_is_read_every_fifth_sample_is_unread_in_between() {
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        let mut channel = Repetition::default();
        let mut value = 0.0;
        for index in 0..4000 {
            let is_read = index % 5 == 0;
            value = if is_read { generator.sample(StandardNormal) } else { value };
            let expected = if is_read { Repeat::None } else { Repeat::Unread };
            let repeat = take(&mut channel, value);
            assert!(index < 1000 || repeat == expected, "{index}: {repeat:?}");
        }
        // four have come already
        let in_a_row = 4 + (0..200).take_while(|_| take(&mut channel, value) == Repeat::Unread).count();
        assert!((10..20).contains(&in_a_row), "{in_a_row}");
        assert!(matches!(take(&mut channel, value), Repeat::Rare { nats, before } if nats > 6.0 && before > NEVER));
    }

    /// What a law leaves is not the channel's noise where that goes straight on.
    #[test]
    fn a_channel_that_scatters_by_many_of_its_steps_repeats_by_a_fault() {
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        for (scatters, told) in [(1e4, true), (0.1, false)] {
            let mut channel = Repetition::default();
            for index in 0..4000 {
                let scatter: f64 = generator.sample(StandardNormal);
                channel.take((f64::from(index / 4) + scatters * scatter).round(), 0.1, 1e4, NEVER);
            }
            let repeats = channel.last.unwrap();
            assert_eq!(channel.take(repeats, 0.1, 1e4, NEVER) != Repeat::None, told, "{channel:?}");
        }
    }
}
