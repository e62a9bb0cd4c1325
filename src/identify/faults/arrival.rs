//! A reading as it arrives: the interval since the last one, and what each channel repeats.

use super::expected::Expected;
use super::hypothesis::Value;
use super::kind::Kind;
use super::price::event;
use super::repetition::{Repeat, Repetition};
use crate::estimation::{Channel, Filter, OUTLYING};
use crate::identify::reading::Reading;
use crate::identify::sample::Sample;
use crate::law::{Drive, Hold};
use serde::{Deserialize, Serialize};

/// A reading is held from so many stds on: two of them in a row would make an alarm of a false-alarm interval of 1e6 s,
/// 16 nats, and by chance one comes in 16 000 readings. Of a law of which more evidence is asked more is.
const HELD: f64 = 4.0;

/// A reading beside the interval since the last one.
pub struct Arrival {
    pub reading: Reading,
    pub dt: f64,
    pub drive: Drive,
    /// What it is where F acts a sample earlier, and a sample later, than it came until now.
    shifted: [Drive; 2],
    pub values: [Option<Value>; 2],
    /// What the repetitions before this one have cost by channel, nats; 0 where it is none.
    pub runs: [f64; 2],
}

impl Arrival {
    /// The drive if that has happened.
    pub fn drive_by(&self, kind: Kind) -> &Drive {
        match kind {
            Kind::Late(-1) => &self.shifted[0],
            Kind::Late(_) => &self.shifted[1],
            _ => &self.drive,
        }
    }

    /// Whether its readings are as near to what is foreseen as chance leaves them.
    pub fn is_near<const N: usize>(&self, law: &Expected, foreseen: &Filter<N>) -> bool {
        Channel::ALL.into_iter().all(|channel| match self.values[channel as usize] {
            Some(read) => {
                let (residual, variance) = foreseen.residual(channel, read.value, law.noise.sensor[channel as usize]);
                !read.is_rare() && residual * residual <= HELD * HELD * law.caution * variance
            }
            None => true,
        })
    }

    /// What was read of either channel.
    pub fn measured(&self) -> [Option<f64>; 2] {
        self.values.map(|value| value.map(|value| value.value))
    }

    /// A motion at rest repeats itself as a stuck sensor does: a repetition says something of a channel only where the
    /// other one moves.
    pub fn allow_rest(&mut self, law: &Expected) {
        let varies = self.values.map(|value| value.is_some_and(|value| value.repeats.is_none()));
        let is_fast = self.reading.sample.qd.powi(2) > OUTLYING * OUTLYING * law.noise.sensor[1];
        let other_moves = [varies[1] && is_fast, varies[0]];
        for index in (0..2).filter(|index| !other_moves[*index]) {
            self.values[index].iter_mut().for_each(|value| value.repeats = value.repeats.map(|_| 0.0));
            self.runs[index] = 0.0;
        }
    }
}

/// What a channel is expected to have moved by at least since the last sample, and the std of its noise: what a
/// repetition is held against.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    pub moved: [f64; 2],
    pub scatter: [f64; 2],
}

impl Course {
    /// Nothing is known of it.
    pub const UNKNOWN: Course = Course { moved: [f64::INFINITY; 2], scatter: [0.0; 2] };
}

/// Readings one after the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Arrivals {
    pub last: Option<Sample>,
    /// F of the sample before that, N.
    excitation_before: f64,
    repetitions: [Repetition; 2],
    /// Which channels have gone unread, and which of these have just been found to.
    goes_unread: [bool; 2],
    found_unread: [bool; 2],
}

impl Arrivals {
    /// The channels that have just been found to go unread: until now they were taken at their word.
    pub fn found_unread(&mut self) -> [bool; 2] {
        std::mem::take(&mut self.found_unread)
    }

    /// Takes a reading of these channels; none is an arrival before there is an interval. `course` is asked for where a
    /// channel repeats itself alone.
    pub fn take(
        &mut self,
        reading: Reading,
        measured: [bool; 2],
        hold: Hold,
        course: impl FnOnce(&Sample) -> Course,
    ) -> Option<Arrival> {
        let sample = reading.sample;
        let before = self.last.replace(sample)?;
        let repeats = sample.q == before.q || sample.qd == before.qd;
        let Course { moved, scatter } = if repeats { course(&before) } else { Course::UNKNOWN };
        let drive = |from: f64, to: f64| match hold {
            Hold::Zero => Drive::Held(from),
            Hold::Linear | Hold::BandLimited => Drive::Line(from, to),
        };
        let [now, last] = [sample.excitation, before.excitation];
        let older = std::mem::replace(&mut self.excitation_before, last);
        // what comes next nobody knows
        let shifted = [drive(now, now), drive(older, last)];
        let drive = drive(last, now);
        let dt = sample.t - before.t;
        let never = -event(dt).ln();
        let (mut reading, mut runs) = (reading, [0.0; 2]);
        let values = Channel::ALL.map(|channel| {
            let index = channel as usize;
            let value = [sample.q, sample.qd][index];
            let repeats = match self.repetitions[index].take(value, moved[index], scatter[index], never) {
                Repeat::None => None,
                Repeat::Unread => {
                    reading.faulty[index] = true;
                    self.found_unread[index] |= !std::mem::replace(&mut self.goes_unread[index], true);
                    return None;
                }
                Repeat::Rare { nats, before } => {
                    runs[index] = before;
                    Some(nats)
                }
            };
            measured[index].then_some(Value { value, repeats })
        });
        Some(Arrival { reading, dt, drive, shifted, values, runs })
    }
}
