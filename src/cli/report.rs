//! `switchid report`: all that the other commands say of a recording and a model, on one page.

use super::compare;
use super::diagnose;
use super::error::CommandError;
use super::figures;
use super::identify;
use super::input::{Input, InputArguments};
use super::looked::Looked;
use super::output::Targets;
use super::progress::Waiting;
use super::words::quoted;
use crate::diagnose::Options;
use crate::report::{Block, page};
use clap::Args;
use std::path::PathBuf;

const EXAMPLE: &str = r#"Examples:
  switchid report recording.csv --model model.toml -o report.html
  switchid report first.csv second.csv@20:60 --model model.toml -o report.html --force

One page with everything in it: the recordings as they are, stages and laws, where the model fails, what it lacks, and how
to make the page again. Figures can be zoomed; nothing is loaded from elsewhere."#;

/// Write all that is known of a recording and a model onto one page (HTML)
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    #[command(flatten)]
    input: InputArguments,
    /// Where to write the page
    #[arg(short, long, value_name = "OUT.html")]
    output: PathBuf,
    /// Overwrite files where they exist
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let target = Targets::new(arguments.input.files()?, arguments.force).claim("-o", &arguments.output)?;
    let blocks = Waiting::on("reporting", || blocks(arguments))?;
    target.write(&page(&format!("switchid: {}", arguments.input.data.join(", ")), &blocks))
}

fn blocks(arguments: &Arguments) -> Result<Vec<Block>, CommandError> {
    let InputArguments { data, model } = &arguments.input;
    let input = Input::open(data, model)?.thinned();
    let mut blocks = Vec::new();
    for data in data {
        let looked = Looked::open(data, Some(&model.model), &model.columns)?;
        blocks.push(Block::Figure(figures::recording(&looked)));
        let told = identify::told(data, model)?;
        let right = if looked.opened.recording.channels().excitation { "F" } else { "0" };
        blocks.extend([
            Block::Heading(format!("{data}: the law of its last stage")),
            Block::Law { terms: told.law, right: right.into() },
            Block::Figure(told.figure),
            Block::Verbatim(told.text),
        ]);
    }
    let compared = input.compared(&Options::default());
    blocks.extend([
        Block::Figure(figures::comparison(&compared)),
        Block::Verbatim(compare::text(&compared, &input.model, &input.file, None)),
    ]);
    match diagnose::find(&input) {
        Ok(found) => blocks.extend([
            Block::Figure(figures::diagnosis(&input, &found.principal)),
            Block::Verbatim(diagnose::text(&found, &input)),
        ]),
        Err(error) => blocks.push(Block::Text(error.to_string())),
    }
    blocks.extend([
        Block::Heading("The model".into()),
        Block::Verbatim(input.model.to_toml()),
        Block::Heading("How to make this page again".into()),
        Block::Verbatim(format!("{}\n(switchid {})", again(arguments), env!("CARGO_PKG_VERSION"))),
    ]);
    Ok(blocks)
}

/// The command.
fn again(arguments: &Arguments) -> String {
    let data: Vec<String> = arguments.input.data.iter().map(|data| quoted(data)).collect();
    let model = quoted(&arguments.input.model.model.display().to_string());
    let mut command = format!("switchid report {} --model {model}", data.join(" "));
    if let Some(hold) = &arguments.input.model.hold {
        command += &format!(" --hold {hold}");
    }
    for column in arguments.input.model.columns.named() {
        command += &format!(" --columns {}", quoted(column));
    }
    format!("{command} -o {}", quoted(&arguments.output.display().to_string()))
}
