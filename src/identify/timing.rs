//! When F acted: between samples, and against q and q̇. What is assumed of it is left where the motion tells otherwise.

use super::faults::{Lateness, is_held};
use super::report::SensorState;
use super::sample::Sample;
use super::settings::Channels;
use crate::estimation::{Lag, TWENTY_TO_ONE, log_sum};
use crate::law::Hold;
use serde::{Deserialize, Serialize};

/// Samples that F may be told to act later and earlier than it comes: by one, and by what a hold adds to that.
const LATEST: f64 = 1.5;
const EARLIEST: f64 = -1.0;

/// Samples that are kept for an F that acts at another time: where it begins to it may by one more.
const FARTHEST: f64 = 2.0;

/// Std of a lag that nobody has told yet, in samples: that of a hold.
const UNTOLD: f64 = 0.5;

/// Std of what any hold or late channel is in truth, in samples: clocks and the integration between samples are no
/// better, and without noise a record would tell a lag of that size.
const EXACT: f64 = 0.01;

/// What else than is assumed F may do: six multiples of half a sample, and any lag.
const RIVALS: usize = 7;

/// What is assumed of F.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// What it does between samples.
    pub hold: Hold,
    /// What it was said to do.
    said: Hold,
    /// Samples that it acts later than it comes: 1 where q and q̇ come a sample late, −1 where F does.
    pub lag: f64,
    /// Std of that; 0 where a hold or a late channel explains it.
    std: f64,
    /// Samples of the record that told so: another is believed of a record twice as long only.
    told_by: u64,
    /// Whether a law has been validated under it: what a law lacks may look like a lag.
    is_confirmed: bool,
}

impl Timing {
    /// The channels in time.
    pub fn new(hold: Hold) -> Timing {
        Timing { hold, said: hold, lag: 0.0, std: 0.0, told_by: 0, is_confirmed: false }
    }

    /// What was assumed before anything was told.
    pub fn anew(&self) -> Timing {
        Timing::new(self.said)
    }

    /// What F does between samples, where a hold that changed is a lag of half a sample.
    pub fn shown_hold(&self) -> Hold {
        match (is_held(self.hold, self.lag), self.hold) {
            (true, _) => Hold::Zero,
            (false, Hold::Zero) => Hold::Linear,
            (false, other) => other,
        }
    }

    /// Samples that F acts later than it comes, were it to move straight: to first order a force held over an interval
    /// is one that does and acts half a sample late.
    pub fn late(&self) -> f64 {
        self.lag + if self.hold == Hold::Zero { 0.5 } else { 0.0 }
    }

    /// What is assumed once a channel has begun to come late, after so many samples of the record; none of what is more
    /// than can be set right, or where F is interpolated from samples to come.
    pub fn moved(&self, late: &Lateness, samples: u64) -> Option<Timing> {
        let lag = self.lag + late.later;
        let is_told = self.hold != Hold::BandLimited && lag.abs() <= FARTHEST;
        is_told.then_some(Timing { lag, told_by: samples, is_confirmed: true, ..*self })
    }

    /// What is assumed once a record of so many samples tells of a lag.
    pub fn corrected(&self, found: &Lag, samples: u64) -> Option<Timing> {
        if samples < 2 * self.told_by || self.odds(found) < TWENTY_TO_ONE {
            return None;
        }
        let likeliest = self.likeliest(found);
        let (late, std) = (self.late() + likeliest.moved, likeliest.std);
        let hold = if (late - 0.5).fract() == 0.0 { Hold::Zero } else { Hold::Linear };
        let lag = late - if hold == Hold::Zero { 0.5 } else { 0.0 };
        // what is interpolated from samples to come is held instead, or comes in time
        let is_possible = self.hold != Hold::BandLimited || hold == Hold::Zero && lag == 0.0;
        let is_new = (EARLIEST..=LATEST).contains(&lag) && is_possible;
        is_new.then_some(Timing { hold, lag, std, told_by: samples, is_confirmed: false, ..*self })
    }

