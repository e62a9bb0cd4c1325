//! Faults of sensors and clocks: none is a switch, none leaves a trace, and `valid` is a promise all the while.

mod before_a_law;
mod bursts;
mod offsets;
mod outages;
mod silence;
mod unread;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use switchid::identify::{Channels, Identifier, Sample, SensorState, Settings, Skipped};
use switchid::law::{Given, Model, State};
use switchid::simulate::{Builtin, Scenario, record};

/// Std of the sensors' noise.
const NOISE: f64 = 0.01;

/// Time at which a fault begins, and number of its first sample.
const FAULT: f64 = 8.0;
const FIRST: usize = 8000;

/// Std beyond which no honest error is.
const BEYOND: f64 = 8.0;

/// A plant whose law switches at `switch` s, for `duration` s.
fn plant(builtin: Builtin, seed: u64, switch: f64, duration: f64) -> Scenario {
    let mut scenario = builtin.random(seed).with_noise(NOISE);
    scenario.stages.truncate(2);
    (scenario.stages[1].start, scenario.duration) = (switch, duration);
    scenario
}

fn samples(scenario: &Scenario) -> Vec<Sample> {
    let sample = |reading: switchid::simulate::Reading| Sample {
        t: reading.t,
        q: reading.q,
        qd: reading.qd,
        excitation: reading.excitation,
    };
    record(scenario).unwrap().into_iter().map(sample).collect()
}

/// Ten seconds of one law.
fn steady(seed: u64) -> (Scenario, Vec<Sample>) {
    let scenario = plant(Builtin::DuffingSine, seed, 1e3, 10.0);
    let samples = samples(&scenario);
    (scenario, samples)
}

fn identifier(builtin: Builtin) -> Identifier {
    let model = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    Identifier::new(&model, Settings::default()).unwrap()
}

/// What was seen of a stream.
#[derive(Debug, Default)]
struct Seen {
    switches: u32,
    valid_at_the_end: bool,
    /// Time of the last sample at which no law was valid, s.
    invalid_until: f64,
    /// Largest error ÷ std while valid, the second after a true switch left out.
    worst: f64,
    /// Whether `valid` stood beside a coefficient without std.
    unknown: bool,
    /// Every state that a sensor was said to be in, by channel.
    sensors: [Vec<SensorState>; 3],
}

fn watch(scenario: &Scenario, builtin: Builtin, samples: &[Sample]) -> Seen {
    let mut identifier = identifier(builtin);
    let mut seen = Seen::default();
    for sample in samples {
        identifier.step(*sample).ok();
        seen.take(&identifier, scenario, sample.t);
    }
    seen.switches = identifier.output().switch_count;
    seen.valid_at_the_end = identifier.output().valid;
    seen
}

impl Seen {
    fn take_state(&mut self, identifier: &Identifier) {
        for (said, now) in self.sensors.iter_mut().zip(identifier.output().sensors) {
            if said.last() != Some(&now) {
                said.push(now);
            }
        }
    }

    fn take(&mut self, identifier: &Identifier, scenario: &Scenario, t: f64) {
        self.take_state(identifier);
        let output = identifier.output();
        if !output.valid {
            self.invalid_until = t;
            return;
        }
        let stage = scenario.stage_at(t);
        let truth = &scenario.stages[stage];
        let settled = stage == 0 || t - truth.start > 1.0;
        for (known, truth) in identifier.coefficients().iter().zip(&truth.coefficients) {
            self.unknown |= known.std.is_none();
            let z = known.std.map_or(0.0, |std| (known.value - truth).abs() / std);
            self.worst = if settled { self.worst.max(z) } else { self.worst };
        }
    }

    fn said(&self, channel: usize) -> &[SensorState] {
        &self.sensors[channel]
    }
}

/// Readings that are wide draws of `size` stds.
fn burst(samples: &mut [Sample], size: f64, generator: &mut ChaCha8Rng) {
    for sample in samples {
        let sign = if generator.random_bool(0.5) { 1.0 } else { -1.0 };
        sample.qd += sign * size * NOISE * generator.random_range(0.5..1.5);
    }
}

