//! Slow drift of a coefficient is told from a switch: it is said and followed, and raises no stream of alarms.

use switchid::identify::{Coefficient, Identifier, Output, Sample, Settings, Status};
use switchid::law::{Given, Model, State};
use switchid::simulate::{Builtin, ExcitationKind, Scenario, Stage, record};

const SAMPLE_TIME: f64 = 4e-3;

/// A Duffing oscillator under a sine for `duration` s whose linear stiffness is this function of time, in steps of 50
/// ms.
fn duffing(duration: f64, stiffness: impl Fn(f64) -> f64) -> Scenario {
    moving(duration, |t| [1.0, 0.3, stiffness(t), 2.0])
}

/// One of which all coefficients are.
fn moving(duration: f64, coefficients: impl Fn(f64) -> [f64; 4]) -> Scenario {
    let stage = |step: u32| {
        let start = 0.05 * f64::from(step);
        Stage { start, coefficients: coefficients(start).to_vec(), amplitude: 2.0, omega: 1.5 }
    };
    let stages = (0..(20.0 * duration) as u32).map(stage).collect();
    let mut scenario = Scenario::new("drift", Builtin::DuffingSine.terms(), stages, duration);
    scenario.initial = State { q: 0.5, qd: 0.0 };
    scenario.excitation.kind = ExcitationKind::Sine;
    scenario.excitation.sample_time = SAMPLE_TIME;
    scenario.with_noise(1e-2).with_seed(1)
}

/// One whose stiffness moves by a part of itself from 20 s on, within `duration` s.
fn ramp(part: f64, duration: f64) -> Scenario {
    duffing(30.0 + duration, |t| 4.0 * (1.0 + part * ((t - 20.0) / duration).clamp(0.0, 1.0)))
}

/// After a sample: its time, what the identifier says, its coefficients, and the truth.
type After = (f64, Output, [Coefficient; 4], Vec<f64>);

/// What the default identifier says after every sample.
fn run(scenario: &Scenario) -> Vec<After> {
    let terms = Builtin::DuffingSine.terms().into_iter();
    let model = Model::of("Duffing", terms.map(|term| (term, Given::Fit)));
    let settings = Settings { sample_time: SAMPLE_TIME, ..Settings::default() };
    let mut identifier = Identifier::new(&model, settings).unwrap();
    let step = |reading: switchid::simulate::Reading| {
        let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
        identifier.step(sample).unwrap();
        let truth = scenario.stages[scenario.stage_at(reading.t)].coefficients.clone();
        let known = identifier.coefficients().try_into().unwrap();
        (reading.t, *identifier.output(), known, truth)
    };
    record(scenario).unwrap().into_iter().map(step).collect()
}

/// The mean of (error ÷ std)² over all coefficients.
fn normalised((_, _, known, truth): &After) -> f64 {
    let square = |(known, truth): (&Coefficient, &f64)| ((known.value - truth) / known.std.unwrap()).powi(2);
    known.iter().zip(truth).map(square).sum::<f64>() / 4.0
}

/// The ramp is said with one alarm at most, told for this share of it, by values with an honest std.
fn is_followed(scenario: &Scenario, duration: f64, least: f64) {
    let after = run(scenario);
    let alarms = after.last().unwrap().1.switch_count;
    assert!(alarms <= 1, "{alarms} alarms");
    assert!(after.iter().all(|(t, output, ..)| !output.drifting || *t > 20.0));
    // by values that may be known too little to be valid
    let is_told = |output: &Output| output.drifting && output.status == Status::Tracking;
    let told: Vec<_> = after.iter().filter(|(t, output, ..)| is_told(output) && *t < 20.0 + duration).collect();
    let share = told.len() as f64 * SAMPLE_TIME / duration;
    assert!(share > least, "told for {share} of the drift");
    let mean = told.iter().map(|after| normalised(after)).sum::<f64>() / told.len() as f64;
    assert!(mean < 4.0, "(error ÷ std)² is {mean}");
    let near = |(_, _, known, truth): &&After| (known[2].value / truth[2] - 1.0).abs() < 0.15;
    assert!(told.iter().all(near));
    let wrong = wrong_for(&after, &[]);
    assert!(wrong < 3.0, "valid and wrong for {wrong} s");
}

#[test]
fn a_slow_drift_is_said_and_followed_with_an_honest_std() {
    is_followed(&ramp(0.2, 20.0), 20.0, 0.4);
    is_followed(&ramp(-0.2, 20.0).with_seed(61), 20.0, 0.4);
    is_followed(&ramp(0.2, 40.0).with_seed(62), 40.0, 0.4);
}

#[test]
fn a_slow_drift_is_followed_in_noise() {
    is_followed(&ramp(0.2, 20.0).with_noise(5e-2).with_seed(63), 20.0, 0.4);
    is_followed(&ramp(-0.2, 40.0).with_noise(5e-2).with_seed(64), 40.0, 0.4);
}

#[test]
fn a_drift_of_four_natural_periods_is_followed() {
    is_followed(&ramp(0.2, 10.0).with_seed(65), 10.0, 0.4);
    is_followed(&ramp(-0.2, 10.0).with_noise(5e-2).with_seed(66), 10.0, 0.15);
}

#[test]
fn what_has_drifted_comes_to_rest() {
    let scenario = duffing(90.0, |t| 4.0 * (1.0 + 0.2 * ((t - 20.0) / 20.0).clamp(0.0, 1.0)));
    let after = run(&scenario);
    let (_, last, known, truth) = after.last().unwrap();
    assert!(last.valid && !last.drifting, "{last:?}");
    assert!((known[2].value / truth[2] - 1.0).abs() < 0.02, "{known:?}");
}

