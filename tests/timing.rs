//! When the excitation acted: samples that come late, a hold that is said wrongly, and what no sample tells.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use switchid::identify::{Identifier, Sample, SensorState, Settings};
use switchid::law::{Given, Hold, Model, Term};
use switchid::simulate::{Builtin, Scenario, record};

/// Std of the sensors' noise.
const NOISE: f64 = 0.01;

/// Largest error ÷ std that is an honest one.
const BEYOND: f64 = 6.0;

/// One law for 20 s, read every `sample_time` s while F is held.
fn scenario(builtin: Builtin, seed: u64, sample_time: f64) -> Scenario {
    let mut scenario = builtin.random(seed).with_noise(NOISE);
    scenario.stages.truncate(1);
    scenario.excitation.sample_time = sample_time;
    scenario.duration = 20.0;
    scenario
}

fn samples(scenario: &Scenario) -> Vec<Sample> {
    let readings = record(scenario).unwrap().into_iter();
    readings.map(|read| Sample { t: read.t, q: read.q, qd: read.qd, excitation: read.excitation }).collect()
}

/// The identifier after the samples; no coefficient is ever further off than its std say, and no switch is seen.
fn identify(builtin: Builtin, hold: Hold, scenario: &Scenario, samples: &[Sample]) -> Identifier {
    let model = Model::of("plant", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
    let mut identifier = Identifier::new(&model, Settings { hold, ..Settings::default() }).unwrap();
    let truth = &scenario.stages[0].coefficients;
    for sample in samples {
        identifier.step(*sample).unwrap();
        let off = identifier.coefficients().iter().zip(truth);
        let off = off.filter_map(|(known, truth)| Some((known.value - truth).abs() / known.std?)).fold(0.0, f64::max);
        assert!(!identifier.output().valid || off < BEYOND, "{hold} at {} s: {off} std", sample.t);
    }
    assert!(identifier.output().valid && identifier.output().switch_count == 0, "{hold}: {:?}", identifier.output());
    identifier
}

#[test]
fn a_motion_or_a_force_that_comes_a_sample_late_is_said_to_and_counted_with() {
    let builtin = Builtin::DuffingWhite;
    let scenario = scenario(builtin, 7, 1e-3);
    let read = samples(&scenario);
    let pairs = || read.windows(2);
    let motion: Vec<Sample> = pairs().map(|pair| Sample { q: pair[0].q, qd: pair[0].qd, ..pair[1] }).collect();
    let force: Vec<Sample> = pairs().map(|pair| Sample { excitation: pair[0].excitation, ..pair[1] }).collect();
    let (ok, late) = (SensorState::Ok, SensorState::Late);
    for (samples, expected) in [(&read, [ok; 3]), (&motion, [late, late, ok]), (&force, [ok, ok, late])] {
        assert_eq!(identify(builtin, Hold::Zero, &scenario, samples).output().sensors, expected);
    }
}

#[test]
fn a_hold_that_is_said_wrongly_is_found_in_the_stream() {
    for (builtin, seed) in [(Builtin::DuffingWhite, 8), (Builtin::DuffingSine, 8), (Builtin::VanDerPolSine, 9)] {
        let scenario = scenario(builtin, seed, 0.01);
        let samples = samples(&scenario);
        for said in [Hold::Zero, Hold::Linear] {
            let found = identify(builtin, said, &scenario, &samples).output().hold;
            assert_eq!(found, Some(Hold::Zero), "{} said to be {said}", builtin.id());
        }
    }
}

/// Under one sine a delay of the force is a damping: q̈ + 0.4 q̇ + 9 q = cos 2t in its steady state, every 0.2 s.
#[test]
fn a_law_that_depends_on_what_one_sine_cannot_tell_is_not_valid() {
    let terms = [(Term::Inertia, Given::Known(1.0)), (Term::power(0, 1), Given::Fit), (Term::power(1, 0), Given::Fit)];
    let model = Model::of("linear", terms);
    let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
    let mut generator = ChaCha8Rng::seed_from_u64(1);
    let (omega, phase) = (2.0_f64, (0.8_f64).atan2(5.0));
    let amplitude = 5.0_f64.hypot(0.8).recip();
    let mut said = false;
    for index in 0..600 {
        let t = 0.2 * f64::from(index);
        let mut noise = || 1e-3 * generator.random_range(-1.0..1.0);
        let angle = omega * t - phase;
        let (q, qd) = (amplitude * angle.cos() + noise(), -omega * amplitude * angle.sin() + noise());
        identifier.step(Sample { t, q, qd, excitation: (omega * t).cos() }).unwrap();
        assert!(!identifier.output().valid, "valid at {t} s: {:?}", identifier.coefficients());
        said |= identifier.output().hold.is_none();
    }
    let open = identifier.unidentifiable();
    assert!(said && open.contains(&"when F acts between samples".to_string()), "{open:?}");
}
