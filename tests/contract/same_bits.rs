//! The same samples through the library, the command line and the FMU.

use super::configurations::duffing;
use std::process::Command;
use switchid::fmu::identifier;
use switchid::identify::{Identifier, Outputs, Sample, Settings};
use switchid::law::{Model, Term};
use switchid::simulate::{Builtin, Stage, record};
use switchid_fmu_identifier::functions;
use switchid_fmu_slave::host::{Instance, Request};
use switchid_fmu_slave::{Interface, linked_functions};

/// What each way publishes after the last sample: all coefficients, all stds.
type Published = Vec<f64>;

/// Duffing, 8 s at 1 kHz with sensor noise, a switch after 5 s.
fn samples() -> Vec<Sample> {
    let mut scenario = Builtin::DuffingSine.scenario().with_noise(0.01);
    scenario.duration = 8.0;
    scenario.stages.truncate(1);
    let next = Stage { start: 5.0, coefficients: vec![1.2, 0.6, 6.0, 3.0], ..scenario.stages[0].clone() };
    scenario.stages.push(next);
    let readings = record(&scenario).unwrap();
    readings.iter().map(|r| Sample { t: r.t, q: r.q, qd: r.qd, excitation: r.excitation }).collect()
}

fn terms(model: &Model) -> Vec<Term> {
    model.terms.iter().map(|entry| entry.term).collect()
}

fn through_library(model: &Model, samples: &[Sample]) -> Published {
    let mut identifier = Identifier::new(model, Settings::default()).unwrap();
    samples.iter().for_each(|sample| identifier.step(*sample).unwrap());
    assert_eq!(identifier.output().switch_count, 1, "the record must show a switch");
    let outputs = Outputs::new(&terms(model), &identifier);
    outputs.values(&identifier).take(2 * model.terms.len()).map(|value| value.number()).collect()
}

fn through_command_line(model: &Model, samples: &[Sample]) -> Published {
    let directory = tempfile::tempdir().unwrap();
    let row = |sample: &Sample| format!("{},{},{},{}\n", sample.t, sample.q, sample.qd, sample.excitation);
    let data = std::iter::once("t,q,qd,F\n".to_string()).chain(samples.iter().map(row)).collect::<String>();
    std::fs::write(directory.path().join("data.csv"), data).unwrap();
    std::fs::write(directory.path().join("model.toml"), model.to_toml()).unwrap();
    let arguments = ["identify", "data.csv", "--model", "model.toml", "--hold", "zero", "--trace", "trace.csv"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_switchid"));
    let output = command.args(arguments).current_dir(directory.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let trace = std::fs::read_to_string(directory.path().join("trace.csv")).unwrap();
    let cells = |line: &str| line.split(',').map(String::from).collect::<Vec<_>>();
    let (header, last) = (cells(trace.lines().next().unwrap()), cells(trace.lines().last().unwrap()));
    let at = |name: &String| last[header.iter().position(|column| column == name).unwrap()].parse().unwrap();
    names(model).iter().map(at).collect()
}

fn names(model: &Model) -> Vec<String> {
    Outputs::describe(&terms(model)).into_iter().take(2 * model.terms.len()).map(|output| output.name).collect()
}

fn through_fmu(model: &Model, samples: &[Sample]) -> Published {
    let fmu = identifier("Identifier", model).unwrap();
    let directory = tempfile::tempdir().unwrap();
    for (path, content) in fmu.files() {
        if let Some(name) = path.strip_prefix("resources/") {
            std::fs::write(directory.path().join(name), content).unwrap();
        }
    }
    let text = std::fs::read(directory.path().join("interface.json")).unwrap();
    let interface: Interface = serde_json::from_slice(&text).unwrap();
    let location = directory.path().display().to_string();
    let request = Request { co_simulation: true, guid: fmu.guid(), location: Some(&location), logging: true };
    let instance = Instance::new(linked_functions!(functions), &request).unwrap();
    let reference = |name: &str| interface.description.position(name).unwrap() as u32;
    assert_eq!(instance.initialize(0.0), 0, "{:?}", instance.messages());
    let inputs = ["q", "qd", "F"].map(reference);
    for sample in samples {
        assert_eq!(instance.set_reals(&inputs, &[sample.q, sample.qd, sample.excitation]), 0);
        assert_eq!(instance.step(sample.t, 1e-3), 0, "{:?}", instance.messages());
    }
    let references: Vec<u32> = names(model).iter().map(|name| reference(name)).collect();
    instance.reals(&references).unwrap()
}

fn same_bits(model: &Model) {
    let samples = samples();
    let library = through_library(model, &samples);
    assert_eq!(through_command_line(model, &samples), library, "command line");
    assert_eq!(through_fmu(model, &samples), library, "FMU");
}

#[test]
fn a_model_of_terms_to_fit() {
    same_bits(&duffing());
}

#[test]
fn the_full_library() {
    same_bits(&Model::cubic_library());
}