/// From 20 s on for `duration` s the law moves from one to the other.
fn between(duration: f64, [from, to]: [[f64; 4]; 2]) -> impl Fn(f64) -> [f64; 4] {
    move |t| {
        let part = ((t - 20.0) / duration).clamp(0.0, 1.0);
        std::array::from_fn(|index| from[index] + part * (to[index] - from[index]))
    }
}

/// Seconds for which it is valid and wrong, but for the first after each of these switches.
fn wrong_for(after: &[After], switches: &[f64]) -> f64 {
    let is_wrong = |(t, output, known, truth): &&After| {
        let error = |(known, truth): (&Coefficient, &f64)| (known.value - truth).powi(2);
        let e = known.iter().zip(truth).map(error).sum::<f64>() / truth.iter().map(|truth| truth * truth).sum::<f64>();
        output.valid && e > 0.05 * 0.05 && !switches.iter().any(|switch| (*switch..switch + 1.0).contains(t))
    };
    SAMPLE_TIME * after.iter().filter(is_wrong).count() as f64
}

const SETTLED: [f64; 4] = [1.0, 0.3, 4.0, 2.0];
const WORN: [[f64; 4]; 2] = [[0.85, 0.4, 4.0, 1.5], [1.1, 0.3, 5.0, 2.6]];

/// Nothing in the motion under one sine tells all coefficients apart while they move: what it does not tell is not
/// valid.
#[test]
fn a_law_that_moves_as_a_whole_is_not_valid_and_wrong_and_left_once_it_rests() {
    for (seed, to) in (71..).zip(WORN) {
        let duration = 25.0;
        let after = run(&moving(65.0, between(duration, [SETTLED, to])).with_seed(seed));
        let wrong = wrong_for(&after, &[]);
        assert!(wrong < 1.0, "{seed}: valid and wrong for {wrong} s");
        let drifted = after.iter().rev().find(|(_, output, ..)| output.drifting).map(|(t, ..)| *t);
        assert!(drifted.is_some_and(|t| t < 20.0 + duration + 12.0), "{seed}: until {drifted:?}");
        assert!(after.last().unwrap().1.valid, "{seed}");
    }
}

#[test]
fn a_switch_within_a_drift_is_seen_at_once_and_counted() {
    for (seed, to) in (80..).zip(WORN) {
        let (at, drift) = (33.0, between(25.0, [SETTLED, to]));
        let law = |t: f64| if t < at { drift(t) } else { [1.0, 0.5, 5.5, 1.2] };
        let after = run(&moving(60.0, law).with_seed(seed));
        assert!(after.iter().any(|(t, output, ..)| *t < at && output.drifting), "{seed}");
        let count = |time: f64| after.iter().rev().find(|(t, ..)| *t < time).unwrap().1.switch_count;
        let last = &after.last().unwrap().1;
        assert_eq!(count(at + 0.5), count(at) + 1, "{seed}");
        assert!((last.switch_time - at).abs() < 0.4, "{seed}: {last:?}");
        assert_eq!(last.switch_count, count(at + 0.5), "{seed}");
        let wrong = wrong_for(&after, &[at]);
        assert!(wrong < 1.0 && last.valid && !last.drifting, "{seed}: {wrong} s, {last:?}");
    }
}

#[test]
fn a_switch_is_no_drift() {
    for (size, seed) in [(0.1, 67), (0.375, 1), (-0.3, 68)] {
        let after = run(&duffing(60.0, |t| if t < 30.0 { 4.0 } else { 4.0 * (1.0 + size) }).with_seed(seed));
        let (_, last, ..) = after.last().unwrap();
        assert_eq!(last.switch_count, 1);
        assert!(last.detection_time.unwrap() < 30.5, "{last:?}");
        assert!(after.iter().all(|(_, output, ..)| !output.drifting));
    }
}

/// Early on the weak rows of this record speak for coefficients that move, while a constant law already explains it.
#[test]
fn a_record_that_a_constant_law_explains_is_no_drift() {
    let mut scenario = Builtin::VanDerPolSine.random(9724).with_noise(0.01);
    scenario.duration = 10.0;
    scenario.stages.truncate(1);
    let terms = Builtin::VanDerPolSine.terms().into_iter();
    let model = Model::of("van der Pol", terms.map(|term| (term, Given::Fit)));
    let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
    for reading in record(&scenario).unwrap() {
        let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
        identifier.step(sample).unwrap();
        assert!(!identifier.output().drifting, "at {} s", reading.t);
    }
    assert!(identifier.output().valid);
}

/// The rest fills the window, so that its record is folded while the motion is young: the law is known all the same.
#[test]
fn a_motion_that_begins_after_a_rest_is_known_and_no_drift() {
    let terms = Builtin::DuffingSine.terms().into_iter();
    let model = Model::of("Duffing", terms.map(|term| (term, Given::Fit)));
    for seed in [1, 2, 3] {
        let mut scenario = Builtin::DuffingSine.random(seed).with_noise(0.01);
        scenario.stages.truncate(1);
        (scenario.duration, scenario.initial) = (15.0, State::default());
        let motion = record(&scenario).unwrap();
        let mut rest = scenario.clone().with_seed(seed + 100);
        (rest.duration, rest.stages[0].amplitude) = (20.0, 0.0);
        let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
        let readings = record(&rest).unwrap();
        let begins = readings.last().unwrap().t + scenario.excitation.sample_time;
        let moves = motion.iter().map(|reading| (begins + reading.t, reading));
        for (t, reading) in readings.iter().map(|reading| (reading.t, reading)).chain(moves) {
            let sample = Sample { t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
            identifier.step(sample).unwrap();
            assert!(!identifier.output().drifting, "{seed} at {t} s");
        }
        assert!(identifier.output().valid, "{seed}");
    }
}
