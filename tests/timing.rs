//! When the excitation acted: samples that come late, and a hold that is said wrongly.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use switchid::identify::{Identifier, Output, Sample, SensorState, Settings};
use switchid::law::{Given, Hold, Model, Motion, State};
use switchid::limits::SETTLED_ERROR;
use switchid::simulate::{Builtin, Scenario, record};

/// Std of the sensors' noise.
const NOISE: f64 = 0.01;

/// Largest error ÷ std that is an honest one.
const BEYOND: f64 = 6.0;

/// One law for 20 s, read every `sample_time` s while F is held.
fn scenario(builtin: Builtin, seed: u64, sample_time: f64) -> Scenario {
    let mut scenario = builtin.random(seed).with_noise(NOISE);
    scenario.stages.truncate(1);
    scenario.excitation.sample_time = sample_time;
    scenario.duration = 20.0;
    scenario
}

fn samples(scenario: &Scenario) -> Vec<Sample> {
    let readings = record(scenario).unwrap().into_iter();
    readings.map(|read| Sample { t: read.t, q: read.q, qd: read.qd, excitation: read.excitation }).collect()
}

/// The identifier after the samples: its law is valid, its coefficients as far off as their std say, and no switch was
/// seen.
fn identify(builtin: Builtin, hold: Hold, scenario: &Scenario, samples: &[Sample]) -> Identifier {
    let model = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    let mut identifier = Identifier::new(&model, Settings { hold, ..Settings::default() }).unwrap();
    samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
    let truth = &scenario.stages[0].coefficients;
    let off = identifier.coefficients().iter().zip(truth);
    let off = off.map(|(known, truth)| (known.value - truth).abs() / known.std.unwrap()).fold(0.0, f64::max);
    let output = identifier.output();
    assert!(output.valid && output.switch_count == 0 && off < BEYOND, "{hold}: {off} std, {output:?}");
    identifier
}

#[test]
fn a_motion_or_a_force_that_comes_a_sample_late_is_said_to_and_counted_with() {
    let builtin = Builtin::DuffingWhite;
    let scenario = scenario(builtin, 7, 1e-3);
    let read = samples(&scenario);
    let pairs = || read.windows(2);
    let motion: Vec<Sample> = pairs().map(|pair| Sample { q: pair[0].q, qd: pair[0].qd, ..pair[1] }).collect();
    let force: Vec<Sample> = pairs().map(|pair| Sample { excitation: pair[0].excitation, ..pair[1] }).collect();
    let (ok, late) = (SensorState::Ok, SensorState::Late);
    for (samples, expected) in [(&read, [ok; 3]), (&motion, [late, late, ok]), (&force, [ok, ok, late])] {
        assert_eq!(identify(builtin, Hold::Zero, &scenario, samples).output().sensors, expected);
    }
}

/// What F was over the last interval is not known before the next sample comes: where it is found to come late, nothing
/// else must stand in for that.
#[test]
fn a_force_that_is_found_to_come_late_leaves_no_kick_in_the_record() {
    let builtin = Builtin::DuffingWhite;
    let model = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    for seed in [7, 8, 9, 10] {
        let read = samples(&scenario(builtin, seed, 1e-3));
        let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
        for pair in read.windows(2) {
            identifier.step(Sample { excitation: pair[0].excitation, ..pair[1] }).unwrap();
            let output = identifier.output();
            let (t, named) = (pair[1].t, output.missing.map(|missing| missing.effect().id));
            assert!(t < 3.0 || output.valid && named.is_none(), "{seed}: {named:?} at {t}, {output:?}");
        }
    }
}

/// With a sample in mid-stream F, or q and q̇, begin to come late: the law is the one it was, and its next switch
/// counts.
#[test]
fn a_channel_that_begins_to_come_late_is_no_switch_and_hides_none() {
    let late = SensorState::Late;
    let (of_motion, of_force) = ([late, late, SensorState::Ok], [SensorState::Ok, SensorState::Ok, late]);
    for (builtin, library, seed, noise, late_force, by, said) in [
        (Builtin::DuffingWhite, false, 560_676, 0.001, true, 1, of_force),
        (Builtin::VanDerPolWhite, false, 561_207, 0.01, true, 1, of_force),
        (Builtin::VanDerPolWhite, false, 560_186, 0.1, true, 2, of_force),
        (Builtin::VanDerPolSine, true, 564_213, 0.001, false, 1, of_motion),
        (Builtin::VanDerPolSine, true, 564_390, 0.001, false, 1, of_motion),
        (Builtin::DuffingWhite, false, 564_295, 0.001, false, 1, of_motion),
    ] {
        let mut scenario = builtin.random(seed).with_noise(noise);
        scenario.stages.truncate(2);
        (scenario.stages[1].start, scenario.duration) = (20.0, 24.0);
        let read = samples(&scenario);
        let given = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
        let model = if library { Model::cubic_library() } else { given };
        let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
        for (index, sample) in read.iter().enumerate() {
            let before = if index > 12_000 { &read[index - by] } else { sample };
            let Sample { q, qd, .. } = before;
            identifier
                .step(match late_force {
                    true => Sample { excitation: before.excitation, ..*sample },
                    false => Sample { q: *q, qd: *qd, ..*sample },
                })
                .unwrap();
            let Output { switch_count, sensors, valid, .. } = identifier.output();
            assert!(*switch_count == 0 || sample.t >= 20.0, "{seed}: a switch at {}", sample.t);
            assert!(sample.t != 19.0 || *valid && *sensors == said, "{seed}: {:?}", identifier.output());
        }
        let output = identifier.output();
        assert!(output.switch_count == 1 && output.detection_time.unwrap() < 20.5, "{seed}: {output:?}");
    }
}

