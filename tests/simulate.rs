//! Plants: what they show depends on time and seed alone, switches fall where the scenario says, noise has its
//! variance.

use switchid::law::{Motion, State, Term};
use switchid::simulate::{
    Builtin, Excitation, ExcitationKind, Plant, PlantError, Scenario, ScenarioError, SimulateError, Stage, record,
};

const DUFFING: [Term; 4] = [Term::Inertia, Term::power(0, 1), Term::power(1, 0), Term::power(3, 0)];

fn stage(start: f64, coefficients: [f64; 4]) -> Stage {
    Stage { start, coefficients: coefficients.to_vec(), amplitude: 2.0 + start, omega: 1.5 + start }
}

/// Two switches, neither on a grid point.
fn switching(kind: ExcitationKind) -> Scenario {
    let stages = vec![
        stage(0.0, [1.0, 0.3, 4.0, 2.0]),
        stage(0.31234567, [1.4, 0.1, 6.0, 1.0]),
        stage(0.31299, [0.8, 0.6, 2.5, 3.0]),
    ];
    let mut scenario = Scenario::new("switching", DUFFING.to_vec(), stages, 1.0).with_noise(0.01).with_seed(3);
    scenario.initial = State { q: 0.4, qd: -0.2 };
    scenario.excitation.kind = kind;
    scenario
}

fn plant_at(scenario: &Scenario, times: impl IntoIterator<Item = f64>) -> Plant {
    let mut plant = Plant::new(scenario.clone()).unwrap();
    times.into_iter().for_each(|t| plant.advance_to(t).unwrap());
    plant
}

#[test]
fn the_communication_steps_leave_no_trace() {
    for kind in [ExcitationKind::None, ExcitationKind::Sine, ExcitationKind::WhiteNoise] {
        let scenario = switching(kind);
        for end in [0.7, 0.70037, 0.31234567, 0.31264] {
            let direct = plant_at(&scenario, [end]);
            let fine = plant_at(&scenario, (1..=9973).map(|n| end * f64::from(n) / 9973.0));
            let coarse = plant_at(&scenario, [0.1 * end, 0.111, 0.31234567_f64.min(end), end]);
            assert_eq!(direct, fine, "{kind:?} at {end}");
            assert_eq!(direct, coarse, "{kind:?} at {end}");
            assert_eq!(direct.reading(), fine.reading());
        }
    }
}

#[test]
fn time_stamps_that_jitter_in_their_last_bits_give_the_same_readings() {
    let scenario = switching(ExcitationKind::WhiteNoise);
    let mut jittered = Plant::new(scenario.clone()).unwrap();
    let mut t = 0.0;
    for (index, expected) in record(&scenario).unwrap().iter().enumerate() {
        jittered.advance_to(t).unwrap();
        let reading = jittered.reading();
        assert!((reading.q - expected.q).abs() < 1e-12 && (reading.qd - expected.qd).abs() < 1e-12, "sample {index}");
        assert_eq!(reading.excitation, expected.excitation);
        t += 1e-3;
    }
}

#[test]
fn a_switch_between_two_samples_happens_at_its_instant() {
    let scenario = Scenario { inner_step: 1e-3, ..switching(ExcitationKind::Sine) };
    let before = plant_at(&scenario, [0.312]);
    let held = before.reading().excitation;
    let motion = |stage: usize| Motion::new(&DUFFING, &scenario.stages[stage].coefficients);
    let first = motion(0).step_held(before.truth().state, 0.31234567 - 0.312, held);
    let second = motion(1).step_held(first, 0.31299 - 0.31234567, held);
    let expected = motion(2).step_held(second, 0.313 - 0.31299, held);
    let after = plant_at(&scenario, [0.313]);
    let state = after.truth().state;
    assert!((state.q - expected.q).abs() < 1e-15 && (state.qd - expected.qd).abs() < 1e-15);
    let stages: Vec<usize> =
        [0.312, 0.3123456, 0.31234567, 0.31299, 0.313].map(|t| plant_at(&scenario, [t]).truth().stage).to_vec();
    assert_eq!(stages, [0, 0, 1, 2, 2]);
    assert_eq!(after.reading().excitation, scenario.stages[2].amplitude * (scenario.stages[2].omega * 0.313).sin());
}

