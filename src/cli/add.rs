//! `switchid add`: an effect joins the model.

use super::diagnose::WindowReport;
use super::error::CommandError;
use super::input::{Input, ModelArguments};
use super::output::{self, Pairs, Targets};
use super::progress::Waiting;
use super::words::{numbers, percent};
use crate::diagnose::{Addition, Law, Posed, improved_model, refitted_model, same_effect};
use crate::law::{Catalogue, Expression, Model, Term};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLE: &str = r#"Examples:
  switchid add coulomb_friction --model model.toml --data recording.csv -o better.toml
  switchid add tip_drag --model model.toml --data first.csv second.csv -o better.toml --json

EFFECT is an id of the catalogue, a product of powers ("q^2*qd") or one of the model's own [effects]. Its inner
parameters are fitted with all coefficients; the new model holds their numbers. The model itself is left alone."#;

/// Likeness of two names from which one may be meant by the other.
const ALIKE: f64 = 0.85;

/// Add an effect to a model, refit it, and write the new model
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// The effect
    effect: String,
    /// The recordings (text, spreadsheet, MAT, MDF 4 or Parquet), or sections of them: DATA@t0:t1 in seconds
    #[arg(long, required = true, num_args = 1..)]
    data: Vec<String>,
    #[command(flatten)]
    model: ModelArguments,
    /// Where to write the new model
    #[arg(short, long, value_name = "MODEL2")]
    output: PathBuf,
    /// Write coefficients as "fit" in place of the values found, but for numbers that MODEL holds: for `identify` and
    /// `fmu`
    #[arg(long)]
    refit: bool,
    /// Overwrite the output file where it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    effect: String,
    error_before: f64,
    error_after: f64,
    coefficients: Pairs,
    std: Pairs,
    inner: Pairs,
    errors: Vec<WindowReport>,
    hold: &'static str,
    model: String,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    // with --force the new model may take the old one's place, never a recording's
    let mut targets = Targets::new(output::files_of(&arguments.data)?, arguments.force);
    let target = targets.claim("-o", &arguments.output)?;
    output::one_document("-o", &target, arguments.json)?;
    let input = Input::open(&arguments.data, &arguments.model)?.thinned();
    let term = effect(&arguments.effect, &input)?;
    let found = Waiting::on("fitting", || find(&input, term));
    let effect = arguments.effect.clone();
    let found = found.ok_or_else(|| CommandError::NotDetermined { data: input.named(), effect })?;
    target.write(&written(&input.model, &found.after, arguments.refit).to_toml())?;
    if target.is_stdout() {
        Ok(())
    } else if arguments.json {
        output::print_json(&report(arguments, &found))
    } else {
        output::print(&text(arguments, &found, &input))
    }
}

/// The model that is written: with the law's values, or to be fitted anew.
pub(super) fn written(model: &Model, law: &Law, refit: bool) -> Model {
    if refit { refitted_model(model, law) } else { improved_model(model, law) }
}

/// The law with the effect, sharpened by the likelihood where that holds.
fn find(input: &Input, term: Term) -> Option<Addition> {
    let recordings = input.recordings();
    let posed = Posed::new(&input.model, &recordings, input.hold)?;
    let found = posed.add(term)?;
    Some(Addition { after: posed.sharpened(&found.after, &recordings), ..found })
}

/// The term of that name, which the model must not have yet.
fn effect(name: &str, input: &Input) -> Result<Term, CommandError> {
    let entry = input.model.named(name).map_err(|_| unknown(name, &input.model.expressions))?;
    match input.model.terms.iter().find(|own| same_effect(own.term, entry.term)) {
        Some(own) => {
            let (effect, model, key) = (name.into(), input.file.clone(), own.key.clone());
            Err(CommandError::Present { effect, model, key })
        }
        None => Ok(entry.term),
    }
}

/// Why there is no such effect; `expressions` are the model's own.
pub(super) fn unknown(name: &str, expressions: &[Expression]) -> CommandError {
    let own = expressions.iter().map(|expression| expression.name().to_string());
    let known: Vec<String> = Catalogue::ENTRIES.iter().map(|entry| entry.id.to_string()).chain(own).collect();
    let alike = known.iter().map(|other| (strsim::jaro_winkler(name, other), other));
    let mut alike: Vec<(f64, &String)> = alike.filter(|(likeness, _)| *likeness > ALIKE).collect();
    alike.sort_by(|a, b| b.0.total_cmp(&a.0));
    let nearest = alike.into_iter().take(2).map(|(_, other)| other.clone()).collect();
    CommandError::NoEffect { effect: name.into(), nearest, known }
}

fn report(arguments: &Arguments, found: &Addition) -> Report {
    let law = &found.after;
    let error = found.errors[1];
    Report {
        effect: arguments.effect.clone(),
        error_before: error.before,
        error_after: error.after,
        coefficients: Pairs::coefficients(law),
        std: Pairs::std(law),
        inner: Pairs(inner(law)),
        errors: WindowReport::all(&found.errors, law.target),
        hold: law.timing.hold.id(),
        model: arguments.output.display().to_string(),
    }
}

/// The inner parameters of the term that was added.
fn inner(law: &Law) -> Vec<(String, f64)> {
    law.terms.last().map_or_else(Vec::new, |term| term.inner_named(&law.expressions))
}

fn text(arguments: &Arguments, found: &Addition, input: &Input) -> String {
    let law = &found.after;
    let error = found.errors[1];
    let mut text = format!(
        "{}: error on held-out data {} → {} (windows of {:.3} s)\n",
        arguments.effect,
        percent(error.before),
        percent(error.after),
        error.window
    );
    if error.after > error.before {
        text += "it makes the error worse: this record does not speak for it\n";
    }
    if law.coefficients.last().zip(law.std.last()).is_some_and(|(value, std)| value.abs() < *std) {
        text += "its coefficient is within its uncertainty: this record does not show it\n";
    }
    text += &numbers(law, &input.units);
    text + &format!("written: {}\n", arguments.output.display())
}