/// A Duffing oscillator whose stiffness changes at 24 s, under a sum of sines that is held until 10 s and moves
/// straight from then on, or the other way round.
fn held_otherwise(seed: u64, first: Hold) -> Vec<Sample> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let sines: Vec<[f64; 3]> =
        (0..6).map(|_| [1.0..2.0, 0.5..12.0, 0.0..6.0].map(|range| generator.random_range(range))).collect();
    let force = |t: f64| sines.iter().map(|[size, rate, phase]| size * (rate * t + phase).sin()).sum::<f64>();
    let terms = Builtin::DuffingSine.terms();
    let mut state = State { q: 0.5, qd: 0.0 };
    let sample = |number: u32| {
        let t = 1e-3 * f64::from(number);
        let [from, next] = [t, t + 1e-3].map(force);
        let mut noise = || NOISE * generator.sample::<f64, _>(StandardNormal);
        let sample = Sample { t, q: state.q + noise(), qd: state.qd + noise(), excitation: from };
        let law = [1.0, 0.4, if t < 24.0 { 4.0 } else { 5.0 }, 1.0];
        let to = if (t < 10.0) == (first == Hold::Zero) { from } else { next };
        state = Motion::new(&terms, &law).step_linear(state, 1e-3, from, to);
        sample
    };
    (0..26_000).map(sample).collect()
}

/// What a hold does is seen seconds after it began to, and explains what another law would have to change for.
#[test]
fn a_hold_that_changes_in_mid_stream_is_no_switch_and_hides_none() {
    let model = Model::of("plant", Builtin::DuffingSine.terms().into_iter().map(|term| (term, Given::Fit)));
    for seed in 1..=4 {
        for (first, then) in [(Hold::Zero, Hold::Linear), (Hold::Linear, Hold::Zero)] {
            let mut identifier = Identifier::new(&model, Settings { hold: first, ..Settings::default() }).unwrap();
            for sample in held_otherwise(seed, first) {
                identifier.step(sample).unwrap();
                let Output { switch_count, hold, valid, .. } = identifier.output();
                assert!(*switch_count == 0 || sample.t >= 24.0, "{seed}, {first}: a switch at {}", sample.t);
                assert!(sample.t != 23.0 || *valid && *hold == then, "{seed}, {first}: {hold}");
            }
            let output = identifier.output();
            assert!(output.switch_count == 1 && output.detection_time.unwrap() < 24.5, "{seed}, {first}: {output:?}");
        }
    }
}

#[test]
fn a_hold_that_is_said_wrongly_is_found_in_the_stream() {
    for (builtin, seed) in [(Builtin::DuffingWhite, 8), (Builtin::DuffingSine, 8), (Builtin::VanDerPolWhite, 9)] {
        let scenario = scenario(builtin, seed, 0.01);
        let samples = samples(&scenario);
        for said in [Hold::Zero, Hold::Linear] {
            let found = identify(builtin, said, &scenario, &samples).output().hold;
            assert_eq!(found, Hold::Zero, "{} said to be {said}", builtin.id());
        }
    }
}

#[test]
fn a_law_has_honest_stds_before_a_lag_is_told_and_stays_valid_when_it_is() {
    let builtin = Builtin::DuffingSine;
    let model = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    // F is held for 1 ms and read every 5 or 20 ms: it acts a tenth or a fortieth of a sample late against a line
    for (seed, every) in [(703, 5), (711, 5), (723, 20)] {
        let scenario = scenario(builtin, seed, 1e-3);
        let truth = &scenario.stages[0].coefficients;
        let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
        let (mut worst, mut valid) = (0.0_f64, 0);
        for sample in samples(&scenario).iter().step_by(every) {
            identifier.step(*sample).unwrap();
            if !identifier.output().valid {
                assert_eq!(valid, 0, "{seed}: not valid any more at {}", sample.t);
                continue;
            }
            valid += 1;
            let off = identifier.coefficients().iter().zip(truth);
            worst = off.map(|(known, truth)| (known.value - truth).abs() / known.std.unwrap()).fold(worst, f64::max);
        }
        assert!(worst < BEYOND && valid > 500, "{seed}: {worst} std, valid in {valid}");
    }
}

