//! The last samples, in a ring whose memory is fixed at construction.

use super::packed_readings;
use super::reading::Reading;
use super::sample::{PACE_SHARE, Sample, is_outage};
use super::settings::Channels;
use crate::estimation::{Filter, Noise, Observation, SAMPLES_OF_A_VARIANCE, initial_state, state_after_outage};
use crate::law::{BandLimited, Drive, Hold, REACH, look_ahead};
use serde::{Deserialize, Serialize};

/// An interval this many times as long as the usual one lacks samples, half way between none and one …
const GAP: f64 = 1.5;

/// … unless so many in a row are that less than this would be chance: then the samples come at another rate.
const CHANCE: f64 = 1e-6;

/// Share of intervals that lack samples, at least: four in a row are no chance where there were none before.
const LACKING: f64 = 0.03;

/// Accepted samples by number; the first of all is number 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Window {
    #[serde(with = "packed_readings")]
    ring: Vec<Reading>,
    count: u64,
    /// Number of the first sample after the last outage.
    resumed: u64,
    /// Time of the last sample of which a reading of the motion counts, s.
    counted: f64,
    channels: Channels,
    hold: Hold,
    band_limited: BandLimited,
    pace: Pace,
    /// What of the excitation the next interval has unseen besides, N² s.
    unseen: f64,
}

/// How the samples come, and how much the excitation moves between two of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Pace {
    /// The usual time between two samples, s.
    dt: f64,
    /// Longer ones in a row, and how many of them usually come between two that are not.
    longer: i32,
    lacking: f64,
    /// Mean of half the square of what the excitation moves by, N².
    roughness: f64,
    count: f64,
}

impl Pace {
    fn take(&mut self, before: &Sample, sample: &Sample) {
        let dt = sample.t - before.t;
        let run = self.longer;
        self.longer = if self.is_gap(dt) { run + 1 } else { 0 };
        let share = (self.lacking / (1.0 + self.lacking)).max(LACKING);
        let is_another_rate = self.dt == 0.0 || share.powi(self.longer) < CHANCE;
        if is_another_rate {
            (self.dt, self.longer) = (dt, 0);
        }
        if self.longer > 0 {
            return;
        }
        self.dt += PACE_SHARE * (dt - self.dt);
        self.count = (self.count + 1.0).min(SAMPLES_OF_A_VARIANCE);
        let run = if is_another_rate { 0 } else { run };
        self.lacking += (f64::from(run) - self.lacking) / self.count;
        let square = 0.5 * (sample.excitation - before.excitation).powi(2);
        self.roughness += (square - self.roughness) / self.count;
    }

    fn is_gap(&self, dt: f64) -> bool {
        self.dt > 0.0 && dt > GAP * self.dt
    }

    /// Over an interval in which samples are missing the excitation is known at its ends alone: intensity of the white
    /// force that may have been there besides, N² s.
    fn unseen(&self, dt: f64, moved: f64) -> f64 {
        match self.is_gap(dt) {
            true => (1.0 - self.dt / dt) * (self.roughness * self.dt + 0.25 * moved * moved * dt),
            false => 0.0,
        }
    }
}

impl Window {
    /// Room for `capacity` samples.
    pub fn new(capacity: usize, channels: Channels, hold: Hold) -> Window {
        let ring = vec![Reading::default(); capacity];
        let (band_limited, pace) = (BandLimited::new(), Pace::default());
        Window { ring, count: 0, resumed: 0, counted: f64::INFINITY, channels, hold, band_limited, pace, unseen: 0.0 }
    }

    /// How many samples it can hold.
    pub fn capacity(&self) -> usize {
        self.ring.len()
    }

