//! `switchid identify`: the streaming identifier over a recording.

use super::error::CommandError;
use super::identify_report::Report;
use super::input::is_noiseless;
use super::output;
use super::progress::{Progress, Waiting};
use super::stage_limit::{StageLimit, force_limits, stage_limits};
use super::trace::Trace;
use super::words::percent;
use crate::data::{self, DataError, Opened};
use crate::identify::{self, BuildError, Gap, Identification, Method, Recording, Settings, Stage};
use crate::law::{Hold, Model, Term, Units, unit_of};
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// More gaps than these are told together.
const GAPS_TOLD: usize = 4;

/// Least width of the column of terms.
const TERM: usize = 12;

/// Shortest time that one decimal shows, s.
const SHOWN: f64 = 0.05;

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
    /// The recording (CSV with a header, MAT or Parquet), or a section of it: DATA@t0:t1 in seconds
    data: String,
    /// The model file (TOML)
    #[arg(long, short)]
    model: PathBuf,
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
    /// Write the laws that were vouched for into this file (TOML), to be recognised in other recordings
    #[arg(long, value_name = "FILE")]
    save_laws: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// What the run rested on.
pub(super) struct Run {
    pub(super) opened: Opened,
    pub(super) settings: Settings,
    /// Who chose the hold.
    hold_from: &'static str,
    /// Whether F is what the law gives.
    pub(super) gives_force: bool,
    pub(super) found: Identification,
    /// What any method could reach, stage by stage; none where a stage has no law or no limit.
    limits: Vec<Option<StageLimit>>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    check_targets(arguments)?;
    let model = data::open_model(&arguments.model)?;
    let opened = data::open_recording(&arguments.data, &model)?;
    let (settings, hold_from) = settings(arguments, &model, &opened.recording)?;
    let found = identify(arguments, &model, settings, &opened.recording)?;
    arguments.save_laws.as_deref().map_or(Ok(()), |path| save(path, &found))?;
    let limits = Waiting::on("looking for the limits", || match model.is_force_law() {
        true => force_limits(&model, &found, &opened.recording),
        false => stage_limits(&found, &opened.recording, &settings),
    });
    let gives_force = model.is_force_law();
    let run = Run { opened, settings, hold_from, gives_force, found, limits };
    warnings(&run)
        .iter()
        .chain(&unsaved(arguments, &run.found))
        .for_each(|warning| output::complain("warning", warning));
    if arguments.json { output::print_json(&Report::of(&run)) } else { output::print(&text(&run)) }
}

fn identify(
    arguments: &Arguments,
    model: &Model,
    settings: Settings,
    recording: &Recording,
) -> Result<Identification, CommandError> {
    let known = arguments.known_laws.as_deref().map(data::open_laws).transpose()?.unwrap_or_default();
    let mut progress = Progress::new(recording.count());
    let mut trace = arguments.trace.as_deref().map(|path| Trace::create(path, model)).transpose()?;
    let found = identify::identify_knowing(model, settings, &known, recording, |identifier, index| {
        progress.reached(index);
        if let Some(trace) = &mut trace {
            trace.push(recording.t()[index], identifier);
        }
    });
    progress.finish();
    trace.map_or(Ok(()), Trace::finish)?;
    found.map_err(|source| refused(arguments, source))
}

/// Laws are at fault by their own file's name, all else by the model's.
fn refused(arguments: &Arguments, source: BuildError) -> CommandError {
    match (source, &arguments.known_laws) {
        (BuildError::Laws(source), Some(path)) => {
            CommandError::Data(DataError::Laws { file: path.display().to_string(), source })
        }
        (source, _) => CommandError::Build { model: arguments.model.display().to_string(), source },
    }
}

/// What is written must not be what is read.
fn check_targets(arguments: &Arguments) -> Result<(), CommandError> {
    let mut inputs = output::files_of(std::slice::from_ref(&arguments.data))?;
    inputs.push(arguments.model.clone());
    inputs.extend(arguments.known_laws.clone());
    for (option, path) in [("--trace", &arguments.trace), ("--save-laws", &arguments.save_laws)] {
        path.as_deref().map_or(Ok(()), |path| output::check_target(option, path, &inputs))?;
    }
    Ok(())
}