/// Readings of the displacement that are off by about `size` stds, all to one side.
fn burst_to_one_side(samples: &mut [Sample], size: f64, seed: u64) {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    samples.iter_mut().for_each(|sample| sample.q += size * NOISE * generator.random_range(0.5..1.5));
}

/// A law of a young record moves by many of its std, and what it knew is no reason for a switch since.
#[test]
fn a_law_that_leaves_itself_has_not_switched() {
    let scenario = plant(Builtin::VanDerPolSine, 9868, 20.0, 27.0);
    let mut identifier = Identifier::new(&Model::cubic_library(), Settings::default()).unwrap();
    samples(&scenario).into_iter().for_each(|sample| identifier.step(sample).unwrap());
    assert_eq!((identifier.output().switch_count, identifier.output().valid), (1, true));
}

#[test]
fn a_bad_reading_is_said_to_be_one_and_to_be_over() {
    let (scenario, mut samples) = steady(50);
    samples[FIRST].q += 1.0;
    let seen = watch(&scenario, Builtin::DuffingSine, &samples);
    assert_eq!(seen.said(0), [SensorState::Ok, SensorState::Outlier, SensorState::Ok]);
    assert!(seen.said(1) == [SensorState::Ok] && seen.said(2) == [SensorState::Ok], "{seen:?}");
}

#[test]
fn no_number_that_a_sensor_can_send_leaves_a_trace() {
    for value in [1e100, -1e300, f64::MAX] {
        let (scenario, mut samples) = steady(51);
        samples[FIRST].excitation = value;
        samples[FIRST + 300..FIRST + 310].iter_mut().for_each(|sample| sample.q = value);
        samples[FIRST + 600].qd = -value;
        let seen = watch(&scenario, Builtin::DuffingSine, &samples);
        let calm = seen.switches == 0 && seen.valid_at_the_end && seen.worst < BEYOND;
        assert!(calm && seen.invalid_until < FAULT + 0.9, "{value}: {seen:?}");
    }
}

/// On a test bench the logger runs before the actuator does: for longer here than samples are kept.
#[test]
fn a_motion_that_begins_from_rest_is_identified() {
    const REST: f64 = 31.0;
    let mut scenario = plant(Builtin::DuffingSine, 57, 12.0, 15.0);
    scenario.initial = State::default();
    let moving = samples(&scenario);
    let mut generator = ChaCha8Rng::seed_from_u64(57);
    let mut noise = || NOISE * generator.sample::<f64, _>(StandardNormal);
    let rest =
        (0..(1e3 * REST) as usize).map(|k| Sample { t: 1e-3 * k as f64, q: noise(), qd: noise(), excitation: 0.0 });
    let later = moving.into_iter().map(|sample| Sample { t: REST + sample.t, ..sample });
    let samples: Vec<Sample> = rest.chain(later).collect();
    scenario.stages[1].start += REST;
    let seen = watch(&scenario, Builtin::DuffingSine, &samples);
    assert!(seen.switches == 1 && seen.valid_at_the_end && seen.worst < BEYOND, "{seen:?}");
    assert!(seen.sensors.iter().all(|said| *said == [SensorState::Ok]), "{seen:?}");
}

#[test]
fn a_stuck_sensor_is_no_switch_and_is_said_to_be_stuck() {
    let (scenario, mut samples) = steady(52);
    let before = samples[FIRST - 1].qd;
    samples[FIRST..FIRST + 1000].iter_mut().for_each(|sample| sample.qd = before);
    let seen = watch(&scenario, Builtin::DuffingSine, &samples);
    assert!(seen.switches == 0 && seen.valid_at_the_end && seen.worst < BEYOND, "{seen:?}");
    assert!(seen.said(1).contains(&SensorState::Stuck) && seen.said(1).last() == Some(&SensorState::Ok), "{seen:?}");
}

