//! The streaming identifier names the effect that its law lacks, and none where it lacks none.

use switchid::identify::{Identifier, Sample, Settings};
use switchid::law::{Catalogue, Given, Model, Term};
use switchid::simulate::{Scenario, record};

/// A linear oscillator under a multisine, with an effect of the catalogue hidden in it.
fn scenario(hidden: &str, seed: u64) -> Scenario {
    let text = format!(
        "terms = ['qdd', 'qd', 'q']\nduration = 30.0\nseed = {seed}\nnoise = {{ q = 1e-3, qd = 1e-3 }}\n\
         excitation = {{ kind = 'multisine', from = 1.0, to = 12.0, count = 30, rms = 5.0, sample_time = 2e-3 }}\n\
         [hidden]\n{hidden}\n[[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.6, 40.0]\n"
    );
    Scenario::from_toml(&text).unwrap()
}

/// The id of the effect named after the whole record.
fn named(hidden: &str, seed: u64) -> Option<&'static str> {
    let model = Model::of("linear", ["qdd", "qd", "q"].map(|term| (Term::parse(term).unwrap(), Given::Fit)));
    let mut identifier = Identifier::new(&model, Settings::default()).unwrap();
    for reading in record(&scenario(hidden, seed)).unwrap() {
        let (q, qd, excitation) = (reading.q, reading.qd, reading.excitation);
        identifier.step(Sample { t: reading.t, q, qd, excitation }).unwrap();
    }
    assert_eq!(identifier.output().switch_count, 0, "{hidden}");
    identifier.output().missing.map(|missing| Catalogue::ENTRIES[missing.entry].id)
}

#[test]
fn a_hidden_effect_is_named() {
    for (hidden, effect) in [
        ("coulomb_friction = 0.6", "coulomb_friction"),
        ("quadratic_damping = 0.4", "quadratic_damping"),
        ("constant_force = 0.5", "constant_force"),
    ] {
        assert_eq!(named(hidden, 7), Some(effect), "{hidden}");
    }
}

#[test]
fn a_complete_law_lacks_nothing() {
    for seed in [1, 2, 3] {
        assert_eq!(named("", seed), None, "seed {seed}");
    }
}
