//! The plants' library through the C interface.

#[path = "../../identifier/tests/contract/mod.rs"]
mod contract;

use contract::{Drive, OK, Subject};
use switchid::fmu::{DUFFING, VAN_DER_POL, plant, plant_of_model};
use switchid::law::{Catalogue, InnerParameter, InnerRange, Model, Term};
use switchid::simulate::{Builtin, Excitation, ExcitationKind, Plant, Scenario};
use switchid_fmu_plant::functions;
use switchid_fmu_slave::host::Instance;
use switchid_fmu_slave::linked_functions;

const WHITE: i32 = 3;

fn subject(law: &str) -> Subject {
    Subject::new(linked_functions!(functions), &plant(law).unwrap())
}

fn set(subject: &Subject, instance: &Instance, values: &[(&str, f64)]) {
    for (name, value) in values {
        assert_eq!(instance.set_reals(&[subject.reference(name)], &[*value]), OK, "{name}");
    }
}

/// Two stages, white excitation, noisy sensors.
fn prepare(subject: &Subject, instance: &Instance) {
    set(subject, instance, &[("stage[2].time", 0.15), ("stage[2].P", 9.0), ("noise.q", 0.1), ("noise.qd", 0.2)]);
    assert_eq!(instance.set_integer(subject.reference("excitation.kind"), WHITE), OK);
    assert_eq!(instance.set_integer(subject.reference("seed"), 5), OK);
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
}

fn real(subject: &Subject, instance: &Instance, name: &str) -> f64 {
    instance.reals(&[subject.reference(name)]).unwrap()[0]
}

#[test]
fn the_contract_holds() {
    for law in [DUFFING, VAN_DER_POL] {
        let subject = subject(law);
        let drive = Drive {
            prepare: &|instance| prepare(&subject, instance),
            step: &|instance, k| assert_eq!(instance.step(f64::from(k) * 1e-3, 1e-3), OK),
            steps: 200,
        };
        contract::check(&subject, &drive);
    }
}

#[test]
fn what_it_shows_does_not_depend_on_the_communication_step() {
    let subject = subject(DUFFING);
    let (fine, coarse) = (subject.instance(), subject.instance());
    prepare(&subject, &fine);
    prepare(&subject, &coarse);
    let mut t = 0.0;
    for _ in 0..300 {
        assert_eq!(fine.step(t, 1e-3).max(fine.step(t + 1e-3, 0.0)), OK);
        t += 1e-3;
    }
    assert_eq!(coarse.step(0.0, 0.3 * (1.0 - 1e-15)), OK);
    assert_eq!(subject.outputs(&fine), subject.outputs(&coarse));
}

/// The built-in scenario through the library and through the FMU.
fn agrees(law: &str, builtin: Builtin, names: [&str; 4], circuit: impl Fn(&[f64]) -> [f64; 4]) {
    let subject = subject(law);
    let instance = subject.instance();
    let scenario: Scenario = builtin.scenario().with_seed(3).with_noise(0.02);
    for (number, stage) in (1..).zip(&scenario.stages) {
        let named = names.into_iter().zip(circuit(&stage.coefficients));
        let all = named.chain([("time", stage.start), ("P", stage.amplitude), ("omega", stage.omega)]);
        for (name, value) in all {
            set(&subject, &instance, &[(&format!("stage[{number}].{name}"), value)]);
        }
    }
    set(&subject, &instance, &[("noise.q", 0.02), ("noise.qd", 0.02), ("q0", 0.5)]);
    let kind = if scenario.excitation.kind == ExcitationKind::Sine { 2 } else { WHITE };
    assert_eq!(instance.set_integer(subject.reference("excitation.kind"), kind), OK);
    assert_eq!(instance.set_integer(subject.reference("seed"), 3), OK);
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    let mut plant = Plant::new(scenario).unwrap();
    for k in 0..60 {
        let t = f64::from(k);
        assert_eq!(instance.step(t, 1.0), OK);
        plant.advance_to(t + 1.0).unwrap();
        let (reading, truth) = (plant.reading(), plant.truth());
        assert_eq!(real(&subject, &instance, "q").to_bits(), reading.q.to_bits(), "t = {t}");
        assert_eq!(real(&subject, &instance, "qd"), reading.qd);
        assert_eq!(real(&subject, &instance, "F"), reading.excitation);
        assert_eq!(real(&subject, &instance, "true.q"), truth.state.q);
        assert_eq!(instance.integer(subject.reference("true.stage")), Ok(truth.stage as i32 + 1));
        assert_eq!(real(&subject, &instance, "true.coef.qdd"), truth.coefficients[0]);
    }
}