/// A sender that repeats its last message repeats F too, which is not what acts meanwhile.
#[test]
fn a_sender_that_stalls_is_no_switch() {
    for (builtin, seed) in [(Builtin::DuffingSine, 52), (Builtin::VanDerPolSine, 53), (Builtin::DuffingWhite, 54)] {
        let scenario = plant(builtin, seed, 1e3, 14.0);
        let mut samples = samples(&scenario);
        let before = samples[FIRST - 1];
        samples[FIRST..FIRST + 1000].iter_mut().for_each(|sample| *sample = Sample { t: sample.t, ..before });
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.invalid_until < FAULT + 1.3 && seen.worst < BEYOND, "{builtin:?}: {seen:?}");
        for channel in 0..3 {
            let said = seen.said(channel);
            assert!(
                said.contains(&SensorState::Stuck) && said.last() == Some(&SensorState::Ok),
                "{builtin:?}: {seen:?}"
            );
        }
    }
}

/// A sample that nobody has read, sent between two that were: the last one again, or their mean. `first` is the first.
fn fill_in(samples: &mut [Sample], first: usize, mean: bool) {
    for index in (first..samples.len() - 1).step_by(2) {
        let (before, after) = (samples[index - 1], samples[if mean { index + 1 } else { index - 1 }]);
        let between = |of: fn(&Sample) -> f64| 0.5 * (of(&before) + of(&after));
        let [q, qd, excitation] = [between(|s| s.q), between(|s| s.qd), between(|s| s.excitation)];
        samples[index] = Sample { t: samples[index].t, q, qd, excitation };
    }
}

/// A sample that was sent again or interpolated is no reading, and no reason to leave readings out.
#[test]
fn samples_that_nobody_has_read_are_left_out() {
    for (mean, first) in [(false, 1), (false, FIRST), (true, 1), (true, FIRST)] {
        let scenario = plant(Builtin::VanDerPolSine, 20_005, 11.0, 18.0);
        let mut samples = samples(&scenario);
        fill_in(&mut samples, first, mean);
        let seen = watch(&scenario, Builtin::VanDerPolSine, &samples);
        assert!(
            seen.switches == 1 && seen.valid_at_the_end && seen.worst < BEYOND,
            "{mean}, from {first} on: {seen:?}"
        );
        let mut identifier = identifier(Builtin::VanDerPolSine);
        let left_out = |sample: &&Sample| match identifier.step(**sample) {
            Err(Skipped::Interpolated { .. }) => mean,
            Err(Skipped::Repeated { .. }) => !mean,
            _ => false,
        };
        assert!(samples.iter().filter(left_out).count() > 12 * (samples.len() - first) / 25, "{mean}, from {first} on");
    }
}

/// Where a sample is missed nobody has read what F was: what that did to the motion is no reading that is off.
#[test]
fn samples_that_are_missed_are_no_fault_of_the_sensors() {
    for (builtin, seed) in [(Builtin::DuffingWhite, 20_002), (Builtin::VanDerPolWhite, 20_004)] {
        let scenario = plant(builtin, seed, 1e3, 14.0);
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut samples = samples(&scenario);
        samples.retain(|sample| sample.t < FAULT || !generator.random_bool(0.05));
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.invalid_until < FAULT + 0.3 && seen.worst < BEYOND, "{builtin:?}: {seen:?}");
        assert!((0..3).all(|channel| seen.said(channel) == [SensorState::Ok]), "{builtin:?}: {seen:?}");
    }
}

/// What is left of an offset after a few readings is a part of the noise, and in thousands of samples a switch.
#[test]
fn a_sensor_that_is_off_from_some_sample_on_is_no_switch() {
    let off = [(Builtin::VanDerPolSine, 20_002, 0.01, 0.1), (Builtin::VanDerPolSine, 20_005, 0.01, 0.07)];
    for (builtin, seed, noise, offset) in off.into_iter().chain([(Builtin::VanDerPolSine, 55, 0.001, 0.02)]) {
        let scenario = plant(builtin, seed, 1e3, 14.0).with_noise(noise);
        let mut samples = samples(&scenario);
        samples[FIRST..].iter_mut().for_each(|sample| sample.q += offset);
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.invalid_until < FAULT + 0.3, "{seed}: {seen:?}");
        assert!(seen.worst < BEYOND && seen.said(0) == [SensorState::Ok, SensorState::Offset], "{seed}: {seen:?}");
    }
}

