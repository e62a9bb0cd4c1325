//! Time stamps: one after a gap is believed once the next one agrees; a clock that was set back goes on from where it
//! was, after an outage.

use crate::identify::sample::{GAP, OUTAGE, PACE_SHARE, Skipped};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Steps of one length in a row that make up a clock: what is usual, or that it was set back.
const STEADY: u32 = 10;

/// Steps that are usual differ by this factor at most. Once a longer one has gone by without a sample that is used,
/// nothing that is said holds for the present.
const ALIKE: Range<f64> = 0.4..2.5;

/// What rounding leaves of the distance of two stamps, as a part of the later one: a step that is half of `sample_time`
/// is not sooner than that.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The clock of a stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Last time of the record, and the one before, s.
    last: Option<f64>,
    before: f64,
    /// What is added to a stamp: the clock may have been set back.
    shift: f64,
    /// The usual step, s, and how many it is known from.
    pace: f64,
    known: u32,
    /// Another step, s, and how many have been like it since one was like the usual.
    other: f64,
    others: u32,
    /// The last stamp from before the record's end, the first of those that it goes on from, and how many there are.
    stray: Option<f64>,
    first: f64,
    steady: u32,
}

impl Clock {
    /// The time of the record for a stamp; `sample_time` is the shortest step.
    ///
    /// # Errors
    /// [`Skipped`] where the stamp is not believed.
    pub fn time(&mut self, stamp: f64, sample_time: f64) -> Result<f64, Skipped> {
        let Some(last) = self.last else { return Ok(stamp) };
        let t = stamp + self.shift;
        let step = t - last;
        if step <= 0.0 {
            return self.set_back(stamp, last).ok_or(Skipped::NotLater { t: stamp, previous: last - self.shift });
        }
        if step + ROUNDING * t.abs() < 0.5 * sample_time {
            return Err(Skipped::TooSoon { t: stamp });
        }
        Ok(t)
    }

    /// Whether a sample of that time comes after a gap: samples were lost, or its stamp is wrong.
    pub fn is_after_gap(&self, t: f64) -> bool {
        self.is_late(t, GAP)
    }

    /// What is said of a stamp that the next one came before.
    pub fn ahead(&self, stamp: f64) -> Skipped {
        Skipped::Ahead { t: stamp, previous: self.last.map_or(stamp, |last| last - self.shift) }
    }

    /// Whether that time is more than so many usual steps after the last sample.
    fn is_late(&self, t: f64, steps: f64) -> bool {
        self.known >= STEADY && self.last.is_some_and(|last| t - last > steps * self.pace)
    }

    /// The time of a stamp of a clock that was set back, once that is sure.
    fn set_back(&mut self, stamp: f64, last: f64) -> Option<f64> {
        if self.known < STEADY || self.stray == Some(stamp) {
            return None;
        }
        let agrees = self.stray.is_some_and(|stray| ALIKE.contains(&((stamp - stray) / self.pace)));
        (self.first, self.steady) = if agrees { (self.first, self.steady + 1) } else { (stamp, 0) };
        self.stray = Some(stamp);
        // what comes before the last sample alone says that its stamp was ahead by less than a gap
        if self.steady < STEADY || stamp + self.shift > self.before {
            return None;
        }
        // when between the last sample of the record and the first that came before it nobody knows: a sender that
        // starts again may have been away, and whatever an outage brings may have come
        self.shift = last + OUTAGE * self.pace - self.first;
        Some(stamp + self.shift)
    }

    /// A sample of that time is used.
    pub fn advance(&mut self, t: f64) {
        if let Some(last) = self.last {
            let step = t - last;
            self.before = last;
            self.follow_pace(step);
        }
        (self.last, self.stray, self.first, self.steady) = (Some(t), None, 0.0, 0);
    }

    /// Steps in a row that are alike and not like the usual one are the new clock.
    fn follow_pace(&mut self, step: f64) {
        let is_alike = |other: f64| ALIKE.contains(&(step / other));
        if self.pace == 0.0 || is_alike(self.pace) {
            self.known = (self.known + 1).min(STEADY);
            self.pace += if self.pace == 0.0 { step } else { PACE_SHARE * (step - self.pace) };
            self.others = 0;
        } else {
            (self.other, self.others) = if is_alike(self.other) { (self.other, self.others + 1) } else { (step, 0) };
            if self.known < STEADY || self.others >= STEADY {
                (self.pace, self.known, self.others) = (step, 0, 0);
            }
        }
    }

