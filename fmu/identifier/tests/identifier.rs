//! The identifier's library through the C interface.

mod contract;
mod laws;

use contract::{Drive, OK, Subject};
use switchid::fmu::identifier;
use switchid::identify::{Identifier, Outputs, Sample, Settings};
use switchid::law::{Given, Model, Term};
use switchid::simulate::{Builtin, Reading, Scenario, SensorNoise, Stage, record};
use switchid_fmu_identifier::functions;
use switchid_fmu_slave::host::Instance;
use switchid_fmu_slave::linked_functions;

const TERMS: &str = "qdd qd q q^3";

fn subject() -> Subject {
    let fmu = identifier("SwitchedIdentifier", &Model::cubic_library()).unwrap();
    Subject::new(linked_functions!(functions), &fmu)
}

/// Duffing, 8 s at 1 kHz, a switch after 6 s.
fn readings() -> Vec<Reading> {
    let mut scenario = Builtin::DuffingSine.scenario().with_noise(0.01);
    scenario.duration = 8.0;
    scenario.stages.truncate(1);
    let next = Stage { start: 6.0, coefficients: vec![1.2, 0.6, 6.0, 3.0], ..scenario.stages[0].clone() };
    scenario.stages.push(next);
    record(&scenario).unwrap()
}

fn prepare(subject: &Subject, instance: &Instance) {
    assert_eq!(instance.set_text(subject.reference("terms"), TERMS), OK);
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
}

fn sample(subject: &Subject, instance: &Instance, reading: &Reading, t: f64, step: f64) {
    let inputs = ["q", "qd", "F"].map(|name| subject.reference(name));
    assert_eq!(instance.set_reals(&inputs, &[reading.q, reading.qd, reading.excitation]), OK);
    assert_eq!(instance.step(t, step), OK, "{:?}", instance.messages());
}

fn feed<'a>(subject: &Subject, instance: &Instance, readings: impl IntoIterator<Item = &'a Reading>) {
    readings.into_iter().for_each(|reading| sample(subject, instance, reading, reading.t, 1e-3));
}

/// The record read by the library's identifier.
fn through_library(readings: &[Reading]) -> Vec<f64> {
    let library = Model::cubic_library();
    let terms: Vec<Term> = library.terms.iter().map(|entry| entry.term).collect();
    let model = library.with_terms(TERMS.split(' ')).unwrap();
    let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
    for reading in readings {
        let (q, qd, excitation) = (reading.q, reading.qd, reading.excitation);
        identifier.step(Sample { t: reading.t, q, qd, excitation }).unwrap();
    }
    Outputs::new(&terms, &identifier).values(&identifier).map(|value| value.number()).collect()
}

fn numbers(subject: &Subject, instance: &Instance) -> Vec<f64> {
    let terms: Vec<Term> = Model::cubic_library().terms.iter().map(|entry| entry.term).collect();
    let outputs = Outputs::describe(&terms);
    let read = |name: &str| {
        let reference = subject.reference(name);
        match name {
            "switch.count" | "status" | "missing.effect" | "law.number" | "sensor.q" | "sensor.qd" | "sensor.F" => {
                f64::from(instance.integer(reference).unwrap())
            }
            name if matches!(name, "valid" | "drifting") || name.starts_with("known.") => {
                f64::from(instance.boolean(reference).unwrap())
            }
            _ => instance.reals(&[reference]).unwrap()[0],
        }
    };
    outputs.iter().map(|output| read(&output.name)).collect()
}

#[test]
fn the_contract_holds() {
    let subject = subject();
    let readings = readings();
    let thinned: Vec<Reading> = readings.into_iter().step_by(4).collect();
    let drive = Drive {
        prepare: &|instance| prepare(&subject, instance),
        step: &|instance, k| {
            let reading = &thinned[k as usize];
            sample(&subject, instance, reading, reading.t, 4e-3);
        },
        steps: thinned.len() as u32,
    };
    contract::check(&subject, &drive);
}

#[test]
fn the_same_samples_give_the_library_s_bits() {
    let (subject, readings) = (subject(), readings());
    let instance = subject.instance();
    prepare(&subject, &instance);
    feed(&subject, &instance, &readings);
    assert_eq!(numbers(&subject, &instance), through_library(&readings));
}

#[test]
fn a_sample_that_is_no_number_is_skipped() {
    let (subject, readings) = (subject(), readings());
    let instance = subject.instance();
    prepare(&subject, &instance);
    for (index, reading) in readings.iter().enumerate() {
        let broken = match index {
            500 => Reading { q: f64::NAN, ..*reading },
            700 => Reading { qd: f64::INFINITY, ..*reading },
            900 => Reading { excitation: f64::NAN, ..*reading },
            _ => *reading,
        };
        sample(&subject, &instance, &broken, reading.t, 1e-3);
    }
    let mut kept = readings;
    for index in [900, 700, 500] {
        kept.remove(index);
    }
    assert_eq!(numbers(&subject, &instance), through_library(&kept));
    let warnings: Vec<_> = instance.messages().into_iter().filter(|(status, ..)| *status == 1).collect();
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings[0].2.contains("t = 0.5 s has a q that"), "{warnings:?}");
}

#[test]
fn jittering_and_split_steps_are_taken() {
    let (subject, readings) = (subject(), readings());
    let instance = subject.instance();
    prepare(&subject, &instance);
    let mut t = 0.0;
    for reading in &readings[..3000] {
        sample(&subject, &instance, reading, t, 1e-3);
        sample(&subject, &instance, reading, t, 0.0);
        t += 1e-3;
    }
    sample(&subject, &instance, &readings[3000], t, 0.09999999999999998);
    let warnings = instance.messages().into_iter().filter(|(status, ..)| *status == 1).count();
    assert_eq!(warnings, 4, "{:?}", instance.messages());
    assert!(numbers(&subject, &instance).iter().all(|value| value.is_finite()));
}

