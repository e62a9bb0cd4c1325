//! Samples that are missing, or sent again: an outage may bring an offset, or hide a switch.

use super::{FIRST, NOISE, identifier, plant, samples, steady};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use switchid::identify::{Identifier, Output, Sample, SensorState, Settings};
use switchid::law::{Given, Model};
use switchid::limits::SETTLED_ERROR;
use switchid::simulate::Builtin;

#[test]
fn a_sensor_that_comes_back_from_an_outage_with_an_offset_is_no_switch() {
    let (_, mut samples) = steady(61);
    samples[FIRST..].iter_mut().for_each(|sample| sample.q += 5.0 * NOISE);
    samples.drain(FIRST - 1000..FIRST);
    let mut identifier = identifier(Builtin::DuffingSine);
    samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
    let output = identifier.output();
    assert!(output.switch_count == 0 && output.sensors[0] == SensorState::Offset, "{output:?}");
}

/// Under a white force a state that is one sample old is none.
#[test]
fn an_offset_without_an_outage_is_no_switch() {
    for builtin in [Builtin::DuffingWhite, Builtin::VanDerPolWhite] {
        let mut samples = samples(&plant(builtin, 10525, 1e3, 12.0));
        samples[FIRST..].iter_mut().for_each(|sample| sample.q += 5.0 * NOISE);
        let mut identifier = identifier(builtin);
        samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
        let output = identifier.output();
        assert!(output.switch_count == 0 && output.valid && output.sensors[0] == SensorState::Offset, "{output:?}");
    }
}

/// The law of a record of which nothing is read for so many seconds, in the midst of which it switches, there being no
/// samples or zeros instead of q and q̇: what is false while `valid` holds, and the output at the end.
fn over_a_gap(builtin: Builtin, library: bool, seed: u64, switch: f64, gap: f64, zeros: bool) -> (f64, Output) {
    let scenario = plant(builtin, seed, switch, switch + 10.0);
    let given = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    let model = if library { Model::cubic_library() } else { given };
    let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
    let mut wrong = 0.0;
    for sample in samples(&scenario) {
        let is_hidden = (sample.t - switch).abs() <= 0.5 * gap;
        match (is_hidden, zeros) {
            (false, _) => identifier.step(sample).unwrap(),
            (true, true) => _ = identifier.step(Sample { q: 0.0, qd: 0.0, ..sample }).ok(),
            (true, false) => continue,
        }
        let (output, truth) = (identifier.output(), &scenario.stages[usize::from(sample.t > switch)].coefficients);
        let counts = output.valid && (sample.t - switch - 0.5 * gap).abs() > 0.5;
        let of = |term| scenario.terms.iter().position(|own| *own == term).map_or(0.0, |place| truth[place]);
        let off = identifier.coefficients().iter().map(|known| (known.value - of(known.term)).powi(2));
        let e = off.sum::<f64>() / truth.iter().map(|value| value * value).sum::<f64>();
        wrong += if counts && e > SETTLED_ERROR { 1e-3 } else { 0.0 };
    }
    (wrong, *identifier.output())
}

/// An offset explains what the law has become for a tenth of a second as well, the motion over the gap does not.
#[test]
fn a_switch_that_no_sample_shows_is_one_from_the_first_that_does() {
    for (builtin, library, seed, gap, zeros) in [
        (Builtin::DuffingSine, false, 10516, 1.0, false),
        (Builtin::DuffingSine, true, 10516, 0.2, false),
        (Builtin::DuffingWhite, false, 10516, 1.0, false),
        (Builtin::VanDerPolSine, false, 10517, 0.2, false),
        (Builtin::VanDerPolWhite, false, 10517, 1.0, false),
        (Builtin::VanDerPolSine, false, 10519, 5.0, false),
        (Builtin::DuffingSine, false, 10516, 1.0, true),
        (Builtin::VanDerPolWhite, true, 10517, 0.2, true),
    ] {
        let (wrong, output) = over_a_gap(builtin, library, seed, 10.0, gap, zeros);
        let named = output.named_time.map(|named| named - 10.0 - 0.5 * gap);
        let label = format!("{} {seed}, gap {gap} s: {wrong} s wrong, named after {named:?} s", builtin.id());
        assert!(output.switch_count == 1 && wrong == 0.0 && output.valid, "{label}; {output:?}");
        assert!(
            named.is_some_and(|named| named < 1.0) && output.sensors == [SensorState::Ok; 3],
            "{label}; {output:?}"
        );
    }
}