    /// Whether the record has had no sample for longer than is usual, at a stamp that was skipped: it is later than the
    /// next sample can be, or one of several that came before the last.
    pub fn is_stale(&self, stamp: f64) -> bool {
        self.is_late(stamp + self.shift, ALIKE.end) || self.known >= STEADY && self.steady >= 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::sample::is_outage;

    fn times(stamps: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut clock = Clock::default();
        let mut believed = Vec::new();
        for stamp in stamps {
            if let Ok(t) = clock.time(stamp, 1e-3) {
                clock.advance(t);
                believed.push(t);
            }
        }
        believed
    }

    fn stamps(from: f64, count: u32) -> impl Iterator<Item = f64> {
        (0..count).map(move |index| from + 1e-3 * f64::from(index))
    }

    #[test]
    fn a_sample_comes_after_a_gap_once_the_usual_step_is_known() {
        let mut clock = Clock::default();
        for stamp in stamps(0.0, 50) {
            assert!(!clock.is_after_gap(stamp + 0.1) || stamp > 0.009);
            let t = clock.time(stamp, 1e-3).unwrap();
            clock.advance(t);
        }
        assert!(!clock.is_after_gap(0.053) && clock.is_after_gap(0.054) && clock.is_after_gap(1e6));
    }

    #[test]
    fn after_a_stamp_that_was_a_little_ahead_the_clock_is_what_it_was() {
        let seen = times(stamps(0.0, 50).chain([0.053]).chain(stamps(0.051, 50)));
        assert!(seen.is_sorted() && seen[51..].iter().zip(stamps(0.054, 30)).all(|(t, was)| (t - was).abs() < 1e-9));
    }

    #[test]
    fn a_clock_that_was_set_back_goes_on() {
        let seen = times(stamps(3600.0, 50).chain(stamps(0.0, 50)));
        assert!(seen.len() > 85 && seen.is_sorted() && seen[seen.len() - 1] < 3600.2, "{seen:?}");
    }

    #[test]
    fn the_record_is_stale_once_samples_are_missing_not_at_one_stamp_from_before() {
        let mut clock = Clock::default();
        stamps(0.0, 50).for_each(|stamp| {
            let t = clock.time(stamp, 1e-3).unwrap();
            clock.advance(t);
        });
        assert!(clock.time(0.01, 1e-3).is_err() && !clock.is_stale(0.01));
        assert!(!clock.is_stale(0.051) && clock.is_stale(0.0525) && !clock.is_stale(f64::NAN));
        [0.011, 0.012].into_iter().for_each(|stamp| assert!(clock.time(stamp, 1e-3).is_err()));
        assert!(clock.is_stale(0.012));
    }

    /// A sender that is four times as slow from then on is not for ever late.
    #[test]
    fn another_rate_becomes_the_usual_one() {
        let mut clock = Clock::default();
        let slower = (1..50).map(|index| 0.049 + 4e-3 * f64::from(index));
        for stamp in stamps(0.0, 50).chain(slower) {
            let t = clock.time(stamp, 1e-3).unwrap();
            clock.advance(t);
        }
        assert!(!clock.is_stale(0.245 + 6e-3) && clock.is_stale(0.245 + 12e-3));
    }

    #[test]
    fn a_sender_that_starts_again_may_have_been_away() {
        let seen = times(stamps(7.0, 50).chain(stamps(0.0, 50)));
        assert!(seen.windows(2).any(|pair| is_outage(pair[1] - pair[0], 1e-3)), "{seen:?}");
    }

    #[test]
    fn steps_of_half_a_sample_time_are_all_taken() {
        for (from, h) in [(0.0, 5e-4), (1234.5, 5e-4), (1e6, 5e-4)] {
            let summed = std::iter::successors(Some(from), |t| Some(t + h)).take(5000);
            let exact = (0..5000).map(|index| from + h * f64::from(index));
            assert_eq!([times(summed).len(), times(exact).len()], [5000; 2], "{from}");
        }
        let sooner = (0..5000).map(|index| 1234.5 + 4.9e-4 * f64::from(index));
        assert_eq!(times(sooner).len(), 2500);
    }

    #[test]
    fn stamps_that_repeat_are_skipped() {
        assert_eq!(times([0.0, 1e-3, 1e-3, 1e-3, 2e-3]).len(), 3);
    }
}
