//! The C interface with a toy slave: every cell of the allowed-call table, refusals, panics, the log.

use serde::{Deserialize, Serialize};
use std::path::Path;
use std::ptr::{null, null_mut};
use switchid_fmu_slave::ctypes::EventInfo;
use switchid_fmu_slave::host::{Functions, Instance, Request, Saved};
use switchid_fmu_slave::{
    Causality, Continuous, Description, INTERFACE_FILE, Interface, Kind, Log, Slave, SlaveError, Value, Values,
    Variability, Variable,
};

/// y(t + h) = y(t) + gain · u(t), in model exchange ẏ = gain · u and y(t₀) = t₀ with an event at every full second;
/// panics where u is 13, refuses a gain of 7.
#[derive(Clone, Serialize, Deserialize)]
pub struct Toy {
    sum: f64,
    time: f64,
    integrated: bool,
}

#[derive(Debug, thiserror::Error)]
#[error("gain = 7 brings bad luck: take 8, 100 % safer")]
struct BadLuck;

impl Slave for Toy {
    const ROOM: usize = 1 << 16;

    fn instantiate(_: &Path, _: &Description) -> Result<Toy, SlaveError> {
        Ok(Toy { sum: 0.0, time: 0.0, integrated: false })
    }

    fn start(&mut self, time: f64, values: &mut Values, _: &mut Log) -> Result<(), SlaveError> {
        if values.real(GAIN as usize) == 7.0 {
            return Err(BadLuck.into());
        }
        self.sum = time;
        values.put(Y as usize, Value::Real(self.sum));
        Ok(())
    }

    fn start_continuous(&mut self, time: f64, values: &mut Values, log: &mut Log) -> Result<(), SlaveError> {
        self.start(time, values, log)?;
        (self.time, self.integrated) = (time, true);
        Ok(())
    }

    fn continuous(&mut self) -> Option<&mut dyn Continuous> {
        if self.integrated { Some(self) } else { None }
    }

    fn step(&mut self, _: f64, _: f64, values: &mut Values, log: &mut Log) -> Result<(), SlaveError> {
        let u = values.real(U as usize);
        assert!(u != 13.0, "thirteen");
        if u.is_nan() {
            log.warn_rarely("u", || "u is NaN: 100 % useless".into());
        } else {
            self.sum += values.real(GAIN as usize) * u;
        }
        values.put(Y as usize, Value::Real(self.sum));
        Ok(())
    }
}

impl Continuous for Toy {
    fn set_time(&mut self, time: f64) {
        self.time = time;
    }

    fn states(&self) -> Vec<f64> {
        vec![self.sum]
    }

    fn set_states(&mut self, states: &[f64]) {
        self.sum = states[0];
    }

    fn derivatives(&self, values: &Values) -> Vec<f64> {
        let u = values.real(U as usize);
        assert!(u != 13.0, "thirteen");
        vec![values.real(GAIN as usize) * u]
    }

    fn settle(&mut self, _: &Values, _: &mut Log) -> Option<f64> {
        Some(self.time.floor() + 1.0)
    }

    fn show(&self, values: &mut Values) {
        values.put(Y as usize, Value::Real(self.sum));
    }
}

switchid_fmu_slave::export!(Toy);
switchid_fmu_slave::export_exchange!(Toy);

const U: u32 = 0;
const GAIN: u32 = 1;
const COUNT: u32 = 2;
const FLAG: u32 = 3;
const NOTE: u32 = 4;
const Y: u32 = 5;
const MARK: u32 = 6;

const OK: u32 = 0;
const ERROR: u32 = 3;
const GUID: &str = "the-guid";

fn toy_functions() -> Functions {
    switchid_fmu_slave::linked_functions!(functions)
}

fn variable(name: &str, causality: Causality, kind: Kind) -> Variable {
    Variable {
        name: name.into(),
        description: String::new(),
        causality,
        variability: Variability::Discrete,
        kind,
        depends_on: Vec::new(),
        derivative_of: None,
        follows: Vec::new(),
    }
}

fn resources_with(guid: &str) -> tempfile::TempDir {
    resources_for(guid, true)
}