#[test]
fn a_faster_stream_is_thinned_and_said_once() {
    let (subject, readings) = (subject(), readings());
    let instance = subject.instance();
    assert_eq!(instance.set_reals(&[subject.reference("sample_time")], &[4e-3]), OK);
    prepare(&subject, &instance);
    feed(&subject, &instance, &readings[..2000]);
    let warnings: Vec<_> = instance.messages().into_iter().filter(|(status, ..)| *status == 1).collect();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].2.contains("sample_time"));
}

#[test]
fn refused_parameters_are_named() {
    let subject = subject();
    for (terms, named) in [
        ("qdd foo", "unknown term \"foo\""),
        ("qdd q^5", "no output coef.q_5"),
        ("qd q", "no inertia"),
        ("qdd q linear_stiffness", "the same term"),
        ("coef.qdd, q_3; q^3", "\"q_3\" and \"q^3\" are the same term"),
    ] {
        let instance = subject.instance();
        assert_eq!(instance.set_text(subject.reference("terms"), terms), OK);
        assert_ne!(instance.initialize(0.0), OK);
        assert!(instance.messages()[0].2.contains(named), "{:?}", instance.messages());
    }
    let instance = subject.instance();
    assert_eq!(instance.set_reals(&[subject.reference("max_window")], &[0.01]), OK);
    assert_ne!(instance.initialize(0.0), OK);
    assert!(instance.messages()[0].2.contains("max_window"), "{:?}", instance.messages());
}

/// Coefficients that are not left out of the model after a second of samples.
fn fitted(prepare: impl Fn(&Subject, &Instance)) -> Vec<String> {
    let (subject, readings) = (subject(), readings());
    let instance = subject.instance();
    prepare(&subject, &instance);
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    feed(&subject, &instance, &readings[..4000]);
    let terms = Model::cubic_library().terms.into_iter().map(|entry| entry.term.fmu_name());
    terms.filter(|term| instance.boolean(subject.reference(&format!("known.{term}"))) == Ok(1)).collect()
}

#[test]
fn terms_are_chosen_by_text_or_by_the_name_of_a_law() {
    let by_text = |text: &'static str| {
        fitted(move |subject, instance| assert_eq!(instance.set_text(subject.reference("terms"), text), OK))
    };
    let duffing = ["qdd", "q", "qd", "q_3"];
    assert_eq!(by_text("qdd q qd q^3"), duffing);
    assert_eq!(by_text(" coef.qdd, q_3;qd\tlinear_stiffness "), duffing);
    let by_name = fitted(|subject, instance| assert_eq!(instance.set_integer(subject.reference("model"), 3), OK));
    assert_eq!(by_name, duffing);
    let (subject, both) = (subject(), subject().instance());
    assert_eq!(both.set_integer(subject.reference("model"), 3), OK);
    assert_eq!(both.set_text(subject.reference("terms"), TERMS), OK);
    assert_ne!(both.initialize(0.0), OK);
    assert!(both.messages()[0].2.contains("terms and model both"), "{:?}", both.messages());
}

#[test]
fn missing_resources_are_named() {
    let subject = subject();
    for resource in ["interface.json", "model.toml"] {
        let refusal = subject.refusal_without(resource);
        assert!(refusal.contains(resource), "{refusal}");
    }
}

/// A damper on a testing machine, its law given to library and FMU.
#[test]
fn a_law_that_gives_the_force_is_identified_as_in_the_library() {
    let terms = ["qd", "q", "coulomb_friction"].map(|name| Term::parse(name).unwrap());
    let model = Model::of("damper", terms.map(|term| (term, Given::Fit)));
    let stage = |start, damping| Stage { start, coefficients: vec![damping, 20.0, 2.0], amplitude: 0.2, omega: 5.0 };
    let mut scenario = Scenario::new("damper", terms.to_vec(), vec![stage(0.0, 3.0), stage(4.0, 5.0)], 7.0);
    scenario.noise = SensorNoise { q: 1e-4, qd: 1e-3, force: 0.2 };
    let readings = record(&scenario).unwrap();
    let subject = Subject::new(linked_functions!(functions), &identifier("Damper", &model).unwrap());
    let instance = subject.instance();
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    feed(&subject, &instance, &readings);
    let mut library = Identifier::new(&model, Settings::default()).unwrap();
    for reading in &readings {
        let (q, qd, excitation) = (reading.q, reading.qd, reading.excitation);
        library.step(Sample { t: reading.t, q, qd, excitation }).unwrap();
    }
    let output = library.output();
    assert_eq!(instance.integer(subject.reference("switch.count")), Ok(1));
    assert_eq!(instance.boolean(subject.reference("valid")), Ok(1));
    let read = |name: &str| instance.reals(&[subject.reference(name)]).unwrap()[0];
    assert_eq!(read("prediction.F"), output.prediction.force);
    assert_eq!(read("deviation"), output.deviation);
    assert!(output.deviation > 0.0 && output.deviation < output.threshold, "{output:?}");
    for coefficient in library.coefficients() {
        assert_eq!(read(&format!("coef.{}", coefficient.term.fmu_name())), coefficient.value);
    }
    assert!((read("coef.qd") - 5.0).abs() < 5.0 * read("std.qd"));
    assert!((read("noise_estimate.F") / 0.2 - 1.0).abs() < 0.1);
}
