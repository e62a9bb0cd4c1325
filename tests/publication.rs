//! The published procedure, selected by `method`: what it reaches, where it gives up, and the contract of every
//! identifier.

use switchid::identify::{Channels, Coefficient, Identifier, Method, Sample, Settings, Status};
use switchid::law::{Given, Hold, Model, Term};
use switchid::simulate::{Builtin, Scenario, record};

fn duffing() -> Model {
    model(&["qdd", "qd", "q", "q^3"])
}

fn model(terms: &[&str]) -> Model {
    Model::of("test", terms.iter().map(|term| (Term::parse(term).unwrap(), Given::Fit)))
}

fn published(model: &Model, settings: Settings) -> Identifier {
    Identifier::new(model, Settings { method: Method::Publication, ..settings }).unwrap()
}

fn samples(scenario: &Scenario) -> Vec<Sample> {
    let readings = record(scenario).unwrap().into_iter();
    readings.map(|r| Sample { t: r.t, q: r.q, qd: r.qd, excitation: r.excitation }).collect()
}

/// Eq. (8).
fn error(found: &[Coefficient], truth: &[f64]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
    square(&mut found.iter().zip(truth).map(|(found, truth)| found.value - truth)) / square(&mut truth.iter().copied())
}

/// Duffing sine up to shortly before its second switch.
fn two_stages() -> Scenario {
    Scenario { duration: 22.0, ..Builtin::DuffingSine.scenario() }
}

#[test]
fn it_identifies_a_duffing_stage_and_sees_its_end() {
    let scenario = two_stages();
    let switch = scenario.switch_times()[0];
    let mut identifier = published(&duffing(), Settings::default());
    for sample in samples(&scenario) {
        identifier.step(sample).unwrap();
        let output = identifier.output();
        if sample.t < 1.0 {
            assert_eq!((output.status, output.valid), (Status::Acquiring, false), "at {}", sample.t);
        } else if (1.1..switch).contains(&sample.t) {
            assert_eq!((output.status, output.valid), (Status::Tracking, true), "at {}", sample.t);
            assert!(error(identifier.coefficients(), &scenario.stages[0].coefficients) < 1e-10);
            assert!(identifier.coefficients().iter().all(|known| known.std.is_some_and(|std| std < 1e-3)));
        }
    }
    let output = identifier.output();
    let delay = output.detection_time.unwrap() - switch;
    assert!(0.1 < delay && delay < 2.0, "delay {delay}");
    assert_eq!((output.switch_count, output.switch_time), (1, switch + delay));
    assert!(output.identified_time.unwrap() > switch + delay + 0.999);
    assert!(error(identifier.coefficients(), &scenario.stages[1].coefficients) < 1e-10);
}

#[test]
fn while_it_captures_the_new_stage_nothing_is_known() {
    let mut identifier = published(&duffing(), Settings::default());
    for sample in samples(&two_stages()) {
        let before = identifier.coefficients().to_vec();
        identifier.step(sample).unwrap();
        if identifier.output().status == Status::ReIdentifying {
            let now = identifier.coefficients();
            assert!(now.iter().zip(&before).all(|(now, before)| now.std.is_none() && now.value == before.value));
            assert!(!identifier.output().valid && identifier.output().identified_time.is_none());
        }
    }
}

#[test]
fn a_linear_oscillator_in_single_frequency_steady_state_leaves_inertia_and_stiffness_open() {
    let [m, c, k, omega] = [1.3, 0.4, 5.0, 3.0_f64];
    let motion = |t: f64| Sample {
        t,
        q: 0.7 * (omega * t + 0.4).sin(),
        qd: 0.7 * omega * (omega * t + 0.4).cos(),
        excitation: 0.7 * ((k - m * omega * omega) * (omega * t + 0.4).sin() + c * omega * (omega * t + 0.4).cos()),
    };
    let mut identifier =
        published(&model(&["qdd", "qd", "q"]), Settings { hold: Hold::BandLimited, ..Settings::default() });
    for k in 0..5000 {
        identifier.step(motion(1e-3 * f64::from(k))).unwrap();
    }
    let [inertia, damping, stiffness] = identifier.coefficients() else { panic!("three terms") };
    assert_eq!(identifier.unidentifiable(), ["qdd and q together"]);
    assert_eq!((inertia.std, inertia.value, stiffness.std, stiffness.value), (None, 0.0, None, 0.0));
    assert!((damping.value - c).abs() < 1e-6 && damping.std.is_some(), "{damping:?}");
    assert_eq!((identifier.output().valid, identifier.output().switch_count), (false, 0));
}

#[test]
fn a_total_time_derivative_is_reported_whatever_the_data() {
    for method in Method::ALL {
        let identifier = Identifier::new(&Model::cubic_library(), Settings { method, ..Settings::default() }).unwrap();
        let always = identifier.unidentifiable().into_iter().filter(|text| text.ends_with("[potential]"));
        assert_eq!(always.collect::<Vec<_>>(), ["qd in [potential]"]);
    }
}

