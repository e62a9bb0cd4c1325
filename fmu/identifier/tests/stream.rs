//! What the identifier says of the samples that a host feeds.

#[path = "contract/subject.rs"]
mod subject;

use subject::{OK, Subject};
use switchid::fmu::identifier;
use switchid::law::Model;
use switchid_fmu_identifier::functions;
use switchid_fmu_slave::Kind;
use switchid_fmu_slave::host::Instance;
use switchid_fmu_slave::linked_functions;

struct Run {
    subject: Subject,
    instance: Instance,
}

impl Run {
    fn new() -> Run {
        let fmu = identifier("SwitchedIdentifier", &Model::cubic_library()).unwrap();
        let subject = Subject::new(linked_functions!(functions), &fmu);
        let instance = subject.instance();
        assert_eq!(instance.set_text(subject.reference("terms"), "qdd, qd, q"), OK);
        assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
        Run { subject, instance }
    }

    fn feed(&self, t: f64, step: f64, inputs: [f64; 3]) {
        let references = ["q", "qd", "F"].map(|name| self.subject.reference(name));
        assert_eq!(self.instance.set_reals(&references, &inputs), OK);
        assert_eq!(self.instance.step(t, step), OK, "{:?}", self.instance.messages());
    }

    /// A free oscillation of 1 rad/s from a step of the run to another.
    fn swing(&self, from: u32, to: u32, step: f64) {
        (from..to).for_each(|k| self.feed(f64::from(k) * step, step, motion(f64::from(k) * step)));
    }

    fn stream(&self) -> String {
        let number = self.instance.integer(self.subject.reference("stream")).unwrap();
        let description = &self.subject.interface.description;
        let Kind::Enumeration { of, .. } = &description.variables[description.position("stream").unwrap()].kind else {
            panic!("stream is no enumeration")
        };
        let items = &description.enumerations.iter().find(|own| own.name == *of).unwrap().items;
        items[number as usize - 1].0.clone()
    }

    fn warnings(&self) -> Vec<String> {
        let said = self.instance.messages().into_iter().filter(|(status, ..)| *status == 1);
        said.map(|(_, _, text)| text).collect()
    }
}

fn motion(t: f64) -> [f64; 3] {
    [t.sin(), t.cos(), 0.1 * (2.0 * t).cos()]
}

#[test]
fn an_ordinary_stream_has_nothing_said_of_it() {
    let run = Run::new();
    run.swing(0, 3000, 1e-2);
    assert_eq!((run.stream().as_str(), run.warnings().len()), ("ok", 0), "{:?}", run.warnings());
}

#[test]
fn inputs_that_nobody_connected_are_named_once() {
    let run = Run::new();
    (0..2000).for_each(|k| run.feed(f64::from(k) * 1e-3, 1e-3, [0.0; 3]));
    assert_eq!(run.stream(), "not_connected");
    let warnings = run.warnings();
    assert!(warnings.len() == 1 && warnings[0].starts_with("t = 0.5 s: "), "{warnings:?}");
}

#[test]
fn a_motion_that_ends_is_named_and_again_after_it_came_back() {
    let run = Run::new();
    let rest = |from: u32, to: u32| (from..to).for_each(|k| run.feed(f64::from(k) * 1e-2, 1e-2, [0.3, 0.0, 0.1]));
    run.swing(0, 1000, 1e-2);
    rest(1000, 2000);
    assert_eq!(run.stream(), "no_motion");
    run.swing(2000, 3000, 1e-2);
    assert_eq!(run.stream(), "ok");
    rest(3000, 4000);
    let warnings = run.warnings();
    assert_eq!((run.stream().as_str(), warnings.len()), ("no_motion", 2), "{warnings:?}");
    assert!(warnings.iter().all(|text| text.contains("have not changed")), "{warnings:?}");
}