#[test]
fn a_schedule_gives_the_library_s_motion() {
    let as_they_are = |c: &[f64]| [c[0], c[1], c[2], c[3]];
    agrees(DUFFING, Builtin::DuffingSine, ["m", "c", "k1", "k3"], as_they_are);
    agrees(DUFFING, Builtin::DuffingWhite, ["m", "c", "k1", "k3"], as_they_are);
}

/// Every effect of the catalogue hidden at once, with inner parameters off their defaults.
#[test]
fn hidden_effects_give_the_library_s_motion() {
    let subject = subject(DUFFING);
    let instance = subject.instance();
    let mut scenario = Builtin::DuffingNoise.scenario().with_seed(7).with_noise(0.0);
    scenario.excitation =
        Excitation { kind: ExcitationKind::Multisine, from: 2.0, to: 9.0, count: 5, rms: 2.5, ..Excitation::default() };
    for (number, entry) in (1..).zip(Catalogue::ENTRIES) {
        let coefficient = 0.02 + 0.01 * f64::from(number);
        set(&subject, &instance, &[(&format!("hidden.{}", entry.id), coefficient)]);
        let Term::Effect(effect) = entry.term else {
            scenario.hidden.push(entry.term, coefficient);
            continue;
        };
        let other = |parameter: &InnerParameter| match parameter.range {
            InnerRange::Either(one, other) => {
                if parameter.default == one {
                    other
                } else {
                    one
                }
            }
            InnerRange::Any => parameter.default + 0.3,
            _ => 1.5 * parameter.default,
        };
        let inner: Vec<f64> = entry.inner().iter().map(other).collect();
        for (parameter, value) in entry.inner().iter().zip(&inner) {
            set(&subject, &instance, &[(&format!("hidden.{}.{}", entry.id, parameter.name), *value)]);
        }
        scenario.hidden.push(Term::Effect(effect.with_inner(&inner).unwrap()), coefficient);
    }
    set(&subject, &instance, &[("excitation.from", 2.0), ("excitation.to", 9.0), ("excitation.rms", 2.5), ("q0", 0.5)]);
    for (name, value) in [("excitation.kind", 4), ("excitation.count", 5), ("seed", 7)] {
        assert_eq!(instance.set_integer(subject.reference(name), value), OK, "{name}");
    }
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    let mut plant = Plant::new(scenario).unwrap();
    for k in 0..20 {
        let t = f64::from(k) * 0.1;
        assert_eq!(instance.step(t, 0.1), OK);
        plant.advance_to(t + 0.1).unwrap();
        assert_eq!(real(&subject, &instance, "q").to_bits(), plant.reading().q.to_bits(), "t = {t}");
        assert_eq!(real(&subject, &instance, "F"), plant.reading().excitation);
    }
}

const INPUT: i32 = 6;

/// A plant whose excitation is an input, started.
fn driven(subject: &Subject, values: &[(&str, f64)]) -> Instance {
    let instance = subject.instance();
    set(subject, &instance, values);
    assert_eq!(instance.set_integer(subject.reference("excitation.kind"), INPUT), OK);
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    instance
}

/// With the sine that drives the one on its grid fed to the other as an input, step by step.
#[test]
fn an_excitation_from_outside_moves_a_plant_as_its_own_does() {
    let subject = subject(DUFFING);
    let values = [("stage[2].time", 0.7503), ("stage[2].k3", 5.0), ("noise.q", 0.01), ("q0", 0.2)];
    let hidden =
        [("hidden.coulomb_friction", 0.2), ("hidden.excitation_delay", 0.5), ("hidden.excitation_delay.delay", 0.0123)];
    for values in [&values[..], &[&values[..], &hidden[..]].concat()] {
        let other = driven(&subject, values);
        let own = subject.instance();
        set(&subject, &own, values);
        assert_eq!(own.initialize(0.0), OK);
        for k in 0..1500 {
            let t = f64::from(k) * 1e-3;
            let force = 2.0 * (1.5 * t).sin();
            assert_eq!(real(&subject, &own, "F"), force);
            set(&subject, &other, &[("excitation.F", force)]);
            assert_eq!(own.step(t, 1e-3).max(other.step(t, 1e-3)), OK, "{:?}", other.messages());
            assert_eq!(real(&subject, &other, "F"), force);
            for name in ["q", "qd", "true.q", "true.coef.q_3"] {
                let (own, other) = (real(&subject, &own, name), real(&subject, &other, name));
                assert!((own - other).abs() < 1e-9, "{name} at t = {t} s: {own}, {other}");
            }
        }
    }
}

