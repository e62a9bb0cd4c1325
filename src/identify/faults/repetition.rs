//! How often a channel repeats its last value exactly, and what one more repetition says of a stuck sensor.

use crate::estimation::{BEYOND_CHANCE, SAMPLES_OF_A_VARIANCE};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A repetition rarer than this says something: of a channel that repeats itself more often a stuck sensor is told by
/// what the law expects.
const RARE: f64 = 0.01;

/// Variance of the second difference of white noise, in its own.
const BENDS: f64 = 6.0;

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
    repeated: f64,
    /// What the rare repetitions in a row so far have cost, nats.
    run: f64,
    /// How many there are.
    length: u64,
}

impl Repetition {
    /// Takes a reading; returns −ln of how often the channel repeats a value, nats, where this one does and that is
    /// rare. `course` is what the channel has moved by at least since the last one, as far as is known, and `scatter`
    /// the std of its noise under the law: one that moves by less than its resolution may repeat itself, the likelier
    /// the less it scatters.
    pub fn take(&mut self, value: f64, course: f64, scatter: f64) -> Option<f64> {
        let moved = self.last.replace(value).map(|last| value - last);
        let step = moved.map(f64::abs);
        let scatter = scatter.min((self.bends / BENDS).sqrt());
        let repeats = step == Some(0.0);
        // two normal readings of one mean are rounded to the same value
        let chance = match self.resolution {
            Some(resolution) if course >= resolution => 0.0,
            Some(resolution) => resolution / (2.0 * PI.sqrt() * scatter),
            None => 1.0,
        };
        if repeats && chance >= RARE {
            return None;
        }
        let moved = step.filter(|step| *step > 0.0);
        self.resolution = self.resolution.into_iter().chain(moved).reduce(f64::min);
        let rate = ((self.repeated + 0.5) / (self.readings + 1.0)).max(chance);
        let rare = repeats && rate < RARE;
        self.run = if rare { self.run - rate.ln() } else { 0.0 };
        self.length = if rare { self.length + 1 } else { 0 };
        // what is called a fault does not become usual
        if !rare {
            self.readings += 1.0;
            self.follow_scatter(moved.unwrap_or(0.0));
            self.repeated += f64::from(u8::from(repeats));
        }
        rare.then(|| -rate.ln())
    }

    /// What a law leaves may be its own error; no channel scatters by more than its steps change by.
    fn follow_scatter(&mut self, step: f64) {
        let bend = step - std::mem::replace(&mut self.step, step);
        let usual = self.bends.max(self.resolution.map_or(0.0, |resolution| resolution * resolution));
        let most = BEYOND_CHANCE * BEYOND_CHANCE * usual;
        self.bends += ((bend * bend).min(most) - self.bends) / self.readings.min(SAMPLES_OF_A_VARIANCE);
    }

    /// −ln of how seldom the channel repeats a value as often as it just has, nats.
    pub fn run(&self) -> f64 {
        self.run
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

    #[test]
    fn a_channel_that_always_varied_repeats_by_a_fault() {
        let mut channel = Repetition::default();
        (0..1000).for_each(|index| assert_eq!(channel.take(f64::from(index), 1.0, 0.0), None));
        assert!(channel.take(999.0, 1.0, 0.0).unwrap() > 7.0);
        assert_eq!(channel.take(5.0, 1.0, 0.0), None);
    }

    #[test]
    fn a_coarse_sensor_repeats_all_the_time() {
        let mut channel = Repetition::default();
        (0..1000).for_each(|index| assert_eq!(channel.take(f64::from(index / 3), 1.0, 0.0), None));
    }

    #[test]
    fn a_rounded_channel_repeats_where_it_hardly_moves() {
        let mut channel = Repetition::default();
        (0..1000).for_each(|index| assert_eq!(channel.take(f64::from(index), 1.0, 0.0), None));
        (0..20).for_each(|_| assert_eq!(channel.take(999.0, 0.1, 1.0), None));
        assert!(channel.take(999.0, 1.0, 0.0).unwrap() > 7.0);
    }

    /// What a law leaves is not the channel's noise where that goes straight on.
    #[test]
    fn a_channel_that_scatters_by_many_of_its_steps_repeats_by_a_fault() {
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        for (scatters, told) in [(1e4, true), (0.1, false)] {
            let mut channel = Repetition::default();
            for index in 0..4000 {
                let scatter: f64 = generator.sample(StandardNormal);
                channel.take((f64::from(index / 4) + scatters * scatter).round(), 0.1, 1e4);
            }
            let repeats = channel.last.unwrap();
            assert_eq!(channel.take(repeats, 0.1, 1e4).is_some(), told, "{channel:?}");
        }
    }
}
