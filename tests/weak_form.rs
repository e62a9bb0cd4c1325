//! Records whose errors are no white sensor noise: what the identifier tells of them, from the weak form beside its
//! filter.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use switchid::identify::{Identifier, Sample, Settings};
use switchid::law::{Given, Model, Term};

/// m, c, Coulomb friction, offset.
const TRUTH: [(&str, f64); 4] = [("qdd", 1.0), ("qd", 0.3), ("coulomb_friction", 0.3), ("1", 0.1)];

const DT: f64 = 0.005;

/// Steps of integration in a sample.
const PARTS: u32 = 20;

/// A servo axis under five sines, with a disturbance of the force of `disturbed` times its RMS over some 0.4 s; encoder
/// of `step`, its differences come as q̇ a sample late.
fn servo(seed: u64, seconds: f64, disturbed: f64, step: f64) -> Vec<Sample> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let sines: Vec<[f64; 3]> = (0..5)
        .map(|_| [generator.random_range(0.5..1.0), generator.random_range(0.5..4.5), generator.random_range(0.0..6.0)])
        .collect();
    let (mut q, mut qd, mut disturbance) = (0.0f64, 0.0f64, 0.0);
    let mut samples: Vec<Sample> = Vec::new();
    let mut late = 0.0;
    for k in 0..(seconds / DT) as u32 {
        let t = f64::from(k) * DT;
        let force: f64 = sines.iter().map(|[size, rate, phase]| size * (rate * t + phase).sin()).sum();
        let (decay, white) = ((-DT / 0.4f64).exp(), generator.sample::<f64, _>(StandardNormal));
        disturbance = decay * disturbance + disturbed * 1.2 * (1.0 - decay * decay).sqrt() * white;
        let seen = (q / step).round() * step;
        let before = samples.last().map_or(seen, |sample| sample.q);
        samples.push(Sample { t, q: seen, qd: late, excitation: force });
        late = (seen - before) / DT;
        for _ in 0..PARTS {
            let driven = force + disturbance - 0.3 * qd - 0.1;
            let sticks = qd == 0.0 && driven.abs() < 0.3;
            let next = qd + DT / f64::from(PARTS) * (driven - 0.3 * if qd == 0.0 { driven } else { qd }.signum());
            qd = if sticks || qd * next < 0.0 { 0.0 } else { next };
            q += qd * DT / f64::from(PARTS);
        }
    }
    samples
}

fn identified(samples: &[Sample]) -> Identifier {
    let terms = TRUTH.map(|(name, _)| (Term::parse(name).unwrap(), Given::Fit));
    let settings = Settings { sample_time: DT, ..Settings::default() };
    let mut identifier = Identifier::new(&Model::of("servo", terms), settings).unwrap();
    samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
    identifier
}

#[test]
fn what_is_published_of_a_disturbed_servo_axis_is_near_the_truth_as_its_std_says() {
    let (mut squares, mut count, mut inertias) = (0.0, 0.0, 0);
    for seed in 0..6 {
        let identifier = identified(&servo(seed, 30.0, 0.2, 0.004));
        let output = identifier.output();
        assert!(!output.valid, "seed {seed}: a law that leaves a fifth of the force unexplained is validated");
        let explained = output.explained.unwrap_or_else(|| panic!("seed {seed}: nothing is told"));
        assert!((0.8..1.0).contains(&explained), "seed {seed}: explains {explained}");
        for (coefficient, (name, truth)) in identifier.coefficients().iter().zip(TRUTH) {
            let Some(std) = coefficient.std else { continue };
            assert!(std < coefficient.value.abs(), "seed {seed}: {name} = {} ± {std}", coefficient.value);
            let off = (coefficient.value - truth) / std;
            assert!(off.abs() < 4.5, "seed {seed}: {name} = {} ± {std}", coefficient.value);
            (squares, count) = (squares + off * off, count + 1.0);
            inertias += i32::from(name == "qdd" && std < coefficient.value / 3.0);
        }
    }
    assert_eq!(inertias, 6, "an inertia known to a third of its size");
    assert!(count >= 15.0 && (0.1..2.5).contains(&(squares / count)), "mean z² {} of {count}", squares / count);
}

#[test]
fn a_saved_identifier_goes_on_with_the_same_bits_while_it_tells_the_weak_form() {
    let samples = servo(1, 30.0, 0.2, 0.004);
    let (first, rest) = samples.split_at(5000);
    let mut identifier = identified(first);
    assert!(identifier.output().explained.is_some());
    let bytes = |identifier: &Identifier| postcard::to_allocvec(identifier).unwrap();
    let mut restored: Identifier = postcard::from_bytes(&bytes(&identifier)).unwrap();
    for sample in rest {
        identifier.step(*sample).unwrap();
        restored.step(*sample).unwrap();
    }
    assert!(bytes(&identifier) == bytes(&restored));
}

/// With the excitation's sign turned around the inertia that fits is negative.
#[test]
fn a_law_with_a_negative_inertia_is_never_told() {
    let turned: Vec<Sample> = servo(2, 30.0, 0.2, 0.004)
        .into_iter()
        .map(|sample| Sample { excitation: -sample.excitation, ..sample })
        .collect();
    let identifier = identified(&turned);
    assert!(!identifier.output().valid);
    assert!(identifier.coefficients().iter().all(|coefficient| coefficient.std.is_none()));
}