fn resources_for(guid: &str, model_exchange: bool) -> tempfile::TempDir {
    let real = |start| Kind::Real { start, min: None, max: Some(100.0), unit: None };
    let mut variables = vec![
        variable("u", Causality::Input, real(0.0)),
        variable("gain", Causality::Parameter, real(2.0)),
        variable("count", Causality::Parameter, Kind::Integer { start: 1, min: Some(0), max: None }),
        variable("flag", Causality::Parameter, Kind::Boolean { start: true }),
        variable("note", Causality::Parameter, Kind::String { start: "größe".into() }),
        variable("y", Causality::Output, real(0.0)),
        variable("mark", Causality::Input, real(0.0)),
    ];
    variables[U as usize].variability = Variability::Continuous;
    let description = Description {
        name: "Toy".into(),
        description: String::new(),
        version: String::new(),
        default_step: 1.0,
        default_duration: 1.0,
        units: vec![],
        model_exchange,
        enumerations: vec![],
        variables,
    };
    let directory = tempfile::tempdir().unwrap();
    let interface = Interface { guid: guid.into(), description };
    std::fs::write(directory.path().join(INTERFACE_FILE), serde_json::to_vec(&interface).unwrap()).unwrap();
    directory
}

fn toy() -> Instance {
    toy_with_guid(GUID)
}

fn toy_with_guid(guid: &str) -> Instance {
    toy_for(guid, true)
}

fn toy_for(guid: &str, co_simulation: bool) -> Instance {
    let resources = resources_with(guid);
    let location = format!("file://{}", resources.path().display());
    let request = Request { co_simulation, guid, location: Some(&location), logging: true };
    Instance::new(toy_functions(), &request).unwrap()
}

fn integrated() -> Instance {
    toy_for(GUID, false)
}

fn running() -> Instance {
    let instance = toy();
    assert_eq!(instance.initialize(0.0), OK);
    instance
}

fn last_message(instance: &Instance) -> String {
    instance.messages().last().unwrap().2.clone()
}

/// A fresh instance in that state: i instantiated, n initialization, s step, e event, c continuous, t terminated, f
/// failed.
fn in_phase(phase: char, instance: Instance) -> Instance {
    let start = || assert_eq!(instance.initialize(0.0), OK);
    match phase {
        'i' => {}
        'n' => assert_eq!(instance.enter(), OK),
        's' | 'e' => start(),
        'c' => {
            start();
            assert_eq!(instance.call(|_, c| unsafe { exchange_functions::fmi2EnterContinuousTimeMode(c) }), OK);
        }
        't' => {
            start();
            assert_eq!(instance.terminate(), OK);
        }
        _ => {
            start();
            assert_eq!(instance.set_reals(&[U], &[13.0]), OK);
            instance.step(0.0, 1.0);
            derivatives(&instance, 1);
        }
    }
    instance
}

fn derivatives(instance: &Instance, count: usize) -> u32 {
    instance.call(|_, c| unsafe { exchange_functions::fmi2GetDerivatives(c, [f64::NAN; 3].as_mut_ptr(), count) })
}

type Action = fn(&Instance) -> u32;

