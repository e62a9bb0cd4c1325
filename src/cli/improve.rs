//! `switchid improve`: effects join the model until nothing is missing that the catalogue has.

use super::diagnose::{self, Answer, CandidateReport};
use super::error::CommandError;
use super::input::{Input, ModelArguments};
use super::output::{self, Pairs, Written};
use super::picture::Picture;
use super::progress::Waiting;
use super::words::{number, percent};
use crate::diagnose::{Evidence, Improvement, Options, Step, compare, improve, improved_model};
use crate::identify::Recording;
use crate::law::Hold;
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLE: &str = r#"Examples:
  switchid improve recording.csv --model model.toml -o better.toml
  switchid improve first.csv second.csv --model model.toml -o better.toml --picture staircase.svg --json

Diagnoses and adds until the law is adequate, or what is left is not in the catalogue. An effect that a later one
makes superfluous is taken out again. The noise floor is the error that a right law would leave. The model itself is
left alone: undoing is going back to its file."#;

/// Diagnose and add effects until the model is adequate, and write it
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// The recordings (CSV with a header, MAT or Parquet), or sections of them: DATA@t0:t1 in seconds
    #[arg(required = true)]
    data: Vec<String>,
    #[command(flatten)]
    model: ModelArguments,
    /// Where to write the new model
    #[arg(short, long, value_name = "MODEL2")]
    output: PathBuf,
    /// Draw the error after each step into this file (SVG)
    #[arg(long, value_name = "OUT.svg")]
    picture: Option<PathBuf>,
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
    candidates: Vec<CandidateReport>,
    answer: [String; 3],
    model: String,
}

#[derive(Serialize)]
struct StepReport {
    effect: Option<String>,
    removed: Vec<String>,
    ties: Vec<Vec<String>>,
    error: f64,
    coefficients: Pairs,
    std: Pairs,
}

/// What the command found.
struct Found {
    steps: Vec<Step>,
    answer: Answer,
    /// Error that a right law would leave, and the length of the windows it is taken over, s.
    floor: f64,
    window: f64,
}

/// With --force the new model may take the old one's place, never a recording's; the picture takes neither's.
fn check_targets(arguments: &Arguments) -> Result<(), CommandError> {
    let mut inputs = output::files_of(&arguments.data)?;
    output::check_target("-o", &arguments.output, &inputs)?;
    inputs.push(arguments.model.model.clone());
    arguments.picture.as_deref().map_or(Ok(()), |path| output::check_target("--picture", path, &inputs))
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    check_targets(arguments)?;
    let written = Written::check(&arguments.output, arguments.force)?;
    let picture = arguments.picture.as_deref().map(|path| Picture::open(path, arguments.force)).transpose()?;
    let input = Input::open(&arguments.data, &arguments.model)?;
    let recordings = input.recordings();
    let found = Waiting::on("improving", || find(&input, &recordings)).ok_or_else(|| input.undetermined())?;
    let last = found.steps.last().ok_or_else(|| input.undetermined())?;
    written.write(&improved_model(&input.model, &last.fit).to_toml())?;
    if let Some(picture) = picture {
        picture.staircase(&stairs(&found), found.floor)?;
    }
    if arguments.json {
        output::print_json(&report(arguments, &found, &input))
    } else {
        output::print(&text(arguments, &found, &input))
    }
}

fn find(input: &Input, recordings: &[(&Recording, Hold)]) -> Option<Found> {
    let Improvement { steps, last } = improve(&input.model, &Evidence::new(recordings))?;
    let best = improved_model(&input.model, &steps.last()?.fit);
    let window = last.window;
    let floor = compare(&best, recordings, &Options { window: Some(window), ..Options::default() });
    let answer = Answer::of(last, recordings);
    Some(Found { steps, answer, floor: floor.given.error.noise_floor, window })
}

fn report(arguments: &Arguments, found: &Found, input: &Input) -> Report {
    let step = |step: &Step| StepReport {
        effect: step.effect.clone(),
        removed: step.removed.clone(),
        ties: step.ties.clone(),
        error: step.error,
        coefficients: Pairs::coefficients(&step.fit),
        std: Pairs::std(&step.fit),
    };
    let diagnosis = &found.answer.diagnosis;
    Report {
        steps: found.steps.iter().map(step).collect(),
        verdict: diagnose::verdict(diagnosis.finding),
        noise_floor: found.floor,
        window: found.window,
        candidates: diagnosis.candidates.iter().map(|candidate| CandidateReport::of(candidate, input)).collect(),
        answer: diagnose::answer(&found.answer, input),
        model: arguments.output.display().to_string(),
    }
}

fn text(arguments: &Arguments, found: &Found, input: &Input) -> String {
    let mut text = diagnose::answer(&found.answer, input).join("\n");
    text += &format!("\n\nerror on held-out data, windows of {:.3} s\n", found.window);
    for (index, step) in found.steps.iter().enumerate() {
        let _ = writeln!(text, "{index:>3}  {:<40} {:>10}", title(step), percent(step.error));
        for group in &step.ties {
            let _ = writeln!(text, "     this record cannot tell {} from {}", group[0], group[1..].join(", "));
        }
    }
    let _ = writeln!(text, "     {:<40} {:>10}", "noise floor", percent(found.floor));
    if let Some(last) = found.steps.last() {
        text += "\nthe law now:\n";
        for (index, (term, value)) in last.fit.form.terms.iter().zip(&last.fit.coefficients).enumerate() {
            let name = last.fit.form.effect_name(*term);
            let _ = writeln!(text, "  {name:<28} {:>26}{}", number(*value, last.fit.std(index)), input.unit(*term));
        }
    }
    text += "\n";
    text += &diagnose::candidates(&found.answer.diagnosis, input);
    text + &format!("\nwritten: {}\n", arguments.output.display())
}

/// `+ coulomb_friction (− linear_damping)`.
fn title(step: &Step) -> String {
    let added = step.effect.as_ref().map_or_else(|| "the model as it came".into(), |effect| format!("+ {effect}"));
    match step.removed.as_slice() {
        [] => added,
        removed => format!("{added} (− {})", removed.join(", ")),
    }
}

fn stairs(found: &Found) -> Vec<(String, f64)> {
    found.steps.iter().map(|step| (title(step), step.error)).collect()
}