#[test]
fn inputs_that_are_held_are_named() {
    let run = Run::new();
    for k in 0..2000 {
        let held = f64::from(k / 2) * 2e-2;
        run.feed(f64::from(k) * 1e-2, 1e-2, motion(held));
    }
    let warnings = run.warnings();
    assert_eq!(run.stream(), "not_fresh");
    assert!(warnings[0].starts_with("t = 0.01 s: ") && warnings[0].contains("held or stuck"), "{warnings:?}");
    // each is read once, so that the motion tells how F moves from one to the next
    assert!(warnings.len() == 2 && warnings[1].contains("F is linear between samples"), "{warnings:?}");
}

#[test]
fn inputs_that_are_interpolated_are_named() {
    let run = Run::new();
    for k in 0..2000 {
        let [from, to] = [k / 2, k / 2 + 1].map(|k| motion(f64::from(k) * 2e-2));
        let share = 0.5 * f64::from(k % 2);
        let between = std::array::from_fn(|channel| (1.0 - share) * from[channel] + share * to[channel]);
        run.feed(f64::from(k) * 1e-2, 1e-2, between);
    }
    let warnings = run.warnings();
    assert_eq!(run.stream(), "not_fresh");
    assert!(warnings[0].contains("interpolated"), "{warnings:?}");
    // and F, which the interpolation makes linear, is told to be
    assert!(warnings[1..].iter().all(|warning| warning.starts_with("hold: ")) && warnings.len() <= 2, "{warnings:?}");
}

#[test]
fn steps_too_long_for_the_motion_are_named() {
    let run = Run::new();
    run.swing(0, 40, 1.5);
    let warnings = run.warnings();
    assert_eq!((run.stream().as_str(), warnings.len()), ("too_coarse", 1), "{warnings:?}");
    assert!(warnings[0].contains("only 4.") && warnings[0].contains("shorter communication steps"), "{warnings:?}");
}

#[test]
fn a_hole_in_the_stream_is_named_and_over_after_a_while() {
    let run = Run::new();
    run.swing(0, 1500, 1e-2);
    run.swing(1800, 1900, 1e-2);
    assert_eq!(run.stream(), "too_far_apart");
    run.swing(1900, 3000, 1e-2);
    let warnings = run.warnings();
    assert_eq!((run.stream().as_str(), warnings.len()), ("ok", 1), "{warnings:?}");
    assert!(warnings[0].starts_with("t = 18 s: no sample for 3.01 s"), "{warnings:?}");
}

#[test]
fn a_stamp_that_is_ahead_is_said_and_no_hole() {
    let run = Run::new();
    run.swing(0, 1500, 1e-2);
    run.feed(1e6, 1e-2, motion(15.0));
    run.swing(1501, 2500, 1e-2);
    let warnings = run.warnings();
    assert_eq!((run.stream().as_str(), warnings.len()), ("ok", 1), "{warnings:?}");
    assert!(warnings[0].contains("t = 1000000 s") && warnings[0].contains("its time is wrong"), "{warnings:?}");
}

#[test]
fn a_huge_step_is_taken_and_the_next_sample_is_called_far() {
    let run = Run::new();
    run.swing(0, 1000, 1e-2);
    run.feed(1e9, 1e9, motion(0.5));
    run.feed(2e9, 1e-2, motion(0.6));
    assert_eq!(run.stream(), "too_far_apart");
    let coefficients = ["coef.qdd", "coef.qd", "coef.q"].map(|name| run.subject.reference(name));
    assert!(run.instance.reals(&coefficients).unwrap().iter().all(|value| value.is_finite()));
}

#[test]
fn a_sample_that_is_no_number_shows_until_it_is_over() {
    let run = Run::new();
    run.swing(0, 100, 1e-2);
    run.feed(1.0, 1e-2, [f64::NAN, 0.0, 0.0]);
    assert_eq!(run.stream(), "not_a_number");
    run.swing(101, 700, 1e-2);
    assert_eq!((run.stream().as_str(), run.warnings().len()), ("ok", 1), "{:?}", run.warnings());
}
