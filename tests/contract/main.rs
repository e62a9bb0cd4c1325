//! What every identifier must hold, whatever its method, channels, hold and model: it is a function of its samples
//! alone.
//!
//! New equals fresh, a block equals sample by sample, clone-and-go-on and save-restore-and-go-on equal going on, the
//! same samples give the same bytes, no sample whatsoever gives a NaN or a panic, and library, command line and FMU
//! give the same bits.

mod configurations;
mod hostile;
mod running;
mod same_bits;

use configurations::Configuration;
use running::{Bits, bytes, go_on, outputs, restored};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};
use switchid::identify::{Identifier, Recording, Sample, identify_recording};

impl Configuration {
    fn fresh(&self) -> Identifier {
        Identifier::new(&self.model, self.settings).unwrap()
    }
}

/// Outputs after every sample, and the state at the end, of a fresh identifier.
#[derive(Clone)]
struct Reference {
    samples: Vec<Sample>,
    outputs: Vec<Bits>,
    end: Vec<u8>,
}

/// Made once for all tests.
fn reference(configuration: &Configuration) -> Reference {
    static MADE: Mutex<BTreeMap<String, Arc<OnceLock<Reference>>>> = Mutex::new(BTreeMap::new());
    let made = Arc::clone(MADE.lock().unwrap().entry(configuration.name.clone()).or_default());
    made.get_or_init(|| make(configuration)).clone()
}

fn make(configuration: &Configuration) -> Reference {
    let samples = configurations::samples(configuration.settings.channels);
    let mut identifier = configuration.fresh();
    let outputs = go_on(&mut identifier, &samples);
    Reference { samples, outputs, end: bytes(&identifier) }
}

/// Calls `check` for every configuration, on two threads.
fn for_each(check: impl Fn(&Configuration) + Sync) {
    let all = configurations::all();
    let (first, second) = all.split_at(all.len() / 2);
    let check = &check;
    std::thread::scope(|scope| {
        for half in [first, second] {
            scope.spawn(move || half.iter().for_each(check));
        }
    });
}

/// Before the first law, in the first stage, just after the switch.
fn cuts(reference: &Reference) -> [usize; 3] {
    [0.02, 0.5, 0.69].map(|share| (share * reference.samples.len() as f64) as usize)
}

#[test]
fn a_new_one_fed_the_same_samples_gives_the_same_bytes() {
    for_each(|configuration| {
        let (first, mut renewed) = (reference(configuration), configuration.fresh());
        assert_eq!(bytes(&renewed), bytes(&configuration.fresh()), "{}: a new one is not fresh", configuration.name);
        let second = go_on(&mut renewed, &first.samples);
        assert!(first.outputs == second && first.end == bytes(&renewed), "{}", configuration.name);
    });
}

/// Velocity alone is left out: its weak rows know the displacement up to a constant only, and not every motion gives a
/// first law.
#[test]
fn every_configuration_that_measures_displacement_finds_a_law() {
    let silent = Mutex::new(Vec::new());
    for_each(|configuration| {
        if !configuration.settings.channels.q {
            return;
        }
        let reference = reference(configuration);
        if reference.outputs.first() == reference.outputs.last() {
            silent.lock().unwrap().push(configuration.name.clone());
        }
    });
    let silent = silent.into_inner().unwrap();
    assert!(silent.is_empty(), "nothing ever changes in:\n{}", silent.join("\n"));
}

#[test]
fn a_block_equals_sample_by_sample() {
    for_each(|configuration| {
        let reference = reference(configuration);
        let column = |value: fn(&Sample) -> f64, measured: bool| {
            measured.then(|| reference.samples.iter().map(value).collect::<Vec<_>>())
        };
        let channels = configuration.settings.channels;
        let t = reference.samples.iter().map(|sample| sample.t).collect();
        let (q, qd) = (column(|sample| sample.q, channels.q), column(|sample| sample.qd, channels.qd));
        let excitation = column(|sample| sample.excitation, channels.excitation);
        let recording = Recording::new("block", t, q, qd, excitation).unwrap();
        let mut seen = Vec::new();
        let watch = |identifier: &Identifier, _| seen.push(outputs(identifier));
        identify_recording(&configuration.model, configuration.settings, &recording, watch).unwrap();
        assert!(seen == reference.outputs, "{}", configuration.name);
    });
}

#[test]
fn a_clone_and_a_restored_one_go_on_as_the_one_they_come_from() {
    for_each(|configuration| {
        let reference = reference(configuration);
        for cut in cuts(&reference) {
            let (before, after) = reference.samples.split_at(cut);
            let mut identifier = configuration.fresh();
            go_on(&mut identifier, before);
            let saved = bytes(&identifier);
            assert!(bytes(&restored(&saved)) == saved, "{}: saving loses something", configuration.name);
            for (way, mut other) in [("cloned", identifier.clone()), ("restored", restored(&saved))] {
                let same = go_on(&mut other, after) == reference.outputs[cut..] && bytes(&other) == reference.end;
                assert!(same, "{}: {way} at sample {cut} it goes on otherwise", configuration.name);
            }
            assert!(bytes(&identifier) == saved, "{}: a clone disturbs", configuration.name);
        }
    });
}

#[test]
fn the_record_shows_a_first_law_and_a_switch() {
    let configuration = configurations::all().into_iter().next().unwrap();
    let reference = reference(&configuration);
    let at = |cut: usize| {
        let mut identifier = configuration.fresh();
        go_on(&mut identifier, &reference.samples[..cut]);
        *identifier.output()
    };
    assert!(at(cuts(&reference)[1]).valid, "no law in the first stage");
    let end = at(reference.samples.len());
    assert_eq!(end.switch_count, 1);
    assert!((end.switch_time - 8.0).abs() < 0.1, "{}", end.switch_time);
}
