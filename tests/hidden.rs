//! Plants with effects that are not among the terms of their law.

use switchid::law::{Effect, Expression, Term};
use switchid::simulate::{Excitation, ExcitationKind, Hidden, Plant, Scenario, ScenarioError, Stage, record};

const DUFFING: [Term; 4] = [Term::Inertia, Term::power(0, 1), Term::power(1, 0), Term::power(3, 0)];

const EVERY_KIND: &str = r#"
    coulomb_friction = 0.3
    cubic_damping = 1
    dead_zone_stiffness = { coefficient = 2.0, gap = 0.1 }
    hysteresis = { coefficient = 1.5, yield_displacement = 0.2, share = 0.6, exponent = 2.0 }
    excitation_delay = { coefficient = 1.0, delay = 0.0137 }
    hidden_resonator = { coefficient = 0.2, frequency = 9.0, damping_ratio = 0.05 }
    tip_drag = { coefficient = 0.2, v = 0.1, expression = "abs(qd/v)^0.5*qd*sin(t)" }
"#;

fn scenario(hidden: &str, kind: ExcitationKind) -> Scenario {
    let stage = |start, k3| Stage { start, coefficients: vec![1.0, 0.3, 4.0, k3], amplitude: 2.0, omega: 1.5 };
    let mut scenario = Scenario::new("hidden", DUFFING.to_vec(), vec![stage(0.0, 2.0), stage(1.2345, 0.5)], 3.0);
    scenario.seed = 5;
    scenario.excitation = Excitation { kind, rms: 2.0, period: 1.0, ..Excitation::default() };
    scenario.hidden = Hidden::from_table(&toml::from_str(hidden).unwrap()).unwrap();
    scenario
}

fn end(scenario: &Scenario, times: impl IntoIterator<Item = f64>) -> Plant {
    let mut plant = Plant::new(scenario.clone()).unwrap();
    times.into_iter().for_each(|t| plant.advance_to(t).unwrap());
    plant
}

#[test]
fn the_communication_steps_leave_no_trace() {
    for kind in [ExcitationKind::Multisine, ExcitationKind::Sweep, ExcitationKind::WhiteNoise] {
        let scenario = scenario(EVERY_KIND, kind);
        let direct = end(&scenario, [1.5]);
        let fine = end(&scenario, (1..=3301).map(|n| 1.5 * f64::from(n) / 3301.0));
        assert_eq!(direct, fine, "{kind:?}");
    }
}

#[test]
fn a_hidden_term_moves_as_one_of_the_law_does() {
    let hidden =
        scenario("quadratic_stiffness = 0.7\none_sided_stop = { coefficient = 3.0, gap = 0.05 }", ExcitationKind::Sine);
    let stop = Effect::prototype("one_sided_stop").unwrap().with_inner(&[0.05]).unwrap();
    let mut open = scenario("", ExcitationKind::Sine);
    open.terms.extend([Term::power(2, 0), Term::Effect(stop)]);
    open.stages.iter_mut().for_each(|stage| stage.coefficients.extend([0.7, 3.0]));
    assert_eq!(record(&hidden).unwrap(), record(&open).unwrap());
    assert_ne!(record(&hidden).unwrap(), record(&scenario("", ExcitationKind::Sine)).unwrap());
}

#[test]
fn every_effect_of_the_catalogue_can_be_hidden_and_is_felt() {
    let plain = end(&scenario("", ExcitationKind::Multisine), [2.0]).truth().state;
    for entry in switchid::law::Catalogue::ENTRIES {
        let mut hidden = scenario("", ExcitationKind::Multisine);
        hidden.hidden.push(entry.term, 0.2);
        let state = end(&hidden, [2.0]).truth().state;
        assert!(state.is_finite() && (state.q - plain.q).abs() > 1e-5, "{}: {state:?}", entry.id);
    }
}

#[test]
fn a_pure_delay_shifts_the_motion() {
    let delayed = scenario("excitation_delay = { coefficient = 1.0, delay = 0.25 }", ExcitationKind::Multisine);
    let plain = scenario("", ExcitationKind::Multisine);
    let state_at = |mut scenario: Scenario, t: f64| {
        scenario.stages.truncate(1);
        (scenario.excitation.from, scenario.excitation.to, scenario.excitation.count) = (1.0, 1.0, 1);
        end(&scenario, [t]).truth().state
    };
    let (late, early) = (state_at(delayed, 60.0), state_at(plain, 59.75));
    assert!((late.q - early.q).abs() < 2e-3 && (late.qd - early.qd).abs() < 2e-3, "{late:?} {early:?}");
}

#[test]
fn hidden_effects_survive_being_written() {
    let scenario = scenario(EVERY_KIND, ExcitationKind::Sweep);
    let text = scenario.to_toml().unwrap();
    assert_eq!(Scenario::from_toml(&text).unwrap(), scenario, "{text}");
    let mut plant = end(&scenario, [0.7123]);
    let mut restored: Plant = postcard::from_bytes(&postcard::to_stdvec(&plant).unwrap()).unwrap();
    let mut read: Plant = serde_json::from_str(&serde_json::to_string(&plant).unwrap()).unwrap();
    for plant in [&mut plant, &mut restored, &mut read] {
        plant.advance_to(1.4).unwrap();
    }
    assert_eq!((&restored, &read), (&plant, &plant));
}

#[test]
fn what_cannot_be_hidden_is_refused_by_name() {
    for (hidden, named) in [
        ("coulomb_friction = \"fit\"", "\"coulomb_friction\": coefficient is not given"),
        ("one_sided_stop = 2.0", "\"one_sided_stop\": gap is not given"),
        ("one_sided_stop = { coefficient = 2.0, gap = -1.0 }", "gap = -1"),
        ("one_sided_stop = { coefficient = 2.0, hole = 1.0 }", "\"hole\""),
        ("drag = { coefficient = 2.0, expression = \"q*+\" }", "position 4"),
        ("drag = { coefficient = 2.0, expression = \"a*q\" }", "\"drag\": a is not given"),
        ("friction = 1.0", "unknown term \"friction\""),
    ] {
        let error = Hidden::from_table(&toml::from_str(hidden).unwrap()).unwrap_err().to_string();
        assert!(error.contains(named), "{hidden}: {error}");
    }
    let mut many = scenario("", ExcitationKind::None);
    (1..6).for_each(|n| {
        let resonator = Effect::prototype("hidden_resonator").unwrap().with_inner(&[f64::from(n), 0.1]).unwrap();
        many.hidden.push(Term::Effect(resonator), 0.1);
    });
    assert!(matches!(Plant::new(many), Err(ScenarioError::Dynamics(_))));
    let mut wild = scenario("", ExcitationKind::None);
    wild.hidden.push_expression(Expression::parse("x", "q").unwrap(), f64::NAN);
    assert!(matches!(Plant::new(wild), Err(ScenarioError::StageNumber { .. })));
    let mut fast = scenario("", ExcitationKind::Multisine);
    fast.excitation.count = 0;
    assert!(matches!(Plant::new(fast), Err(ScenarioError::OutOfRange { name: "excitation.count", .. })));
}