#[test]
fn clone_and_go_on_equals_go_on_and_fresh_equals_fresh() {
    let mut identifier = published(&duffing(), Settings::default());
    let mut fresh = identifier.clone();
    let samples = samples(&two_stages().with_noise(0.01));
    for cut in [1, 500, 1003, 1500, 4000] {
        let mut original = identifier.clone();
        samples[..cut].iter().for_each(|sample| original.step(*sample).unwrap());
        let mut copy = original.clone();
        for sample in &samples[cut..cut + 2000] {
            original.step(*sample).unwrap();
            copy.step(*sample).unwrap();
        }
        assert_eq!(format!("{original:?}"), format!("{copy:?}"), "cut at {cut}");
    }
    for sample in samples {
        identifier.step(sample).unwrap();
        fresh.step(sample).unwrap();
    }
    assert!(identifier.output().switch_count > 1, "noise should have started the loop of switch and re-identification");
    assert_eq!(format!("{identifier:?}"), format!("{fresh:?}"));
}

#[test]
fn its_settings_are_obeyed() {
    let samples = samples(&two_stages());
    let first_alarm = |settings: Settings| {
        let mut identifier = published(&duffing(), settings);
        samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
        (identifier.output().detection_time, identifier.output().threshold)
    };
    let usual = Settings::default();
    let (alarm, threshold) = first_alarm(usual);
    assert_eq!(threshold, 0.05);
    let (late, threshold) = first_alarm(Settings { deviation_threshold: 0.2, ..usual });
    assert_eq!(threshold, 0.2);
    assert!(late > alarm, "{late:?} against {alarm:?}");
    let (blind, _) = first_alarm(Settings { weight_q: 0.0, weight_qd: 0.0, ..usual });
    assert_eq!(blind, None);
    let mut patient = published(&duffing(), Settings { initial_window: 3.0, ..usual });
    samples.iter().take(3000).for_each(|sample| patient.step(*sample).unwrap());
    assert_eq!(patient.output().status, Status::Acquiring);
    samples.iter().skip(3000).take(200).for_each(|sample| patient.step(*sample).unwrap());
    assert_eq!(patient.output().status, Status::Tracking);
}

#[test]
fn the_law_is_found_from_position_alone_and_from_velocity_alone() {
    let scenario = Scenario { duration: 3.0, ..Builtin::DuffingSine.scenario() };
    let truth = &scenario.stages[0].coefficients;
    for (channels, initial_q, bound) in [
        (Channels { qd: false, ..Channels::ALL }, 0.5, 1e-4),
        // the displacement is known up to its start only, so it must be 0 here
        (Channels { q: false, ..Channels::ALL }, 0.0, 1e-4),
    ] {
        let mut scenario = scenario.clone();
        scenario.initial.q = initial_q;
        let mut identifier = published(&duffing(), Settings { channels, ..Settings::default() });
        samples(&scenario).into_iter().for_each(|sample| identifier.step(sample).unwrap());
        let e = error(identifier.coefficients(), truth);
        assert!(e < bound, "{channels:?}: e = {e:e}");
        assert_eq!(identifier.output().switch_count, 0, "{channels:?}");
    }
}

/// A name and (q, q̇, F) by sample number.
type Signal = (&'static str, fn(i32) -> [f64; 3]);

/// Signals no plant gives.
fn nonsense() -> [Signal; 5] {
    [
        ("standing still", |_| [0.0; 3]),
        ("constant", |_| [1.0, 2.0, 3.0]),
        ("huge", |k| [1e200 * f64::from(k % 7), -1e250, 1e300 * f64::from(k % 3)]),
        ("runaway", |k| [(0.02 * f64::from(k)).exp(), (0.02 * f64::from(k)).exp(), -1.0]),
        ("unrelated", |k| {
            let draw = |by: i32| f64::from(k.wrapping_mul(by).wrapping_mul(1_103_515_245) >> 8) / 8e6;
            [draw(3), draw(7), draw(11)]
        }),
    ]
}

#[test]
fn nonsense_gives_no_nan_and_no_panic() {
    for (what, signal) in nonsense() {
        for hold in Hold::ALL {
            let mut identifier = published(&Model::cubic_library(), Settings { hold, ..Settings::default() });
            for k in 0..4000 {
                let [q, qd, excitation] = signal(k);
                identifier.step(Sample { t: 1e-3 * f64::from(k), q, qd, excitation }).unwrap();
                let output = identifier.output();
                let numbers = [output.deviation, output.threshold, output.prediction.q, output.prediction.qd];
                let known = identifier.coefficients().iter().flat_map(|known| [known.value, known.std.unwrap_or(0.0)]);
                assert!(numbers.into_iter().chain(known).all(f64::is_finite), "{what}, {hold}, sample {k}: {output:?}");
            }
        }
    }
}
