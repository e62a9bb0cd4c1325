//! The plants' library in model exchange, integrated by the test.

#[path = "../../identifier/tests/contract/subject.rs"]
mod subject;

use subject::{OK, Subject};
use switchid::fmu::{DUFFING, plant, plant_of_model};
use switchid::law::Model;
use switchid_fmu_plant::{exchange_functions, functions};
use switchid_fmu_slave::host::{Exchange, Instance, Request};
use switchid_fmu_slave::{Causality, Kind, Variable, linked_exchange_functions, linked_functions};

const INPUT: i32 = 6;

fn subject(law: &str) -> Subject {
    Subject::new(linked_functions!(functions), &plant(law).unwrap())
}

fn exchange(subject: &Subject) -> Result<Instance, Vec<(u32, String, String)>> {
    let location = format!("file:///{}", subject.resources.path().display());
    let guid = &subject.interface.guid;
    Instance::new(subject.functions, &Request { co_simulation: false, guid, location: Some(&location), logging: true })
}

fn set(subject: &Subject, instance: &Instance, values: &[(&str, f64)]) {
    for (name, value) in values {
        assert_eq!(instance.set_reals(&[subject.reference(name)], &[*value]), OK, "{name}: {:?}", instance.messages());
    }
}

/// Every real output.
fn outputs(subject: &Subject, instance: &Instance) -> Vec<f64> {
    let real = |own: &Variable| own.causality == Causality::Output && matches!(own.kind, Kind::Real { .. });
    let variables = subject.interface.description.variables.iter().zip(0..);
    let references: Vec<u32> = variables.filter(|(own, _)| real(own)).map(|(_, reference)| reference).collect();
    instance.reals(&references).unwrap()
}

/// Classical Runge–Kutta in steps of at most `h` from event to event; how many events there were.
fn integrate(instance: &Instance, [start, end]: [f64; 2], h: f64, input: &dyn Fn(f64)) -> u32 {
    let plant = equations(instance);
    let (mut t, mut events) = (start, 0);
    while t < end {
        input(t);
        let next = plant.new_discrete_states().unwrap().map_or(end, |next| next.min(end));
        assert_eq!(plant.enter_continuous_time_mode(), OK);
        let parts = ((next - t) / h).ceil().max(1.0);
        let mut x = plant.states(2).unwrap();
        for part in 0..parts as u32 {
            let dt = (next - t) / parts;
            x = runge_kutta(plant, t + f64::from(part) * dt, dt, &x, input);
        }
        t = next;
        assert_eq!(plant.set_time(t).max(plant.set_states(&x)), OK);
        assert_eq!((plant.completed_integrator_step(), plant.enter_event_mode()), (Ok(false), OK));
        events += 1;
    }
    events
}

fn equations(instance: &Instance) -> Exchange<'_> {
    Exchange { instance, functions: linked_exchange_functions!(exchange_functions) }
}

fn runge_kutta(plant: Exchange, t: f64, dt: f64, x: &[f64], input: &dyn Fn(f64)) -> Vec<f64> {
    let mut slopes = vec![vec![0.0; 2]];
    for share in [0.0, 0.5, 0.5, 1.0] {
        let before = &slopes[slopes.len() - 1];
        let at: Vec<f64> = x.iter().zip(before).map(|(x, slope)| x + share * dt * slope).collect();
        assert_eq!(plant.set_time(t + share * dt).max(plant.set_states(&at)), OK);
        input(t + share * dt);
        slopes.push(plant.derivatives(2).unwrap());
    }
    let mean = |of: usize| (slopes[1][of] + 2.0 * slopes[2][of] + 2.0 * slopes[3][of] + slopes[4][of]) / 6.0;
    x.iter().enumerate().map(|(of, x)| x + dt * mean(of)).collect()
}

