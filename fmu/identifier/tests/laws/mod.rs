//! Laws that return, through the C interface: known again after a switch, across a saved state, and from laws in the
//! archive.

use super::contract::{OK, Subject};
use switchid::fmu::{identifier, identifier_knowing};
use switchid::identify::{Identifier, Sample, SavedLaws, Settings};
use switchid::law::{Given, Model};
use switchid::simulate::{Builtin, Reading, record};
use switchid_fmu_identifier::functions;
use switchid_fmu_slave::host::Instance;
use switchid_fmu_slave::linked_functions;

const LENGTH: f64 = 8.0;
const A: [f64; 4] = [1.0, 0.3, 4.0, 2.0];
const B: [f64; 4] = [1.2, 0.5, 5.5, 1.2];

fn model() -> Model {
    Model::of("Duffing", Builtin::DuffingSine.terms().into_iter().map(|term| (term, Given::Fit)))
}

/// A record of these laws at 1 kHz, one after the other.
fn readings(laws: &[[f64; 4]], seed: u64) -> Vec<Reading> {
    let mut scenario = Builtin::DuffingSine.scenario().with_noise(0.01).with_seed(seed);
    let mut stages = vec![scenario.stages[0].clone(); laws.len()];
    for (index, (stage, law)) in stages.iter_mut().zip(laws).enumerate() {
        (stage.start, stage.coefficients) = (LENGTH * index as f64, law.to_vec());
    }
    (scenario.stages, scenario.duration) = (stages, LENGTH * laws.len() as f64);
    record(&scenario).unwrap()
}

/// Steps the instance through the readings; the time at which the law of that number is first in use, s.
fn in_use(subject: &Subject, instance: &Instance, readings: &[Reading], number: i32) -> Option<f64> {
    let inputs = ["q", "qd", "F"].map(|name| subject.reference(name));
    let [valid, law] = ["valid", "law.number"].map(|name| subject.reference(name));
    let mut first = None;
    for reading in readings {
        assert_eq!(instance.set_reals(&inputs, &[reading.q, reading.qd, reading.excitation]), OK);
        assert_eq!(instance.step(reading.t, 1e-3), OK, "{:?}", instance.messages());
        let is_in_use = instance.boolean(valid) == Ok(1) && instance.integer(law) == Ok(number);
        first = first.or(is_in_use.then_some(reading.t));
    }
    first
}

fn initialized(subject: &Subject) -> Instance {
    let instance = subject.instance();
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    instance
}

#[test]
fn a_law_that_returns_bears_its_number_in_a_restored_state_too() {
    let subject = Subject::new(linked_functions!(functions), &identifier("Duffing", &model()).unwrap());
    let readings = readings(&[A, B, A], 1);
    let (before, after) = readings.split_at((1e3 * (2.0 * LENGTH - 1.0)) as usize);
    let instance = initialized(&subject);
    let second = in_use(&subject, &instance, before, 2).unwrap();
    assert!(second > LENGTH);
    let state = instance.save().unwrap();
    let bytes = instance.pack(state).unwrap();
    let other = initialized(&subject);
    assert_eq!(other.restore(other.unpack(&bytes).unwrap()), OK);
    let [one, restored] = [&instance, &other].map(|instance| in_use(&subject, instance, after, 1).unwrap());
    assert_eq!(one, restored);
    assert!(one > 2.0 * LENGTH && one - 2.0 * LENGTH < 0.2 * (second - LENGTH), "{one}, the new law at {second}");
    assert_eq!(subject.outputs(&instance), subject.outputs(&other));
}

#[test]
fn laws_in_the_archive_are_known_from_the_first_samples_on() {
    let plain = Subject::new(linked_functions!(functions), &identifier("Duffing", &model()).unwrap());
    let knowing =
        Subject::new(linked_functions!(functions), &identifier_knowing("Duffing", &model(), &known()).unwrap());
    let record = readings(&[A], 2);
    let [with, without] = [&knowing, &plain].map(|subject| in_use(subject, &initialized(subject), &record, 1).unwrap());
    assert!(with < 0.35 * without, "{with} s with the law in the archive, {without} s without");
}

/// The laws that a record of A leaves.
fn known() -> SavedLaws {
    let mut identifier = Identifier::new(&model(), Settings::default()).unwrap();
    for reading in readings(&[A], 1) {
        let (q, qd, excitation) = (reading.q, reading.qd, reading.excitation);
        identifier.step(Sample { t: reading.t, q, qd, excitation }).unwrap();
    }
    identifier.known_laws()
}
