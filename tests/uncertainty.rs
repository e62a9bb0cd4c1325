//! What the stream says about what it does not know yet: how well it knows the instant of a switch, and how much more
//! of a record a law needs.

use switchid::identify::{Coefficient, Identifier, Output, Sample, Settings};
use switchid::law::{Given, Model};
use switchid::simulate::{Builtin, Scenario, record};

const SAMPLE_TIME: f64 = 2e-3;

/// The first two stages of a random scenario.
fn one_switch(builtin: Builtin, seed: u64, noise: f64) -> Scenario {
    let mut scenario = builtin.random(seed).with_noise(noise);
    scenario.stages.truncate(2);
    scenario.duration = scenario.stages[1].start + 5.0;
    scenario.excitation.sample_time = SAMPLE_TIME;
    scenario
}

/// Calls `watch` with time, outputs and coefficients after every sample.
fn follow(builtin: Builtin, scenario: &Scenario, mut watch: impl FnMut(f64, &Output, &[Coefficient])) {
    let model = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    let settings = Settings { sample_time: SAMPLE_TIME, ..Settings::default() };
    let mut identifier = Identifier::new(&model, settings).unwrap();
    for reading in record(scenario).unwrap() {
        let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
        identifier.step(sample).unwrap();
        watch(reading.t, identifier.output(), identifier.coefficients());
    }
}

/// (estimated − true) ÷ std of the switch instant, where an alarm followed the switch.
fn normalised_error(builtin: Builtin, seed: u64, noise: f64) -> Option<f64> {
    let scenario = one_switch(builtin, seed, noise);
    let switch = scenario.stages[1].start;
    let mut found = None;
    follow(builtin, &scenario, |t, output, _| {
        if output.switch_count == 0 {
            assert_eq!(output.switch_time_std, None);
        } else if t > switch && found.is_none() {
            found = Some((output.switch_time - switch) / output.switch_time_std.unwrap());
        }
    });
    found
}

#[test]
fn the_std_of_a_switch_instant_is_that_of_its_error() {
    let cases = [
        (Builtin::DuffingSine, 0.001),
        (Builtin::DuffingWhite, 0.01),
        (Builtin::DuffingSine, 0.1),
        (Builtin::VanDerPolSine, 0.01),
        (Builtin::VanDerPolWhite, 0.001),
        (Builtin::VanDerPolSine, 0.1),
    ];
    let errors: Vec<f64> = cases
        .into_iter()
        .flat_map(|(builtin, noise)| (300..304).filter_map(move |seed| normalised_error(builtin, seed, noise)))
        .collect();
    let mean = errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
    assert!(errors.len() >= 22, "{} switches seen", errors.len());
    assert!((0.3..3.0).contains(&mean), "{mean}: {errors:?}");
    assert!(errors.iter().filter(|error| error.abs() > 3.0).count() <= 1, "{errors:?}");
}

/// What was said between alarm and law: (seconds that it took from then on, seconds that were foretold for the slowest
/// coefficient).
fn foretold(builtin: Builtin, seed: u64, noise: f64) -> Vec<(f64, Option<f64>)> {
    let scenario = one_switch(builtin, seed, noise);
    let (mut said, mut known) = (Vec::new(), None);
    follow(builtin, &scenario, |t, output, coefficients| {
        if output.switch_count != 1 || known.is_some() {
            return;
        }
        let mut needed = coefficients.iter().map(|coefficient| coefficient.needed);
        let slowest = needed.try_fold(0.0_f64, |slowest, needed| Some(slowest.max(needed?)));
        match output.valid {
            true => {
                known = Some(t);
                assert_eq!(slowest, Some(0.0));
            }
            false => said.push((t, slowest)),
        }
    });
    let known = known.unwrap_or(f64::INFINITY);
    said.into_iter().map(|(t, slowest)| (known - t, slowest)).collect()
}

#[test]
fn the_seconds_that_a_law_still_needs_are_foretold_within_a_factor_of_two() {
    let said: Vec<(f64, Option<f64>)> =
        (300..306).flat_map(|seed| foretold(Builtin::DuffingSine, seed, 0.01)).collect();
    let near = |(took, said): &&(f64, Option<f64>)| said.is_some_and(|said| said < 2.0 * took && said > took / 2.0);
    let share = said.iter().filter(near).count() as f64 / said.len() as f64;
    assert!(share > 0.5, "{share}");
    let silent = said.iter().filter(|(_, said)| said.is_none()).count() as f64 / said.len() as f64;
    assert!(silent < 0.3, "{silent}");
}