/// Five stds are chance in one reading: in these streams every one was, each for itself, until the law had switched.
#[test]
fn an_offset_of_five_stds_is_told_by_all_its_readings() {
    for (builtin, seed) in
        [(Builtin::DuffingSine, 10_303), (Builtin::DuffingWhite, 10_310), (Builtin::DuffingSine, 10_314)]
    {
        let scenario = plant(builtin, seed, 1e3, 14.0);
        let mut samples = samples(&scenario);
        samples[10_000..].iter_mut().for_each(|sample| sample.q += 5.0 * NOISE);
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.valid_at_the_end, "{seed}: {seen:?}");
        assert!(seen.said(0).contains(&SensorState::Offset) && seen.worst < BEYOND, "{seed}: {seen:?}");
    }
}

/// Where the velocity turns the law expects it to stand: what stands still beside its noise is stuck.
#[test]
fn a_sensor_stuck_where_the_motion_turns_is_no_switch() {
    for seed in 40..46 {
        let (scenario, mut samples) = steady(seed);
        let turn = (FIRST..FIRST + 1500).max_by(|a, b| samples[*a].qd.total_cmp(&samples[*b].qd)).unwrap();
        let stuck = samples[turn].qd;
        samples[turn..turn + 300].iter_mut().for_each(|sample| sample.qd = stuck);
        let seen = watch(&scenario, Builtin::DuffingSine, &samples);
        assert!(seen.switches == 0 && seen.valid_at_the_end, "{seed}: {seen:?}");
        assert!(seen.said(1).contains(&SensorState::Stuck), "{seed}: {seen:?}");
    }
}

#[test]
fn samples_that_are_no_numbers_end_what_is_valid_until_they_are() {
    let builtin = Builtin::DuffingSine;
    let (_, samples) = steady(53);
    let mut identifier = identifier(builtin);
    samples[..FIRST].iter().for_each(|sample| identifier.step(*sample).unwrap());
    assert!(identifier.output().valid);
    for sample in &samples[FIRST..FIRST + 5] {
        identifier.step(Sample { qd: f64::NAN, ..*sample }).unwrap_err();
    }
    assert!(!identifier.output().valid && identifier.output().sensors[1] == SensorState::Missing);
    samples[FIRST + 5..FIRST + 8].iter().for_each(|sample| identifier.step(*sample).unwrap());
    assert!(identifier.output().valid && identifier.output().sensors[1] == SensorState::Ok);
}

#[test]
fn a_stamp_far_ahead_and_a_clock_that_is_set_back_do_not_end_the_stream() {
    let (scenario, mut samples) = steady(54);
    samples[FIRST].t = 1e6;
    samples[FIRST + 500..].iter_mut().for_each(|sample| sample.t -= 5.0);
    let mut identifier = identifier(Builtin::DuffingSine);
    let skipped = samples.iter().filter(|sample| identifier.step(**sample).is_err()).count();
    let output = identifier.output();
    assert!(skipped < 15 && output.valid && output.switch_count == 0, "{skipped} skipped: {output:?}");
    assert!(scenario.stages.len() == 2);
}

/// A stamp by which a sample comes after a gap is the sender's until the next one comes before it.
#[test]
fn a_stamp_that_is_ahead_of_the_next_is_left_out_alone() {
    for (seed, ahead) in [(55, 0.008), (56, 0.03), (57, 0.2), (58, 1e6)] {
        let (_, mut samples) = steady(seed);
        let right = samples[FIRST].t;
        samples[FIRST].t += ahead;
        let mut identifier = identifier(Builtin::DuffingSine);
        samples[..=FIRST].iter().for_each(|sample| identifier.step(*sample).unwrap());
        assert!(!identifier.output().valid, "{ahead} s");
        let skipped = identifier.step(samples[FIRST + 1]).unwrap_err();
        assert!(matches!(skipped, Skipped::Ahead { t, .. } if t == right + ahead), "{skipped}");
        samples[FIRST + 2..].iter().for_each(|sample| identifier.step(*sample).unwrap());
        let output = identifier.output();
        assert!(output.valid && output.switch_count == 0, "{ahead} s: {output:?}");
    }
}