/// A warning where laws were to be saved, and there is none.
fn unsaved(arguments: &Arguments, found: &Identification) -> Option<String> {
    let path = arguments.save_laws.as_ref().filter(|_| found.known_laws.laws.is_empty())?;
    Some(format!(
        "{}: no law was saved, since none was vouched for: this record is too short or too noisy for the model, or the model's form \
         does not explain it (`switchid compare` tells)",
        path.display()
    ))
}

fn save(path: &Path, found: &Identification) -> Result<(), CommandError> {
    let file = path.display().to_string();
    let text = found.known_laws.to_toml().map_err(|error| CommandError::write(&file, error))?;
    std::fs::write(path, text).map_err(|error| CommandError::write(&file, error))
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

/// One by one where there are few.
fn gap_warnings(source: &str, gaps: &[Gap]) -> Vec<String> {
    let hole = |gap: &Gap| format!("no samples from {} s to {} s", gap.start, gap.end);
    match gaps {
        [first, .., last] if gaps.len() > GAPS_TOLD => vec![format!(
            "{source}: {} gaps, the first with {}, the last with {}: identified anew after each, nothing is carried over \
             them; where samples are missing throughout, resample the recording",
            gaps.len(),
            hole(first),
            hole(last)
        )],
        _ => gaps
            .iter()
            .map(|gap| format!("{source}: {}: identified anew after this gap, nothing is carried over it", hole(gap)))
            .collect(),
    }
}

/// Everything that was left out or taken otherwise than the file says.
fn warnings(run: &Run) -> Vec<String> {
    let recording = &run.opened.recording;
    let source = recording.source();
    let mut warnings = gap_warnings(source, &recording.gaps());
    if !recording.channels().excitation {
        warnings.push(format!("{source}: there is no excitation: taken as free motion, the inertia is fixed to 1"));
    }
    if let Some(first) = run.found.skipped.first() {
        let count = run.found.skipped.len();
        warnings.push(format!("{source}: {count} samples were not used; the first: {first}"));
    }
    if is_noiseless([run.found.noise_q, run.found.noise_qd], recording).contains(&true) {
        warnings.push(format!(
            "{source}: hardly any sensor noise is to be seen: no comparison with what any method could reach"
        ));
    }
    warnings
}

/// Stages with their limits.
pub(super) fn stages(run: &Run) -> impl Iterator<Item = (&Stage, Option<&StageLimit>)> {
    run.found.stages.iter().zip(run.limits.iter().map(Option::as_ref))
}

/// Estimated std of the sensors' noise by channel.
pub(super) fn noise(found: &Identification) -> Vec<(String, f64)> {
    let channels = [("q", found.noise_q), ("qd", found.noise_qd), ("F", found.noise_force)];
    channels.into_iter().filter_map(|(channel, std)| Some((channel.to_string(), std?))).collect()
}

fn text(run: &Run) -> String {
    let mut text = head(run);
    text += "\nstage       start           ±         end    detected  identified   s\n";
    for (index, stage) in run.found.stages.iter().enumerate() {
        let (detected, identified) = (time(stage.detected), time(stage.identified));
        let std = stage.start_std.map_or_else(|| "–".into(), |std| format!("{std:.4}"));
        let _ = writeln!(
            text,
            "{:>5} {:>11.3} {std:>11} {:>11.3} {detected:>11} {identified:>11}",
            index + 1,
            stage.start,
            stage.end
        );
    }
    for (index, (stage, limit)) in stages(run).enumerate() {
        let law = law(stage, limit, run.settings.channels.excitation, &run.opened.units);
        let drifting = if stage.drifting { " (drifting; its last coefficients)" } else { "" };
        let again = again(&run.found.stages[..index], stage);
        let _ = write!(text, "\nstage {}{again}{drifting}: {law}", index + 1);
    }
    text
}

/// ` (law 1 again)` where the law was known when the stage began.
fn again(before: &[Stage], stage: &Stage) -> String {
    let seen = stage.recognised || before.iter().any(|other| other.law_number == stage.law_number);
    stage.law_number.filter(|_| seen).map_or_else(String::new, |number| format!(" (law {number} again)"))
}

fn head(run: &Run) -> String {
    let recording = &run.opened.recording;
    let (first, last) = (recording.sample(0).t, recording.sample(recording.count() - 1).t);
    let mut text = format!("{}: {} samples from {first} s to {last} s\n", recording.source(), recording.count());
    for column in &run.opened.columns {
        let _ = writeln!(text, "  {column}");
    }
    text += &match run.gives_force {
        true => "F is the output: F = law(q, q̇)\n".into(),
        false => format!("between samples: {} ({})\n", run.settings.hold, run.hold_from),
    };
    let noise: Vec<String> = noise(&run.found).iter().map(|(channel, std)| format!("{channel} {std:.3e}")).collect();
    let noise = if noise.is_empty() { "not known".into() } else { noise.join(", ") };
    let _ = writeln!(text, "sensor noise (std): {noise}");
    text
}

/// The law on one line, its coefficients with their std, units and what any method could reach, and what is not known.
fn law(stage: &Stage, limit: Option<&StageLimit>, forced: bool, units: &Units) -> String {
    let unknown = "cannot be determined from these data";
    let mut text = stage.law(forced).unwrap_or_else(|| unknown.into()) + "\n";
    let longest = stage.known().map(|(known, _)| known.term.name().chars().count()).max();
    let width = longest.unwrap_or(0).max(TERM);
    let unit_width = stage.known().map(|(known, _)| unit(known.term, units).chars().count()).max().unwrap_or(0);
    for (known, std) in stage.known() {
        let line = format!(
            "  {:<width$} {:>14.6e} ± {std:.1e} {:<unit_width$}{}",
            known.term.name(),
            known.value,
            unit(known.term, units),
            times_limit(known.term, std, limit)
        );
        text = text + line.trim_end() + "\n";
    }
    let open: Vec<String> = stage
        .coefficients
        .iter()
        .filter(|entry| entry.std.is_none() && entry.needed.is_none())
        .map(|entry| entry.term.name())
        .collect();
    if !open.is_empty() {
        let _ = writeln!(text, "  not known: {}", open.join(", "));
    }
    text += &lacking(stage);
    text += &explained(stage);
    if limit.is_some_and(|limit| !limit.explained()) {
        text += "  the law leaves more than sensor noise: no comparison with what any method could reach\n";
    }
    for combination in &stage.unidentifiable {
        let _ = writeln!(text, "  no data of this stage determine {combination}");
    }
    text
}

/// What share of the force the law explains, and whether it is validated; empty where that is not told.
fn explained(stage: &Stage) -> String {
    let validated = match stage.identified.filter(|_| stage.valid) {
        Some(_) => "",
        None => {
            "; it is not validated: what it leaves is no white noise, or the record too short; the std are those between parts of \
             the record"
        }
    };
    let line = |share: f64| format!("  the law explains {} of the variance of the force{validated}\n", percent(share));
    stage.explained.map_or_else(String::new, line)
}

/// `q^3: not known yet, about 1.4 s more of such motion`, a line for each coefficient that a law to vouch for needs better.
fn lacking(stage: &Stage) -> String {
    let last = stage.lacking().map(|(_, seconds)| seconds).fold(0.0, f64::max);
    let line = |(term, seconds): (Term, f64)| {
        let known = stage.known().any(|(known, _)| known.term == term);
        let what = if known { "not known well yet" } else { "not known yet" };
        format!("  {}: {what}, {} more of such motion\n", term.name(), more(seconds, last))
    };
    stage.lacking().map(line).collect()
}

/// `about 1.4 s`, never 0.0 s: a term that lacks next to nothing waits for the last one, with which the law is known.
fn more(seconds: f64, last: f64) -> String {
    let shown = |seconds: &f64| *seconds >= SHOWN;
    let seconds = Some(seconds).filter(shown).or(Some(last).filter(shown));
    seconds.map_or_else(|| "less than 0.1 s".into(), |seconds| format!("about {seconds:.1} s"))
}

/// `  (1.1 times the limit)`; empty where the limit is not known or the law is not complete.
fn times_limit(term: Term, std: f64, limit: Option<&StageLimit>) -> String {
    let least = limit.filter(|limit| limit.explained()).and_then(|limit| limit.std(term));
    least.map_or_else(String::new, |least| format!("  ({:.2} times the limit)", std / least))
}

fn unit(term: Term, units: &Units) -> String {
    unit_of(term, units).filter(|unit| unit != "1").unwrap_or_default()
}

fn time(t: Option<f64>) -> String {
    t.map_or_else(|| "–".into(), |t| format!("{t:.3}"))
}

#[cfg(test)]
mod tests {
    use super::more;

    #[test]
    fn what_a_term_lacks_is_never_nothing() {
        assert_eq!([more(1.44, 3.0), more(0.01, 3.0)], ["about 1.4 s", "about 3.0 s"]);
        assert_eq!(more(0.01, 0.04), "less than 0.1 s");
    }
}
