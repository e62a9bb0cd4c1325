//! Readings that are off for a while and as before after it: none is a switch, and none is lost for what comes.

use super::{BEYOND, FAULT, FIRST, NOISE, burst, identifier, plant, samples, steady, watch};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use switchid::identify::Sample;
use switchid::simulate::Builtin;

const PLANTS: [Builtin; 4] =
    [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite];

#[test]
fn a_few_bad_readings_of_the_velocity_are_no_switch() {
    for (seed, (count, size)) in (40..).zip([(1, 100.0), (2, 10.0), (2, 1000.0), (7, 30.0), (20, 3.0), (50, 300.0)]) {
        let (scenario, mut samples) = steady(seed);
        burst(&mut samples[FIRST..FIRST + count], size, &mut ChaCha8Rng::seed_from_u64(seed));
        let seen = watch(&scenario, Builtin::DuffingSine, &samples);
        let calm = seen.switches == 0 && seen.valid_at_the_end && !seen.unknown && seen.worst < BEYOND;
        assert!(calm && seen.invalid_until < FAULT + 0.35, "{count} of {size} stds: {seen:?}");
    }
}

/// Under a rough excitation readings that are each too near to be held speak for a switch of the inertia together.
#[test]
fn a_burst_in_which_no_reading_is_far_off_is_no_switch() {
    for seed in 10..14 {
        let scenario = plant(Builtin::DuffingWhite, seed, 1e3, 9.0);
        let mut samples = samples(&scenario);
        burst(&mut samples[FIRST..FIRST + 20], 3.4, &mut ChaCha8Rng::seed_from_u64(seed));
        let seen = watch(&scenario, Builtin::DuffingWhite, &samples);
        assert!(seen.switches == 0, "seed {seed}: {seen:?}");
    }
}

/// The first readings of a burst near the noise are what louder sensors would read.
#[test]
fn a_burst_near_the_noise_is_not_louder_sensors() {
    for seed in [7, 13, 15, 20, 58] {
        let scenario = plant(Builtin::DuffingWhite, 80 + seed, 1e3, 10.0);
        let mut samples = samples(&scenario);
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        for sample in &mut samples[FIRST..FIRST + 15] {
            let mut off = || 3.0 * NOISE * generator.random_range(0.5..1.5) * [-1.0, 1.0][generator.random_range(0..2)];
            (sample.q, sample.qd) = (sample.q + off(), sample.qd + off());
        }
        let seen = watch(&scenario, Builtin::DuffingWhite, &samples);
        assert!(seen.switches == 0 && seen.worst < BEYOND, "{seed}: {seen:?}");
    }
}

/// What a loud second explained is no reason against the switch that follows it.
#[test]
fn a_switch_after_a_loud_second_is_seen_soon() {
    for seed in 10..14 {
        let scenario = plant(Builtin::DuffingWhite, seed, FAULT + 0.5, 9.5);
        let mut samples = samples(&scenario);
        burst(&mut samples[FIRST..FIRST + 500], 5.0, &mut ChaCha8Rng::seed_from_u64(seed));
        let seen = watch(&scenario, Builtin::DuffingWhite, &samples);
        assert!(seen.switches == 1, "seed {seed}: {seen:?}");
    }
}

/// Its first reading, just too near to be one of a burst alone, would speak for a switch with 18 nats.
#[test]
fn a_burst_has_begun_before_it_is_sure() {
    for seed in 0..6 {
        let (scenario, mut samples) = steady(seed);
        for (sample, off) in samples[FIRST..].iter_mut().zip([6.3, -11.0, -12.0, 14.0]) {
            sample.qd += NOISE * off;
        }
        let seen = watch(&scenario, Builtin::DuffingSine, &samples);
        assert!(seen.switches == 0 && seen.valid_at_the_end, "seed {seed}: {seen:?}");
    }
}