#[test]
fn a_driven_plant_holds_the_contract() {
    let subject = subject(VAN_DER_POL);
    let prepare = |instance: &Instance| {
        set(&subject, instance, &[("stage[2].time", 0.15), ("noise.q", 0.1)]);
        assert_eq!(instance.set_integer(subject.reference("excitation.kind"), INPUT), OK);
        assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    };
    let step = |instance: &Instance, k: u32| {
        set(&subject, instance, &[("excitation.F", (0.3 * f64::from(k)).sin())]);
        assert_eq!(instance.step(f64::from(k) * 1e-3, 1e-3), OK);
    };
    contract::check(&subject, &Drive { prepare: &prepare, step: &step, steps: 200 });
}

#[test]
fn a_driven_plant_takes_steps_of_any_length_and_no_force_that_is_none() {
    let subject = subject(DUFFING);
    let (whole, split) = (driven(&subject, &[]), driven(&subject, &[]));
    set(&subject, &whole, &[("excitation.F", 3.0)]);
    set(&subject, &split, &[("excitation.F", 3.0)]);
    assert_eq!(whole.step(0.0, 0.7).max(split.step(0.0, 0.123456).max(split.step(0.123456, 0.576544))), OK);
    assert!((real(&subject, &whole, "q") - real(&subject, &split, "q")).abs() < 1e-9);
    set(&subject, &split, &[("excitation.F", f64::NAN)]);
    assert_eq!(whole.step(0.7, 0.1).max(split.step(0.7, 0.1)), OK);
    assert!((real(&subject, &whole, "q") - real(&subject, &split, "q")).abs() < 1e-9);
    let text = split.messages().last().unwrap().2.clone();
    assert!(text.contains("excitation.F is no finite number at t = 0.7 s"), "{text}");
}

#[test]
fn a_step_that_would_take_too_long_is_refused_and_changes_nothing() {
    let subject = subject(DUFFING);
    let own = subject.instance();
    assert_eq!(own.initialize(0.0), OK);
    for instance in [own, driven(&subject, &[])] {
        assert_ne!(instance.step(0.0, 1e9), OK);
        let text = instance.messages().last().unwrap().2.clone();
        assert!(text.contains("too far for one step") && text.contains("5000 s or less"), "{text}");
        assert_eq!(instance.step(0.0, 1.0), OK);
    }
}

#[test]
fn an_impossible_inner_parameter_is_named() {
    let subject = subject(DUFFING);
    let instance = subject.instance();
    set(&subject, &instance, &[("hidden.stribeck_friction", 0.1), ("hidden.stribeck_friction.speed", 0.0)]);
    assert_ne!(instance.initialize(0.0), OK);
    assert!(instance.messages()[0].2.contains("hidden.stribeck_friction: speed = 0"), "{:?}", instance.messages());
}

#[test]
fn van_der_pol_s_terms_are_products_of_its_circuit() {
    let subject = subject(VAN_DER_POL);
    let instance = subject.instance();
    let circuit = [("L", 1.5), ("alpha", 0.5), ("a", -2.0), ("C", 4.0)];
    for (name, value) in circuit {
        set(&subject, &instance, &[(&format!("stage[1].{name}"), value)]);
    }
    assert_eq!(instance.initialize(0.0), OK);
    let truth = ["qdd", "qd", "q_2_qd", "q"].map(|term| real(&subject, &instance, &format!("true.coef.{term}")));
    assert_eq!(truth, [1.5, 1.0, 0.5, 0.25]);
}

#[test]
fn time_counts_from_the_start() {
    let subject = subject(DUFFING);
    let (early, late) = (subject.instance(), subject.instance());
    assert_eq!(early.initialize(0.0).max(late.initialize(128.0)), OK);
    assert_eq!(early.step(0.0, 0.25).max(late.step(128.0, 0.25)), OK);
    assert_eq!(subject.outputs(&early), subject.outputs(&late));
}

#[test]
fn refused_schedules_are_named() {
    let subject = subject(DUFFING);
    for (name, value, named) in [
        ("stage[1].time", 1.0, "stage 1"),
        ("stage[4].time", 2.0, "stage[3].time"),
        ("stage[1].m", 0.0, "mass"),
        ("excitation.sample_time", 0.0, "excitation.sample_time"),
    ] {
        let instance = subject.instance();
        set(&subject, &instance, &[("stage[2].time", 1.5), (name, value)]);
        assert_ne!(instance.initialize(0.0), OK, "{name}");
        assert!(instance.messages()[0].2.contains(named), "{:?}", instance.messages());
    }
}

