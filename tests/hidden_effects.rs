//! Effects hidden in plants, and what a diagnosis says of their records: a small part of
//! `cargo xtask effects`, under another seed.

#[path = "../measure/effects/benchmark/mod.rs"]
mod benchmark;

use benchmark::{Answer, Outcome, Outside, Secret, Sensors, Setting, draw, judge, pair};
use rayon::prelude::*;
use std::time::{SystemTime, UNIX_EPOCH};
use switchid::diagnose::{Doubt, Posed};
use switchid::identify::Recording;
use switchid::law::{Catalogue, Given, Model, Term};
use switchid::simulate::{Reading, Scenario, record};

const SEED: u64 = 20_417;
const SAMPLES: usize = 2000;

fn setting(secret: Secret, strength: f64, noise: f64, draw: u64) -> Setting {
    Setting { secret, strength, noise, sensors: Sensors::Ideal, switch: 0.0, samples: SAMPLES, seed: SEED, draw }
}

/// The outcomes of problems that their records can show.
fn visible(settings: Vec<Setting>) -> Vec<(Setting, Outcome)> {
    let outcome = |setting: Setting| {
        let problem = draw(&setting).unwrap_or_else(|| panic!("no bounded motion: {setting:?}"));
        let outcome = judge(&setting, &problem);
        let words = format!("{} | {} s of CPU | {}", problem.words, outcome.seconds, outcome.words);
        (setting, Outcome { words, ..outcome })
    };
    settings.into_par_iter().map(outcome).filter(|(_, outcome)| outcome.visible).collect()
}

/// At least that share of outcomes passes, of at least `fewest`.
fn assert_share(outcomes: &[(Setting, Outcome)], fewest: usize, share: f64, passes: impl Fn(&Outcome) -> bool) {
    let missed = || outcomes.iter().filter(|(_, outcome)| !passes(outcome));
    let list: Vec<String> = missed()
        .map(|(setting, outcome)| format!("{setting:?}: {:?}, tie {}: {}", outcome.answer, outcome.tie, outcome.words))
        .collect();
    assert!(outcomes.len() >= fewest, "only {} records show their effect", outcomes.len());
    let rate = 1.0 - list.len() as f64 / outcomes.len().max(1) as f64;
    assert!(rate >= share, "{} of {} missed:\n{}", list.len(), outcomes.len(), list.join("\n"));
}

/// Effects that a model can lack.
fn ids() -> Vec<String> {
    Catalogue::ENTRIES.iter().map(|entry| entry.id.to_string()).collect()
}

