//! `switchid init`: a model file to begin with, out of a recording.

use super::columns::ColumnArguments;
use super::error::CommandError;
use super::looked::Looked;
use super::output::{self, Targets};
use super::progress::Waiting;
use crate::data::{Section, Taken};
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

const EXAMPLE: &str = r#"Examples:
  switchid init recording.csv -o model.toml
  switchid init "run 5.csv" --columns q="Weg [mm]" > model.toml

Which column is which, its unit, what the excitation does between samples and whether q has an offset are guessed; the
model says why in comments. Then: switchid identify recording.csv --model model.toml"#;

/// Write a commented model file for a recording
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// The recording, or a section of it: DATA@t0:t1 in seconds
    data: String,
    #[command(flatten)]
    columns: ColumnArguments,
    /// Where to write the model; else to standard output
    #[arg(short, long, value_name = "MODEL", default_value = "-")]
    output: PathBuf,
    /// Overwrite the output file where it exists
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let inputs = output::files_of(std::slice::from_ref(&arguments.data))?;
    let target = Targets::new(inputs, arguments.force).claim("-o", &arguments.output)?;
    let looked = Waiting::on("looking", || Looked::open(&arguments.data, None, &arguments.columns))?;
    target.write(&template(&looked, &Section::parse(&arguments.data)?))?;
    for remark in &looked.remarks {
        output::complain("note", &format!("{}: {}: {}", arguments.data, remark.channel, remark.sentence));
    }
    Ok(())
}

/// The model file.
fn template(looked: &Looked, section: &Section) -> String {
    let name = section.path.file_stem().map_or_else(|| "recording".into(), |stem| stem.to_string_lossy().into_owned());
    let mut text = format!("# A model to begin with, for {}.\n", looked.opened.recording.source());
    let _ = writeln!(text, "name = {}", quoted(&name));
    let _ = writeln!(text, "# What the excitation does between samples: \"zero\", \"linear\" or \"band_limited\".");
    let _ = writeln!(text, "hold = \"{}\" # {}", looked.hold.id(), looked.hold_from);
    text += "\n# Which column is which.\n[columns]\n";
    for taken in &looked.opened.taken {
        let _ = writeln!(text, "{} = {} # {}", taken.channel.name(), quoted(&taken.column), why(taken));
    }
    let unknown: Vec<&Taken> = looked.opened.taken.iter().filter(|taken| taken.unit.is_none()).collect();
    if !unknown.is_empty() {
        text += "\n# Units that the header does not tell are taken as SI; name others here.\n# [units]\n";
        unknown.iter().for_each(|taken| text += &format!("# {} = \"{}\"\n", taken.channel.name(), si(taken)));
    }
    text += "\n# m q̈ + c q̇ + k q = F: \"fit\" is estimated, a number held, \"maybe\" left to the evidence.\n";
    text += "# `switchid effects` lists what else a law may have, `switchid diagnose` says what it lacks.\n[terms]\n";
    if looked.opened.recording.channels().excitation {
        text += "inertia = \"fit\"\n";
    } else {
        text += "inertia = 1.0 # free motion: nothing gives forces a scale\n";
    }
    text += "linear_damping = \"fit\"\nlinear_stiffness = \"fit\"\n";
    match looked.remarks.iter().find(|remark| remark.channel == "q" && remark.kind == "offset") {
        Some(remark) => text += &format!("constant_force = \"fit\" # q: {}\n", remark.sentence),
        None => text += "# constant_force = \"maybe\" # where q or F has an offset\n",
    }
    text + "# coulomb_friction = \"maybe\"\n# cubic_stiffness = \"maybe\"\n"
}

fn why(taken: &Taken) -> String {
    let told = match taken.guessed {
        Some(how) => format!("guessed {how}"),
        None => "as it is named".into(),
    };
    let unit = taken.unit.map_or_else(|| "no unit told: SI".into(), |unit| format!("in {}", unit.name));
    format!("{told}; {unit}")
}

fn si(taken: &Taken) -> &'static str {
    match taken.channel.name() {
        "t" => "ms",
        "q" => "mm",
        "qd" => "mm/s",
        _ => "kN",
    }
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.into()).to_string()
}