/// A fault drawn at random.
fn spoil(samples: &mut [Sample], generator: &mut ChaCha8Rng) {
    let count = generator.random_range(1..60);
    let stuck = samples[FIRST - 1];
    match generator.random_range(0..6) {
        0 => burst(&mut samples[FIRST..FIRST + count], 10.0_f64.powf(generator.random_range(0.5..3.0)), generator),
        1 => samples[FIRST..FIRST + 10 * count].iter_mut().for_each(|sample| sample.q = stuck.q),
        2 => samples[FIRST..FIRST + 10 * count].iter_mut().for_each(|sample| sample.qd = 0.0),
        3 => samples[FIRST].excitation *= generator.random_range(-20.0..20.0),
        4 => samples[FIRST..FIRST + count].iter_mut().for_each(|sample| sample.q = 1e300),
        _ => samples[FIRST..FIRST + count].iter_mut().for_each(|sample| sample.excitation = f64::NAN),
    }
}

#[test]
fn valid_is_a_promise_whatever_the_sensors_do() {
    for seed in 60..72 {
        let builtin = if seed % 2 == 0 { Builtin::DuffingSine } else { Builtin::DuffingWhite };
        let scenario = plant(builtin, seed, 10.0, 14.0);
        let mut samples = samples(&scenario);
        spoil(&mut samples, &mut ChaCha8Rng::seed_from_u64(seed));
        let seen = watch(&scenario, builtin, &samples);
        assert!(!seen.unknown && seen.worst < BEYOND, "seed {seed}: {seen:?}");
        assert!(seen.switches == 1, "seed {seed}: the switch at 10 s is the only one: {seen:?}");
    }
}

#[test]
fn a_sensor_that_becomes_louder_is_believed_and_its_noise_told() {
    let (scenario, mut samples) = steady(60);
    let mut generator = ChaCha8Rng::seed_from_u64(60);
    let mut more = || NOISE * 8.0_f64.sqrt() * (0..12).map(|_| generator.random_range(-0.5..0.5)).sum::<f64>();
    samples[FIRST - 3000..]
        .iter_mut()
        .for_each(|sample| (sample.q, sample.qd) = (sample.q + more(), sample.qd + more()));
    let mut identifier = identifier(Builtin::DuffingSine);
    samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
    let output = identifier.output();
    let ratio = output.noise.qd.unwrap() / (3.0 * NOISE);
    assert!((0.75..1.25).contains(&ratio) && output.switch_count == 0 && output.valid, "{ratio}: {output:?}");
    assert!(output.sensors == [SensorState::Ok; 3] && scenario.stages.len() == 2, "{:?}", output.sensors);
}

/// Switches between two samples, of plants without noise: what the law then is, is wrong by thousands of stds.
#[test]
fn without_noise_a_switch_is_no_fault_of_all_sensors() {
    let white = Builtin::VanDerPolWhite;
    // of the last one two readings are taken for a burst at first
    let all = [(white, 29, 10.0004), (white, 34, 10.0003), (white, 10, 10.0007), (Builtin::DuffingSine, 6, 10.0001)];
    for (builtin, seed, switch) in all {
        let scenario = plant(builtin, seed, switch, 12.0).with_noise(0.0);
        let mut identifier = identifier(builtin);
        samples(&scenario).iter().for_each(|sample| identifier.step(*sample).unwrap());
        let output = identifier.output();
        let delay = output.detection_time.map(|detected| detected - switch);
        assert!(
            output.switch_count == 1 && output.valid && delay.is_some_and(|delay| delay < 0.01),
            "{seed}: {output:?}"
        );
    }
}

