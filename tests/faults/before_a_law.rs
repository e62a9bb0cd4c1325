//! Faults in the first second, when the motion alone says what a reading may be: a law is found as without them.

use super::{BEYOND, NOISE, burst, identifier, plant, samples, watch};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use switchid::identify::{Sample, SensorState};
use switchid::simulate::Builtin;

/// Number of the first faulty sample.
const EARLY: usize = 500;

const PLANTS: [Builtin; 4] =
    [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite];

/// In every plant the law of such a record stands at its end, and its std held all the while.
fn stands(seed: u64, mut spoil: impl FnMut(&mut [Sample])) {
    for builtin in PLANTS {
        let scenario = plant(builtin, seed, 1e3, 10.0);
        let mut samples = samples(&scenario);
        spoil(&mut samples);
        let seen = watch(&scenario, builtin, &samples);
        let honest = !seen.unknown && seen.worst < BEYOND;
        assert!(seen.valid_at_the_end && honest && seen.switches == 0, "{builtin:?}: {seen:?}");
    }
}

#[test]
fn no_number_in_the_first_second_leaves_a_trace() {
    for value in [1e3, -1e100, f64::MAX] {
        stands(10_506, |samples| samples[EARLY..EARLY + 10].iter_mut().for_each(|sample| sample.q = value));
    }
}

/// Before anything is known the record begins after them.
#[test]
fn no_number_in_the_first_moment_leaves_a_trace() {
    for (first, value) in [(0, 1e300), (10, f64::MAX), (90, -1e5)] {
        stands(10_506, |samples| samples[first..first + 10].iter_mut().for_each(|sample| sample.q = value));
    }
}

#[test]
fn a_burst_is_none_of_the_motion() {
    stands(10_507, |samples| {
        burst(&mut samples[EARLY..EARLY + 50], 100.0, &mut ChaCha8Rng::seed_from_u64(10_507));
    });
}

/// Slow motions among them, whose readings repeat themselves at their turning points as a stuck sensor's do.
#[test]
fn a_sensor_that_is_stuck_for_a_second_is_left_out() {
    for seed in [10_506, 10_507] {
        stands(seed, |samples| {
            let stuck = samples[EARLY - 1].q;
            samples[EARLY..EARLY + 1000].iter_mut().for_each(|sample| sample.q = stuck);
        });
    }
}

#[test]
fn one_bad_reading_in_a_hundred_hides_no_law() {
    let mut generator = ChaCha8Rng::seed_from_u64(10_508);
    stands(10_508, |samples| {
        for sample in &mut samples[100..] {
            for value in [&mut sample.q, &mut sample.qd] {
                if generator.random_bool(0.01) {
                    *value += 100.0 * NOISE * generator.sample::<f64, _>(StandardNormal);
                }
            }
        }
    });
}

/// A velocity that a filter delays and scales is the motion's own.
#[test]
fn channels_that_do_not_fit_each_other_are_no_fault() {
    for builtin in PLANTS {
        let mut samples = samples(&plant(builtin, 10_509, 1e3, 4.0));
        for index in (20..samples.len()).rev() {
            samples[index].qd = 1.1 * samples[index - 20].qd;
        }
        let mut identifier = identifier(builtin);
        let mut said = [0, 0];
        for sample in &samples {
            identifier.step(*sample).unwrap();
            let states = identifier.output().sensors;
            said.iter_mut().zip(states).for_each(|(said, state)| *said += u32::from(state != SensorState::Ok));
        }
        assert_eq!(said, [0, 0], "{builtin:?}: samples with a fault of q and q̇");
    }
}
