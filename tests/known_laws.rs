//! Laws that return: recognised, refined, saved and loaded, and told from laws that only resemble them.

use switchid::identify::{Identifier, Output, Sample, SavedLaws, SavedLawsError, Settings};
use switchid::law::{Given, Model};
use switchid::simulate::{Builtin, Scenario, record};

const LENGTH: f64 = 8.0;
const A: [f64; 4] = [1.0, 0.3, 4.0, 2.0];
const B: [f64; 4] = [1.2, 0.5, 5.5, 1.2];
/// A with a linear stiffness that is 3 % larger.
const NEARLY_A: [f64; 4] = [1.0, 0.3, 4.12, 2.0];

fn model() -> Model {
    Model::of("Duffing", Builtin::DuffingSine.terms().into_iter().map(|term| (term, Given::Fit)))
}

fn scenario(laws: &[[f64; 4]], seed: u64) -> Scenario {
    let mut scenario = Builtin::DuffingSine.scenario().with_noise(0.01).with_seed(seed);
    let sample = scenario.stages[0].clone();
    let stage = |(index, law): (usize, &[f64; 4])| {
        let mut stage = sample.clone();
        (stage.start, stage.coefficients) = (LENGTH * index as f64, law.to_vec());
        stage
    };
    scenario.stages = laws.iter().enumerate().map(stage).collect();
    scenario.duration = LENGTH * laws.len() as f64;
    scenario
}

fn samples(laws: &[[f64; 4]], seed: u64) -> Vec<Sample> {
    let readings = record(&scenario(laws, seed)).unwrap();
    readings.iter().map(|r| Sample { t: r.t, q: r.q, qd: r.qd, excitation: r.excitation }).collect()
}

fn fresh() -> Identifier {
    Identifier::new(&model(), Settings::default()).unwrap()
}

/// The outputs after each sample.
fn run(identifier: &mut Identifier, samples: &[Sample]) -> Vec<Output> {
    let step = |sample: &Sample| {
        identifier.step(*sample).unwrap();
        *identifier.output()
    };
    samples.iter().map(step).collect()
}

/// Time after `from` at which the law of this number is first in use, from the outputs of a 1 kHz record, s.
fn in_use(outputs: &[Output], from: f64, number: u32) -> f64 {
    let first = (1e3 * from) as usize;
    let place = outputs[first..].iter().position(|output| output.valid && output.law_number == Some(number));
    1e-3 * place.expect("the law does not return") as f64
}

fn after_a() -> SavedLaws {
    let mut identifier = fresh();
    run(&mut identifier, &samples(&[A], 1));
    identifier.known_laws()
}