/// Its first readings are let through one by one, or are set aside before the burst is known.
#[test]
fn a_burst_that_is_not_held_from_its_first_reading_on_is_no_switch() {
    for (builtin, seed, count, size) in [(Builtin::DuffingSine, 377, 7, 6.0), (Builtin::DuffingWhite, 351, 5, 3.5)] {
        let scenario = plant(builtin, seed, 1e3, 9.5);
        let mut samples = samples(&scenario);
        burst(&mut samples[FIRST..FIRST + count], size, &mut ChaCha8Rng::seed_from_u64(seed));
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.valid_at_the_end, "{builtin:?} {seed}: {seen:?}");
    }
}

/// Only an acceleration far beyond what a switch usually brings explains two readings far off on one side.
#[test]
fn two_readings_far_off_under_a_rough_excitation_are_no_switch() {
    for (builtin, seed) in [(Builtin::DuffingWhite, 10_443), (Builtin::DuffingWhite, 70), (Builtin::VanDerPolWhite, 71)]
    {
        let scenario = plant(builtin, seed, 1e3, 9.5);
        let mut samples = samples(&scenario);
        samples[FIRST].qd -= 27.0 * NOISE;
        samples[FIRST + 1].qd -= 42.0 * NOISE;
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.valid_at_the_end, "{builtin:?} {seed}: {seen:?}");
    }
}

/// What a large switch makes of readings under a rough force is no burst, however many a sensor has had.
#[test]
fn a_large_switch_long_after_bursts_has_its_name_as_soon_as_without() {
    let switch = 20.0;
    for builtin in [Builtin::DuffingWhite, Builtin::VanDerPolWhite] {
        let mut samples = samples(&plant(builtin, 10_506, switch, 20.5));
        for first in [8_000, 10_000, 12_000, 14_000, 16_000, 18_000] {
            for (sample, size) in samples[first..].iter_mut().zip([1.0, -0.7, 0.4, -1.3, 0.9]) {
                sample.qd += size;
            }
        }
        let mut identifier = identifier(builtin);
        samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
        let output = identifier.output();
        let delay = output.named_time.map(|named| named - switch);
        assert!(output.switch_count == 1 && delay.is_some_and(|delay| delay < 0.02), "{builtin:?}: {output:?}");
    }
}

/// A step of the velocity is no bend of it, the same in every reading or scattered. By its first readings chance may
/// make it one.
#[test]
fn a_burst_of_the_velocity_to_one_side_is_seldom_a_switch() {
    let mut switches = Vec::new();
    for (builtin, seed) in PLANTS.into_iter().chain(PLANTS).zip(60..) {
        let samples = samples(&plant(builtin, seed, 1e3, 9.0));
        let mut steady = identifier(builtin);
        samples[..FIRST].iter().for_each(|sample| steady.step(*sample).unwrap());
        for (size, count) in [(3.0, 10), (3.0, 20), (5.0, 10), (5.0, 20)] {
            for scatter in [0.0, 0.5] {
                let mut generator = ChaCha8Rng::seed_from_u64(seed);
                let mut identifier = steady.clone();
                for (place, sample) in samples[FIRST..].iter().enumerate() {
                    let off = size * NOISE * (1.0 + scatter * generator.random_range(-1.0..1.0));
                    let off = if place < count { off } else { 0.0 };
                    identifier.step(Sample { qd: sample.qd + off, ..*sample }).unwrap();
                }
                switches.push(identifier.output().switch_count);
            }
        }
    }
    assert!(3 * switches.iter().sum::<u32>() <= switches.len() as u32, "{switches:?}");
}

/// What chance makes look like a step at first goes on as no burst does: its readings count after all.
#[test]
fn a_switch_that_begins_like_a_step_has_its_name_soon() {
    let builtin = Builtin::VanDerPolSine;
    let mut scenario = plant(builtin, 10_610, 10.0, 11.0);
    scenario.stages[1].coefficients = builtin.random(10_610 + 77_014).stages[1].coefficients.clone();
    let mut identifier = identifier(builtin);
    samples(&scenario).iter().for_each(|sample| identifier.step(*sample).unwrap());
    let output = identifier.output();
    let delay = output.named_time.map(|named| named - 10.0);
    assert!(output.switch_count == 1 && delay.is_some_and(|delay| delay < 0.05), "{delay:?}: {output:?}");
}
