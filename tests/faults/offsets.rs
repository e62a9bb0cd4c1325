//! Readings that are off for good, by little or by as much as the motion, in either channel.

use super::{NOISE, Seen, burst_to_one_side, plant, samples};
use switchid::identify::{Identifier, Sample, SensorState, Settings};
use switchid::law::{Given, Hold, Model};
use switchid::simulate::{Builtin, Scenario};

/// What is seen of samples of one law, of which both terms and all of a library are asked for by turns.
fn watch(scenario: &Scenario, builtin: Builtin, library: bool, samples: &[Sample]) -> Seen {
    let given = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    let model = if library { Model::cubic_library() } else { given };
    let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
    let mut seen = Seen::default();
    for sample in samples {
        identifier.step(*sample).unwrap();
        seen.take_state(&identifier);
    }
    seen.switches = identifier.output().switch_count;
    seen.valid_at_the_end = identifier.output().valid;
    seen.worst = largest_error(&identifier, scenario);
    seen
}

/// In std.
fn largest_error(identifier: &Identifier, scenario: &Scenario) -> f64 {
    let truth = &scenario.stages[0].coefficients;
    let of = |term| scenario.terms.iter().position(|own| *own == term).map_or(0.0, |place| truth[place]);
    let known = identifier.coefficients().iter().filter_map(|known| Some((known, known.std.filter(|std| *std > 0.0)?)));
    known.map(|(known, std)| (known.value - of(known.term)).abs() / std).fold(0.0, f64::max)
}

/// The offset of (q, q̇) from time `at` on, before which so many seconds are missing.
fn put_off(samples: &mut Vec<Sample>, at: f64, gap: f64, offset: [f64; 2]) {
    samples.retain(|sample| !(at - gap..at).contains(&sample.t));
    for sample in samples.iter_mut().filter(|sample| sample.t >= at) {
        (sample.q, sample.qd) = (sample.q + offset[0], sample.qd + offset[1]);
    }
}

fn is_told(seen: &Seen, channel: usize) -> bool {
    seen.switches == 0
        && seen.valid_at_the_end
        && seen.worst < 6.0
        && seen.sensors[channel].last() == Some(&SensorState::Offset)
}

/// The law in use follows what is read after an outage, and is as far from the motion as that.
#[test]
fn an_offset_of_the_velocity_after_an_outage_is_neither_one_of_the_displacement_nor_a_switch() {
    for (builtin, library, seed, at, gap, stds) in [
        (Builtin::DuffingWhite, true, 500_008, 11.014, 0.29, -182.7),
        (Builtin::DuffingSine, false, 510_080, 9.957, 1.13, 25.3),
        (Builtin::VanDerPolWhite, false, 510_017, 10.0, 0.5, -16.6),
    ] {
        let scenario = plant(builtin, seed, 1e3, at + 5.0);
        let mut samples = samples(&scenario);
        put_off(&mut samples, at, gap, [0.0, stds * NOISE]);
        let seen = watch(&scenario, builtin, library, &samples);
        assert!(is_told(&seen, 1), "{seed}: {seen:?}");
    }
}

/// Under a law that is off by as much, F seems to act at another time than it does.
#[test]
fn an_offset_that_is_not_told_yet_says_nothing_of_when_f_acted() {
    let scenario = plant(Builtin::VanDerPolWhite, 10640, 1e3, 14.0);
    let mut samples = samples(&scenario);
    put_off(&mut samples, 11.0, 1.0, [5.0 * NOISE, 0.0]);
    let mut identifier = Identifier::new(&Model::cubic_library(), Settings::default()).unwrap();
    for sample in &samples {
        identifier.step(*sample).unwrap();
        assert_eq!(identifier.output().hold, Hold::Zero, "at {} s", sample.t);
    }
    assert_eq!(identifier.output().sensors[0], SensorState::Offset);
}

/// Linear about none, one of the motion's own size is not found.
#[test]
fn an_offset_as_large_as_the_motion_is_found_after_an_outage() {
    for (builtin, seed, at, gap, offset) in [
        (Builtin::VanDerPolSine, 510_477, 17.78, 1.78, 0.42),
        (Builtin::VanDerPolWhite, 510_023, 15.55, 0.58, -2.0),
        (Builtin::DuffingSine, 510_080, 9.957, 1.13, 1.0),
    ] {
        let scenario = plant(builtin, seed, 1e3, at + 5.0);
        let mut samples = samples(&scenario);
        put_off(&mut samples, at, gap, [offset, 0.0]);
        let seen = watch(&scenario, builtin, false, &samples);
        assert!(is_told(&seen, 0), "{seed}: {seen:?}");
    }
}

/// A kick moves q̇ as well, and q tells them apart long after both had been told from all else.
#[test]
fn an_offset_of_the_velocity_that_nothing_announces_is_no_kick() {
    for (builtin, seed, at, stds) in [
        (Builtin::VanDerPolWhite, 510_017, 16.007, -16.6),
        (Builtin::DuffingWhite, 511_132, 11.455, 6.5),
        (Builtin::VanDerPolSine, 500_126, 12.0, 12.2),
    ] {
        let scenario = plant(builtin, seed, 1e3, at + 6.0);
        let mut samples = samples(&scenario);
        put_off(&mut samples, at, 0.0, [0.0, stds * NOISE]);
        let seen = watch(&scenario, builtin, false, &samples);
        assert!(is_told(&seen, 1), "{seed}: {seen:?}");
    }
}

/// They may be taken for an offset at first, which is one of the readings after them then.
#[test]
fn readings_off_to_one_side_for_a_while_leave_nothing() {
    for seed in 530_100..530_106 {
        let scenario = plant(Builtin::VanDerPolWhite, seed, 1e3, 12.0);
        let mut samples = samples(&scenario);
        burst_to_one_side(&mut samples[8000..8040], 22.0, seed);
        let seen = watch(&scenario, Builtin::VanDerPolWhite, false, &samples);
        let said = &seen.sensors[0];
        assert!(seen.switches == 0 && seen.valid_at_the_end && seen.worst < 6.0, "{seed}: {seen:?}");
        assert!(said.last() != Some(&SensorState::Outlier), "{seed}: {seen:?}");
    }
}
