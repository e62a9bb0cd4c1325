//! What the interface costs: `cargo xtask bench interface`. Duffing, four terms, 1 kHz, noise of 1 %.

#[path = "../../fmu/identifier/tests/contract/subject.rs"]
mod subject;

use std::time::{Duration, Instant};
use subject::{OK, Subject};
use switchid::fmu::identifier;
use switchid::identify::{Identifier, Sample, Settings};
use switchid::law::Model;
use switchid::simulate::{Builtin, Reading, record};
use switchid_fmu_identifier::functions;
use switchid_fmu_slave::host::Instance;
use switchid_fmu_slave::linked_functions;

const TERMS: [&str; 4] = ["qdd", "qd", "q", "q^3"];

fn main() {
    let library = Model::cubic_library();
    let subject = Subject::new(linked_functions!(functions), &identifier("SwitchedIdentifier", &library).unwrap());
    let mut scenario = Builtin::DuffingSine.scenario().with_noise(0.01);
    scenario.duration = 35.0;
    scenario.stages.truncate(1);
    let readings = record(&scenario).unwrap();
    let times = (0..20).map(|_| timed(|| start(&subject, &readings[0])).1).collect();
    println!("{:<32}{:4.2} ms", "instantiate to first step", 1e3 * median(times));
    let instance = start(&subject, &readings[0]);
    run(&subject, &instance, &readings);
    states(&instance);
}

/// The record through the interface, beside the library alone.
fn run(subject: &Subject, instance: &Instance, readings: &[Reading]) {
    let inputs = ["q", "qd", "F"].map(|name| subject.reference(name));
    let (mut library, mut beyond) = (Vec::new(), Vec::new());
    let mut alone = Identifier::new(&Model::cubic_library().with_terms(TERMS).unwrap(), Settings::default()).unwrap();
    alone.step(sample(&readings[0])).unwrap();
    for reading in &readings[1..] {
        assert_eq!(instance.set_reals(&inputs, &[reading.q, reading.qd, reading.excitation]), OK);
        let whole = timed(|| assert_eq!(instance.step(reading.t, 1e-3), OK)).1;
        let inner = timed(|| alone.step(sample(reading)).unwrap()).1;
        beyond.push(whole.saturating_sub(inner));
        library.push(inner);
    }
    println!("{:<32}{:4.2} µs", "the library's step", 1e6 * median(library));
    println!("{:<32}{:4.2} µs", "fmi2DoStep beyond it", 1e6 * median(beyond));
}

fn states(instance: &Instance) {
    let bytes = instance.pack(instance.save().unwrap()).unwrap();
    println!("{:<32}{:4.2} MB", "serialised state", 1e-6 * bytes.len() as f64);
    let mut state = instance.save().unwrap();
    report("fmi2GetFMUstate", || {
        let mut copy = instance.save().unwrap();
        instance.free(&mut copy);
    });
    report("fmi2SetFMUstate", || {
        instance.restore(state);
    });
    report("size and fmi2SerializeFMUstate", || drop(instance.pack(state)));
    report("fmi2DeSerializeFMUstate", || {
        let mut copy = instance.unpack(&bytes).unwrap();
        instance.free(&mut copy);
    });
    instance.free(&mut state);
}

fn start(subject: &Subject, reading: &Reading) -> Instance {
    let instance = subject.instance();
    assert_eq!(instance.set_text(subject.reference("terms"), &TERMS.join(" ")), OK);
    assert_eq!(instance.initialize(0.0), OK);
    let inputs = ["q", "qd", "F"].map(|name| subject.reference(name));
    assert_eq!(instance.set_reals(&inputs, &[reading.q, reading.qd, reading.excitation]), OK);
    assert_eq!(instance.step(reading.t, 1e-3), OK);
    instance
}

fn sample(reading: &Reading) -> Sample {
    Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation }
}

fn report(what: &str, mut call: impl FnMut()) {
    let times = (0..100).map(|_| timed(&mut call).1).collect();
    println!("{what:<32}{:4.2} ms", 1e3 * median(times));
}

fn timed<T>(call: impl FnOnce() -> T) -> (T, Duration) {
    let began = Instant::now();
    let result = call();
    (result, began.elapsed())
}

fn median(mut times: Vec<Duration>) -> f64 {
    times.sort_unstable();
    times[times.len() / 2].as_secs_f64()
}