/// Over two radians an offset may explain what another law does, and the next seconds show that it does not.
#[test]
fn an_offset_that_was_a_switch_in_the_outage_is_taken_back() {
    for (library, seed, gap) in [(true, 10627, 5.0), (false, 10635, 0.2), (true, 10635, 0.2)] {
        let (wrong, output) = over_a_gap(Builtin::DuffingSine, library, seed, 20.0, gap, false);
        assert!(output.switch_count == 1 && wrong < 0.2 && output.valid, "{seed}: {wrong} s wrong; {output:?}");
        assert_eq!(output.sensors, [SensorState::Ok; 3], "{seed}: {output:?}");
        let away = (output.switch_time - 20.0 - 0.5 * gap).abs();
        assert!(away < 0.01, "{seed}: {away} s from the first sample that shows it");
    }
}

/// What a white force did in the intervals that nobody saw kicks q̇ by four stds of its noise, under the law in use as
/// well as while the next one is sought.
#[test]
fn a_law_stays_known_and_the_next_is_found_where_one_sample_in_ten_is_lost() {
    for (builtin, seed) in [(Builtin::DuffingWhite, 10530), (Builtin::VanDerPolWhite, 10531)] {
        let scenario = plant(builtin, seed, 12.0, 24.0);
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut identifier = identifier(builtin);
        let mut before = None;
        for sample in samples(&scenario).into_iter().filter(|sample| sample.t < 6.0 || generator.random_bool(0.9)) {
            identifier.step(sample).unwrap();
            before = before.or((sample.t > 11.9).then(|| *identifier.output()));
        }
        let (before, output) = (before.unwrap(), identifier.output());
        assert!(before.valid && before.switch_count == 0, "{seed}: {before:?}");
        let named = output.named_time.map(|named| named - 12.0);
        assert!(output.switch_count == 1 && named.is_some_and(|named| named < 0.1), "{seed}: {output:?}");
        for (known, truth) in identifier.coefficients().iter().zip(&scenario.stages[1].coefficients) {
            let off = (known.value - truth).abs();
            assert!(off < 0.1 * truth.abs(), "{seed}: {known:?}, {truth}");
        }
    }
}

/// A sender that has no F to send sends the last once more; of a rough one that is not what acts.
#[test]
fn a_force_that_is_sent_again_is_no_switch() {
    for seed in [10516, 10517] {
        let mut samples = samples(&plant(Builtin::DuffingWhite, seed, 1e3, 14.0));
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        for index in FIRST..samples.len() {
            if generator.random_bool(0.1) {
                samples[index].excitation = samples[index - 1].excitation;
            }
        }
        let mut identifier = identifier(Builtin::DuffingWhite);
        samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
        let output = identifier.output();
        assert!(output.switch_count == 0 && output.valid, "{seed}: {output:?}");
    }
}

/// A switch to a law that is taken for a known one at first: under that one a channel has an offset.
#[test]
fn a_law_that_was_recognised_wrongly_leaves_no_offset() {
    let scenario = Builtin::VanDerPolSine.random(29).with_noise(NOISE);
    let mut identifier = Identifier::new(&Model::cubic_library(), Settings::default()).unwrap();
    for sample in samples(&scenario).into_iter().take_while(|sample| sample.t < 90.0) {
        identifier.step(sample).unwrap();
    }
    let output = identifier.output();
    assert!(output.switch_count == 4 && output.valid && output.sensors == [SensorState::Ok; 3], "{output:?}");
}

/// What acted while every channel was sent again is open, and widens what the innovations may be; that is no error of
/// the law's.
#[test]
fn a_law_whose_samples_are_sent_again_now_and_then_stays_valid() {
    let mut samples = samples(&plant(Builtin::DuffingWhite, 10530, 1e3, 12.0));
    let mut generator = ChaCha8Rng::seed_from_u64(10530 ^ 0xfa17);
    for index in 4000..samples.len() {
        if generator.random_bool(0.1) {
            samples[index] = Sample { t: samples[index].t, ..samples[index - 1] };
        }
    }
    let mut identifier = identifier(Builtin::DuffingWhite);
    let mut lost = 0;
    for sample in samples {
        identifier.step(sample).ok();
        lost += u32::from(sample.t > 4.0 && !identifier.output().valid);
    }
    let output = identifier.output();
    assert!(output.switch_count == 0 && output.valid && lost < 200, "{lost}: {output:?}");
}
