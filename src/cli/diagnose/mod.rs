//! `switchid diagnose`: which effect a model lacks.

mod found;
mod report;
mod text;

pub(super) use report::{CandidateReport, TimingReport, WindowReport};
pub(super) use text::{answer, candidates, text, verdict};

use super::error::CommandError;
use super::figures;
use super::input::{Input, InputArguments};
use super::output::{self, Targets};
use super::pictures::PictureArguments;
use super::progress::Waiting;
use crate::diagnose::diagnose_stages;
use clap::Args;
use found::Found;

const EXAMPLE: &str = r#"Examples:
  switchid diagnose recording.csv --model model.toml
  switchid diagnose first.csv second.csv@20:60 --model model.toml --hold linear --json

The model's form gets its best coefficients; what it lacks is sought among the effects of the catalogue and the
model's own [effects] that no term names. A record that switches is diagnosed stage by stage. A model without inertia
is a law F = law(q, qd): F is the output.
"missing": an effect that lowers the error on stretches of the record that no coefficient has seen, beyond chance,
with a sign that physics allows. "adequate": what is left is what the sensors alone would leave. "unexplained": more
is left, and no effect of the catalogue passes.
Errors are the RMS weak residual ÷ std of the weak target over windows of 0.1, 0.3 and 1 T0; all three decide."#;

/// Find the physical effect that a model lacks
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    #[command(flatten)]
    input: InputArguments,
    #[command(flatten)]
    picture: PictureArguments,
    /// Overwrite files where they exist
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let mut targets = Targets::new(arguments.input.files()?, arguments.force);
    let picture = arguments.picture.open(&mut targets)?;
    let input = Input::open(&arguments.input.data, &arguments.input.model)?.thinned();
    let found = Waiting::on("diagnosing", || find(&input))?;
    picture.map_or(Ok(()), |picture| picture.draw(&figures::diagnosis(&input, &found.principal)))?;
    if arguments.json {
        output::print_json(&report::Report::of(&found, &input))
    } else {
        output::print(&text(&found, &input))
    }
}

/// The diagnosis of all recordings.
///
/// # Errors
/// Where no law is determined.
pub(super) fn find(input: &Input) -> Result<Found, CommandError> {
    let found = diagnose_stages(&input.model, &input.recordings(), input.hold);
    let (Some(finding), Some(principal)) = (found.finding(), found.principal().cloned()) else {
        return Err(input.undetermined());
    };
    Ok(Found { principal, finding, clock: found.clock, stages: found.stages })
}