    /// What else F does by such a record: a hold or a late channel where one stands out from the others, else a lag of
    /// its own.
    fn likeliest(&self, found: &Lag) -> Rival {
        let [mut apart @ .., own] = self.rivals(found, TWENTY_TO_ONE);
        apart.sort_unstable_by(|a, b| b.odds.total_cmp(&a.odds));
        let stands_out = apart[0].odds > own.odds && apart[0].odds - apart[1].odds > TWENTY_TO_ONE;
        if stands_out { apart[0] } else { own }
    }

    /// Log-odds by a record that F acts at another time than is assumed, nats.
    pub fn odds(&self, found: &Lag) -> f64 {
        self.rivals(found, TWENTY_TO_ONE).iter().map(|rival| rival.odds).fold(f64::NEG_INFINITY, log_sum)
    }

    /// Mean square of the lag beyond what is assumed that a record saying `found` leaves open, in squares of a sample:
    /// what is assumed must be likelier to be left, but is no likelier than anything else where a std is told.
    pub fn left_open(&self, found: &Lag) -> f64 {
        if self.hold == Hold::BandLimited {
            return 0.0;
        }
        if self.std > 0.0 {
            return self.own(found, self.std).square();
        }
        let rivals = self.rivals(found, 0.0);
        let most = rivals.iter().map(|rival| rival.odds).fold(0.0, f64::max);
        let share = |odds: f64| (odds - most).exp();
        let all = share(0.0) + rivals.iter().map(|rival| share(rival.odds)).sum::<f64>();
        rivals.iter().map(|rival| share(rival.odds) * rival.square()).sum::<f64>() / all
    }

    /// What else F may do by a record that says `found`. What is assumed is right at odds of `price` nats against a
    /// hold or channels that come late, which are multiples of half a sample, and these at as much against a lag of any
    /// size; both are normal about it.
    fn rivals(&self, found: &Lag, price: f64) -> [Rival; RIVALS] {
        let found = &found.blurred(EXACT);
        let moves: [f64; RIVALS - 1] = std::array::from_fn(|place| EARLIEST + 0.5 * place as f64 - self.late());
        let apart = |moved: f64| if moved == 0.0 { f64::NEG_INFINITY } else { -0.5 * (moved / UNTOLD).powi(2) };
        let all = moves.into_iter().map(apart).fold(f64::NEG_INFINITY, log_sum);
        let own = self.own(found, UNTOLD);
        let own = Rival { odds: own.odds - 2.0 * price, ..own };
        std::array::from_fn(|place| match moves.get(place) {
            Some(&moved) => {
                let odds = apart(moved) - all + found.evidence_of(moved) - price;
                Rival { moved, std: 0.0, odds }
            }
            None => own,
        })
    }

    /// A lag of any size, normal with the std `prior` before the record.
    fn own(&self, found: &Lag, prior: f64) -> Rival {
        let variance = (found.std.powi(-2) + prior.powi(-2)).recip();
        let moved = variance * found.std.powi(-2) * found.samples;
        let misfit = 0.5 * found.samples * found.samples / (found.std * found.std + prior * prior);
        let odds = found.evidence - misfit + (variance.sqrt() / prior).ln();
        Rival { moved, std: variance.sqrt(), odds }
    }

    /// Says which of the channels measured come late, where they do nothing worse and a law has been valid with that.
    pub fn say_late(&mut self, is_valid: bool, channels: Channels, sensors: &mut [SensorState; 3]) {
        self.is_confirmed |= is_valid;
        // up to half a sample is a hold's
        let late = match self.late() {
            _ if !self.is_confirmed => [false; 3],
            late if late > 0.5 => [channels.q, channels.qd, false],
            late => [false, false, late < 0.0],
        };
        let said = sensors.iter_mut().zip(late).filter(|(state, late)| *late && **state == SensorState::Ok);
        said.for_each(|(state, _)| *state = SensorState::Late);
    }
}

/// What F may do instead of what is assumed.
#[derive(Clone, Copy, Debug)]
struct Rival {
    /// By how many samples F then acts later, and the std of that.
    moved: f64,
    std: f64,
    /// Log-odds against what is assumed.
    odds: f64,
}

