//! While nothing that is read counts, nothing holds: channels that are dead, a sender that was away.

use super::{FIRST, identifier, plant, samples};
use switchid::identify::{Identifier, Sample};
use switchid::simulate::Builtin;

/// The share of the samples with which `valid` holds.
fn valid_share(identifier: &mut Identifier, samples: &[Sample]) -> f64 {
    let mut valid = 0;
    for sample in samples {
        identifier.step(*sample).ok();
        valid += u32::from(identifier.output().valid);
    }
    f64::from(valid) / samples.len() as f64
}

/// A plug is pulled for three seconds, in which the law switches.
#[test]
fn no_law_is_valid_while_its_channels_are_dead() {
    let dead: [fn(&mut Sample); 3] = [
        |sample| (sample.q, sample.qd) = (0.0, 0.0),
        |sample| (sample.q, sample.qd, sample.excitation) = (0.0, 0.0, 0.0),
        |sample| (sample.q, sample.qd) = (1e300, -1e300),
    ];
    for (number, dead) in dead.into_iter().enumerate() {
        for builtin in [Builtin::DuffingSine, Builtin::VanDerPolWhite] {
            let mut samples = samples(&plant(builtin, 10_516, 9.5, 16.0));
            samples[FIRST..FIRST + 3000].iter_mut().for_each(dead);
            let mut identifier = identifier(builtin);
            assert!(valid_share(&mut identifier, &samples[..FIRST]) > 0.3, "{builtin:?}");
            // what a channel repeats is told once that is no chance
            valid_share(&mut identifier, &samples[FIRST..FIRST + 100]);
            let share = valid_share(&mut identifier, &samples[FIRST + 100..FIRST + 3000]);
            assert!(share == 0.0, "{number}, {builtin:?}: valid in {share} of the samples");
            valid_share(&mut identifier, &samples[FIRST + 3000..]);
            let output = identifier.output();
            assert!(output.switch_count == 1 && output.valid, "{number}, {builtin:?}: {output:?}");
        }
    }
}

/// Its clock begins at nought again, and nobody knows how long it was away.
#[test]
fn a_sender_that_was_away_and_starts_again_is_no_switch() {
    for builtin in [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine] {
        for away in [0.3, 1.0, 3.0] {
            let mut samples = samples(&plant(builtin, 10_517, 1e3, 16.0));
            let back = samples[FIRST].t + away;
            samples.retain(|sample| sample.t < back - away || sample.t >= back);
            samples.iter_mut().filter(|sample| sample.t >= back).for_each(|sample| sample.t -= back);
            let mut identifier = identifier(builtin);
            valid_share(&mut identifier, &samples);
            let output = identifier.output();
            assert!(output.switch_count == 0 && output.valid, "{builtin:?}, {away} s: {output:?}");
        }
    }
}

/// By the time what it did has become a switch F varies again.
#[test]
fn a_force_that_was_stuck_for_a_moment_is_no_switch() {
    for (builtin, first, count) in [
        (Builtin::VanDerPolSine, 10_474, 100),
        (Builtin::VanDerPolWhite, 10_971, 25),
        (Builtin::DuffingWhite, 9295, 25),
    ] {
        let mut samples = samples(&plant(builtin, 700, 1e3, 14.0));
        let stuck = samples[first - 1].excitation;
        samples[first..first + count].iter_mut().for_each(|sample| sample.excitation = stuck);
        let mut identifier = identifier(builtin);
        valid_share(&mut identifier, &samples);
        let output = identifier.output();
        assert!(output.switch_count == 0 && output.valid, "{builtin:?}: {output:?}");
    }
}
