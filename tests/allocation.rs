//! Nothing is allocated after construction: every call of the allocator during a step is counted.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use switchid::identify::{Identifier, Sample, Settings, Status};
use switchid::law::{Given, Model, Term};
use switchid::simulate::{Builtin, Scenario, SensorNoise, Stage, record};

/// The system's allocator, counting by thread, so that tests beside this one do not count.
struct Counting;

thread_local! {
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    CALLS.set(CALLS.get() + 1);
}

// SAFETY: every call goes to the system's allocator as it came; the counter itself allocates nothing.
#[expect(unsafe_code, reason = "an allocator cannot be written without; the library itself has none")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Runs the first `duration` s of the scenario; the statuses seen, and at which times a step called the allocator.
fn run(builtin: Builtin, noise: f64, duration: f64, model: &Model, settings: Settings) -> (Vec<Status>, Vec<f64>) {
    let mut scenario = builtin.scenario().with_noise(noise);
    scenario.duration = duration;
    scenario.stages.retain(|stage| stage.start < duration);
    let rows = record(&scenario).unwrap();
    let mut identifier = Identifier::new(model, settings).unwrap();
    let (mut statuses, mut allocating) = (Vec::new(), Vec::new());
    for row in rows {
        let sample = Sample { t: row.t, q: row.q, qd: row.qd, excitation: row.excitation };
        let before = CALLS.get();
        let taken = identifier.step(sample);
        if CALLS.get() != before {
            allocating.push(row.t);
        }
        taken.unwrap();
        if statuses.last() != Some(&identifier.output().status) {
            statuses.push(identifier.output().status);
        }
    }
    (statuses, allocating)
}

/// Acquisition, tracking, a switch, re-identification and tracking of the new law, all without the allocator.
fn assert_silent(builtin: Builtin, noise: f64, duration: f64, model: &Model) {
    let (statuses, allocating) = run(builtin, noise, duration, model, Settings::default());
    let mut rest = statuses.iter();
    for phase in [Status::Acquiring, Status::Tracking, Status::ReIdentifying, Status::Tracking] {
        assert!(rest.any(|status| *status == phase), "{phase:?} is missing from {statuses:?}");
    }
    let first = allocating.first();
    assert!(allocating.is_empty(), "{} steps called the allocator, the first at {first:?} s", allocating.len());
}

#[test]
fn a_duffing_oscillator_is_followed_through_a_switch_without_allocating() {
    let terms = ["qdd", "qd", "q", "q^3"].map(|name| (Term::parse(name).unwrap(), Given::Fit));
    assert_silent(Builtin::DuffingSine, 0.0, 24.0, &Model::of("duffing", terms));
}

#[test]
fn a_full_library_under_noise_is_followed_through_a_switch_without_allocating() {
    assert_silent(Builtin::VanDerPolSine, 0.01, 36.0, &Model::cubic_library());
}

/// The first stage's law returns in the third.
#[test]
fn a_law_is_recognised_without_allocating() {
    let terms = ["qdd", "qd", "q", "q^3"].map(|name| (Term::parse(name).unwrap(), Given::Fit));
    let mut scenario = Builtin::DuffingSine.scenario().with_noise(0.01);
    scenario.stages.truncate(3);
    scenario.stages[2].coefficients = scenario.stages[0].coefficients.clone();
    scenario.duration = 40.0;
    let mut identifier = Identifier::new(&Model::of("duffing", terms), Settings::default()).unwrap();
    let mut allocating = 0;
    for row in record(&scenario).unwrap() {
        let sample = Sample { t: row.t, q: row.q, qd: row.qd, excitation: row.excitation };
        let before = CALLS.get();
        identifier.step(sample).unwrap();
        allocating += CALLS.get() - before;
    }
    assert!(identifier.output().recognised, "the law was not recognised");
    assert_eq!(allocating, 0);
}

#[test]
fn a_law_that_gives_the_force_is_followed_through_a_switch_without_allocating() {
    let terms = ["qd", "q", "coulomb_friction"].map(|name| Term::parse(name).unwrap());
    let stage = |start, damping| Stage { start, coefficients: vec![damping, 20.0, 2.0], amplitude: 0.2, omega: 5.0 };
    let mut scenario = Scenario::new("damper", terms.to_vec(), vec![stage(0.0, 3.0), stage(5.0, 5.0)], 8.0);
    scenario.noise = SensorNoise { q: 1e-4, qd: 1e-3, force: 0.2 };
    let model = Model::of("damper", terms.map(|term| (term, Given::Fit)));
    let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
    let mut allocating = 0;
    for row in record(&scenario).unwrap() {
        let sample = Sample { t: row.t, q: row.q, qd: row.qd, excitation: row.excitation };
        let before = CALLS.get();
        identifier.step(sample).unwrap();
        allocating += CALLS.get() - before;
    }
    assert_eq!((identifier.output().switch_count, identifier.output().valid), (1, true));
    assert_eq!(allocating, 0);
}

#[test]
fn an_allocation_is_counted() {
    let before = CALLS.get();
    drop(std::hint::black_box(vec![0_u8; 16]));
    assert_eq!(CALLS.get(), before + 2);
}