impl Rival {
    /// Mean square of the lag.
    fn square(&self) -> f64 {
        self.moved * self.moved + self.std * self.std
    }
}

/// Samples that F is read from: the present one and as many before as F may act later, and one.
const RECENT: usize = 4;

/// Samples of which F is that of the same instant as q and q̇.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Alignment {
    /// The last samples, the newest first; before there were so many, the first.
    recent: [Sample; RECENT],
    /// Time of the last sample that was given, s.
    given: Option<f64>,
    has_begun: bool,
}

impl Alignment {
    /// The sample with the F that acted at its instant; none where that is still to come.
    pub fn align(&mut self, lag: f64, sample: Sample) -> Option<Sample> {
        if !std::mem::replace(&mut self.has_begun, true) {
            self.recent = [sample; RECENT];
        }
        self.recent.rotate_right(1);
        self.recent[0] = sample;
        // where F comes late that of the present instant is still to come
        let behind = (-lag).max(0.0).ceil();
        let (whole, share) = ((behind + lag).floor(), (behind + lag).fract());
        let excitation = |back: f64| self.recent[(back as usize).min(RECENT - 1)].excitation;
        // a mean of two, which is finite and at its ends exact whatever a sensor sends
        let excitation = (1.0 - share) * excitation(whole) + share * excitation(whole + 1.0);
        let aligned = Sample { excitation, ..self.recent[behind as usize] };
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
        Lag::of(samples, 0.02)
    }

    #[test]
    fn half_a_sample_is_a_hold_and_a_whole_one_a_late_channel() {
        let held = Timing::new(Hold::Zero);
        let after = |timing: Timing, samples| timing.corrected(&found(samples), 1000).map(|new| (new.hold, new.lag));
        assert_eq!(after(held, -0.5), Some((Hold::Linear, 0.0)));
        assert_eq!(after(held, 0.98), Some((Hold::Zero, 1.0)));
        assert_eq!(after(held, -1.03), Some((Hold::Zero, -1.0)));
        assert_eq!(after(Timing::new(Hold::Linear), 0.5), Some((Hold::Zero, 0.0)));
        let own = after(held, -0.25).map(|(hold, lag)| (hold, (100.0 * lag).round()));
        assert_eq!(own, Some((Hold::Linear, 25.0)), "a force that is late by a time of its own");
        assert_eq!(after(held, 0.05), None, "chance");
        assert_eq!(after(held, 5.0), None, "more than can be set right");
        assert_eq!(after(Timing::new(Hold::BandLimited), 0.5), Some((Hold::Zero, 0.0)));
        assert_eq!(after(Timing::new(Hold::BandLimited), 1.0), None);
    }

    #[test]
    fn a_hold_is_likelier_than_a_late_channel_and_that_than_any_lag() {
        let told = |samples, std| Timing::new(Hold::Zero).corrected(&Lag::of(samples, std), 1000);
        let found = |samples, std| told(samples, std).map(|new| (new.hold, new.lag, new.std));
        assert_eq!(found(-0.5, 0.14), None, "6.4 nats");
        assert_eq!(found(-0.5, 0.13), Some((Hold::Linear, 0.0, 0.0)), "7.4 nats");
        assert_eq!(found(1.0, 0.27), None, "6.9 nats");
        assert_eq!(found(1.0, 0.16), Some((Hold::Zero, 1.0, 0.0)), "19.5 nats");
        assert!(found(1.0, 0.23).is_some_and(|(.., std)| std > 0.0), "9.5 nats: half a sample is no less likely");
        assert!(found(-0.25, 0.07).is_none(), "6.4 nats");
        assert!(found(-0.25, 0.05).is_some_and(|(.., std)| std > 0.0), "12.5 nats");
    }

    #[test]
    fn what_was_left_is_believed_of_twice_the_record_only() {
        let late = Timing::new(Hold::Zero).corrected(&found(1.0), 1000).unwrap();
        assert_eq!(late.corrected(&found(-1.0), 1999), None);
        assert_eq!(late.corrected(&found(-1.0), 2000).map(|new| new.lag), Some(0.0));
    }