    /// Adds a sample; the oldest goes when there is no room. Nothing is known of what moved the motion over an outage.
    pub fn push(&mut self, reading: impl Into<Reading>) {
        let mut reading = reading.into();
        let Sample { t, .. } = reading.sample;
        reading.unseen += std::mem::take(&mut self.unseen);
        if reading.counts(self.channels.of_motion()) {
            if is_outage(t - self.counted, self.pace.dt) {
                reading.unseen = f64::INFINITY;
            }
            self.counted = t;
        }
        if reading.unseen.is_infinite() {
            self.resumed = self.count;
        }
        if self.count > 0 {
            let before = *self.sample(self.count - 1);
            self.pace.take(&before, &reading.sample);
        }
        let slot = self.slot(self.count);
        self.ring[slot] = reading;
        self.count += 1;
    }

    /// Time that is usual between two samples, s; 0 before there are two.
    pub fn pace(&self) -> f64 {
        self.pace.dt
    }

    /// Number of the oldest sample that is still there.
    pub fn oldest(&self) -> u64 {
        self.count.saturating_sub(self.ring.len() as u64)
    }

    /// Number of the next sample to come.
    pub fn end(&self) -> u64 {
        self.count
    }

    /// One past the last sample up to which the excitation is known.
    pub fn ready(&self) -> u64 {
        (self.count + 1).saturating_sub(look_ahead(self.hold) as u64)
    }

    /// The sample of that number, which must be in the window.
    #[inline]
    pub fn sample(&self, number: u64) -> &Sample {
        &self.ring[self.slot(number)].sample
    }

    /// Number of the first sample since which none is missing for long, of those that are still there.
    pub fn resumed(&self) -> u64 {
        self.resumed.max(self.oldest())
    }

    /// Whether an outage ends with the sample of that number.
    pub fn ends_outage(&self, number: u64) -> bool {
        self.ring[self.slot(number)].unseen.is_infinite()
    }

    /// What is missed of F over the interval to the next sample, if that is so long and F moves by so much: intensity
    /// of a white force, N² s.
    pub fn missed(&self, dt: f64, moved: f64) -> f64 {
        self.pace.unseen(dt, moved)
    }

    /// What F is taken to do between samples.
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// From now on F is taken to do this between samples, and to act so many samples later than it did.
    pub fn set_timing(&mut self, hold: Hold, later: f64) {
        self.hold = hold;
        self.set_later(self.oldest(), later);
    }

    /// With sample `number` the motion goes on from another state than it had.
    pub fn break_off(&mut self, number: u64) {
        let slot = self.slot(number);
        self.ring[slot].unseen = f64::INFINITY;
        self.resumed = self.resumed.max(number);
    }

    /// From sample `first` on F is taken to act so many samples later than it did.
    pub fn set_later(&mut self, first: u64, later: f64) {
        let range = first.max(self.oldest())..self.end();
        match later > 0.0 {
            _ if later == 0.0 || range.is_empty() => {}
            // each is made of older ones
            true => range.rev().for_each(|number| self.move_excitation(number, later)),
            false => range.for_each(|number| self.move_excitation(number, later)),
        }
        self.forget_ends(later);
    }

    /// What acts at the record's ends once F acts so many samples later is not in the window: it may be as far from
    /// what is put there as F moves.
    fn forget_ends(&mut self, later: f64) {
        let unknown = later.abs().ceil() as u64;
        let unseen = 2.0 * self.pace.roughness * self.pace.dt;
        let ends = match later > 0.0 {
            true => self.oldest()..(self.oldest() + unknown + 1).min(self.end()),
            false => self.end().saturating_sub(unknown).max(self.oldest())..self.end(),
        };
        for number in ends {
            let slot = self.slot(number);
            self.ring[slot].unseen += unseen;
        }
        self.unseen += if later < 0.0 { unseen } else { 0.0 };
    }

    /// What was taken to act so many samples before this one acts with it; at the record's ends, what there is.
    fn move_excitation(&mut self, number: u64, later: f64) {
        let excitation = self.excitation_before(number, later);
        let slot = self.slot(number);
        self.ring[slot].sample.excitation = excitation;
    }

