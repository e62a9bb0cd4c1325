//! `switchid compare`: a model against measurements.

use super::compare_report::Report;
use super::error::CommandError;
use super::figures;
use super::input::{Input, InputArguments};
use super::output::{self, Targets};
use super::pictures::PictureArguments;
use super::words::{digits, number, percent, quantity, quoted, with_inner};
use crate::diagnose::{Comparison, Estimate, NOISE_RATIO, Options, Side, Target, Verdict, WindowError};
use crate::identify::Recording;
use crate::law::{Model, equation, unit_of};
use clap::Args;
use std::fmt::Write;

const EXAMPLE: &str = r#"Examples:
  switchid compare recording.csv --model model.toml
  switchid compare first.csv second.csv@20:60 --model model.toml --window 0.3 --json

Two laws stand side by side: the model as given, its numbers held, and the best of its form, every
coefficient fitted. Where the first errs much more, the form is right and the numbers are off.
The force residual is the RMS of what the law leaves over of the force, weighted over windows, ÷ std of
the excitation or the inertia force, whichever is noisier; the noise floor is what it would be were the law
right. Both are those of `diagnose` and `improve`, over windows of 0.3 T₀; --window asks for others."#;

/// Compare a model with measurements: how wrong it is, where, and how wrong it could at best be
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    #[command(flatten)]
    input: InputArguments,
    /// Length of the windows over which the residual force is averaged; else chosen from the motion
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    window: Option<f64>,
    /// Length of the windows of open-loop prediction
    #[arg(long, value_name = "S", allow_negative_numbers = true, default_value_t = Options::default().horizon)]
    horizon: f64,
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
    let options = options(arguments)?;
    let mut targets = Targets::new(arguments.input.files()?, arguments.force);
    let picture = arguments.picture.open(&mut targets)?;
    let input = Input::open(&arguments.input.data, &arguments.input.model)?.thinned();
    fits(options.window, &input)?;
    let found = input.compared(&options);
    picture.map_or(Ok(()), |picture| picture.draw(&figures::comparison(&found)))?;
    if arguments.json {
        output::print_json(&Report::of(&found, &input.model))
    } else {
        output::print(&text(&found, &input.model, &input.file, options.window))
    }
}

/// Whether every record has room for two windows of more than a few samples.
fn fits(window: Option<f64>, input: &Input) -> Result<(), CommandError> {
    let Some(window) = window else { return Ok(()) };
    let recordings = input.recordings();
    let span = |recording: &&Recording| recording.t()[recording.count() - 1] - recording.t()[0];
    let most = recordings.iter().map(|recording| 0.5 * span(recording)).fold(f64::INFINITY, f64::min);
    let least = recordings.iter().map(|recording| 4.0 * recording.sample_time()).fold(0.0, f64::max);
    if (least..=most).contains(&window) { Ok(()) } else { Err(CommandError::Window { window, least, most }) }
}

fn options(arguments: &Arguments) -> Result<Options, CommandError> {
    let positive = |option: &'static str, value: f64| {
        let range = "a positive number of seconds";
        if value > 0.0 && value.is_finite() { Ok(value) } else { Err(CommandError::Option { option, value, range }) }
    };
    let window = arguments.window.map(|window| positive("window", window)).transpose()?;
    Ok(Options { window, horizon: positive("horizon", arguments.horizon)?, ..Options::default() })
}

/// How wrong a law is, and what noise alone would leave.
struct Wrong {
    residual: f64,
    floor: f64,
    /// Length of the windows, s.
    window: f64,
}

impl Wrong {
    /// As the judge has it, whose figures `diagnose` and `improve` tell; over windows that were asked for, or where the
    /// record is too short for a judge, the comparison's own.
    fn of(side: &Side, found: &Comparison, asked: Option<f64>) -> Wrong {
        match side.judged.filter(|_| asked.is_none()) {
            Some(judged) => {
                let WindowError { after, floor, window, .. } = judged.errors[1];
                Wrong { residual: after, floor, window }
            }
            None => Wrong { residual: side.error.force_residual, floor: side.error.noise_floor, window: found.window },
        }
    }

