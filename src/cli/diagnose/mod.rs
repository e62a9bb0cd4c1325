//! `switchid diagnose`: which effect a model lacks.

mod report;
mod text;

pub(super) use report::CandidateReport;
pub(super) use text::{answer, candidates, verdict};

use super::error::CommandError;
use super::input::{Input, ModelArguments};
use super::output;
use super::progress::Waiting;
use crate::diagnose::{Decision, Dependence, Diagnosis, Evidence, Finding, StageDiagnosis, Visible};
use crate::diagnose::{decide, depends_on, diagnose_stages, visible};
use crate::identify::Recording;
use crate::law::Hold;
use clap::Args;

const EXAMPLE: &str = r#"Examples:
  switchid diagnose recording.csv --model model.toml
  switchid diagnose first.csv second.csv@20:60 --model model.toml --hold linear --json

The model's form gets its best coefficients; what it lacks is sought among the effects of the catalogue and the
model's own [effects] that no term names. A record that switches is diagnosed stage by stage.
"missing": an effect whose gain is significant among all that were tried, with a sign that physics allows.
"adequate": the law explains its record. "unexplained": something is missing that the catalogue does not have.
Errors are the RMS weak residual ÷ RMS weak excitation on stretches of the record that the coefficients have not seen."#;

/// Find the physical effect that a model lacks
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// The recordings (CSV with a header, MAT or Parquet), or sections of them: DATA@t0:t1 in seconds
    #[arg(required = true)]
    data: Vec<String>,
    #[command(flatten)]
    model: ModelArguments,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// A diagnosis with what would decide it further.
pub(super) struct Answer {
    pub(super) diagnosis: Diagnosis,
    pub(super) decision: Option<Decision>,
    pub(super) visible: Option<Visible>,
    pub(super) dependence: Option<Dependence>,
}

impl Answer {
    /// Completes a diagnosis of these recordings.
    pub(super) fn of(diagnosis: Diagnosis, recordings: &[(&Recording, Hold)]) -> Answer {
        let evidence = Evidence::new(recordings);
        let finding = diagnosis.finding;
        let unexplained = (finding == Finding::Unexplained).then(|| depends_on(&diagnosis, &evidence));
        Answer {
            decision: decide(&diagnosis, &evidence),
            visible: (finding == Finding::Adequate).then(|| visible(&diagnosis, &evidence)).flatten(),
            dependence: unexplained.flatten(),
            diagnosis,
        }
    }
}

/// One stage of a recording, and what it lacks; no answer where it is too short for a law.
struct StageAnswer {
    data: String,
    start: f64,
    end: f64,
    answer: Option<Answer>,
}

/// What the command found.
struct Found {
    /// The answer that says most: of all recordings together, or of one stage.
    principal: Answer,
    finding: Finding,
    stages: Vec<StageAnswer>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let input = Input::open(&arguments.data, &arguments.model)?;
    let found = Waiting::on("diagnosing", || find(&input))?;
    if arguments.json {
        output::print_json(&report::Report::of(&found, &input))
    } else {
        output::print(&text::text(&found, &input))
    }
}

fn find(input: &Input) -> Result<Found, CommandError> {
    let recordings = input.recordings();
    let found = diagnose_stages(&input.model, &recordings);
    let (Some(finding), Some(principal)) = (found.finding(), found.principal()) else {
        return Err(input.undetermined());
    };
    let is_principal =
        |stage: &StageDiagnosis| stage.diagnosis.as_ref().is_some_and(|own| std::ptr::eq(own, principal));
    let stage = found.stages.iter().position(is_principal);
    let principal = principal.clone();
    let principal = match stage.map(|index| &found.stages[index]) {
        Some(stage) => Answer::of(principal, &[(&stage.samples, recordings[stage.recording].1)]),
        None => Answer::of(principal, &recordings),
    };
    let stages = found.stages.into_iter().map(|stage| StageAnswer {
        data: stage.samples.source().into(),
        start: stage.start,
        end: stage.end,
        answer: stage.diagnosis.map(|own| Answer::of(own, &[(&stage.samples, recordings[stage.recording].1)])),
    });
    Ok(Found { principal, finding, stages: stages.collect() })
}