#[test]
fn a_law_that_returns_is_in_use_as_soon_as_the_switch_is_seen() {
    let mut ratios: Vec<f64> = (0..5)
        .map(|seed| {
            let outputs = run(&mut fresh(), &samples(&[A, B, A], 20 + seed));
            let alarm = outputs.iter().find(|output| output.switch_count == 2).unwrap().detection_time.unwrap();
            in_use(&outputs, 2.0 * LENGTH, 1) / (alarm - 2.0 * LENGTH)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    assert!(ratios[2] < 1.3, "time until known ÷ time until detected: {ratios:?}");
}

#[test]
fn a_law_that_returns_gets_more_exact() {
    let mut identifier = fresh();
    let samples = samples(&[A, B, A], 3);
    let third = samples.len() / 3;
    run(&mut identifier, &samples[..third]);
    let std = |identifier: &Identifier| identifier.coefficients()[2].std.unwrap();
    let before = std(&identifier);
    run(&mut identifier, &samples[third..]);
    assert_eq!(identifier.output().law_number, Some(1));
    assert!(std(&identifier) < 0.85 * before, "{} after {before}", std(&identifier));
    let error = (identifier.coefficients()[2].value - A[2]).abs();
    assert!(error < 4.0 * std(&identifier), "{error}");
    assert_eq!(identifier.known_laws().laws.len(), 2);
}

#[test]
fn a_law_that_only_resembles_a_known_one_gets_a_number_of_its_own() {
    for seed in 0..3 {
        let outputs = run(&mut fresh(), &samples(&[A, B, NEARLY_A], 40 + seed));
        assert_eq!(outputs.last().unwrap().law_number, Some(3), "seed {seed}");
    }
}

#[test]
fn saved_laws_are_recognised_in_another_record_soon_after_its_first_samples() {
    let text = after_a().to_toml().unwrap();
    let saved = SavedLaws::from_toml(&text).unwrap();
    assert_eq!(saved, after_a());
    let record = samples(&[A], 77);
    let mut knowing = fresh().with_known_laws(&saved).unwrap();
    let (with, without) = (run(&mut knowing, &record), run(&mut fresh(), &record));
    let (with, without) = (in_use(&with, 0.0, 1), in_use(&without, 0.0, 1));
    assert!(with < 0.35 * without, "{with} s with the law saved, {without} s without");
    assert_eq!(knowing.output().switch_count, 0);
}

/// What is recognised among several laws stays in use.
#[test]
fn a_saved_law_is_recognised_among_others_once() {
    let mut identifier = fresh();
    run(&mut identifier, &samples(&[A, B], 1));
    let mut knowing = fresh().with_known_laws(&identifier.known_laws()).unwrap();
    let outputs = run(&mut knowing, &samples(&[B], 6));
    let changes = outputs.windows(2).filter(|pair| pair[0].valid != pair[1].valid).count();
    assert_eq!((outputs.last().unwrap().law_number, changes), (Some(2), 1));
}

#[test]
fn a_first_law_that_no_saved_one_explains_is_a_new_one() {
    let mut identifier = fresh().with_known_laws(&after_a()).unwrap();
    for (law, number) in [(B, 2), (NEARLY_A, 2)] {
        let outputs = run(&mut identifier.clone(), &samples(&[law], 5));
        assert_eq!(outputs.last().unwrap().law_number, Some(number), "{law:?}");
    }
    run(&mut identifier, &samples(&[A], 5));
    assert_eq!(identifier.output().law_number, Some(1));
}

#[test]
fn clones_and_restored_ones_go_on_alike_through_a_recognition() {
    let samples = samples(&[A, B, A], 9);
    let mut reference = fresh();
    let outputs = run(&mut reference, &samples);
    let end = postcard::to_stdvec(&reference).unwrap();
    let alarm = outputs.iter().position(|output| output.switch_count == 2).unwrap();
    let mut identifier = fresh();
    let mut done = 0;
    for cut in [alarm - 1, alarm + 1, alarm + 9, alarm + 200] {
        run(&mut identifier, &samples[done..cut]);
        done = cut;
        let saved = postcard::to_stdvec(&identifier).unwrap();
        let mut restored: Identifier = postcard::from_bytes(&saved).unwrap();
        run(&mut restored, &samples[cut..]);
        assert!(postcard::to_stdvec(&restored).unwrap() == end, "restored at sample {cut} it goes on otherwise");
    }
}

#[test]
fn laws_of_another_model_are_refused_by_term() {
    let stiffening = after_a();
    let linear = Model::of("linear", model().terms[..3].iter().map(|entry| (entry.term, Given::Fit)));
    let refused = Identifier::new(&linear, Settings::default()).unwrap().with_known_laws(&stiffening).unwrap_err();
    assert_eq!(refused, SavedLawsError::ForeignTerm { law: 1, term: "q^3".into() });
    let refused = Identifier::new(&Model::cubic_library(), Settings::default())
        .unwrap()
        .with_known_laws(&stiffening)
        .unwrap_err();
    assert!(matches!(refused, SavedLawsError::MissingTerm { law: 1, .. }), "{refused}");
}

#[test]
fn saved_laws_that_make_no_sense_are_refused() {
    let sound = after_a();
    let refused = |change: fn(&mut SavedLaws)| {
        let mut saved = sound.clone();
        change(&mut saved);
        fresh().with_known_laws(&saved).unwrap_err().to_string()
    };
    assert!(refused(|saved| saved.laws[0].covariance[1][1] = -1.0).contains("positive definite"));
    assert!(refused(|saved| saved.laws[0].coefficients[0] = f64::NAN).contains("coefficients"));
    assert!(refused(|saved| saved.laws[0].noise.q = 0.0).contains("noise"));
    assert!(refused(|saved| saved.laws.push(saved.laws[0].clone())).contains("each number once"));
    assert!(SavedLaws::from_toml("[[law]]\nnumber = 1").unwrap_err().to_string().contains("samples"));
}