#[test]
fn the_hidden_effect_comes_first() {
    let each = ids().into_iter().flat_map(|id| [0, 1].map(|draw| (id.clone(), draw)));
    let outcomes = visible(each.map(|(id, draw)| setting(Secret::Missing(vec![id]), 0.1, 0.002, draw)).collect());
    assert_share(&outcomes, 24, 0.95, |outcome| matches!(outcome.answer, Answer::Right | Answer::Tied));
    assert_share(&outcomes, 24, 0.8, Outcome::is_right);
    let mut ratios: Vec<f64> = outcomes.iter().filter_map(|(_, outcome)| outcome.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    assert!(median < 1.1, "error with the effect found ÷ error of the true form: {median}");
}

/// The stiffness rises by 30 % on the way.
#[test]
fn a_switch_and_a_hidden_effect_are_told_apart() {
    let ids = [
        "coulomb_friction",
        "constant_force",
        "quadratic_stiffness",
        "one_sided_stop",
        "asymmetric_damping",
        "cogging",
    ];
    let each = ids.into_iter().flat_map(|id| [0, 1].map(|draw| (id, draw)));
    let beside = |(id, draw): (&str, u64)| {
        let secret = Secret::Missing(vec![id.into()]);
        Setting { switch: 0.3, samples: 2 * SAMPLES, ..setting(secret, 0.2, 0.002, draw) }
    };
    let outcomes = visible(each.map(beside).collect());
    assert_share(&outcomes, 6, 0.9, |outcome| matches!(outcome.answer, Answer::Right | Answer::Tied));
    assert_share(&outcomes, 6, 0.9, |outcome| outcome.switch == Some(true));
}

/// Of drives, joints and dampers, at 5 and 20 % of the force.
#[test]
fn what_real_rigs_have_comes_first_or_in_a_stated_tie() {
    let rigs = [
        "presliding_friction",
        "friction_with_backlash",
        "asymmetric_damping",
        "load_dependent_friction",
        "position_dependent_friction",
        "cogging",
        "relaxation",
        "actuator_lag",
    ];
    let strengths = rigs.into_iter().flat_map(|id| [0.05, 0.2].map(|strength| (id, strength)));
    let all = strengths.flat_map(|(id, strength)| [0, 1].map(|draw| (id, strength, draw)));
    let missing = |id: &str| Secret::Missing(vec![id.into()]);
    let outcomes = visible(all.map(|(id, strength, draw)| setting(missing(id), strength, 0.001, draw)).collect());
    assert_share(&outcomes, 20, 0.92, |outcome| matches!(outcome.answer, Answer::Right | Answer::Tied));
    for id in rigs {
        let own = outcomes.iter().filter(|(setting, _)| setting.secret == missing(id));
        assert!(own.count() > 0, "no record shows {id}");
    }
}

/// Friction that grows towards one side, beside friction that is everywhere more than what it loses on the other.
#[test]
fn friction_that_grows_along_the_way_is_found_and_none_that_would_push() {
    let scenario = |coulomb: f64| {
        let text = format!(
            "terms = ['qdd', 'qd', 'q', 'coulomb_friction']\nduration = 30.0\nnoise = {{ q = 1e-4, qd = 1e-4 }}\n\
             excitation = {{ kind = 'multisine', from = 1.0, to = 12.0, count = 30, rms = 5.0, sample_time = 5e-3 }}\n\
             hidden = {{ position_dependent_friction = {{ coefficient = 1.2, power = 1 }} }}\n\
             [[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.6, 40.0, {coulomb}]\n"
        );
        Scenario::from_toml(&text).unwrap()
    };
    let named = |coulomb: f64, terms: &[&str]| {
        let readings = record(&scenario(coulomb)).unwrap();
        let of = |value: fn(&Reading) -> f64| readings.iter().map(value).collect::<Vec<f64>>();
        let channels = [of(|own| own.t), of(|own| own.q), of(|own| own.qd), of(|own| own.excitation)];
        let [t, q, qd, excitation] = channels;
        let recording = Recording::new("friction", t, Some(q), Some(qd), Some(excitation)).unwrap();
        let model = Model::of("rig", terms.iter().map(|term| (Term::parse(term).unwrap(), Given::Fit)));
        Posed::new(&model, &[&recording], None).unwrap().diagnose().unwrap()
    };
    let found = named(0.9, &["qdd", "qd", "q", "coulomb_friction"]);
    assert_eq!(found.effect.as_deref(), Some("position_dependent_friction"), "{:?}", found.candidates);
    let pushing = named(0.0, &["qdd", "qd", "q"]);
    let candidate = pushing.candidates.iter().find(|one| one.effect == "position_dependent_friction").unwrap();
    assert_eq!(candidate.doubt, Some(Doubt::Sign), "{candidate:?}");
}

#[test]
fn a_complete_model_is_adequate() {
    let beside = ["coulomb_friction", "one_sided_stop", "hysteresis", "hidden_resonator", "excitation_delay"];
    let secrets = [None].into_iter().chain(beside.map(Some)).map(|id| Secret::Complete(id.map(String::from)));
    let settings = secrets.flat_map(|secret| [0.002, 0.03].map(|noise| setting(secret.clone(), 0.1, noise, 0)));
    assert_share(&visible(settings.collect()), 12, 0.97, Outcome::is_right);
}

#[test]
fn what_the_catalogue_does_not_have_is_not_forced_into_it() {
    let settings = Outside::ALL.map(|outside| setting(Secret::Outside(outside), 0.1, 0.002, 0));
    assert_share(&visible(settings.to_vec()), 8, 0.85, |outcome| outcome.answer != Answer::Wrong);
}

#[test]
fn two_hidden_effects_are_found() {
    let settings = (0..18).map(|number| setting(pair(SEED, 0, number), 0.1, 0.005, number));
    assert_share(&visible(settings.collect()), 8, 0.8, Outcome::is_right);
}

/// What holds the target predicts it by itself: a filtered velocity beside the law's damper was named for a force that
/// has no name, F³ and a position-dependent inertia never beside another effect.
#[test]
fn what_holds_the_target_is_told_by_what_it_explains() {
    let drawn = |secret: Secret, strength: f64, noise: f64, seed: u64| Setting {
        seed,
        samples: 5000,
        ..setting(secret, strength, noise, 0)
    };
    let both = |one: &str, other: &str| Secret::Missing(vec![one.into(), other.into()]);
    let outcomes = visible(vec![
        drawn(Secret::Outside(Outside::JumpingStiffness), 0.05, 0.01, 6317),
        drawn(both("bilinear_stiffness", "excitation_gain_nonlinearity"), 0.2, 0.001, 6314),
        drawn(both("load_dependent_friction", "position_dependent_inertia"), 0.2, 0.001, 6314),
        drawn(Secret::Missing(vec!["relaxation".into()]), 0.2, 0.01, 6403),
    ]);
    assert_share(&outcomes, 4, 1.0, Outcome::is_right);
}

/// Of complete laws no effect is named, nor are they called unexplained: a held force and a cubic spring read 26 times
/// a period showed a position-dependent inertia at 130 std, and what a loop had stored before the record was an error.
#[test]
fn what_reading_and_the_time_before_a_record_leave_is_no_effect() {
    let drawn = |id: &str, strength: f64, seed: u64| Setting {
        seed,
        samples: 5000,
        ..setting(Secret::Complete(Some(id.into())), strength, 0.001, 0)
    };
    let outcomes = visible(vec![
        drawn("stribeck_friction", 0.05, 6372),
        drawn("cogging", 0.2, 6372),
        drawn("friction_with_backlash", 0.2, 6381),
    ]);
    assert_share(&outcomes, 3, 1.0, Outcome::is_right);
}

/// Effects and numbers are drawn when the test runs, so that nothing can be made to fit them. Some 22 of 36 can be seen
/// at all; where 96 % of those are found in the long run, chance takes more than a fifth of them once in 800 runs.
#[test]
fn effects_that_nobody_knows_before_are_found() {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos() as u64;
    let ids = ids();
    let id = |draw: u64| ids[((now / 1000 + 7 * draw) % ids.len() as u64) as usize].clone();
    let drawn = (0..36).map(|draw| Setting { seed: now, ..setting(Secret::Missing(vec![id(draw)]), 0.2, 0.005, draw) });
    assert_share(&visible(drawn.collect()), 12, 0.8, |outcome| matches!(outcome.answer, Answer::Right | Answer::Tied));
}