#[test]
fn a_switch_on_a_grid_point_switches_the_excitation_with_the_law() {
    for start in [0.003, 0.3, 0.7, 12.345] {
        let mut scenario = switching(ExcitationKind::Sine);
        scenario.stages.truncate(1);
        scenario.stages.push(stage(start, [1.0, 0.2, 3.0, 1.0]));
        let index = (start / 1e-3_f64).round();
        let plant = plant_at(&scenario, [index * 1e-3]);
        assert_eq!(plant.truth().stage, 1, "start {start}");
        let expected = scenario.stages[1].amplitude * (scenario.stages[1].omega * (index * 1e-3)).sin();
        assert_eq!(plant.reading().excitation, expected);
    }
}

#[test]
fn the_inner_integration_converges_with_order_four() {
    let end = |inner_step: f64| {
        let mut scenario = Scenario { inner_step, noise: Default::default(), ..switching(ExcitationKind::Sine) };
        scenario.excitation.sample_time = 0.1;
        plant_at(&scenario, [0.9]).truth().state
    };
    let exact = end(1e-4);
    let error = |step: f64| (end(step).q - exact.q).abs() + (end(step).qd - exact.qd).abs();
    for step in [0.1, 0.05, 0.025] {
        let order = (error(step) / error(0.5 * step)).log2();
        assert!((3.5..5.0).contains(&order), "order {order} at {step}");
    }
}

#[test]
fn the_default_inner_step_is_exact_to_rounding() {
    let coarse = Builtin::DuffingSine.scenario();
    let fine = Scenario { inner_step: 1e-4, ..coarse.clone() };
    let (coarse, fine) = (plant_at(&coarse, [60.0]).truth().state, plant_at(&fine, [60.0]).truth().state);
    assert!((coarse.q - fine.q).abs() < 1e-11 && (coarse.qd - fine.qd).abs() < 1e-11);
}

#[test]
fn white_noise_has_the_variance_of_its_intensity_on_any_grid() {
    for sample_time in [1e-3, 4e-3] {
        let mut scenario = Builtin::DuffingWhite.scenario();
        scenario.excitation =
            Excitation { kind: ExcitationKind::WhiteNoise, intensity: 3.0, sample_time, ..Default::default() };
        let forces: Vec<f64> = record(&scenario).unwrap().iter().map(|reading| reading.excitation).collect();
        let count = forces.len() as f64;
        let variance = forces.iter().map(|force| force * force).sum::<f64>() / count;
        let expected = 3.0 / sample_time;
        assert!((variance / expected - 1.0).abs() < 5.0 * (2.0 / count).sqrt(), "{variance} against {expected}");
    }
}

