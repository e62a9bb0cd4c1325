//! `switchid improve`: effects join the model until nothing is missing that the catalogue has.

use super::add::written;
use super::diagnose::{self, CandidateReport, TimingReport, WindowReport};
use super::error::CommandError;
use super::figures;
use super::input::{Input, InputArguments};
use super::output::{self, Pairs, Targets};
use super::pictures::PictureArguments;
use super::progress::Waiting;
use super::words::{numbers, percent};
use crate::diagnose::{Clock, Improvement, Law, Posed, Step, WindowError, improved_model};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLE: &str = r#"Examples:
  switchid improve recording.csv --model model.toml -o better.toml
  switchid improve first.csv second.csv --model model.toml -o better.toml --picture staircase.svg --json

Diagnoses and adds until the law is adequate, or what is left is not in the catalogue. An effect that a later one
makes superfluous is taken out again; nothing is added that makes an error worse. The noise floor is the error that a
right law would leave. --validate shows the same errors on a recording that no coefficient has seen. The model itself
is left alone: undoing is going back to its file."#;

/// Diagnose and add effects until the model is adequate, and write it
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    #[command(flatten)]
    input: InputArguments,
    /// Where to write the new model
    #[arg(short, long, value_name = "MODEL2")]
    output: PathBuf,
    #[command(flatten)]
    picture: PictureArguments,
    /// Recordings that no coefficient has seen, on which every step's law is judged as it is
    #[arg(long, value_name = "DATA2", num_args = 1..)]
    validate: Vec<String>,
    /// Write coefficients as "fit" in place of the values found, but for numbers that MODEL holds: for `identify` and
    /// `fmu`
    #[arg(long)]
    refit: bool,
    /// Overwrite output files where they exist
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    steps: Vec<StepReport>,
    verdict: &'static str,
    noise_floor: f64,
    window: f64,
    period: f64,
    explained: f64,
    left: String,
    timing: TimingReport,
    hold: &'static str,
    candidates: Vec<CandidateReport>,
    answer: Vec<String>,
    model: String,
}

#[derive(Serialize)]
struct StepReport {
    effect: Option<String>,
    ties: Vec<Vec<String>>,
    error: f64,
    errors: Vec<WindowReport>,
    /// Errors of the step's law, its numbers held, on recordings that no coefficient has seen.
    validation: Option<Vec<WindowReport>>,
    coefficients: Pairs,
    std: Pairs,
}

/// What the command found.
struct Found {
    improvement: Improvement,
    /// The last law, sharpened by the likelihood where that holds.
    law: Law,
    /// Errors of every step's law on other recordings.
    validation: Vec<Option<[WindowError; 3]>>,
    clock: Clock,
}

impl Found {
    fn steps(&self) -> &[Step] {
        &self.improvement.steps
    }

