//! `switchid identify`: the streaming identifier over a recording.

mod found;
mod report;
mod text;

use super::columns::ColumnArguments;
use super::course::Course;
use super::error::CommandError;
use super::figures;
use super::input::{ENOUGH, PARTS, is_noiseless};
use super::looked;
use super::output::{self, Target, Targets};
use super::pictures::PictureArguments;
use super::progress::{Progress, Waiting};
use super::stage_limit::{force_limits, stage_limits};
use super::trace::Trace;
use super::words::seconds;
use crate::data::{self, DataError};
use crate::diagnose::Posed;
#[cfg(feature = "pictures")]
use crate::identify::Coefficient;
use crate::identify::{self, BuildError, Gap, Identification, Method, Recording, Settings};
use crate::law::{Hold, Model, ModelTerm};
#[cfg(feature = "pictures")]
use crate::law::{Term, unit_of};
use clap::Args;
use clap::builder::PossibleValuesParser;
use found::Run;
use std::path::PathBuf;

/// More gaps than these are told together.
const GAPS_TOLD: usize = 4;

const EXAMPLE: &str = r#"Examples:
  switchid identify recording.csv --model model.toml
  switchid identify recording.csv@20:60 --model model.toml --hold linear --json
  switchid identify recording.csv --model model.toml --trace trace.csv
  switchid identify monday.csv --model model.toml --save-laws laws.toml
  switchid identify tuesday.csv --model model.toml --known-laws laws.toml

A model file:
  name = "positioning axis"
  [columns]                  # which column is what; without it t, q, qd and F
  t = "time_s"
  q = "position"
  F = "force_N"
  [units]                    # of columns whose header names none; else SI
  q = "mm"
  [terms]                    # m q̈ + c q̇ + k q = F
  inertia = "fit"            # "fit": estimated, stays
  linear_damping = 0.3       # a number: known, held
  "q^3" = "maybe"            # "maybe": evidence decides whether the law has it"#;

/// Identify the stages of a recording and the law of each
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// The recording (text, spreadsheet, MAT, MDF 4 or Parquet), or a section of it: DATA@t0:t1 in seconds
    data: String,
    /// The model file (TOML)
    #[arg(long, short)]
    model: PathBuf,
    #[command(flatten)]
    columns: ColumnArguments,
    /// What the excitation did between samples; else the model says, or the best one is kept
    #[arg(long, value_parser = PossibleValuesParser::new(Hold::ALL.map(Hold::id)))]
    hold: Option<String>,
    /// Which procedure identifies
    #[arg(long, default_value = Method::Default.id(), value_parser = PossibleValuesParser::new(Method::ALL.map(Method::id)))]
    method: String,
    /// Mean time between two false alarms
    #[arg(long, value_name = "S", allow_negative_numbers = true, default_value_t = Settings::default().false_alarm_interval)]
    false_alarm_interval: f64,
    /// Write every output of the identifier after each sample into this CSV file, as the FMU would show them
    #[arg(long, value_name = "OUT.csv")]
    trace: Option<PathBuf>,
    /// Laws to recognise from the first sample on, as --save-laws wrote them
    #[arg(long, value_name = "FILE")]
    known_laws: Option<PathBuf>,
    /// Write the laws that were validated into this file (TOML), to be recognised in other recordings
    #[arg(long, value_name = "FILE")]
    save_laws: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureArguments,
    /// Overwrite files where they exist
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// What a page tells of a run.
#[cfg(feature = "pictures")]
pub(super) struct Told {
    /// The text that the command prints.
    pub(super) text: String,
    /// The picture that it draws.
    pub(super) figure: crate::report::Figure,
    /// Value with std, and symbol, of the last stage's coefficients.
    pub(super) law: Vec<[String; 2]>,
}

