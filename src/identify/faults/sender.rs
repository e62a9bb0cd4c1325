//! What a sender makes up where it has no new reading: a sample that repeats the last one, or one on the line between
//! its neighbours, in every channel though the motion goes on and where that is no chance.
//!
//! How often a channel does so by chance is told by the samples in which not all of them do.

use crate::identify::sample::{Sample, Skipped};
use serde::{Deserialize, Serialize};

/// What channels do together by chance less often than this, if each goes its own way, they have not been read for.
const CHANCE: f64 = 1e-6;

/// What rounding leaves of a point's distance from the line between two others, as a part of the way and of its value.
const ON_LINE: [f64; 2] = [1e-9, 8.0 * f64::EPSILON];

/// The samples that a sender has sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sender {
    /// The last sample and the one before it.
    last: [Option<Sample>; 2],
    repeated: Coincidence,
    on_line: Coincidence,
    /// Whether it interpolates, and the sample that waits for the next one to show whether it was read.
    interpolates: bool,
    waiting: Option<Sample>,
}

/// How often q, q̇ and F each do something of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Coincidence {
    seen: f64,
    alone: [f64; 3],
}

impl Coincidence {
    fn take(&mut self, channels: [bool; 3]) {
        if channels != [true; 3] {
            self.seen += 1.0;
            self.alone.iter_mut().zip(channels).for_each(|(alone, does)| *alone += f64::from(u8::from(does)));
        }
    }

    /// Whether all of them do it, and by no chance.
    fn is_none(&self, channels: [bool; 3]) -> bool {
        let chance: f64 = self.alone.iter().map(|alone| (alone + 0.5) / (self.seen + 1.0)).product();
        channels == [true; 3] && chance < CHANCE
    }
}

fn values(sample: &Sample) -> [f64; 3] {
    [sample.q, sample.qd, sample.excitation]
}

fn repeats(last: &Sample, sample: &Sample) -> [bool; 3] {
    let [last, now] = [last, sample].map(values);
    std::array::from_fn(|channel| last[channel] == now[channel])
}

/// In which channels the second of three samples lies on the line between the others.
fn on_line(before: &Sample, middle: &Sample, after: &Sample) -> [bool; 3] {
    let share = (middle.t - before.t) / (after.t - before.t);
    let [from, at, to] = [before, middle, after].map(values);
    std::array::from_fn(|channel| {
        let way = to[channel] - from[channel];
        let off = at[channel] - (from[channel] + share * way);
        let size = from[channel].abs().max(to[channel].abs());
        off.abs() <= ON_LINE[0] * way.abs() + ON_LINE[1] * size
    })
}

impl Sender {
    /// Whether a sample is the last one again.
    pub fn repeats(&self, sample: &Sample) -> bool {
        self.last[0].is_some_and(|last| sample.qd != 0.0 && self.repeated.is_none(repeats(&last, sample)))
    }

    /// The channels that vary: what repeats itself as a rule is not stuck.
    pub fn varies(&self) -> [bool; 3] {
        self.repeated.alone.map(|alone| alone < 0.5 * self.repeated.seen)
    }

    /// Takes a sample that is not the last one again; returns what is to be read. Once a sample was interpolated each
    /// one waits for the next.
    ///
    /// # Errors
    /// [`Skipped::Interpolated`] for the sample before this one.
    pub fn read(&mut self, sample: Sample) -> Result<Option<Sample>, Skipped> {
        let [last, before] = self.last;
        self.last = [Some(sample), last];
        last.into_iter().for_each(|last| self.repeated.take(repeats(&last, &sample)));
        let made_up = before.zip(last).is_some_and(|(before, last)| {
            let line = on_line(&before, &last, &sample);
            self.on_line.take(line);
            last.qd != before.qd && self.on_line.is_none(line)
        });
        if !self.interpolates {
            self.interpolates = made_up;
            return Ok(Some(sample));
        }
        match self.waiting.replace(sample) {
            Some(Sample { t, .. }) if made_up => Err(Skipped::Interpolated { t }),
            read => Ok(read),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times that are read, of 20 000 samples that are each a mixture of two readings, rounded to `resolution`.
    fn read(resolution: f64, mixture: impl Fn(u32) -> (u32, f64)) -> Vec<f64> {
        let rounded = |value: f64| if resolution > 0.0 { (value / resolution).round() * resolution } else { value };
        let reading = |k: u32| [0.7, 0.9, 1.9].map(|rate| rounded((rate * f64::from(k)).sin()));
        let sample = |k: u32| {
            let (first, share) = mixture(k);
            let [from, to] = [first, first + 1].map(reading);
            let [q, qd, excitation] =
                std::array::from_fn(|channel| from[channel] + share * (to[channel] - from[channel]));
            Sample { t: f64::from(k), q, qd, excitation }
        };
        let mut sender = Sender::default();
        let mut take = |k| (!sender.repeats(&sample(k))).then(|| sender.read(sample(k)).ok().flatten()).flatten();
        (0..20_000).filter_map(|k| take(k).map(|sample| sample.t)).collect()
    }

    #[test]
    fn every_sample_that_was_read_is_read_at_once() {
        assert_eq!(read(0.0, |k| (k, 0.0)), (0..20_000).map(f64::from).collect::<Vec<_>>());
    }

    #[test]
    fn samples_that_are_sent_twice_are_read_once() {
        let times = read(0.0, |k| (k / 2, 0.0));
        assert!(times.len() < 10_100 && times[200..].iter().all(|t| t % 2.0 == 0.0), "{}", times.len());
    }

    #[test]
    fn samples_that_are_interpolated_are_left_out() {
        for every in [2, 5] {
            let times = read(0.0, |k| (k / every, f64::from(k % every) / f64::from(every)));
            assert!(times.len() < (20_000 / every + 60 * every) as usize, "{}", times.len());
            assert!(times[300..].iter().all(|t| t % f64::from(every) == 0.0));
        }
    }

    #[test]
    fn what_rounding_may_do_is_no_fault() {
        assert_eq!(read(0.5, |k| (k / 2, 0.0)).len(), 20_000);
        assert_eq!(read(0.5, |k| (k / 2, 0.5 * f64::from(k % 2))).len(), 20_000);
    }
}
