//! Laws whose output is F: at the limit, honest, and their switches seen.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use switchid::identify::{Identification, Identifier, Recording, Sample, Settings, identify_recording, settings_for};
use switchid::law::{Given, Model, State, Term};
use switchid::limits::{Bound, Imposed, Law, force_bound, force_detection, level};
use switchid::simulate::{Excitation, ExcitationKind, Reading, Scenario, SensorNoise, Stage, record};

const TERMS: [&str; 4] = ["qd", "q", "1", "coulomb_friction"];
const LAW: [f64; 4] = [3.0, 20.0, 1.5, 2.0];
const NOISE: f64 = 0.5;

fn terms() -> Vec<Term> {
    TERMS.map(|name| Term::parse(name).unwrap()).to_vec()
}

fn model() -> Model {
    Model::of("damper", terms().into_iter().map(|term| (term, Given::Fit)))
}

/// A multisine of RMS 0.2 between 1 and 8 rad/s; stages begin at the given times.
fn damper(stages: &[(f64, [f64; 4])], duration: f64, seed: u64) -> Scenario {
    let stage = |(start, law): &(f64, [f64; 4])| Stage {
        start: *start,
        coefficients: law.to_vec(),
        amplitude: 0.0,
        omega: 0.0,
    };
    let mut scenario = Scenario::new("damper", terms(), stages.iter().map(stage).collect(), duration).with_seed(seed);
    scenario.noise = SensorNoise { q: 1e-4, qd: 1e-3, force: NOISE };
    let kind = ExcitationKind::Multisine;
    scenario.excitation =
        Excitation { kind, sample_time: 2e-3, from: 1.0, to: 8.0, count: 8, rms: 0.2, ..Excitation::default() };
    scenario
}

fn recording(readings: &[Reading], measures_velocity: bool) -> Recording {
    let column = |value: fn(&Reading) -> f64| readings.iter().map(value).collect::<Vec<f64>>();
    let velocity = measures_velocity.then(|| column(|reading| reading.qd));
    let (t, q, force) = (column(|r| r.t), column(|r| r.q), column(|r| r.excitation));
    Recording::new("damper", t, Some(q), velocity, Some(force)).unwrap()
}

fn identified(scenario: &Scenario, measures_velocity: bool) -> Identification {
    let recording = recording(&record(scenario).unwrap(), measures_velocity);
    let settings = settings_for(&recording, Settings::default());
    identify_recording(&model(), settings, &recording, |_, _| {}).unwrap()
}

fn motion(scenario: &Scenario) -> Vec<Imposed> {
    let exact = Scenario { noise: SensorNoise::default(), ..scenario.clone() };
    let imposed = |reading: Reading| Imposed { t: reading.t, state: State { q: reading.q, qd: reading.qd } };
    record(&exact).unwrap().into_iter().map(imposed).collect()
}

fn law(coefficients: [f64; 4]) -> Law {
    let pairs: Vec<(Term, f64)> = terms().into_iter().zip(coefficients).collect();
    Law::new(&pairs, &[0, 1, 2, 3]).unwrap()
}

fn bound(scenario: &Scenario) -> Bound {
    force_bound(&law(LAW), &motion(scenario), NOISE).unwrap()
}

/// Σ (θ − θ*)² ÷ Σ θ*².
fn error(found: &[f64]) -> f64 {
    let squares: f64 = found.iter().zip(LAW).map(|(found, truth)| (found - truth).powi(2)).sum();
    squares / LAW.map(|value| value * value).iter().sum::<f64>()
}

