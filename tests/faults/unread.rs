//! Channels that are not read anew for every sample: the last value stands for what they have gone on to.

use super::{identifier, plant, samples, watch};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use switchid::identify::{Sample, SensorState};
use switchid::simulate::Builtin;

/// The readings of q and q̇ as they were last read, by whether each is read anew at a sample.
fn held(samples: &[Sample], mut is_read: impl FnMut(usize) -> [bool; 2]) -> Vec<Sample> {
    let mut last = samples[0];
    let hold = |(index, sample): (usize, &Sample)| {
        let [q, qd] = is_read(index);
        (last.q, last.qd) = (if q { sample.q } else { last.q }, if qd { sample.qd } else { last.qd });
        Sample { q: last.q, qd: last.qd, ..*sample }
    };
    samples.iter().enumerate().map(hold).collect()
}

/// A logger that writes every channel at the rate of the fastest.
#[test]
fn a_channel_that_is_read_every_fifth_sample_leaves_the_law_and_hides_no_switch() {
    for (builtin, channels) in [
        (Builtin::DuffingSine, [true, false]),
        (Builtin::DuffingSine, [false, true]),
        (Builtin::VanDerPolSine, [true, true]),
        (Builtin::DuffingWhite, [false, true]),
        (Builtin::VanDerPolWhite, [true, true]),
    ] {
        let scenario = plant(builtin, 18, 20.0, 30.0);
        let samples = held(&samples(&scenario), |index| channels.map(|held| !held || index % 5 == 0));
        let seen = watch(&scenario, builtin, &samples);
        let is_stuck = (0..2).any(|channel| seen.said(channel).contains(&SensorState::Stuck));
        assert!(seen.switches == 1 && seen.valid_at_the_end && !is_stuck, "{builtin:?} {channels:?}: {seen:?}");
        assert!(seen.worst < 6.0 && !seen.unknown, "{builtin:?} {channels:?}: {seen:?}");
    }
}

/// A sender that now and then has nothing new of one channel.
#[test]
fn readings_that_repeat_the_last_one_now_and_then_are_none() {
    for builtin in [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite] {
        let scenario = plant(builtin, 18, 20.0, 30.0);
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        let samples = held(&samples(&scenario), |_| [true, generator.random_bool(0.9)]);
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 1 && seen.valid_at_the_end && seen.worst < 6.0, "{builtin:?}: {seen:?}");
    }
}

/// What a channel does as a rule is no fault; what lasts for longer than it ever did is.
#[test]
fn a_channel_that_is_read_now_and_then_may_be_stuck_too() {
    let scenario = plant(Builtin::DuffingSine, 18, 1e3, 14.0);
    let samples = held(&samples(&scenario), |index| [true, index % 5 == 0 && !(10_000..11_000).contains(&index)]);
    let mut identifier = identifier(Builtin::DuffingSine);
    let mut stuck = Vec::new();
    for sample in &samples {
        identifier.step(*sample).unwrap();
        stuck.extend((identifier.output().sensors[1] == SensorState::Stuck).then_some(sample.t));
    }
    let [first, last] = [stuck.first(), stuck.last()].map(|t| t.copied().unwrap_or(f64::NAN));
    assert!((10.0..10.2).contains(&first) && (10.99..11.01).contains(&last), "{first} to {last}");
    let output = identifier.output();
    assert!(output.switch_count == 0 && output.valid, "{output:?}");
}
