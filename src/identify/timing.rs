//! When F acted: between samples, and against q and q̇. What is assumed of it is left where the motion tells otherwise.

use super::report::SensorState;
use super::sample::Sample;
use super::settings::Channels;
use crate::estimation::Lag;
use crate::law::Hold;
use serde::{Deserialize, Serialize};

/// A lag is taken for the nearest half sample from this std on: a quarter is two of them.
const TOLD: f64 = 0.125;

/// A lag further from every half sample than this is none that a hold or a late channel makes: F then comes late by a
/// time of its own.
const HALF: f64 = 0.1;

/// What is assumed of F.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timing {
    /// What it does between samples.
    pub hold: Hold,
    /// Samples that it acts later than it comes: 1 where q and q̇ come late, −1 where F does.
    pub lag: i8,
    /// Samples of the record that told so: another is believed of a record twice as long only.
    told_by: u64,
}

impl Timing {
    /// The channels in time.
    pub fn new(hold: Hold) -> Timing {
        Timing { hold, lag: 0, told_by: 0 }
    }

    /// What is assumed once a record of so many samples tells of a lag. To first order a force held over an interval is
    /// one that moves straight and acts half a sample late.
    pub fn corrected(&self, found: &Lag, samples: u64) -> Option<Timing> {
        let halves = (2.0 * found.samples).round();
        let is_told = found.std < TOLD && (found.samples - 0.5 * halves).abs() < HALF.max(3.0 * found.std);
        if !is_told || halves == 0.0 || samples < 2 * self.told_by || self.hold == Hold::BandLimited {
            return None;
        }
        let late = f64::from(2 * self.lag) + if self.hold == Hold::Zero { 1.0 } else { 0.0 } + halves;
        let lag = (0.5 * late).floor();
        let hold = if 2.0 * lag == late { Hold::Linear } else { Hold::Zero };
        (lag.abs() <= 1.0).then_some(Timing { hold, lag: lag as i8, told_by: samples })
    }

    /// Says which of the channels measured come late, where they do nothing worse.
    pub fn say_late(&self, channels: Channels, sensors: &mut [SensorState; 3]) {
        let late = match self.lag {
            0 => [false; 3],
            1.. => [channels.q, channels.qd, false],
            _ => [false, false, true],
        };
        let said = sensors.iter_mut().zip(late).filter(|(state, late)| *late && **state == SensorState::Ok);
        said.for_each(|(state, _)| *state = SensorState::Late);
    }
}

/// Samples of which F is that of the same instant as q and q̇.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Alignment {
    last: Option<Sample>,
    /// Time of the last sample that was given, s.
    given: Option<f64>,
}

impl Alignment {
    /// The sample with the F that acted at its instant; none where that is still to come.
    pub fn align(&mut self, lag: i8, sample: Sample) -> Option<Sample> {
        let last = self.last.replace(sample).unwrap_or(sample);
        let aligned = match lag {
            0 => sample,
            1.. => Sample { excitation: last.excitation, ..sample },
            _ => Sample { excitation: sample.excitation, ..last },
        };
        let is_new = self.given.is_none_or(|given| aligned.t > given);
        is_new.then(|| {
            self.given = Some(aligned.t);
            aligned
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(samples: f64) -> Lag {
        Lag { samples, std: 0.02, evidence: 50.0 }
    }

    #[test]
    fn half_a_sample_is_a_hold_and_a_whole_one_a_late_channel() {
        let held = Timing::new(Hold::Zero);
        let after = |timing: Timing, samples| timing.corrected(&found(samples), 1000).map(|new| (new.hold, new.lag));
        assert_eq!(after(held, -0.5), Some((Hold::Linear, 0)));
        assert_eq!(after(held, 0.98), Some((Hold::Zero, 1)));
        assert_eq!(after(held, -1.03), Some((Hold::Zero, -1)));
        assert_eq!(after(Timing::new(Hold::Linear), 0.5), Some((Hold::Zero, 0)));
        assert_eq!(after(held, 0.25), None, "no lag of a hold or a channel");
        assert_eq!(after(held, 5.0), None, "more than can be set right");
        assert_eq!(after(Timing::new(Hold::BandLimited), 1.0), None);
        assert_eq!(held.corrected(&Lag { std: 0.2, ..found(1.0) }, 1000), None, "not told yet");
    }

    #[test]
    fn what_was_left_is_believed_of_twice_the_record_only() {
        let late = Timing::new(Hold::Zero).corrected(&found(1.0), 1000).unwrap();
        assert_eq!(late.corrected(&found(-1.0), 1999), None);
        assert_eq!(late.corrected(&found(-1.0), 2000).map(|new| new.lag), Some(0));
    }

    #[test]
    fn a_late_channel_meets_the_others_of_its_instant_and_no_instant_comes_twice() {
        let mut alignment = Alignment::default();
        let sample =
            |k: i32| Sample { t: f64::from(k), q: f64::from(k), excitation: f64::from(10 * k), ..Sample::default() };
        let mut align = |lag, k| alignment.align(lag, sample(k)).map(|given| (given.t, given.q, given.excitation));
        assert_eq!(align(0, 1), Some((1.0, 1.0, 10.0)));
        assert_eq!(align(1, 2), Some((2.0, 2.0, 10.0)));
        assert_eq!(align(-1, 3), None);
        assert_eq!(align(-1, 4), Some((3.0, 3.0, 40.0)));
        assert_eq!(align(0, 5), Some((5.0, 5.0, 50.0)));
    }
}