#[test]
fn going_back_in_time_is_refused_but_a_saved_state_goes_back() {
    let subject = subject(DUFFING);
    let instance = subject.instance();
    assert_eq!(instance.initialize(0.0), OK);
    let mut state = instance.save().unwrap();
    assert_eq!(instance.step(0.0, 1.0), OK);
    assert_ne!(instance.step(0.2, 0.1), OK);
    assert!(instance.messages().last().unwrap().2.contains("saved state"));
    assert_eq!(instance.restore(state).max(instance.step(0.0, 0.1)).max(instance.free(&mut state)), OK);
}

#[test]
fn missing_resources_are_named() {
    let subject = subject(DUFFING);
    let refusal = subject.refusal_without("plant.toml");
    assert!(refusal.contains("plant.toml"), "{refusal}");
}

#[test]
fn a_formula_acts_as_the_term_that_it_says() {
    let text = |own: &str| format!("[terms]\ninertia = 1.5\nqd = 0.3\nq = 4.0\n{own}\n");
    let own = "tip = { coefficient = 0.7, n = 3 }\n[effects.tip]\nexpression = \"abs(q)^n*sign(q)\"";
    let ends = ["\"q^3\" = 0.7", own].map(|own| {
        let model = Model::from_toml(&text(own)).unwrap();
        let fmu = plant_of_model("Axis", &model).unwrap();
        let subject = Subject::new(linked_functions!(functions), &fmu);
        let instance = subject.instance();
        set(&subject, &instance, &[("stage[1].P", 3.0), ("q0", 0.8)]);
        assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
        (0..2000).for_each(|k| assert_eq!(instance.step(f64::from(k) * 1e-3, 1e-3), OK));
        (real(&subject, &instance, "true.q"), real(&subject, &instance, "true.qd"))
    });
    assert!((ends[0].0 - ends[1].0).abs() < 1e-12 && (ends[0].1 - ends[1].1).abs() < 1e-12, "{ends:?}");
    assert!(ends[0].0.abs() > 1e-3, "{ends:?}");
}

/// A damper whose friction has a Stribeck part.
fn specimen() -> Subject {
    let text = "[terms]\nqd = 3.0\nq = 20.0\nstribeck_friction = { coefficient = 2.0, speed = 0.1 }\n\
                hardening = { coefficient = 5.0, a = 2.0 }\n[effects.hardening]\nexpression = \"sinh(a*q)\"\n";
    let model = Model::from_toml(text).unwrap();
    Subject::new(linked_functions!(functions), &plant_of_model("Damper", &model).unwrap())
}

fn impose(subject: &Subject, instance: &Instance, k: u32) -> [f64; 2] {
    let (sin, cos) = (5e-3 * f64::from(k)).sin_cos();
    let imposed = [0.1 * sin, 0.5 * cos];
    assert_eq!(instance.set_reals(&["q", "qd"].map(|name| subject.reference(name)), &imposed), OK);
    assert_eq!(instance.step(f64::from(k) * 1e-3, 1e-3), OK, "{:?}", instance.messages());
    imposed
}

#[test]
fn a_specimen_holds_the_contract() {
    let subject = specimen();
    let prepare = |instance: &Instance| {
        set(&subject, instance, &[("stage[2].time", 0.15), ("stage[2].q", 30.0), ("noise.F", 0.1)]);
        assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    };
    let step = |instance: &Instance, k: u32| {
        impose(&subject, instance, k);
    };
    contract::check(&subject, &Drive { prepare: &prepare, step: &step, steps: 200 });
}

#[test]
fn a_specimen_answers_what_is_imposed() {
    let subject = specimen();
    let instance = subject.instance();
    set(
        &subject,
        &instance,
        &[("stage[2].time", 0.15), ("stage[2].qd", 6.0), ("noise.F", 0.1), ("hidden.coulomb_friction", 1.0)],
    );
    assert_eq!(instance.initialize(0.0), OK, "{:?}", instance.messages());
    let (mut noise, steps) = (0.0, 300);
    for k in 0..steps {
        let [q, qd] = impose(&subject, &instance, k);
        let damping = if k < 150 { 3.0 } else { 6.0 };
        let friction = qd.signum() * (1.0 + 2.0 * (-qd.abs() / 0.1).exp()) + 5.0 * (2.0 * q).sinh();
        let truth = real(&subject, &instance, "true.F");
        assert!((truth - (damping * qd + 20.0 * q + friction)).abs() < 1e-12, "step {k}: {truth}");
        noise += (real(&subject, &instance, "F") - truth).powi(2);
    }
    let std = (noise / f64::from(steps)).sqrt();
    assert!((std / 0.1 - 1.0).abs() < 0.15, "{std}");
    assert_eq!(instance.integer(subject.reference("true.stage")), Ok(2));
}