    /// F so many samples before sample `number`.
    fn excitation_before(&self, number: u64, later: f64) -> f64 {
        let (first, last) = (self.oldest() as i64, self.end() as i64 - 1);
        let whole = later.ceil();
        let [from, to] = [0, 1].map(|next| (number as i64 - whole as i64 + next).clamp(first, last) as u64);
        let [from, to] = [from, to].map(|number| self.sample(number).excitation);
        (1.0 - whole + later) * from + (whole - later) * to
    }

    /// Changes the last `count` readings.
    pub fn amend(&mut self, count: u64, change: impl Fn(&mut Reading)) {
        for number in self.end().saturating_sub(count).max(self.oldest())..self.end() {
            let slot = self.slot(number);
            change(&mut self.ring[slot]);
        }
    }

    /// Readings of these channels that repeat the last one were none.
    pub fn leave_out_repeated(&mut self, channels: [bool; 2]) {
        for number in self.oldest() + 1..self.end() {
            let [before, now] = [number - 1, number].map(|number| self.sample(number));
            let repeated = [channels[0] && now.q == before.q, channels[1] && now.qd == before.qd];
            self.set_faulty(number, repeated, true);
        }
    }

    /// A sample's readings of these channels are a sensor's fault, or after all they are not.
    pub fn set_faulty(&mut self, number: u64, channels: [bool; 2], are_faulty: bool) {
        let slot = self.slot(number);
        let own = self.ring[slot].faulty.iter_mut().zip(channels);
        own.filter(|(_, of_these)| *of_these).for_each(|(faulty, _)| *faulty = are_faulty);
    }

    /// Sample `number` and the excitation since the one before it; both must be in the window.
    #[inline]
    pub fn observation(&self, number: u64) -> Observation {
        let (before, after) = (self.sample(number - 1), self.sample(number));
        let Reading { faulty: [q_faulty, qd_faulty], unseen, .. } = self.ring[self.slot(number)];
        let counts = [self.channels.q && !q_faulty, self.channels.qd && !qd_faulty];
        let measured = [counts[0].then_some(after.q), counts[1].then_some(after.qd)];
        Observation { dt: after.t - before.t, drive: self.drive(number), measured, unseen }
    }

    /// The excitation of so many samples before those since the sample before sample `number`, as far as it is in the
    /// window.
    pub fn drive_with(&self, number: u64, later: f64) -> Drive {
        let [before, after] = [number - 1, number].map(|number| self.excitation_before(number, later));
        self.drive_between(before, after)
    }

    /// The excitation since the sample before sample `number`.
    fn drive(&self, number: u64) -> Drive {
        match self.hold {
            Hold::BandLimited if self.channels.excitation => self.interpolate(number - 1),
            _ => self.drive_between(self.sample(number - 1).excitation, self.sample(number).excitation),
        }
    }

    /// The excitation from one value to another, held or straight.
    fn drive_between(&self, before: f64, after: f64) -> Drive {
        match self.hold {
            _ if !self.channels.excitation => Drive::Held(0.0),
            Hold::Zero => Drive::Held(before),
            Hold::Linear | Hold::BandLimited => Drive::Line(before, after),
        }
    }

    /// By how much the excitation of the interval before, and of that after, differs in the middle from the one since
    /// the sample before sample `number`; by nothing where they are not in the window.
    pub fn shifts(&self, number: u64) -> [f64; 2] {
        let middle = |number: u64| self.drive(number).part(0, 1)[1];
        let now = middle(number);
        let before = if number > self.oldest() + 1 { middle(number - 1) - now } else { 0.0 };
        let after = match self.hold {
            Hold::Zero if number < self.end() => self.sample(number).excitation - now,
            // of a force that moves straight nobody knows where to before the next sample
            _ if number + 1 < self.end() => middle(number + 1) - now,
            _ => 0.0,
        };
        [before, after]
    }

