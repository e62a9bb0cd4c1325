//! `switchid simulate`: a record with its truth beside it.

use super::error::CommandError;
use super::output::{self, Pairs, Table, Targets};
use crate::data;
use crate::simulate::{Builtin, Excitation, Hidden, Scenario, Stage, record};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

const EXAMPLE: &str = r#"Examples:
  switchid simulate duffing-sine -o record.csv
  switchid simulate van-der-pol-white --seed 7 --noise 0.01 -o record.csv
  switchid simulate my-plant.toml -o record.csv

record.csv has the columns t,q,qd,F; record.truth.json the stages that were simulated.
Built-in: duffing-sine, duffing-white, van-der-pol-sine, van-der-pol-white (five stages each),
duffing-noise, van-der-pol-noise (one stage, the publication's noise cases).

Excitations besides that of the example (angular frequencies in rad/s, sweep time in s):
  { kind = "multisine", from = 1.0, to = 20.0, count = 20, rms = 2.0 }
  { kind = "sweep", from = 1.0, to = 20.0, period = 30.0, rms = 2.0 }

A law without inertia gives F for the q that a machine imposes (dampers, mounts, joints on a testing machine): the
excitation is then q(t) less initial.q, its derivative q̇, and F the output, with its own noise. It must have a velocity:
sine (of the stage at that instant), multisine or sweep.
  terms = ["qd", "q", "coulomb_friction"]
  duration = 20.0
  noise = { q = 1e-5, qd = 1e-4, F = 0.5 }
  excitation = { kind = "multisine", from = 1.0, to = 20.0, count = 10, rms = 0.01, sample_time = 1e-3 }
  [[stage]]
  start = 0.0
  coefficients = [300.0, 2000.0, 15.0]

A scenario file:
  terms = ["qdd", "qd", "q", "q^3"]
  duration = 30.0                     # s
  seed = 1                            # of white excitation and sensor noise
  noise = { q = 0.01, qd = 0.01 }     # std
  initial = { q = 0.5, qd = 0.0 }
  excitation = { kind = "sine" }      # or "none", or { kind = "white_noise", intensity = 3.0 }

  [hidden]                            # effects besides the law's terms, in every stage
  coulomb_friction = 0.3
  dead_zone_stiffness = { coefficient = 2.0, gap = 0.1 }

  [[stage]]
  start = 0.0                         # s
  coefficients = [1.0, 0.3, 4.0, 2.0] # in the order of the terms
  amplitude = 2.0                     # of the sine
  omega = 1.5                         # of the sine, rad/s

  [[stage]]
  start = 15.0
  coefficients = [1.0, 0.6, 4.0, 2.0]
  amplitude = 2.0
  omega = 1.5"#;

/// Make a record of a plant whose law is known, with its truth beside it
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// A scenario file (TOML), or the name of a built-in scenario
    scenario: String,
    /// Where to write the record; its truth goes beside it with the ending .truth.json; - is standard output, without
    /// the truth
    #[arg(short, long, value_name = "DATA")]
    output: PathBuf,
    /// Draw a built-in scenario's stages from this seed; seeds white excitation and sensor noise too
    #[arg(long, allow_negative_numbers = true, value_parser = seed)]
    seed: Option<u64>,
    /// Std of the sensor noise on q and qd, in place of the scenario's
    #[arg(long, value_name = "STD", allow_negative_numbers = true)]
    noise: Option<f64>,
    /// Overwrite files where they exist
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| "a seed is a whole number from 0 on".into())
}

#[derive(Serialize)]
struct Truth {
    scenario: String,
    seed: u64,
    noise: Pairs,
    excitation: Excitation,
    hidden: Hidden,
    switch_times: Vec<f64>,
    stages: Vec<TrueStage>,
}

#[derive(Serialize)]
struct TrueStage {
    start: f64,
    end: f64,
    coefficients: Pairs,
    amplitude: f64,
    omega: f64,
}