#[test]
fn integrated_by_the_host_it_moves_as_in_co_simulation() {
    let subject = subject(DUFFING);
    let (slave, integrated) = (subject.instance(), exchange(&subject).unwrap());
    for instance in [&slave, &integrated] {
        set(&subject, instance, &[("stage[2].time", 0.5005), ("stage[2].k3", 9.0), ("noise.q", 0.01)]);
        assert_eq!(instance.initialize(100.0), OK, "{:?}", instance.messages());
    }
    assert_eq!(outputs(&subject, &slave), outputs(&subject, &integrated));
    assert_eq!(slave.step(100.0, 1.0), OK);
    let events = integrate(&integrated, [100.0, 101.0], 1e-3, &|_| ());
    equations(&integrated).new_discrete_states().unwrap();
    assert_eq!(events, 1001);
    let names = ["q", "qd", "F", "true.coef.q_3", "der(true.q)", "der(true.qd)"].map(|name| subject.reference(name));
    let pairs = slave.reals(&names).unwrap().into_iter().zip(integrated.reals(&names).unwrap());
    pairs.for_each(|(one, other)| assert!((one - other).abs() < 1e-9, "{one} {other}"));
}

#[test]
fn behind_an_input_only_switches_are_events() {
    let subject = subject(DUFFING);
    let integrated = exchange(&subject).unwrap();
    set(&subject, &integrated, &[("stage[2].time", 1.25), ("stage[2].k1", 5.0)]);
    assert_eq!(integrated.set_integer(subject.reference("excitation.kind"), INPUT), OK);
    assert_eq!(integrated.initialize(0.0), OK);
    let force = subject.reference("excitation.F");
    let input = |t: f64| assert_eq!(integrated.set_reals(&[force], &[2.0 * (1.5 * t).sin()]), OK);
    assert_eq!(integrate(&integrated, [0.0, 3.0], 1e-2, &input), 2);
    let end = integrated.reals(&[subject.reference("true.q")]).unwrap()[0];
    // the same law under the same force in fine steps of co-simulation, whose force is held: an order of h apart
    let slave = subject.instance();
    set(&subject, &slave, &[("stage[2].time", 1.25), ("stage[2].k1", 5.0)]);
    assert_eq!(slave.set_integer(subject.reference("excitation.kind"), INPUT), OK);
    assert_eq!(slave.initialize(0.0), OK);
    for step in 0..30_000 {
        let t = f64::from(step) * 1e-4;
        assert_eq!(slave.set_reals(&[force], &[2.0 * (1.5 * (t + 0.5e-4)).sin()]).max(slave.step(t, 1e-4)), OK);
    }
    let held = slave.reals(&[subject.reference("true.q")]).unwrap()[0];
    assert!((end - held).abs() < 1e-7, "{end} {held}");
}

#[test]
fn effects_with_kinks_are_refused_in_a_sentence() {
    let subject = subject(DUFFING);
    let integrated = exchange(&subject).unwrap();
    set(&subject, &integrated, &[("hidden.coulomb_friction", 0.1)]);
    assert_ne!(integrated.initialize(0.0), OK);
    let text = integrated.messages().pop().unwrap().2;
    assert!(text.contains("coulomb") && text.contains("co-simulation"), "{text}");
    let model = Model::from_toml("[terms]\nqdd = 1.0\nq = 4.0\ncoulomb_friction = 0.2\n").unwrap();
    let rough = Subject::new(linked_functions!(functions), &plant_of_model("Rough", &model).unwrap());
    assert!(exchange(&rough).err().unwrap()[0].2.contains("co-simulation only"));
    let model = Model::from_toml("[terms]\nqdd = 1.0\nq = 4.0\n").unwrap();
    let smooth = Subject::new(linked_functions!(functions), &plant_of_model("Smooth", &model).unwrap());
    assert_eq!(exchange(&smooth).unwrap().initialize(0.0), OK);
}

#[test]
fn a_saved_state_goes_on() {
    let subject = subject(DUFFING);
    let integrated = exchange(&subject).unwrap();
    assert_eq!(integrated.initialize(0.0), OK);
    integrate(&integrated, [0.0, 0.1], 1e-3, &|_| ());
    let mut state = integrated.save().unwrap();
    integrate(&integrated, [0.1, 0.2], 1e-3, &|_| ());
    let reference = outputs(&subject, &integrated);
    let other = exchange(&subject).unwrap();
    let mut copy = other.unpack(&integrated.pack(state).unwrap()).unwrap();
    assert_eq!(other.restore(copy), OK);
    integrate(&other, [0.1, 0.2], 1e-3, &|_| ());
    assert_eq!(outputs(&subject, &other), reference);
    assert_eq!(other.free(&mut copy).max(integrated.free(&mut state)), OK);
}