/// A channel that is not measured cannot fail beside the other: the one that does has its name as soon as with both.
#[test]
fn the_only_sensor_that_is_stuck_is_said_to_be_soon() {
    for (channel, channels) in
        [(true, false), (false, true)].map(|(q, qd)| Channels { q, qd, excitation: true }).into_iter().enumerate()
    {
        let mut samples = samples(&plant(Builtin::DuffingSine, 72, 1e3, 10.0).with_noise(1e-3));
        let before = samples[FIRST - 1];
        samples[FIRST..FIRST + 1000].iter_mut().for_each(|sample| (sample.q, sample.qd) = (before.q, before.qd));
        let model = Model::of("plant", Builtin::DuffingSine.terms().into_iter().map(|term| (term, Given::Fit)));
        let mut identifier = Identifier::new(&model, Settings { channels, ..Settings::default() }).unwrap();
        let mut said = None;
        for sample in &samples {
            identifier.step(*sample).unwrap();
            let stuck = identifier.output().sensors[channel] == SensorState::Stuck;
            said = said.or(stuck.then_some(sample.t));
        }
        assert!(said.is_some_and(|said| said < FAULT + 0.03), "{channels:?}: {said:?}");
        let output = identifier.output();
        assert!(output.switch_count == 0 && output.sensors[channel] == SensorState::Ok, "{channels:?}: {output:?}");
    }
}

/// Where one channel is measured the other has no size: that must not make every switch a fault of the sensor's.
#[test]
fn a_switch_is_seen_in_either_channel_alone() {
    for channels in [(true, false), (false, true)].map(|(q, qd)| Channels { q, qd, excitation: true }) {
        let scenario = plant(Builtin::DuffingSine, 70, 8.0, 10.0).with_noise(1e-4);
        let model = Model::of("plant", Builtin::DuffingSine.terms().into_iter().map(|term| (term, Given::Fit)));
        let mut identifier = Identifier::new(&model, Settings { channels, ..Settings::default() }).unwrap();
        samples(&scenario).iter().for_each(|sample| identifier.step(*sample).unwrap());
        let output = identifier.output();
        let delay = output.detection_time.map(|detected| detected - 8.0);
        assert!(output.switch_count == 1 && delay.is_some_and(|delay| delay < 0.1), "{channels:?}: {output:?}");
    }
}

#[test]
fn a_rough_excitation_that_is_stuck_or_misread_is_no_fault_of_the_motion() {
    for (builtin, seed) in
        [(Builtin::VanDerPolWhite, 9007), (Builtin::DuffingWhite, 6000), (Builtin::VanDerPolWhite, 6000)]
    {
        let scenario = plant(builtin, seed, 20.0, 24.0);
        let clean = samples(&scenario);
        let first = 10_000;
        let most = clean.iter().map(|sample| sample.excitation.abs()).fold(0.0, f64::max);
        let mut stuck = clean.clone();
        stuck[first..first + 1000].iter_mut().for_each(|sample| sample.excitation = clean[first - 1].excitation);
        let misread = [-2.5, 2.5].map(|glitch| {
            let mut misread = clean.clone();
            misread[first].excitation += glitch * most;
            misread
        });
        for readings in [&stuck, &misread[0], &misread[1]] {
            let seen = watch(&scenario, builtin, readings);
            assert_eq!(seen.switches, 1, "{builtin:?} {seed}: {seen:?}");
            assert!(!seen.said(0).contains(&SensorState::Offset), "{builtin:?} {seed}: {seen:?}");
        }
    }
}