/// Identifies a recording with nothing but a model.
///
/// # Errors
/// What [`run`] refuses.
#[cfg(feature = "pictures")]
pub(super) fn told(data: &str, model: &super::input::ModelArguments) -> Result<Told, CommandError> {
    let arguments = Arguments {
        data: data.into(),
        model: model.model.clone(),
        columns: model.columns.clone(),
        hold: model.hold.clone(),
        method: Method::Default.id().into(),
        false_alarm_interval: Settings::default().false_alarm_interval,
        trace: None,
        known_laws: None,
        save_laws: None,
        picture: PictureArguments::default(),
        force: false,
        json: false,
    };
    let (run, course) = run_over(&arguments, None)?;
    let known = run.found.stages.last().map_or_else(Vec::new, |stage| stage.known().collect());
    let told = known.iter().filter(|(coefficient, _)| coefficient.value != 0.0);
    let (inertia, others): (Vec<_>, Vec<_>) = told.partition(|(known, _)| known.term == Term::Inertia);
    let term = |(known, std): &(&Coefficient, f64)| {
        let unit = unit_of(known.term, &run.opened.units);
        [super::words::quantity(known.value, *std, unit), known.term.symbol()]
    };
    let law = inertia.into_iter().chain(others).map(term).collect();
    Ok(Told { text: text::text(&run), figure: figures::stages(&run.opened, &run.found, &course), law })
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let mut targets = Targets::new(inputs(arguments)?, arguments.force);
    let mut claim =
        |option, path: &Option<PathBuf>| path.as_deref().map(|path| targets.claim(option, path)).transpose();
    let trace = claim("--trace", &arguments.trace)?;
    let laws = claim("--save-laws", &arguments.save_laws)?;
    let picture = arguments.picture.open(&mut targets)?;
    let (run, course) = run_over(arguments, trace)?;
    looked::say(&run.opened);
    laws.map_or(Ok(()), |laws| save(&laws, &run.found))?;
    warnings(&run)
        .iter()
        .chain(&unsaved(arguments, &run.found))
        .for_each(|warning| output::complain("warning", warning));
    picture.map_or(Ok(()), |picture| picture.draw(&figures::stages(&run.opened, &run.found, &course)))?;
    if arguments.json { output::print_json(&report::Report::of(&run)) } else { output::print(&text::text(&run)) }
}

/// The run, and how the coefficients went over it.
fn run_over(arguments: &Arguments, trace: Option<Target>) -> Result<(Run, Course), CommandError> {
    let mut model = data::open_model(&arguments.model)?;
    arguments.columns.apply(&mut model)?;
    let opened = data::open_stream(&arguments.data, &model)?;
    let (model, inner) = Waiting::on("fitting inner parameters", || with_inner(arguments, model, &opened.recording));
    let (settings, hold_from) = settings(arguments, &model, &opened.recording)?;
    let mut course = Course::new(opened.recording.came());
    let found = identify(arguments, &model, settings, &opened.recording, trace.as_ref(), &mut course)?;
    let limits = Waiting::on("looking for the limits", || match model.is_force_law() {
        true => force_limits(&model, &found, &opened.recording),
        false => stage_limits(&found, &opened.recording, &settings),
    });
    let gives_force = model.is_force_law();
    let carries_over_gaps = identify::carries_over_gaps(&model, &settings);
    let file = arguments.model.display().to_string();
    Ok((Run { opened, file, settings, hold_from, gives_force, carries_over_gaps, inner, found, limits }, course))
}

/// The model with numbers for the inner parameters that it leaves open, which a stream cannot estimate: those that suit
/// the recording as a whole best, and their names and values.
fn with_inner(arguments: &Arguments, model: Model, recording: &Recording) -> (Model, Vec<(String, f64)>) {
    let is_open = |entry: &ModelTerm| entry.open.contains(&true);
    let closed = |entry: &ModelTerm| ModelTerm { open: vec![false; entry.open.len()], ..entry.clone() };
    let given = Model { terms: model.terms.iter().map(closed).collect(), ..model.clone() };
    if !model.terms.iter().any(is_open) || given.check_streaming().is_err() {
        return (model, Vec::new());
    }
    let hold = arguments.hold.as_deref().and_then(Hold::from_id);
    let parts = recording.spread(ENOUGH, PARTS);
    let Some(posed) = Posed::new(&model.freed(), &[parts.as_ref().unwrap_or(recording)], hold) else {
        return (model, Vec::new());
    };
    let fitted = posed.with_inner(&model);
    let open = fitted.terms.iter().zip(&model.terms).filter(|(_, before)| is_open(before));
    let named = open.flat_map(|(entry, _)| {
        let inner = entry.term.inner_named(&model.expressions).into_iter();
        inner.map(|(name, value)| (format!("{name} of {}", entry.key), value))
    });
    let named = named.collect();
    (fitted, named)
}

fn identify(
    arguments: &Arguments,
    model: &Model,
    settings: Settings,
    recording: &Recording,
    trace: Option<&Target>,
    course: &mut Course,
) -> Result<Identification, CommandError> {
    let known = arguments.known_laws.as_deref().map(data::open_laws).transpose()?.unwrap_or_default();
    let mut progress = Progress::new(recording.came());
    let mut index = 0;
    let mut trace = trace.map(|target| Trace::create(target, model)).transpose()?;
    let found = identify::identify_knowing(model, settings, &known, recording, |identifier, sample| {
        progress.reached(index);
        course.push(sample.t, index, identifier);
        trace.iter_mut().for_each(|trace| trace.push(sample.t, identifier));
        index += 1;
    });
    progress.finish();
    trace.map_or(Ok(()), Trace::finish)?;
    found.map_err(|source| refused(arguments, source))
}

