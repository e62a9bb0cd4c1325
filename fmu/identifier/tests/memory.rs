//! How much memory an instance takes, and what it says where there is not so much.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::process::Command;
use switchid::fmu::identifier;
use switchid::law::{Given, Model, Term};
use switchid_fmu_identifier::{IdentifierSlave, functions};
use switchid_fmu_package::Fmu;
use switchid_fmu_slave::host::{Counting, Instance, Request};
use switchid_fmu_slave::{Interface, Slave, linked_functions};

#[global_allocator]
static COUNTED: Counting = Counting::of_slave(IdentifierSlave::ROOM);

/// `fmi2OK`.
const OK: u32 = 0;

/// In the environment of the process that this test runs: how many bytes it may take beyond what it has.
const LIMIT: &str = "SWITCHID_TEST_MEMORY";

/// Bytes of a sample in the record, with as much again for the host.
const SAMPLE: usize = 96;

/// As many terms as a model may have.
fn largest() -> Fmu {
    let powers = (0..8_u8).flat_map(|q| (0..8).map(move |qd| Term::power(q, qd)));
    let terms = [Term::Inertia].into_iter().chain(powers).take(Model::MAX_TERMS);
    identifier("SwitchedIdentifier", &Model::of("largest", terms.map(|term| (term, Given::Fit)))).unwrap()
}

fn unpacked(fmu: &Fmu) -> (tempfile::TempDir, Interface) {
    let resources = tempfile::tempdir().unwrap();
    for (path, content) in fmu.files() {
        if let Some(name) = path.strip_prefix("resources/") {
            std::fs::write(resources.path().join(name), content).unwrap();
        }
    }
    let interface = serde_json::from_slice(&std::fs::read(resources.path().join("interface.json")).unwrap());
    (resources, interface.unwrap())
}

fn instance((resources, interface): &(tempfile::TempDir, Interface)) -> Option<Instance> {
    let location = resources.path().display().to_string();
    let request = Request { co_simulation: true, guid: &interface.guid, location: Some(&location), logging: false };
    Instance::new(linked_functions!(functions), &request).ok()
}

#[test]
fn an_instance_takes_no_more_than_half_of_what_it_asks_for() {
    let subject = unpacked(&largest());
    for window in [1_usize, 30, 100] {
        let asked = IdentifierSlave::ROOM + window * 1000 * SAMPLE;
        let (instance, made) = COUNTED.most(|| instance(&subject).unwrap());
        let place = subject.1.description.position("max_window").unwrap() as u32;
        assert_eq!(instance.set_reals(&[place], &[window as f64]), OK);
        let (status, begun) = COUNTED.most(|| instance.initialize(0.0));
        assert_eq!(status, OK);
        let most = made.max(begun);
        assert!(2 * most <= asked && 4 * most >= asked, "{window} s: {most} of {asked} bytes");
    }
}

/// The other process runs this test alone.
#[test]
fn where_memory_ends_a_call_is_refused_and_the_process_goes_on() {
    if let Ok(limit) = std::env::var(LIMIT) {
        return until_memory_ends(limit.parse().unwrap());
    }
    for step in 0..24 {
        let limit = (8 << 20) + step * 2_100_007_u64;
        let mut own = Command::new(std::env::current_exe().unwrap());
        let name = "where_memory_ends_a_call_is_refused_and_the_process_goes_on";
        let output = own.args(["--exact", name, "--test-threads", "1"]).env(LIMIT, limit.to_string()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{limit} bytes: {}: {said}", output.status);
    }
}

/// Instances are made and initialised until one is refused.
fn until_memory_ends(limit: u64) {
    let subject = unpacked(&identifier("SwitchedIdentifier", &Model::cubic_library()).unwrap());
    let taken = std::fs::read_to_string("/proc/self/statm").unwrap();
    let pages: u64 = taken.split(' ').next().unwrap().parse().unwrap();
    let most = pages * rustix::param::page_size() as u64 + limit;
    setrlimit(Resource::As, Rlimit { current: Some(most), ..getrlimit(Resource::As) }).unwrap();
    let mut instances = Vec::with_capacity(1000);
    while instances.len() < 1000 {
        match instance(&subject) {
            Some(one) if one.initialize(0.0) == OK => instances.push(one),
            _ => return,
        }
    }
    panic!("a thousand instances in {limit} bytes");
}
