//! `switchid check`: what is to be said of a recording before it is believed.

use super::columns::ColumnArguments;
use super::error::CommandError;
use super::figures;
use super::looked::Looked;
use super::output::{self, Targets};
use super::pictures::PictureArguments;
use super::progress::Waiting;
use super::words::seconds;
use clap::Args;
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLE: &str = r#"Examples:
  switchid check recording.csv
  switchid check "run 5.csv" --columns q="Weg [mm]" --columns t=1000Hz --picture run5.html
  switchid check recording.csv@20:60 --model model.toml --json

No model is needed. Is q̇ the derivative of q (sign, scale, lag, filter)? Are units in proportion? Single wild readings, clipping,
coarse steps, stuck stretches, offsets, uneven sampling, lost samples, too few of them: a line each. Every command that reads a
recording says the same lines as notes."#;

/// Look at a recording before it is believed, and draw it
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// The recording, or a section of it: DATA@t0:t1 in seconds
    data: String,
    /// A model file (TOML) that names columns and units; not needed
    #[arg(long, short)]
    model: Option<PathBuf>,
    #[command(flatten)]
    columns: ColumnArguments,
    #[command(flatten)]
    picture: PictureArguments,
    /// Overwrite files where they exist
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    findings: Vec<FindingReport>,
    samples: usize,
    start: f64,
    end: f64,
    /// Samples per second.
    rate: f64,
    hold: &'static str,
    columns: Vec<String>,
    guessed: Option<String>,
}

#[derive(Serialize)]
struct FindingReport {
    channel: &'static str,
    kind: &'static str,
    sentence: String,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let data = std::slice::from_ref(&arguments.data);
    let mut inputs = output::files_of(data)?;
    inputs.extend(arguments.model.clone());
    let picture = arguments.picture.open(&mut Targets::new(inputs, arguments.force))?;
    let looked =
        Waiting::on("looking", || Looked::open(&arguments.data, arguments.model.as_deref(), &arguments.columns))?;
    picture.map_or(Ok(()), |picture| picture.draw(&figures::recording(&looked)))?;
    if arguments.json { output::print_json(&report(&looked)) } else { output::print(&text(&looked)) }
}

fn report(looked: &Looked) -> Report {
    let t = looked.opened.recording.t();
    let finding = |remark: &crate::diagnose::Remark| FindingReport {
        channel: remark.channel,
        kind: remark.kind,
        sentence: format!("{}: {}", remark.channel, remark.sentence),
    };
    Report {
        findings: looked.remarks.iter().map(finding).collect(),
        samples: t.len(),
        start: t[0],
        end: t[t.len() - 1],
        rate: looked.rate(),
        hold: looked.hold.id(),
        columns: looked.opened.columns.clone(),
        guessed: looked.opened.guessed.clone(),
    }
}

fn text(looked: &Looked) -> String {
    let recording = &looked.opened.recording;
    let t = recording.t();
    let mut text = format!(
        "{}: {} samples from {} s to {} s, {} per second\n",
        recording.source(),
        t.len(),
        seconds(t[0]),
        seconds(t[t.len() - 1]),
        (1e6 * looked.rate()).round() / 1e6
    );
    looked.opened.columns.iter().for_each(|column| text += &format!("  {column}\n"));
    text += &format!("between samples: {} ({})\n", looked.hold, looked.hold_from);
    text.extend(looked.opened.guessed.iter().map(|guessed| format!("{guessed}\n")));
    if looked.remarks.is_empty() {
        return text + "nothing is conspicuous\n";
    }
    for remark in &looked.remarks {
        let _ = writeln!(text, "{}: {}", remark.channel, remark.sentence);
    }
    text
}