/// Whether the motion follows them or not: under a sine each is small beside what it moves, and all of them are not.
/// A force that stands still where it turns is what acts for longer than elsewhere.
/// It says for what acts as little as one that stands still within its range, and is said to be stuck once.
#[test]
fn a_rough_excitation_that_is_stuck_far_beyond_its_range_is_no_switch() {
    for (builtin, seed) in [(Builtin::DuffingWhite, 500_143), (Builtin::VanDerPolWhite, 530_194)] {
        let scenario = plant(builtin, seed, 1e3, 12.0);
        let mut samples = samples(&scenario);
        let most = samples.iter().map(|sample| sample.excitation.abs()).fold(0.0, f64::max);
        samples[FIRST..FIRST + 1000].iter_mut().for_each(|sample| sample.excitation = -10.0 * most);
        let seen = watch(&scenario, builtin, &samples);
        let calm = seen.switches == 0 && seen.valid_at_the_end && seen.worst < BEYOND;
        let stuck = seen.said(2).iter().filter(|state| **state == SensorState::Stuck).count();
        assert!(calm && stuck == 1, "{seed}: {seen:?}");
    }
}

#[test]
fn a_force_that_is_stuck_where_it_turns_is_no_switch() {
    use Builtin::{DuffingSine, VanDerPolSine};
    for (builtin, seed) in [(DuffingSine, 139), (DuffingSine, 140), (VanDerPolSine, 168), (VanDerPolSine, 169)] {
        let scenario = plant(builtin, seed, 1e3, 16.0);
        let mut samples = samples(&scenario);
        let first = FIRST + (seed as usize * 97) % 3000;
        let stuck = samples[first].excitation;
        samples[first..first + 1000].iter_mut().for_each(|sample| sample.excitation = stuck);
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.worst < BEYOND, "{builtin:?} {seed}: {seen:?}");
    }
}

/// By chance the motion first went its own way within the noise, and was then far off at once: q̇ was in a burst, had
/// an offset, and was in a burst again, all under a name each, so that the force was not asked for.
#[test]
fn a_rough_excitation_that_is_zero_is_no_burst_of_the_velocity() {
    for builtin in [Builtin::DuffingWhite, Builtin::VanDerPolWhite] {
        let scenario = plant(builtin, 10_432, 1e3, 14.0);
        let mut samples = samples(&scenario);
        samples[10_000..11_000].iter_mut().for_each(|sample| sample.excitation = 0.0);
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.invalid_until < 11.3, "{builtin:?}: {seen:?}");
        assert!(seen.said(2).contains(&SensorState::Stuck) && seen.worst < BEYOND, "{builtin:?}: {seen:?}");
        assert!(!seen.said(1).contains(&SensorState::Offset), "{builtin:?}: {seen:?}");
    }
}

#[test]
fn wild_forces_in_a_row_are_no_switch() {
    for (builtin, seed, noise) in [
        (Builtin::DuffingSine, 20_010, 0.01),
        (Builtin::DuffingSine, 20_013, 0.001),
        (Builtin::VanDerPolSine, 20_016, 0.001),
        (Builtin::VanDerPolWhite, 20_021, 0.01),
    ] {
        let scenario = plant(builtin, seed, 1e3, 12.0).with_noise(noise);
        let mut samples = samples(&scenario);
        let most = samples.iter().map(|sample| sample.excitation.abs()).fold(0.0, f64::max);
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        for sample in &mut samples[FIRST..FIRST + 20] {
            let sign = if generator.random_bool(0.5) { 1.0 } else { -1.0 };
            sample.excitation += sign * most * generator.random_range(1.5..4.0);
        }
        let seen = watch(&scenario, builtin, &samples);
        assert!(seen.switches == 0 && seen.valid_at_the_end && seen.worst < BEYOND, "{builtin:?} {seed}: {seen:?}");
        assert!(seen.invalid_until < FAULT + 0.3, "{builtin:?} {seed}: {seen:?}");
    }
}