/// Which states of a slave, and which of what is integrated, allow the call.
const TABLE: [(&str, &str, &str, Action); 45] = [
    ("set debug logging", "instf", "inectf", |i| i.call(|f, c| unsafe { (f.set_debug_logging)(c, 1, 0, null()) })),
    ("setup experiment", "i", "i", |i| i.setup(0.0)),
    ("enter initialization", "i", "i", |i| i.enter()),
    ("exit initialization", "n", "n", |i| i.exit()),
    ("terminate", "s", "ec", |i| i.terminate()),
    ("reset", "instf", "inectf", |i| i.reset()),
    ("get real", "instf", "inectf", |i| i.reals(&[Y]).err().unwrap_or(OK)),
    ("get integer", "instf", "inectf", |i| i.integer(COUNT).err().unwrap_or(OK)),
    ("get boolean", "instf", "inectf", |i| i.boolean(FLAG).err().unwrap_or(OK)),
    ("get string", "instf", "inectf", |i| i.text(NOTE).err().unwrap_or(OK)),
    ("set real input", "ins", "inec", |i| i.set_reals(&[U], &[1.0])),
    ("set real parameter", "in", "in", |i| i.set_reals(&[GAIN], &[1.0])),
    ("set integer parameter", "in", "in", |i| i.set_integer(COUNT, 5)),
    ("set boolean parameter", "in", "in", |i| i.set_boolean(FLAG, 0)),
    ("set string parameter", "in", "in", |i| i.set_text(NOTE, "x")),
    ("set an output", "", "", |i| i.set_reals(&[Y], &[1.0])),
    ("get state", "instf", "inectf", |i| i.save().map(|mut state| i.free(&mut state)).unwrap_or_else(|status| status)),
    ("set state", "instf", "inectf", |i| {
        let mut state = i.save().unwrap();
        i.restore(state).max(i.free(&mut state))
    }),
    ("serialise", "instf", "inectf", |i| {
        let mut state = i.save().unwrap();
        i.pack(state).err().unwrap_or(OK).max(i.free(&mut state))
    }),
    ("deserialise", "instf", "inectf", |i| {
        let mut state = i.save().unwrap();
        let mut copy = i.unpack(&i.pack(state).unwrap()).unwrap();
        i.free(&mut state).max(i.free(&mut copy))
    }),
    ("directional derivative", "", "", |i| {
        i.call(|f, c| unsafe { (f.directional_derivative)(c, null(), 0, null(), 0, null(), null_mut()) })
    }),
    ("no input derivatives", "ins", "in", |i| {
        i.call(|f, c| unsafe { (f.input_derivatives)(c, null(), 0, null(), null()) })
    }),
    ("an input derivative", "", "", |i| i.call(|f, c| unsafe { (f.input_derivatives)(c, &U, 1, &1, &0.0) })),
    ("no output derivatives", "st", "t", |i| {
        i.call(|f, c| unsafe { (f.output_derivatives)(c, null(), 0, null(), null_mut()) })
    }),
    ("an output derivative", "", "", |i| i.call(|f, c| unsafe { (f.output_derivatives)(c, &Y, 1, &1, &mut 0.0) })),
    ("do step", "s", "", |i| i.step(0.0, 1.0)),
    ("cancel step", "", "", |i| i.call(|f, c| unsafe { (f.cancel_step)(c) })),
    ("status of the step", "stf", "tf", |i| i.call(|f, c| unsafe { (f.get_status)(c, 0, &mut 0) })),
    ("last successful time", "stf", "tf", |i| i.call(|f, c| unsafe { (f.get_real_status)(c, 2, &mut 0.0) })),
    ("an integer status", "", "", |i| i.call(|f, c| unsafe { (f.get_integer_status)(c, 0, &mut 0) })),
    ("terminated", "stf", "tf", |i| i.call(|f, c| unsafe { (f.get_boolean_status)(c, 3, &mut 0) })),
    ("pending status", "stf", "tf", |i| i.call(|f, c| unsafe { (f.get_string_status)(c, 1, &mut null()) })),
    ("an unknown status", "", "", |i| i.call(|f, c| unsafe { (f.get_status)(c, 9, &mut 0) })),
    ("set a discrete input", "ins", "ine", |i| i.set_reals(&[MARK], &[1.0])),
    ("enter event mode", "", "ec", |i| i.call(|_, c| unsafe { exchange_functions::fmi2EnterEventMode(c) })),
    ("new discrete states", "", "e", |i| {
        i.call(|_, c| unsafe { exchange_functions::fmi2NewDiscreteStates(c, &mut EventInfo::default()) })
    }),
    ("enter continuous-time mode", "", "e", |i| {
        i.call(|_, c| unsafe { exchange_functions::fmi2EnterContinuousTimeMode(c) })
    }),
    ("completed integrator step", "", "c", |i| {
        i.call(|_, c| unsafe { exchange_functions::fmi2CompletedIntegratorStep(c, 1, &mut 0, &mut 0) })
    }),
    ("set time", "", "ec", |i| i.call(|_, c| unsafe { exchange_functions::fmi2SetTime(c, 0.5) })),
    ("set states", "", "c", |i| i.call(|_, c| unsafe { exchange_functions::fmi2SetContinuousStates(c, &0.5, 1) })),
    ("get derivatives", "", "nect", |i| derivatives(i, 1)),
    ("no event indicators", "", "ectf", |i| {
        i.call(|_, c| unsafe { exchange_functions::fmi2GetEventIndicators(c, null_mut(), 0) })
    }),
    ("an event indicator", "", "", |i| {
        i.call(|_, c| unsafe { exchange_functions::fmi2GetEventIndicators(c, &mut 0.0, 1) })
    }),
    ("get states", "", "nectf", |i| {
        i.call(|_, c| unsafe { exchange_functions::fmi2GetContinuousStates(c, &mut 0.0, 1) })
    }),
    ("get nominals", "", "nectf", |i| {
        i.call(|_, c| unsafe { exchange_functions::fmi2GetNominalsOfContinuousStates(c, &mut 0.0, 1) })
    }),
];