    #[test]
    fn what_is_left_open_is_the_prior_before_a_record_and_the_lag_itself_after_it() {
        let held = Timing::new(Hold::Zero);
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.01;
        assert!(near(held.left_open(&Lag::UNKNOWN), 0.2169), "{}", held.left_open(&Lag::UNKNOWN));
        assert!(near(held.left_open(&found(0.3)), 0.09), "{}", held.left_open(&found(0.3)));
        assert!(near(held.left_open(&found(0.0)), 0.043 * 0.0223_f64.powi(2)), "{}", held.left_open(&found(0.0)));
        let told = held.corrected(&found(-0.25), 1000).unwrap();
        assert!(near(told.left_open(&Lag::UNKNOWN), 0.02 * 0.02 + EXACT * EXACT));
    }

    /// A hold that changed in mid-stream is kept as a lag.
    #[test]
    fn half_a_sample_that_has_come_in_the_stream_is_shown_as_a_hold() {
        let after = |timing: Timing, later| {
            let moved = timing.moved(&Lateness { later, first: 0 }, 1000);
            moved.map(|moved| (moved.late(), moved.shown_hold()))
        };
        assert_eq!(after(Timing::new(Hold::Zero), -0.5), Some((0.0, Hold::Linear)));
        assert_eq!(after(Timing::new(Hold::Linear), 0.5), Some((0.5, Hold::Zero)));
        let late = Timing::new(Hold::Zero).corrected(&found(1.0), 1000).unwrap();
        assert_eq!(after(late, -0.5), Some((1.0, Hold::Linear)));
        assert_eq!(after(Timing::new(Hold::BandLimited), 1.0), None);
    }

    #[test]
    fn late_is_said_once_a_law_has_been_valid_with_it() {
        let mut late = Timing::new(Hold::Zero).corrected(&found(1.0), 1000).unwrap();
        let mut said = |is_valid| {
            let mut sensors = [SensorState::Ok; 3];
            late.say_late(is_valid, Channels::ALL, &mut sensors);
            sensors[0]
        };
        let (ok, late) = (SensorState::Ok, SensorState::Late);
        assert_eq!([said(false), said(true), said(false)], [ok, late, late]);
    }

    #[test]
    fn a_late_channel_meets_the_others_of_its_instant_and_no_instant_comes_twice() {
        let mut alignment = Alignment::default();
        let sample =
            |k: i32| Sample { t: f64::from(k), q: f64::from(k), excitation: f64::from(10 * k), ..Sample::default() };
        let mut align = |lag, k| alignment.align(lag, sample(k)).map(|given| (given.t, given.q, given.excitation));
        assert_eq!(align(0.0, 1), Some((1.0, 1.0, 10.0)));
        assert_eq!(align(1.0, 2), Some((2.0, 2.0, 10.0)));
        assert_eq!(align(-1.0, 3), None);
        assert_eq!(align(-1.0, 4), Some((3.0, 3.0, 40.0)));
        assert_eq!(align(0.0, 5), Some((5.0, 5.0, 50.0)));
        assert_eq!(align(0.25, 6), Some((6.0, 6.0, 57.5)));
        assert_eq!(align(-0.25, 7), None);
        assert_eq!(align(-0.25, 8), Some((7.0, 7.0, 72.5)));
        assert_eq!(align(1.5, 9), Some((9.0, 9.0, 75.0)));
    }

    #[test]
    fn what_is_read_between_two_finite_forces_is_finite_and_at_the_ends_exact() {
        for (lag, expected) in [(0.0, -f64::MAX), (0.5, 0.0), (1.0, f64::MAX), (1.5, f64::MAX)] {
            let mut alignment = Alignment::default();
            let forces = [f64::MAX, f64::MAX, -f64::MAX].into_iter().enumerate();
            let samples = forces.map(|(k, excitation)| Sample { t: k as f64, excitation, ..Sample::default() });
            let aligned: Vec<f64> = samples.map(|sample| alignment.align(lag, sample).unwrap().excitation).collect();
            assert_eq!(aligned[2], expected, "{lag}");
        }
    }
}