    fn ratio(&self) -> String {
        let ratio = self.residual / self.floor;
        if ratio < 100.0 { format!("{ratio:.2}") } else { digits(ratio, 3) }
    }
}

/// What the command prints; `asked` are the windows that the user wants, s.
pub(super) fn text(found: &Comparison, model: &Model, file: &str, asked: Option<f64>) -> String {
    let wrong = [&found.given, &found.best].map(|side| Wrong::of(side, found, asked));
    let mut text = how_wrong(found, &wrong, asked) + "\nwhere: " + &place(found) + "\n";
    text += &next(found, file);
    text += "\n\n";
    text += &table(found, &wrong);
    text += &numbers(found, model);
    text += &recordings(found);
    text += &fails("where the model as given fails", found, &found.given);
    if found.given.law != found.best.law {
        text += &fails("where the best of this form fails", found, &found.best);
    }
    text
}

/// The second line.
fn place(found: &Comparison) -> String {
    match found.given.fails.first() {
        Some(fail) => found.sentence(fail),
        None if found.given.error.ratio() <= NOISE_RATIO => "nowhere: what is left is noise".into(),
        None => "spread evenly, no time, speed, amplitude or frequency stands out".into(),
    }
}

fn fails(title: &str, found: &Comparison, side: &Side) -> String {
    let lines: String = side.fails.iter().map(|fail| format!("  {}\n", found.sentence(fail))).collect();
    if lines.is_empty() { lines } else { format!("\n{title}:\n{lines}") }
}

/// The first line.
fn how_wrong(found: &Comparison, [given, best]: &[Wrong; 2], asked: Option<f64>) -> String {
    let target = found.given.judged.filter(|_| asked.is_none()).map(|judged| judged.target);
    let against = match (target, found.forced) {
        (Some(Target::Inertia), _) | (None, false) => "inertia force",
        _ => "excitation",
    };
    let [residual, floor] = [given.residual, given.floor].map(percent);
    let mut line = format!("how wrong: {residual} of the {against} is not explained; noise alone would leave {floor}");
    if found.given.law != found.best.law {
        let _ = write!(line, ", the best numbers of this form leave {}", percent(best.residual));
    }
    line
}

/// What to do.
fn next(found: &Comparison, file: &str) -> String {
    let data = found.sources.iter().map(|source| quoted(source)).collect::<Vec<_>>().join(" ");
    let diagnose = format!("`switchid diagnose {data} --model {}`", quoted(file));
    match found.verdict() {
        Verdict::AtNoise => "next: nothing to gain here, the model is down to the noise".into(),
        Verdict::NumbersOff => {
            format!("next: the form is right, the numbers are off: take the best ones ({})", off(found))
        }
        Verdict::NumbersOffAndMore => {
            format!("next: the numbers are off ({}) and more is missing: run {diagnose}", off(found))
        }
        Verdict::FormWrong => {
            format!("next: more than noise is left that no numbers of this form explain: run {diagnose}")
        }
    }
}

/// Coefficients that are off, the most certain one first.
fn off(found: &Comparison) -> String {
    let (given, best) = (&found.given.law, &found.best.law);
    let distance = |index: usize| {
        best.std[index].map_or(0.0, |std| (given.coefficients[index] - best.coefficients[index]).abs() / std)
    };
    let mut indices: Vec<usize> = (0..best.terms.len()).filter(|index| distance(*index) > 3.0).collect();
    indices.sort_by(|a, b| distance(*b).total_cmp(&distance(*a)));
    let change = |index: &usize| {
        let (term, std) = (best.terms[*index], best.std[*index].unwrap_or(0.0));
        let rather = quantity(best.coefficients[*index], std, unit_of(term, &found.units));
        format!("{} {} is rather {rather}", term.name(), number(given.coefficients[*index], 0.0))
    };
    indices.iter().take(3).map(change).collect::<Vec<_>>().join(", ")
}