#[test]
fn every_call_is_allowed_where_the_standard_says_and_nowhere_else() {
    for (name, slave, exchange, action) in TABLE {
        for (phases, allowed, make) in [("instf", slave, toy as fn() -> Instance), ("inectf", exchange, integrated)] {
            for phase in phases.chars() {
                let instance = in_phase(phase, make());
                let expected = if allowed.contains(phase) { OK } else { ERROR };
                assert_eq!(action(&instance), expected, "{name} in {phase} of {phases}: {:?}", instance.messages());
            }
        }
    }
}

#[test]
fn what_is_integrated_shows_time_states_and_events() {
    let instance = integrated();
    assert_eq!(instance.initialize(2.5).max(instance.set_reals(&[U], &[3.0])), OK);
    let mut info = EventInfo::default();
    assert_eq!(instance.call(|_, c| unsafe { exchange_functions::fmi2NewDiscreteStates(c, &mut info) }), OK);
    assert_eq!((info.next_event_time_defined, info.next_event_time), (1, 3.0));
    let (mut x, mut slope) = (0.0, 0.0);
    let statuses = instance.call(|_, c| unsafe {
        [
            exchange_functions::fmi2EnterContinuousTimeMode(c),
            exchange_functions::fmi2SetTime(c, 2.75),
            exchange_functions::fmi2GetContinuousStates(c, &mut x, 1),
            exchange_functions::fmi2GetDerivatives(c, &mut slope, 1),
            exchange_functions::fmi2SetContinuousStates(c, &7.0, 1),
        ]
    });
    assert_eq!((statuses, x, slope, instance.reals(&[Y])), ([OK; 5], 2.5, 6.0, Ok(vec![7.0])));
    assert_eq!(instance.call(|_, c| unsafe { exchange_functions::fmi2SetContinuousStates(c, &f64::NAN, 1) }), ERROR);
    assert!(last_message(&instance).contains("state 1 is NaN"), "{:?}", instance.messages());
    assert_eq!(derivatives(&instance, 2), ERROR);
    assert!(last_message(&instance).contains("2 values for 1"), "{:?}", instance.messages());
    assert_eq!(instance.reals(&[Y]), Ok(vec![7.0]));
}

#[test]
fn a_state_of_one_kind_is_refused_by_the_other() {
    let (slave, exchange) = (running(), integrated());
    let mut state = slave.save().unwrap();
    assert_eq!(exchange.unpack(&slave.pack(state).unwrap()), Err(ERROR));
    assert!(last_message(&exchange).contains("model exchange"), "{:?}", exchange.messages());
    assert_eq!(slave.free(&mut state), OK);
}

#[test]
fn a_refused_call_says_why_and_changes_nothing() {
    let instance = running();
    assert_eq!(instance.set_reals(&[U, GAIN], &[5.0, 9.0]), ERROR);
    assert!(last_message(&instance).contains("gain is a fixed parameter"), "{:?}", instance.messages());
    assert_eq!(instance.reals(&[U, GAIN]), Ok(vec![0.0, 2.0]));
    assert_eq!(instance.step(f64::NAN, 1.0), ERROR);
    assert_eq!(instance.step(0.0, -1.0), ERROR);
    assert_eq!(instance.reals(&[99]), Err(ERROR));
    assert!(last_message(&instance).contains("99 is unknown"));
    assert_eq!(instance.integer(Y), Err(ERROR));
    assert!(last_message(&instance).contains("y is of type Real"));
    assert_eq!(instance.step(0.0, 1.0), OK);
}

#[test]
fn a_refused_parameter_can_be_mended() {
    let instance = toy();
    assert_eq!(instance.enter().max(instance.set_reals(&[GAIN], &[7.0])), OK);
    assert_eq!(instance.exit(), ERROR);
    let text = last_message(&instance);
    assert!(text.starts_with("gain = 7 brings bad luck: take 8, 100 % safer. Not initialised"), "{text}");
    assert!(text.contains("fmi2Reset"), "{text}");
    assert_eq!(instance.set_reals(&[GAIN], &[101.0]).max(instance.exit()), ERROR);
    assert!(last_message(&instance).contains("100 or less"), "{:?}", instance.messages());
    assert_eq!(instance.set_reals(&[GAIN], &[f64::NAN]).max(instance.exit()), ERROR);
    assert_eq!(instance.set_reals(&[GAIN], &[3.0]).max(instance.exit()), OK);
    assert_eq!(instance.set_reals(&[U], &[2.0]).max(instance.step(0.0, 1.0)), OK);
    assert_eq!(instance.reals(&[Y]), Ok(vec![6.0]));
}