/// Laws are at fault by their own file's name, all else by the model's.
fn refused(arguments: &Arguments, source: BuildError) -> CommandError {
    match (source, &arguments.known_laws) {
        (BuildError::Laws(source), Some(path)) => {
            CommandError::from(DataError::Laws { file: path.display().to_string(), source })
        }
        (source, _) => CommandError::Build { model: arguments.model.display().to_string(), source },
    }
}

/// What is read.
fn inputs(arguments: &Arguments) -> Result<Vec<PathBuf>, CommandError> {
    let mut inputs = output::files_of(std::slice::from_ref(&arguments.data))?;
    inputs.push(arguments.model.clone());
    inputs.extend(arguments.known_laws.clone());
    Ok(inputs)
}

/// A warning where laws were to be saved, and there is none.
fn unsaved(arguments: &Arguments, found: &Identification) -> Option<String> {
    let path = arguments.save_laws.as_ref().filter(|_| found.known_laws.laws.is_empty())?;
    Some(format!(
        "{}: no law was saved, since none was validated: this record is too short or too noisy for the model, or the model's form \
         does not explain it (`switchid compare` tells)",
        path.display()
    ))
}

fn save(target: &Target, found: &Identification) -> Result<(), CommandError> {
    target.write(&found.known_laws.to_toml().map_err(|error| CommandError::write("the laws", error))?)
}

fn settings(
    arguments: &Arguments,
    model: &Model,
    recording: &Recording,
) -> Result<(Settings, &'static str), CommandError> {
    let value = arguments.false_alarm_interval;
    if !(value > 0.0 && value.is_finite()) {
        let range = "a positive number of seconds";
        return Err(CommandError::Option { option: "false-alarm-interval", value, range });
    }
    let method = Method::from_id(&arguments.method).unwrap_or_default();
    let base = Settings { method, false_alarm_interval: value, ..Settings::default() };
    let settings = identify::settings_for(recording, base);
    let (hold, from) = match (arguments.hold.as_deref().and_then(Hold::from_id), model.hold) {
        (Some(hold), _) => (hold, "as asked"),
        (None, Some(hold)) => (hold, "the model's"),
        (None, None) if model.is_force_law() => (settings.hold, "a law that gives F has no between"),
        (None, None) => (identify::choose_hold(model, recording, &settings), "chosen"),
    };
    Ok((Settings { hold, ..settings }, from))
}

/// One by one where there are few; `carried` is whether the laws go on over them.
fn gap_warnings(source: &str, gaps: &[Gap], carried: bool) -> Vec<String> {
    let hole = |gap: &Gap| format!("no samples from {} s to {} s", seconds(gap.start), seconds(gap.end));
    let consequence = match carried {
        true => "nothing is known of the motion there, laws go on after it",
        false => "identified anew after it, nothing is carried over it",
    };
    match gaps {
        [first, .., last] if gaps.len() > GAPS_TOLD => vec![format!(
            "{source}: {} gaps, the first with {}, the last with {}: {consequence}; where samples are missing throughout, \
             resample the recording",
            gaps.len(),
            hole(first),
            hole(last)
        )],
        _ => gaps.iter().map(|gap| format!("{source}: {}: {consequence}", hole(gap))).collect(),
    }
}

/// Everything that was left out or taken otherwise than the file says.
fn warnings(run: &Run) -> Vec<String> {
    let recording = &run.opened.recording;
    let source = recording.source();
    let mut warnings = gap_warnings(source, &recording.silences(), run.carries_over_gaps);
    if !recording.channels().excitation {
        warnings.push(format!("{source}: there is no excitation: taken as free motion, the inertia is fixed to 1"));
    }
    if let Some(first) = run.found.skipped.first() {
        warnings.push(match run.found.skipped.len() {
            1 => format!("{source}: one sample was not used: {first}"),
            count => format!("{source}: {count} samples were not used; the first: {first}"),
        });
    }
    if is_noiseless([run.found.noise.q, run.found.noise.qd], recording).contains(&true) {
        warnings.push(format!(
            "{source}: hardly any sensor noise is to be seen: no comparison with what any method could reach"
        ));
    }
    warnings
}