fn table(found: &Comparison, wrong: &[Wrong; 2]) -> String {
    let sides = [&found.given.error, &found.best.error];
    let mut text = format!("{:<34}{:>14}{:>20}\n", "", "as given", "best of this form");
    let mut line = |name: &str, values: [String; 2]| {
        let _ = writeln!(text, "{name:<34}{:>14}{:>20}", values[0], values[1]);
    };
    let share = |value: Option<f64>| value.map_or_else(|| "–".into(), percent);
    let told = |figure: fn(&Wrong) -> f64| [&wrong[0], &wrong[1]].map(|wrong| percent(figure(wrong)));
    line(&format!("force residual ({:.3} s windows)", wrong[0].window), told(|wrong| wrong.residual));
    line("noise floor", told(|wrong| wrong.floor));
    line("residual ÷ noise floor", [wrong[0].ratio(), wrong[1].ratio()]);
    line(
        "free run, RMSE ÷ std",
        sides.map(|side| side.diverged.map_or(share(side.free_run_nrmse), |t| format!("diverges {t:.2} s"))),
    );
    if sides.iter().any(|side| side.free_run_nrmse_velocity.is_some()) {
        line("  of the velocity", sides.map(|side| share(side.free_run_nrmse_velocity)));
    }
    let rmse = |value: Option<f64>| value.map_or_else(|| "–".into(), |value| digits(value, 3));
    line(
        &format!("open loop over {} s, RMSE{}", found.horizon, predicted(found)),
        sides.map(|side| rmse(side.window_rmse)),
    );
    text
}

/// `, m`: in what the open-loop error is told; q̇'s unit where q is not measured.
fn predicted(found: &Comparison) -> String {
    let of_velocity = found.noise.iter().all(|noise| noise[0] == 0.0);
    let unit = if of_velocity { found.units.velocity() } else { found.units.displacement() };
    unit.filter(|unit| unit.symbol != "1").map_or_else(String::new, |unit| format!(", {}", unit.symbol))
}

fn numbers(found: &Comparison, model: &Model) -> String {
    let (given, best) = (&found.given.law, &found.best.law);
    let pairs: Vec<_> = best
        .terms
        .iter()
        .zip(&best.coefficients)
        .zip(&best.std)
        .map(|((term, value), std)| (*term, *value, *std))
        .collect();
    let mut text = format!("\nbest of this form: {}\n", equation(&pairs, found.forced));
    for (index, entry) in model.terms.iter().enumerate() {
        let unit = || unit_of(entry.term, &found.units);
        let known = |law: &Estimate| match law.std[index] {
            Some(std) => quantity(law.coefficients[index], std, unit()),
            None if law.undetermined.contains(&entry.term) => "not determined".into(),
            None => format!("{} (held)", quantity(law.coefficients[index], 0.0, unit())),
        };
        let _ = writeln!(text, "  {:<28} {:>26} {:>26}", entry.key, known(given), known(best));
        text += &with_inner(best.terms[index], &model.expressions, &found.units);
    }
    text
}

fn recordings(found: &Comparison) -> String {
    if found.sources.len() < 2 {
        return String::new();
    }
    let mut text = String::from("\nby recording: force residual as given, best, noise floor; free run as given\n");
    for (index, source) in found.sources.iter().enumerate() {
        let (given, best) = (&found.given.each[index], &found.best.each[index]);
        let free = given.free_run_nrmse.map_or_else(|| "–".into(), percent);
        let [given, best, floor] = [given.force_residual, best.force_residual, given.noise_floor].map(percent);
        let _ = writeln!(text, "  {given:>10} {best:>10} {floor:>10} {free:>10}  {source}");
    }
    text
}