#[test]
fn outputs_fit_the_parameters_before_the_first_step() {
    let instance = toy();
    assert_eq!(instance.setup(4.5).max(instance.enter()), OK);
    assert_eq!(instance.reals(&[Y]), Ok(vec![4.5]));
}

#[test]
fn a_panic_is_a_status_and_reset_heals() {
    let (instance, other) = (running(), running());
    assert_eq!(instance.set_reals(&[U], &[13.0]), OK);
    assert_eq!(instance.step(0.0, 1.0), ERROR);
    assert!(last_message(&instance).contains("thirteen"));
    assert_eq!(instance.step(0.0, 1.0), ERROR);
    assert_eq!(other.step(0.0, 1.0), OK);
    assert_eq!(instance.reset().max(instance.initialize(0.0)).max(instance.step(0.0, 1.0)), OK);
}

#[test]
fn recurring_warnings_do_not_flood() {
    let instance = running();
    assert_eq!(instance.set_reals(&[U], &[f64::NAN]), OK);
    for step in 0..1000 {
        assert_eq!(instance.step(f64::from(step), 1.0), OK);
    }
    let warnings: Vec<_> = instance.messages().into_iter().filter(|(status, ..)| *status == 1).collect();
    assert_eq!(warnings.len(), 4, "{warnings:?}");
    assert_eq!(warnings[0].1, "logStatusWarning");
    assert!(warnings[3].2.contains("1000 times"));
}

fn said_after(on: i32, category: &std::ffi::CStr) -> [usize; 2] {
    let instance = running();
    let category = category.as_ptr();
    assert_eq!(instance.call(|f, c| unsafe { (f.set_debug_logging)(c, on, 1, &category) }), OK);
    assert_eq!(instance.reals(&[99]), Err(ERROR));
    assert_eq!(instance.set_reals(&[U], &[f64::NAN]).max(instance.step(0.0, 1.0)), OK);
    let messages = instance.messages();
    ["logStatusError", "logStatusWarning"].map(|name| messages.iter().filter(|(_, said, _)| said == name).count())
}

#[test]
fn categories_filter() {
    assert_eq!(said_after(0, c"logStatusError"), [0, 1]);
    assert_eq!(said_after(1, c"logStatusError"), [1, 0]);
    assert_eq!(said_after(1, c"logEvents"), [0, 0]);
    assert_eq!(said_after(0, c"logAll"), [1, 1]);
    assert_eq!(said_after(1, c"logAll"), [1, 1]);
}

#[test]
fn a_step_beyond_the_stop_time_is_refused() {
    let instance = toy();
    assert_eq!(instance.setup_until(1.0, 0.5), ERROR);
    assert!(last_message(&instance).contains("stop time 0.5 s"), "{:?}", instance.messages());
    assert_eq!(instance.setup_until(0.0, 1.0).max(instance.enter()).max(instance.exit()), OK);
    let mut t = 0.0;
    for _ in 0..10 {
        assert_eq!(instance.step(t, 0.1), OK);
        t += 0.1;
    }
    assert_eq!(instance.step(t, 0.0), OK);
    assert_eq!(instance.step(t, 0.1), ERROR);
    let text = last_message(&instance);
    assert!(text.contains("t = 1 s over h = 0.1 s") && text.contains("stop time 1 s"), "{text}");
}

#[test]
fn reset_says_which_parameters_are_at_their_defaults_again() {
    let instance = toy();
    assert_eq!(instance.reset(), OK);
    assert!(instance.messages().is_empty());
    assert_eq!(instance.set_reals(&[GAIN], &[3.0]).max(instance.set_text(NOTE, "x")).max(instance.reset()), OK);
    let text = last_message(&instance);
    assert!(text.contains("gain, note") && !text.contains("count"), "{text}");
}