    /// What a right law would leave at the principal window length, and that length, s.
    fn floor(&self) -> [f64; 2] {
        let error = self.steps().last().map(|step| step.errors[1]);
        error.map_or([f64::NAN; 2], |error| [error.floor, error.window])
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    // with --force the new model may take the old one's place, never a recording's; the picture takes neither's
    let read = [&arguments.input.data[..], &arguments.validate].concat();
    let mut targets = Targets::new(output::files_of(&read)?, arguments.force);
    let target = targets.claim("-o", &arguments.output)?;
    output::one_document("-o", &target, arguments.json)?;
    targets.protect(&arguments.input.model.model);
    let picture = arguments.picture.open(&mut targets)?;
    let input = Input::open(&arguments.input.data, &arguments.input.model)?.thinned();
    let others = match arguments.validate.is_empty() {
        true => None,
        false => Some(Input::open(&arguments.validate, &arguments.input.model)?),
    };
    let found = Waiting::on("improving", || find(&input, others.as_ref())).ok_or_else(|| input.undetermined())?;
    target.write(&written(&input.model, &found.law, arguments.refit).to_toml())?;
    if let Some(picture) = picture {
        picture.draw(&figures::staircase(&stairs(&found), found.floor()))?;
    }
    if target.is_stdout() {
        Ok(())
    } else if arguments.json {
        output::print_json(&report(arguments, &found, &input))
    } else {
        output::print(&text(arguments, &found, &input))
    }
}

fn find(input: &Input, others: Option<&Input>) -> Option<Found> {
    let recordings = input.recordings();
    let posed = Posed::new(&input.model, &recordings, input.hold)?;
    let improvement = posed.improve()?;
    let last = &improvement.steps.last()?.law;
    let validation = improvement.steps.iter().map(|step| validated(&step.law, input, others));
    Some(Found {
        validation: validation.collect(),
        law: posed.sharpened(last, &recordings),
        clock: posed.clock(last),
        improvement,
    })
}

/// Errors of a law, its numbers held, on other recordings.
fn validated(law: &Law, input: &Input, others: Option<&Input>) -> Option<[WindowError; 3]> {
    let others = others?;
    let posed = Posed::new(&improved_model(&input.model, law), &others.recordings(), Some(law.timing.hold))?;
    Some(posed.errors_of(law)?.0)
}

fn report(arguments: &Arguments, found: &Found, input: &Input) -> Report {
    let step = |(step, validation): (&Step, &Option<[WindowError; 3]>)| StepReport {
        effect: step.effect.clone(),
        ties: step.ties.clone(),
        error: step.error(),
        errors: WindowReport::all(&step.errors, step.law.target),
        validation: validation.map(|errors| WindowReport::all(&errors, step.law.target)),
        coefficients: Pairs::coefficients(&step.law),
        std: Pairs::std(&step.law),
    };
    let diagnosis = &found.improvement.last;
    let [noise_floor, window] = found.floor();
    Report {
        steps: found.steps().iter().zip(&found.validation).map(step).collect(),
        verdict: diagnose::verdict(diagnosis.finding),
        noise_floor,
        window,
        period: diagnosis.period,
        explained: diagnosis.explained,
        left: diagnosis.left.clone(),
        timing: TimingReport::of(&found.clock),
        hold: found.law.timing.hold.id(),
        candidates: CandidateReport::all(diagnosis, input),
        answer: diagnose::answer(diagnosis, Some(&found.clock), input),
        model: arguments.output.display().to_string(),
    }
}

fn text(arguments: &Arguments, found: &Found, input: &Input) -> String {
    let diagnosis = &found.improvement.last;
    let mut text = diagnose::answer(diagnosis, Some(&found.clock), input).join("\n");
    let [floor, window] = found.floor();
    let validated = if found.validation.iter().any(Option::is_some) { "validation" } else { "" };
    let head = format!("error on held-out data, windows of {window:.3} s{validated:>32}");
    text += &format!("\n\n{}\n", head.trim_end());
    for (index, (step, validation)) in found.steps().iter().zip(&found.validation).enumerate() {
        let other = validation.map_or_else(String::new, |errors| percent(errors[1].after));
        let line = format!("{index:>3}  {:<40} {:>10} {other:>12}", title(step), percent(step.error()));
        text = text + line.trim_end() + "\n";
        for group in &step.ties {
            let _ = writeln!(text, "     this record cannot tell {} from {}", group[0], group[1..].join(", "));
        }
    }
    let _ = writeln!(text, "     {:<40} {:>10}", "noise floor", percent(floor));
    text += "\nthe law now:\n";
    let law = &found.law;
    text += &numbers(law, &input.units);
    text += "\n";
    text += &diagnose::candidates(diagnosis, input);
    text + &format!("\nwritten: {}\n", arguments.output.display())
}

/// `+ coulomb_friction`.
fn title(step: &Step) -> String {
    step.effect.as_ref().map_or_else(|| "the model as it came".into(), |effect| format!("+ {effect}"))
}

fn stairs(found: &Found) -> Vec<(String, f64)> {
    found.steps().iter().map(|step| (title(step), step.error())).collect()
}