#[derive(Serialize)]
struct Report {
    data: String,
    truth: String,
    samples: usize,
    duration: f64,
    stages: usize,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let truth_path = arguments.output.with_extension("truth.json");
    let mut targets = Targets::new(inputs(arguments), arguments.force);
    let target = targets.claim("-o", &arguments.output)?;
    let truth_target = match target.is_stdout() {
        true if arguments.json => return Err(CommandError::TwoDocuments { option: "-o" }),
        true => None,
        false => Some(targets.claim("-o", &truth_path)?),
    };
    let scenario = scenario(arguments)?;
    let readings =
        record(&scenario).map_err(|source| CommandError::Simulate { scenario: arguments.scenario.clone(), source })?;
    let mut table = Table::create(&target, &["t", "q", "qd", "F"])?;
    for reading in &readings {
        table.push(&[reading.t, reading.q, reading.qd, reading.excitation])?;
    }
    table.finish()?;
    match truth_target {
        Some(truth_target) => truth_target.write_json(&truth(&scenario))?,
        None => return Ok(()),
    }
    let report = Report {
        data: arguments.output.display().to_string(),
        truth: truth_path.display().to_string(),
        samples: readings.len(),
        duration: scenario.duration,
        stages: scenario.stages.len(),
    };
    if arguments.json { output::print_json(&report) } else { output::print(&text(&report)) }
}

/// The scenario, where it is a file.
fn inputs(arguments: &Arguments) -> Vec<PathBuf> {
    match Builtin::from_id(&arguments.scenario) {
        Ok(_) => Vec::new(),
        Err(_) => vec![PathBuf::from(&arguments.scenario)],
    }
}

fn text(report: &Report) -> String {
    let Report { data, truth, samples, duration, stages } = report;
    format!("{data}: {samples} samples over {duration} s, {stages} stages\n{truth}: the truth\n")
}

fn scenario(arguments: &Arguments) -> Result<Scenario, CommandError> {
    let named = open(arguments)?;
    match arguments.noise {
        Some(value) if !(value >= 0.0 && value.is_finite()) => {
            Err(CommandError::Option { option: "noise", value, range: "0 or a positive number" })
        }
        Some(std) => Ok(named.with_noise(std)),
        None => Ok(named),
    }
}

fn open(arguments: &Arguments) -> Result<Scenario, CommandError> {
    match (Builtin::from_id(&arguments.scenario), arguments.seed) {
        (Ok(builtin), Some(seed)) => Ok(builtin.random(seed)),
        (Ok(builtin), None) => Ok(builtin.scenario()),
        (Err(source), _) if !Path::new(&arguments.scenario).exists() => {
            Err(CommandError::NoScenario { argument: arguments.scenario.clone(), source })
        }
        (Err(_), seed) => {
            let scenario = data::open_scenario(Path::new(&arguments.scenario))?;
            let seed = seed.unwrap_or(scenario.seed);
            Ok(scenario.with_seed(seed))
        }
    }
}

fn truth(scenario: &Scenario) -> Truth {
    let ends = scenario.stages.iter().skip(1).map(|stage| stage.start).chain([scenario.duration]);
    let stages = scenario.stages.iter().zip(ends).filter(|(stage, _)| stage.start < scenario.duration);
    Truth {
        scenario: scenario.name.clone(),
        seed: scenario.seed,
        noise: Pairs(
            [("q", scenario.noise.q), ("qd", scenario.noise.qd), ("F", scenario.noise.force)]
                .map(|(channel, std)| (channel.into(), std))
                .into(),
        ),
        excitation: scenario.excitation,
        hidden: scenario.hidden.clone(),
        switch_times: scenario.switch_times().into_iter().filter(|t| *t < scenario.duration).collect(),
        stages: stages.map(|(stage, end)| true_stage(scenario, stage, end.min(scenario.duration))).collect(),
    }
}

fn true_stage(scenario: &Scenario, stage: &Stage, end: f64) -> TrueStage {
    let coefficients = scenario.terms.iter().map(|term| term.name()).zip(stage.coefficients.iter().copied());
    TrueStage {
        start: stage.start,
        end,
        coefficients: Pairs(coefficients.collect()),
        amplitude: stage.amplitude,
        omega: stage.omega,
    }
}
