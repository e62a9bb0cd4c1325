//! Slow drift of a coefficient is told from a switch: it is said and followed, and raises no stream of alarms.

use switchid::identify::{Coefficient, Identifier, Output, Sample, Settings};
use switchid::law::{Given, Model, State, Term};
use switchid::simulate::{Builtin, ExcitationKind, Scenario, Stage, record};

const SAMPLE_TIME: f64 = 4e-3;

/// A Duffing oscillator under a sine whose linear stiffness is this function of time, in steps of 50 ms.
fn duffing(stiffness: impl Fn(f64) -> f64) -> Scenario {
    let stage = |step: u32| {
        let start = 0.05 * f64::from(step);
        Stage { start, coefficients: vec![1.0, 0.3, stiffness(start), 2.0], amplitude: 2.0, omega: 1.5 }
    };
    let mut scenario = Scenario::new("drift", Builtin::DuffingSine.terms(), (0..1200).map(stage).collect(), 60.0);
    scenario.initial = State { q: 0.5, qd: 0.0 };
    scenario.excitation.kind = ExcitationKind::Sine;
    scenario.excitation.sample_time = SAMPLE_TIME;
    scenario.with_noise(1e-2).with_seed(1)
}

/// What the default identifier says after every sample, with the linear stiffness's truth.
fn run(scenario: &Scenario) -> Vec<(f64, Output, Coefficient, f64)> {
    let terms = Builtin::DuffingSine.terms().into_iter();
    let model = Model::of("Duffing", terms.map(|term| (term, Given::Fit)));
    let settings = Settings { sample_time: SAMPLE_TIME, ..Settings::default() };
    let mut identifier = Identifier::new(&model, settings).unwrap();
    let step = |reading: switchid::simulate::Reading| {
        let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
        identifier.step(sample).unwrap();
        let truth = scenario.stages[scenario.stage_at(reading.t)].coefficients[2];
        (reading.t, *identifier.output(), identifier.coefficients()[2], truth)
    };
    record(scenario).unwrap().into_iter().map(step).collect()
}

#[test]
fn a_slow_drift_is_said_and_followed_with_one_alarm_at_most() {
    let after = run(&duffing(|t| 4.0 + 0.8 * ((t - 20.0) / 20.0).clamp(0.0, 1.0)));
    let alarms = after.last().unwrap().1.switch_count;
    assert!(alarms <= 1, "{alarms} alarms");
    let drifting: Vec<_> =
        after.iter().filter(|(t, output, ..)| output.drifting && output.valid && *t < 40.0).collect();
    let share = drifting.len() as f64 * SAMPLE_TIME / 20.0;
    assert!(share > 0.1, "said for {share} of the drift");
    assert!(after.iter().all(|(t, output, ..)| !output.drifting || *t > 20.0));
    assert!(drifting.iter().all(|(_, _, known, _)| known.term == Term::power(1, 0)));
    let near = |(_, _, known, truth): &&(f64, Output, Coefficient, f64)| (known.value / truth - 1.0).abs() < 0.2;
    assert!(drifting.iter().all(near));
}

#[test]
fn a_switch_is_no_drift() {
    let after = run(&duffing(|t| if t < 30.0 { 4.0 } else { 5.5 }));
    let (_, last, ..) = after.last().unwrap();
    assert_eq!(last.switch_count, 1);
    assert!(last.detection_time.unwrap() < 30.5, "{last:?}");
    assert!(after.iter().all(|(_, output, ..)| !output.drifting));
}