#[test]
fn coefficients_are_at_the_limit_and_their_std_honest() {
    for measures_velocity in [true, false] {
        let seeds = 60;
        let (mut ratio, mut normalised, mut valid) = (0.0, 0.0, 0);
        for seed in 0..seeds {
            let scenario = damper(&[(0.0, LAW)], 6.0, 100 + seed);
            let found = identified(&scenario, measures_velocity);
            let starts: Vec<_> = found.stages.iter().map(|stage| (stage.start, stage.detected)).collect();
            assert_eq!(found.stages.len(), 1, "seed {seed}, velocity {measures_velocity}: {starts:?}");
            let stage = &found.stages[0];
            let values: Vec<f64> = stage.coefficients.iter().map(|coefficient| coefficient.value).collect();
            let deviation = |index: usize| {
                let coefficient = &stage.coefficients[index];
                let std = coefficient.std.unwrap_or_else(|| panic!("seed {seed}: {:?}", stage));
                ((coefficient.value - LAW[index]) / std).powi(2)
            };
            normalised += (0..4).map(deviation).sum::<f64>() / 4.0;
            ratio += error(&values) / bound(&scenario).relative_error.unwrap();
            valid += u64::from(stage.identified.is_some());
            let noise = found.noise.force.unwrap_or(NOISE);
            assert!((noise / NOISE - 1.0).abs() < 0.15, "seed {seed}: noise {noise}");
        }
        let (ratio, normalised) = (ratio / seeds as f64, normalised / seeds as f64);
        eprintln!("qd {measures_velocity}: e/limit {ratio:.3}, normalised {normalised:.3}, valid {valid}/{seeds}");
        // a mean of 60 of χ²₄ ÷ 4 has std √(2 ÷ 240) = 0.09; that of e ÷ limit about twice as much, one direction
        // being the worst known
        assert!(ratio < 1.5, "velocity {measures_velocity}: e ÷ limit {ratio}");
        assert!((0.7..1.35).contains(&normalised), "velocity {measures_velocity}: {normalised}");
        assert!(valid >= seeds - 3, "only {valid} of {seeds} validated");
    }
}

#[test]
fn a_switch_is_seen_near_the_limit_and_no_other_one() {
    for changed in [[4.5, 20.0, 1.5, 2.0], [3.0, 26.0, 1.5, 2.0], [3.0, 20.0, 1.5, 1.0], [3.0, 20.0, 3.0, 2.0]] {
        let mut ratios = Vec::new();
        for seed in 0..12 {
            let start = 4.0 + 0.1371 * seed as f64;
            let scenario = damper(&[(0.0, LAW), (start, changed)], start + 6.0, 900 + seed);
            let found = identified(&scenario, true);
            let starts: Vec<f64> = found.stages.iter().map(|stage| stage.start).collect();
            let detected: Vec<_> = found.stages.iter().map(|stage| stage.detected).collect();
            assert_eq!(found.stages.len(), 2, "{changed:?}, seed {seed}, {start}: {starts:?} {detected:?}");
            let second = &found.stages[1];
            let delay = second.detected.unwrap() - start;
            let since: Vec<Imposed> = motion(&scenario).into_iter().filter(|instant| instant.t >= start).collect();
            let level = level(1e6, 2e-3);
            let limit = force_detection(&law(LAW), &law(changed), &since, NOISE, level).unwrap().at_start.unwrap();
            assert!(delay > 0.0, "{changed:?}, seed {seed}: {delay}");
            ratios.push(delay / limit.max(2e-3));
            let away = (second.start - start).abs();
            assert!(away < 5.0 * second.start_std.unwrap() + 2e-3, "{changed:?}, seed {seed}: {away} s off");
            for (coefficient, truth) in second.coefficients.iter().zip(changed) {
                let std = coefficient.std.unwrap();
                assert!((coefficient.value - truth).abs() < 5.0 * std, "{changed:?}, seed {seed}: {coefficient:?}");
            }
        }
        ratios.sort_by(f64::total_cmp);
        eprintln!("{changed:?}: delay/limit median {:.2} worst {:.2}", ratios[6], ratios[11]);
        assert!(ratios[6] < 2.0, "{changed:?}: {ratios:?}");
    }
}

#[test]
fn a_machine_that_begins_to_move_has_not_switched() {
    let more = ["q^3", "qd^3"].map(|name| (Term::parse(name).unwrap(), Given::Maybe));
    let larger = Model::of("damper", terms().into_iter().map(|term| (term, Given::Fit)).chain(more));
    for (model, seed) in [model(), larger].iter().flat_map(|model| (0..10).map(move |seed| (model, seed))) {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut white = |std: f64| std * generator.sample::<f64, _>(StandardNormal);
        let mut identifier = Identifier::new(model, Settings { sample_time: 2e-3, ..Settings::default() }).unwrap();
        for k in 0..3000 {
            let t = 2e-3 * f64::from(k);
            // at rest for a second; the velocity is read without noise, so that nothing is told of its terms till then
            let (q, qd) = if t < 1.0 { (0.0, 0.0) } else { (0.3 * (t - 1.0), 0.3) };
            let friction = if t < 1.0 { 0.0 } else { LAW[3] };
            let force = LAW[0] * qd + LAW[1] * q + LAW[2] + friction + white(NOISE);
            let _ = identifier.step(Sample { t, q: q + white(1e-4), qd, excitation: force });
        }
        let output = identifier.output();
        assert_eq!(output.switch_count, 0, "{}, seed {seed}: {}", model.terms.len(), output.switch_time);
    }
}