/// A force that was misread and one that was not read at all are equally likely for ever, and one that is unseen for a
/// second scatters the motion by what nobody knows: neither is a reason to wait, nor to take the law back.
#[test]
fn a_law_stays_valid_after_a_fault_of_the_excitation() {
    for (builtin, seed) in [(Builtin::DuffingWhite, 10_220), (Builtin::VanDerPolWhite, 73)] {
        let scenario = plant(builtin, seed, 1e3, 16.0);
        let clean = samples(&scenario);
        let most = clean.iter().map(|sample| sample.excitation.abs()).fold(0.0, f64::max);
        let misread = [-2.5, -1.7, -1.2, 1.2, 1.7, 2.5].map(|glitch| {
            let mut misread = clean.clone();
            misread[FIRST].excitation += glitch * most;
            (misread, FAULT + 0.3)
        });
        let mut stuck = clean.clone();
        stuck[FIRST..FIRST + 1000].iter_mut().for_each(|sample| sample.excitation = clean[FIRST - 1].excitation);
        for (readings, allowed) in misread.into_iter().chain([(stuck, FAULT + 2.0)]) {
            let seen = watch(&scenario, builtin, &readings);
            assert!(seen.invalid_until < allowed && seen.switches == 0, "{builtin:?} {seed}: {seen:?}");
            assert!(seen.worst < BEYOND, "{builtin:?} {seed}: {seen:?}");
        }
    }
}

#[test]
fn an_outage_before_a_switch_makes_no_drift_of_it() {
    let builtin = Builtin::DuffingSine;
    let scenario = plant(builtin, 5003, 20.0, 26.0);
    let mut samples = samples(&scenario);
    samples.drain(10_000..15_000);
    let mut identifier = Identifier::new(&Model::cubic_library(), Settings::default()).unwrap();
    let inertia = scenario.stages[1].coefficients[0];
    let mut shown = 0;
    for sample in samples {
        identifier.step(sample).unwrap();
        if identifier.output().valid && sample.t > 21.0 {
            let known = identifier.coefficients()[0].value;
            assert!((known - inertia).abs() < 0.1 * inertia, "{known} at {} s, {inertia} is right", sample.t);
            shown += 1;
        }
    }
    assert!(shown > 2000, "valid in {shown} of 5000 samples");
}

#[test]
fn a_drive_that_is_switched_off_hides_neither_an_outlier_nor_a_switch() {
    for (builtin, seed) in
        [Builtin::DuffingSine, Builtin::VanDerPolSine].into_iter().flat_map(|plant| [(plant, 71), (plant, 72)])
    {
        let mut scenario = plant(builtin, seed, 16.0, 20.0);
        scenario.stages.insert(1, scenario.stages[0].clone());
        (scenario.stages[1].start, scenario.stages[1].amplitude, scenario.stages[2].amplitude) = (10.0, 0.0, 0.0);
        let mut samples = samples(&scenario);
        samples[14_500].qd += 20.0 * NOISE;
        let seen = watch(&scenario, builtin, &samples);
        assert_eq!(seen.switches, 1, "{builtin:?} {seed}: {seen:?}");
        assert_eq!(seen.said(2), [SensorState::Ok], "{builtin:?} {seed}: {seen:?}");
        assert!(seen.said(1).contains(&SensorState::Outlier), "{builtin:?} {seed}: {seen:?}");
    }
}

/// A bad reading soon after the drive has stopped makes F, which repeats itself, look stuck: until the motion has
/// followed it as it is read.
#[test]
fn a_drive_that_is_switched_off_before_a_bad_reading_is_not_stuck_for_good() {
    for (builtin, seed) in [Builtin::DuffingSine, Builtin::VanDerPolSine].into_iter().zip([73, 74]) {
        for (first, count) in [(10_005, 3), (10_060, 20), (10_200, 5)] {
            let mut scenario = plant(builtin, seed, 18.0, 22.0);
            scenario.stages.insert(1, scenario.stages[0].clone());
            (scenario.stages[1].start, scenario.stages[1].amplitude, scenario.stages[2].amplitude) = (10.0, 0.0, 0.0);
            let mut samples = samples(&scenario);
            burst(&mut samples[first..first + count], 30.0, &mut ChaCha8Rng::seed_from_u64(seed));
            let seen = watch(&scenario, builtin, &samples);
            assert_eq!(seen.switches, 1, "{builtin:?} {seed} {count} from {first}: {seen:?}");
            assert_eq!(
                seen.said(2).last(),
                Some(&SensorState::Ok),
                "{builtin:?} {seed} {count} from {first}: {seen:?}"
            );
        }
    }
}