#[test]
fn changed_and_truncated_bytes_are_refused() {
    let instance = running();
    let mut state = instance.save().unwrap();
    let bytes = instance.pack(state).unwrap();
    for bit in 0..8 * bytes.len() {
        let mut changed = bytes.clone();
        changed[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(instance.unpack(&changed), Err(ERROR), "bit {bit}");
    }
    for length in 0..bytes.len() {
        assert_eq!(instance.unpack(&bytes[..length]), Err(ERROR), "{length} bytes");
    }
    assert!(last_message(&instance).contains("checksum"), "{:?}", instance.messages());
    assert_eq!(instance.pack_into(state, 3), ERROR);
    assert!(last_message(&instance).contains("fmi2SerializedFMUstateSize"), "{:?}", instance.messages());
    assert_eq!(instance.free(&mut state), OK);
    assert_eq!(instance.step(0.0, 1.0), OK);
}

#[test]
fn a_state_of_another_fmu_is_refused() {
    let instance = running();
    let other = toy_with_guid("another-guid");
    assert_eq!(other.initialize(0.0), OK);
    let mut state = other.save().unwrap();
    assert_eq!(instance.unpack(&other.pack(state).unwrap()), Err(ERROR));
    assert!(last_message(&instance).contains("another-guid"), "{:?}", instance.messages());
    assert_eq!(other.free(&mut state), OK);
}

#[test]
fn a_freed_or_foreign_handle_is_refused() {
    let (instance, other) = (running(), running());
    let (mut state, mut foreign) = (instance.save().unwrap(), other.save().unwrap());
    let kept = state;
    assert_eq!(instance.free(&mut state), OK);
    assert_eq!(state, Saved::NULL);
    assert_eq!(instance.free(&mut state), OK);
    let on_the_stack = Saved::at((&raw const state).addr());
    for handle in [kept, foreign, on_the_stack, Saved::NULL, Saved::at(8), Saved::at(usize::MAX)] {
        assert_eq!(instance.restore(handle), ERROR);
        assert_eq!(instance.pack(handle), Err(ERROR));
        assert_eq!(instance.pack_into(handle, 1000), ERROR);
    }
    assert!(last_message(&instance).contains("none that this instance holds"), "{:?}", instance.messages());
    for mut handle in [kept, foreign, on_the_stack] {
        assert_eq!(instance.free(&mut handle), ERROR);
    }
    let mut rubbish = Saved::at(0xdead_beef);
    assert_eq!(instance.save_into(&mut rubbish).max(instance.restore(rubbish)).max(instance.free(&mut rubbish)), OK);
    assert_eq!(other.restore(foreign).max(other.free(&mut foreign)), OK);
}

#[test]
fn a_held_state_is_overwritten() {
    let instance = running();
    let mut state = instance.save().unwrap();
    let (held, bytes) = (state, instance.pack(state).unwrap());
    assert_eq!(instance.set_reals(&[U], &[3.0]).max(instance.step(0.0, 1.0)), OK);
    assert_eq!(instance.save_into(&mut state), OK);
    assert_eq!(state, held);
    assert_ne!(instance.pack(state).unwrap(), bytes);
    assert_eq!(instance.step(1.0, 1.0).max(instance.restore(state)), OK);
    assert_eq!(instance.reals(&[Y]), Ok(vec![6.0]));
    assert_eq!(instance.free(&mut state), OK);
}

#[test]
fn null_pointers_are_refused() {
    let instance = running();
    assert_eq!(instance.call(|f, c| unsafe { (f.get_real)(c, null(), 1, null_mut()) }), ERROR);
    assert_eq!(instance.call(|f, c| unsafe { (f.set_string)(c, &NOTE, 1, &null()) }), ERROR);
    assert_eq!(instance.call(|f, _| unsafe { (f.do_step)(null_mut(), 0.0, 1.0, 1) }), ERROR);
    instance.call(|f, _| unsafe { (f.free_instance)(null_mut()) });
    assert_eq!(instance.call(|f, c| unsafe { (f.get_real)(c, null(), 0, null_mut()) }), OK);
}

#[test]
fn an_instance_that_cannot_be_says_why() {
    let resources = resources_for(GUID, false);
    let location = format!("file://{}/", resources.path().display());
    let good = Request { co_simulation: true, guid: GUID, location: Some(&location), logging: false };
    assert!(Instance::new(toy_functions(), &Request { guid: "{the-guid}", ..good.clone() }).is_ok());
    for (request, named) in [
        (Request { guid: "another", ..good.clone() }, "another"),
        (Request { location: None, ..good.clone() }, "NULL"),
        (Request { location: Some("file:///nowhere/100%25"), ..good.clone() }, "/nowhere/100%"),
        (Request { co_simulation: false, ..good.clone() }, "co-simulation only"),
    ] {
        let messages = Instance::new(toy_functions(), &request).err().unwrap();
        let (status, category, text) = &messages[0];
        assert_eq!((*status, category.as_str()), (ERROR, "logStatusError"));
        assert!(text.contains(named), "{text}");
    }
    std::fs::write(resources.path().join(INTERFACE_FILE), "{").unwrap();
    assert!(Instance::new(toy_functions(), &good).err().unwrap()[0].2.contains("line 1"));
}
