//! Every configuration the contract is held against, and the record each of them reads.

use switchid::identify::{Channels, Method, Sample, Settings};
use switchid::law::{Given, Hold, Model, State, Term};
use switchid::simulate::{Builtin, ExcitationKind, Reading, Scenario, Stage, record};

/// Time between two samples of the records, s.
pub const SAMPLE_TIME: f64 = 4e-3;

const METHODS: [Method; 1] = [Method::Default];

const CHANNELS: [(&str, Channels); 4] = [
    ("q, qd, F", Channels::ALL),
    ("q, F", Channels { q: true, qd: false, excitation: true }),
    ("qd, F", Channels { q: false, qd: true, excitation: true }),
    ("q", Channels { q: true, qd: false, excitation: false }),
];

/// An identifier to build, and what to call it where it breaks the contract.
pub struct Configuration {
    pub name: String,
    pub model: Model,
    pub settings: Settings,
}

/// Methods × channels × holds × models.
pub fn all() -> Vec<Configuration> {
    let mut all = Vec::new();
    for method in METHODS {
        for (measured, channels) in CHANNELS {
            for hold in Hold::ALL {
                for model in [duffing(), Model::cubic_library()] {
                    let name = format!("{}, {measured}, {hold}, {}", method.id(), model.name);
                    let settings = Settings { method, channels, hold, sample_time: SAMPLE_TIME, ..Settings::default() };
                    all.push(Configuration { name, model, settings });
                }
            }
        }
    }
    for (measured, channels) in &CHANNELS[..2] {
        let (hold, method) = (Hold::Zero, Method::Default);
        let settings = Settings { method, channels: *channels, hold, sample_time: SAMPLE_TIME, ..Settings::default() };
        all.push(Configuration { name: format!("F is the output, {measured}"), model: force_law(), settings });
    }
    all
}

/// c q̇ + k q + k₃ q³ + 1 = F, of the same record: what it leaves is the inertia's force.
fn force_law() -> Model {
    let terms = ["qd", "q", "q^3", "1"].map(|name| Term::parse(name).unwrap());
    Model::of("force law", terms.into_iter().zip([Given::Fit, Given::Fit, Given::Maybe, Given::Fit]))
}

/// m q̈ + c q̇ + k₁ q + k₃ q³, each "fit".
pub fn duffing() -> Model {
    Model::of("Duffing", Builtin::DuffingSine.terms().into_iter().map(|term: Term| (term, Given::Fit)))
}

/// A Duffing record of 12 s with sensor noise: the law switches at 8 s. Free where no excitation is measured; `absent`
/// stands in every channel that is not measured.
pub fn samples_with(channels: Channels, absent: f64) -> Vec<Sample> {
    let kind = if channels.excitation { ExcitationKind::Sine } else { ExcitationKind::None };
    let or_absent = |measured: bool, value: f64| if measured { value } else { absent };
    let sample = |reading: Reading| Sample {
        t: reading.t,
        q: or_absent(channels.q, reading.q),
        qd: or_absent(channels.qd, reading.qd),
        excitation: or_absent(channels.excitation, reading.excitation),
    };
    record(&switching(kind)).unwrap().into_iter().map(sample).collect()
}

/// The same with 0 in the channels that are not measured.
pub fn samples(channels: Channels) -> Vec<Sample> {
    samples_with(channels, 0.0)
}

fn switching(kind: ExcitationKind) -> Scenario {
    let stage = |start: f64, coefficients: [f64; 4]| Stage {
        start,
        coefficients: coefficients.to_vec(),
        amplitude: 2.0,
        omega: 1.5,
    };
    let stages = vec![stage(0.0, [1.0, 0.1, 4.0, 2.0]), stage(8.0, [1.3, 0.05, 9.0, 1.0])];
    let mut scenario = Scenario::new("switching", Builtin::DuffingSine.terms(), stages, 12.0).with_noise(1e-3);
    scenario.initial = State { q: 1.5, qd: 0.0 };
    scenario.excitation.kind = kind;
    scenario.excitation.sample_time = SAMPLE_TIME;
    scenario
}
