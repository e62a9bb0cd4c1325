//! Saved states of the identifier: small, exact, and never anything but what was saved.

#[path = "contract/subject.rs"]
mod subject;

use subject::{OK, Subject};
use switchid::fmu::identifier;
use switchid::law::Model;
use switchid::simulate::{Builtin, Reading, record};
use switchid_fmu_identifier::functions;
use switchid_fmu_slave::host::Instance;
use switchid_fmu_slave::linked_functions;

/// Duffing with four terms at 1 kHz, noise of 1 %.
fn after(seconds: f64) -> (Subject, Instance, Vec<Reading>) {
    after_with(&Model::cubic_library(), "qdd qd q q^3", seconds)
}

/// The same of another model's terms.
fn after_with(model: &Model, terms: &str, seconds: f64) -> (Subject, Instance, Vec<Reading>) {
    let fmu = identifier("SwitchedIdentifier", model).unwrap();
    let subject = Subject::new(linked_functions!(functions), &fmu);
    let instance = subject.instance();
    assert_eq!(instance.set_text(subject.reference("terms"), terms), OK);
    assert_eq!(instance.initialize(0.0), OK);
    let mut scenario = Builtin::DuffingSine.scenario().with_noise(0.01);
    scenario.duration = seconds + 1.0;
    scenario.stages.truncate(1);
    let readings = record(&scenario).unwrap();
    let count = (seconds * 1e3) as usize;
    readings[..count].iter().for_each(|reading| step(&subject, &instance, reading));
    (subject, instance, readings[count..].to_vec())
}

fn step(subject: &Subject, instance: &Instance, reading: &Reading) {
    let inputs = ["q", "qd", "F"].map(|name| subject.reference(name));
    assert_eq!(instance.set_reals(&inputs, &[reading.q, reading.qd, reading.excitation]), OK);
    assert_eq!(instance.step(reading.t, 1e-3), OK);
}

#[test]
fn a_state_of_thirty_seconds_takes_less_than_0_8_mb() {
    let (_, instance, _) = after(31.0);
    let bytes = instance.pack(instance.save().unwrap()).unwrap();
    assert!(bytes.len() < 800_000, "{} bytes", bytes.len());
}

#[test]
fn no_flipped_bit_and_no_truncation_is_accepted() {
    let (_, instance, _) = after(3.0);
    let bytes = instance.pack(instance.save().unwrap()).unwrap();
    let bits = 8 * bytes.len();
    let accepted = (0..2000_usize).filter(|number| {
        let bit = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) % bits;
        let mut changed = bytes.clone();
        changed[bit / 8] ^= 1 << (bit % 8);
        instance.unpack(&changed).is_ok()
    });
    assert_eq!(accepted.count(), 0);
    for part in 0..200 {
        assert!(instance.unpack(&bytes[..bytes.len() * part / 200]).is_err(), "{part} of 200");
    }
}

#[test]
fn a_formula_of_the_users_own_is_a_term_like_any_other_and_goes_into_the_state() {
    let text = "[terms]\nqdd = \"fit\"\nqd = \"fit\"\nq = \"fit\"\nhard = { coefficient = \"fit\", n = 3 }\n\
                [effects.hard]\nexpression = \"abs(q)^n*sign(q)\"\n";
    let (subject, instance, rest) = after_with(&Model::from_toml(text).unwrap(), "qdd qd q hard", 5.0);
    let (builtin, reference, _) = after(5.0);
    let read =
        |subject: &Subject, instance: &Instance, name: &str| instance.reals(&[subject.reference(name)]).unwrap()[0];
    for (own, theirs) in [("hard", "q_3"), ("q", "q")] {
        for kind in ["coef", "std"] {
            let value = read(&subject, &instance, &format!("{kind}.{own}"));
            let expected = read(&builtin, &reference, &format!("{kind}.{theirs}"));
            assert!((value / expected - 1.0).abs() < 1e-6, "{kind}.{own}: {value}, {expected}");
        }
    }
    let other = subject.instance();
    let state = other.unpack(&instance.pack(instance.save().unwrap()).unwrap()).unwrap();
    assert_eq!(other.restore(state), OK);
    for instance in [&instance, &other] {
        rest.iter().for_each(|reading| step(&subject, instance, reading));
    }
    assert!(other.pack(other.save().unwrap()).unwrap() == instance.pack(instance.save().unwrap()).unwrap());
}

/// The other process runs this test alone, with the state's file in its environment.
const STATE: &str = "SWITCHID_TEST_STATE";

#[test]
fn a_state_goes_on_bit_by_bit_in_another_process() {
    let (subject, instance, rest) = after(3.0);
    if let Some(path) = std::env::var_os(STATE) {
        let other = subject.instance();
        let state = other.unpack(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(other.restore(state), OK);
        rest.iter().for_each(|reading| step(&subject, &other, reading));
        std::fs::write(&path, other.pack(other.save().unwrap()).unwrap()).unwrap();
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state");
    std::fs::write(&path, instance.pack(instance.save().unwrap()).unwrap()).unwrap();
    let mut other = std::process::Command::new(std::env::current_exe().unwrap());
    other.args(["--exact", "a_state_goes_on_bit_by_bit_in_another_process"]).env(STATE, &path);
    assert!(other.output().unwrap().status.success());
    rest.iter().for_each(|reading| step(&subject, &instance, reading));
    let here = instance.pack(instance.save().unwrap()).unwrap();
    assert!(std::fs::read(&path).unwrap() == here, "in another process the run differs");
}