/// What chance leaves of a law just found, and a hold said wrongly, lasts for tens of samples: no time where these are
/// frequent, a second where they are rare.
#[test]
fn a_law_of_few_samples_is_not_valid_before_it_is_right() {
    let builtin = Builtin::DuffingSine;
    for (library, seed, every) in
        [(false, 9920, 2), (false, 9924, 5), (false, 9928, 10), (true, 9925, 10), (true, 9912, 20), (true, 9948, 20)]
    {
        let given = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
        let model = if library { Model::cubic_library() } else { given };
        let scenario = scenario(builtin, seed, 1e-3);
        let truth = |term| {
            scenario.terms.iter().position(|own| *own == term).map_or(0.0, |i| scenario.stages[0].coefficients[i])
        };
        let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
        let mut valid = 0;
        for sample in samples(&scenario).iter().step_by(every) {
            identifier.step(*sample).unwrap();
            if identifier.output().valid {
                let known = identifier.coefficients().iter();
                let wrong: f64 = known.map(|known| (known.value - truth(known.term)).powi(2)).sum();
                let squares: f64 = scenario.stages[0].coefficients.iter().map(|value| value * value).sum();
                assert!(wrong < SETTLED_ERROR * squares, "{seed}: e {} at {}", wrong / squares, sample.t);
                valid += 1;
            }
        }
        assert!(valid > 12_000 / every, "{seed}: valid for {valid} samples");
        assert_eq!(identifier.output().switch_count, 0, "{seed}");
    }
}

/// A plant with the terms given or the whole library, one switch at 20 s, whose samples are `spoilt`.
fn with_a_switch(builtin: Builtin, library: bool, seed: u64, spoilt: impl Fn(&[Sample]) -> Vec<Sample>) -> Identifier {
    let mut scenario = builtin.random(seed).with_noise(NOISE);
    scenario.stages.truncate(2);
    (scenario.stages[1].start, scenario.duration) = (20.0, 26.0);
    let given = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    let model = if library { Model::cubic_library() } else { given };
    let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
    for sample in spoilt(&samples(&scenario)) {
        identifier.step(sample).unwrap();
        let switches = identifier.output().switch_count;
        assert!(switches == 0 || sample.t >= 20.0, "{} {seed}: a switch at {}", builtin.id(), sample.t);
    }
    identifier
}

/// Under a wrong hold the law's error is taken for process noise, under which a lag is hardly known: with all error in
/// the sensors it is.
#[test]
fn a_wrong_hold_at_coarse_steps_hides_no_switch() {
    for (library, seed, every) in [(false, 8214, 20), (true, 8204, 20), (true, 8218, 20), (false, 8207, 50)] {
        let coarse = |samples: &[Sample]| samples.iter().step_by(every).copied().collect();
        let identifier = with_a_switch(Builtin::DuffingSine, library, seed, coarse);
        let output = identifier.output();
        assert!(output.switch_count == 1 && output.hold == Hold::Linear, "{seed}: {output:?}");
    }
}

/// A law of 20 s is seven periods long, whether these are 20 000 samples or 400.
#[test]
fn a_law_known_from_few_samples_of_many_periods_is_left_as_soon_as_any() {
    for (library, seed, every) in [(true, 9902, 20), (false, 9902, 50), (true, 9902, 50), (false, 9942, 50)] {
        let coarse = |samples: &[Sample]| samples.iter().step_by(every).copied().collect();
        let identifier = with_a_switch(Builtin::DuffingSine, library, seed, coarse);
        let output = identifier.output();
        assert!(output.switch_count == 1 && output.detection_time.unwrap() < 22.0, "{every} ms: {output:?}");
        assert!(!output.drifting, "{seed}, {every} ms: a switch within an interval is no drift");
    }
}

/// What happened to readings seconds ago may still be open when something else does.
#[test]
fn a_switch_is_seen_while_earlier_readings_are_weighed() {
    let coarse = |samples: &[Sample]| samples.iter().step_by(50).copied().collect();
    for library in [false, true] {
        let identifier = with_a_switch(Builtin::VanDerPolSine, library, 10_354, coarse);
        let output = identifier.output();
        assert!(output.switch_count == 1 && output.detection_time.unwrap() < 20.4, "{output:?}");
    }
    let late = |samples: &[Sample]| {
        samples.windows(2).map(|pair| Sample { q: pair[0].q, qd: pair[0].qd, ..pair[1] }).collect()
    };
    let identifier = with_a_switch(Builtin::VanDerPolSine, true, 10_354, late);
    let output = identifier.output();
    assert!(output.switch_count == 1 && output.sensors[1] != SensorState::Offset, "{output:?}");
}

#[test]
fn a_motion_that_comes_late_under_one_sine_is_no_switch_and_hides_none() {
    let late = |samples: &[Sample]| {
        samples.windows(2).map(|pair| Sample { q: pair[0].q, qd: pair[0].qd, ..pair[1] }).collect()
    };
    for (builtin, library, seed) in [(Builtin::VanDerPolSine, false, 8206), (Builtin::DuffingSine, true, 8211)] {
        let identifier = with_a_switch(builtin, library, seed, late);
        let output = identifier.output();
        assert_eq!((output.switch_count, output.sensors[0]), (1, SensorState::Late), "{seed}: {output:?}");
    }
}
