//! The truth of the built-in scenarios is found again by the default identifier.

#[path = "../examples/figures/follow.rs"]
mod follow;
#[path = "../examples/figures/measure.rs"]
mod measure;

use follow::Figures;
use measure::{measure, model};
use switchid::simulate::{Builtin, Scenario};

fn figures(builtin: Builtin, scenario: &Scenario) -> Figures {
    measure(builtin, scenario).unwrap()
}

/// Every switch detected, no false alarm, and every stage's law to 1e-3 of its coefficients.
fn exact_without_noise(builtin: Builtin) {
    let found = figures(builtin, &builtin.scenario());
    assert!(found.stages.len() >= 5);
    assert_eq!((found.missed(), found.false_alarms), (0, 0), "{found:#?}");
    for (number, stage) in found.stages.iter().enumerate() {
        assert!(stage.error <= 1e-6 && stage.tracking.is_finite(), "stage {number}: {stage:?}");
    }
}

#[test]
fn duffing_under_a_sine() {
    exact_without_noise(Builtin::DuffingSine);
}

#[test]
fn duffing_under_white_noise() {
    exact_without_noise(Builtin::DuffingWhite);
}

#[test]
fn van_der_pol_under_a_sine() {
    exact_without_noise(Builtin::VanDerPolSine);
}

#[test]
fn van_der_pol_under_white_noise() {
    exact_without_noise(Builtin::VanDerPolWhite);
}

/// Median of e over five seeds of sensor noise, without a single alarm.
fn median_error(builtin: Builtin) -> f64 {
    let runs = (1..=5).map(|seed| figures(builtin, &builtin.random(seed)));
    let mut errors: Vec<f64> = runs
        .map(|run| {
            assert_eq!(run.false_alarms, 0, "{run:?}");
            run.stages[0].error
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors[2]
}

#[test]
fn the_publication_s_duffing_noise_case_is_at_least_as_good_as_printed() {
    let error = median_error(Builtin::DuffingNoise);
    assert!(error <= 2.58e-4, "{error:e}");
}

#[test]
fn the_publication_s_van_der_pol_noise_case_is_found_in_the_full_library() {
    assert_eq!(model(Builtin::VanDerPolNoise).terms.len(), 11);
    let error = median_error(Builtin::VanDerPolNoise);
    assert!(error <= 1e-2, "{error:e}");
}

/// Its first law, once found, was contested by its equal again and again, and so never vouched for: every switch was missed.
#[test]
fn a_law_that_challengers_confirm_is_vouched_for() {
    let found = figures(Builtin::VanDerPolSine, &Builtin::VanDerPolSine.random(40).with_noise(0.01));
    assert_eq!((found.missed(), found.false_alarms), (0, 0), "{found:#?}");
}