#[test]
fn sensor_noise_has_its_std_and_is_not_in_the_motion() {
    let noisy = record(&Builtin::DuffingNoise.scenario()).unwrap();
    let clean = record(&Builtin::DuffingNoise.scenario().with_noise(0.0)).unwrap();
    let count = noisy.len() as f64;
    let deviations = |value: fn(&switchid::simulate::Reading) -> f64| -> Vec<f64> {
        noisy.iter().zip(&clean).map(|(a, b)| value(a) - value(b)).collect()
    };
    let (q, qd) = (deviations(|reading| reading.q), deviations(|reading| reading.qd));
    for channel in [&q, &qd] {
        let std = (channel.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
        assert!((std / 0.1 - 1.0).abs() < 5.0 / (2.0 * count).sqrt(), "std {std}");
    }
    let correlation = q.iter().zip(&qd).map(|(a, b)| a * b).sum::<f64>() / (0.01 * count);
    assert!(correlation.abs() < 5.0 / count.sqrt(), "q and qd share noise: {correlation}");
}

#[test]
fn the_seed_alone_decides() {
    let of = |builtin: Builtin, seed| record(&builtin.random(seed)).unwrap()[..2000].to_vec();
    for builtin in Builtin::ALL {
        assert_eq!(of(builtin, 5), of(builtin, 5));
        assert_ne!(of(builtin, 5), of(builtin, 6));
    }
}

#[test]
fn every_number_switches_by_a_tenth_in_every_scenario() {
    let many = [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite];
    for builtin in many {
        for scenario in (0..50).map(|seed| builtin.random(seed)).chain([builtin.scenario()]) {
            scenario.check().unwrap();
            assert!(scenario.stages.len() >= 5);
            scenario.stages.windows(2).for_each(|pair| assert_all_change(&pair[0], &pair[1]));
            let starts = scenario.stages.iter().map(|stage| stage.start).chain([scenario.duration]);
            let starts: Vec<f64> = starts.collect();
            assert!(starts.windows(2).all(|pair| (11.9..25.1).contains(&(pair[1] - pair[0]))), "{starts:?}");
        }
    }
}

fn assert_all_change(old: &Stage, new: &Stage) {
    let numbers = |stage: &Stage| [stage.coefficients.as_slice(), &[stage.amplitude, stage.omega]].concat();
    for (old, new) in numbers(old).into_iter().zip(numbers(new)) {
        assert!((new - old).abs() >= 0.1 * old.abs(), "{old} → {new}");
    }
}

#[test]
fn van_der_pol_goes_from_limit_cycle_to_focus_and_back() {
    for scenario in (0..20).map(|seed| Builtin::VanDerPolSine.random(seed)) {
        let signs = scenario.stages.iter().map(|stage| stage.coefficients[1] < 0.0);
        let signs: Vec<bool> = signs.collect();
        assert!(signs.windows(2).all(|pair| pair[0] != pair[1]));
    }
}

#[test]
fn a_plant_and_its_scenario_survive_being_written() {
    let scenario = switching(ExcitationKind::WhiteNoise);
    assert_eq!(Scenario::from_toml(&scenario.to_toml().unwrap()).unwrap(), scenario);
    let mut plant = plant_at(&scenario, [0.3127]);
    let mut restored: Plant = serde_json::from_str(&serde_json::to_string(&plant).unwrap()).unwrap();
    assert_eq!(restored, plant);
    plant.advance_to(0.9).unwrap();
    restored.advance_to(0.9).unwrap();
    assert_eq!(restored, plant);
}

#[test]
fn what_cannot_be_simulated_is_refused_with_its_place() {
    let good = switching(ExcitationKind::Sine);
    let refused = |change: fn(&mut Scenario)| {
        let mut scenario = good.clone();
        change(&mut scenario);
        Plant::new(scenario).unwrap_err()
    };
    assert_eq!(refused(|s| s.stages[1].start = 0.5), ScenarioError::Order { stage: 3, start: 0.31299, previous: 0.5 });
    assert_eq!(refused(|s| s.stages[0].start = 1.0), ScenarioError::FirstStart { start: 1.0 });
    assert_eq!(refused(|s| s.stages.clear()), ScenarioError::NoStages);
    assert_eq!(refused(|s| s.stages[2].coefficients[0] = 0.0), ScenarioError::ZeroInertia { stage: 3 });
    assert_eq!(
        refused(|s| s.stages[1].coefficients.truncate(3)),
        ScenarioError::Count { stage: 2, expected: 4, found: 3 }
    );
    assert_eq!(refused(|s| s.terms[2] = Term::power(0, 1)), ScenarioError::Twice { term: Term::power(0, 1) });
    assert_eq!(refused(|s| s.terms[0] = Term::power(2, 0)), ScenarioError::NoInertia);
    assert!(matches!(
        refused(|s| s.stages[1].coefficients[3] = f64::NAN),
        ScenarioError::StageNumber { stage: 2, name, .. } if name == "q^3"
    ));
    assert!(matches!(refused(|s| s.noise.q = -0.1), ScenarioError::OutOfRange { name: "noise.q", .. }));
    assert!(matches!(refused(|s| s.duration = f64::INFINITY), ScenarioError::OutOfRange { name: "duration", .. }));
    let typo = good.to_toml().unwrap().replace("duration", "durations");
    assert!(Scenario::from_toml(&typo).unwrap_err().to_string().contains("durations"));
}

#[test]
fn a_plant_neither_goes_back_nor_off_to_infinity() {
    let mut plant = plant_at(&switching(ExcitationKind::Sine), [0.5]);
    let before = plant.clone();
    assert_eq!(plant.advance_to(0.4), Err(PlantError::Backwards { t: 0.4, present: 0.5 }));
    assert!(matches!(plant.advance_to(f64::NAN), Err(PlantError::Time { .. })));
    assert_eq!(plant, before);
    let mut runaway = switching(ExcitationKind::None);
    runaway.duration = 50.0;
    runaway.stages.truncate(1);
    runaway.stages[0].coefficients = vec![1.0, 0.0, -4.0, -2.0];
    assert!(matches!(record(&runaway), Err(SimulateError::Plant(PlantError::Diverged { .. }))));
}