    /// The state at sample `start` from that sample and the next alone, where a filter run begins; a reading that is a
    /// fault tells nothing of it.
    pub fn initial_state(&self, start: u64, noise: &Noise) -> Filter {
        let pair = [start, (start + 1).min(self.end() - 1)].map(|number| *self.sample(number));
        let [q, qd] = [pair.map(|sample| sample.q), pair.map(|sample| sample.qd)];
        let measured = self.channels.of_motion();
        let faulty = self.ring[self.slot(start)].faulty;
        if measured.into_iter().zip(faulty).any(|(measured, faulty)| measured && faulty) {
            let counts =
                [0, 1].map(|channel| (measured[channel] && !faulty[channel]).then_some([q[0], qd[0]][channel]));
            return state_after_outage([q[0], qd[0]], counts, noise);
        }
        initial_state([measured[0].then_some(q), measured[1].then_some(qd)], pair[1].t - pair[0].t, noise)
    }

    /// Interpolates the excitation after sample `start`; beyond the ends of the record its last value stays.
    fn interpolate(&self, start: u64) -> Drive {
        let first = start as i64 - (REACH as i64 - 1);
        let (oldest, newest) = (self.oldest() as i64, self.count as i64 - 1);
        let tap = |index: usize| self.sample((first + index as i64).clamp(oldest, newest) as u64).excitation;
        self.band_limited.interpolate(&std::array::from_fn(tap))
    }

    #[inline]
    fn slot(&self, number: u64) -> usize {
        (number % self.ring.len() as u64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::timing::Alignment;

    /// A window that has dropped its oldest samples.
    fn window(lag: f64) -> Window {
        let (mut window, mut alignment) = (Window::new(8, Channels::ALL, Hold::Linear), Alignment::default());
        for k in 0..12 {
            let sample = Sample { t: f64::from(k), excitation: f64::from(k * k), ..Sample::default() };
            alignment.align(lag, sample).into_iter().for_each(|sample| window.push(sample));
        }
        window
    }

    /// Usual time between two samples after so many of those numbers have come.
    fn pace(numbers: impl Iterator<Item = u32>) -> f64 {
        let mut window = Window::new(8, Channels::ALL, Hold::Zero);
        numbers.for_each(|k| window.push(Sample { t: f64::from(k), ..Sample::default() }));
        window.pace()
    }

    #[test]
    fn samples_that_are_lost_in_a_row_by_chance_do_not_change_the_pace() {
        // of ten one is lost, and then every second one for a while
        let often = (0..2000).filter(|k| k % 10 > 0);
        assert_eq!(pace(often.clone().chain((2001..2010).step_by(2))), 1.0);
        assert_eq!(pace((0..2000).chain((2001..2010).step_by(2))), 2.0);
        // a first interval that is short is none of theirs
        assert_eq!(pace([0].into_iter().chain((1..40).step_by(2))), 2.0);
    }

    /// A force that comes a sample late is known of the last interval when the next sample has come; one that comes a
    /// sample early was before the first.
    #[test]
    fn what_acted_at_the_ends_is_not_known_after_a_move() {
        let unseen = |later: f64, samples: u64| {
            let mut moved = window(0.0);
            moved.set_timing(Hold::Zero, later);
            (0..samples).for_each(|k| moved.push(Sample { t: 12.0 + k as f64, ..Sample::default() }));
            (moved.oldest() + 1..moved.end()).map(|number| moved.observation(number).unseen > 0.0).collect::<Vec<_>>()
        };
        assert_eq!(unseen(-1.0, 2), [false, false, false, false, true, true, false]);
        assert_eq!(unseen(1.0, 0), [true, false, false, false, false, false, false]);
        assert_eq!(unseen(0.0, 2), [false; 7]);
    }

    #[test]
    fn samples_kept_are_moved_as_those_to_come_are_aligned() {
        for later in [0.25, 1.0, 1.5, -0.25, -1.0] {
            let mut moved = window(0.0);
            moved.set_timing(Hold::Linear, later);
            let aligned = window(later);
            // beyond the ends of what is kept the last value stays
            for number in moved.oldest() + 2..moved.end() - 1 {
                assert_eq!(moved.sample(number), aligned.sample(number), "{later}: {number}");
            }
        }
    }
}
