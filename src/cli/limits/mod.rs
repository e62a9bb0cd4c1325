//! `switchid limits`: what any method could reach on a recording.

mod asked;
mod force;
mod report;

use super::error::CommandError;
use super::input::{Input, ModelArguments};
use super::output;
use super::progress::Waiting;
use crate::diagnose::{Evidence, Fit, best_as_given, is_evident};
use crate::identify::{Recording, Settings};
use crate::law::{Given, Hold, ModelError, Term};
use crate::limits::{Bound, Course, Detection, Law, LimitsError, Start, bound, detection, level};
use asked::Asked;
use clap::Args;

const EXAMPLE: &str = r#"Examples:
  switchid limits recording.csv --model model.toml
  switchid limits recording.csv@0:12 --model model.toml --noise q=0.001,qd=0.01 --json
  switchid limits recording.csv --model model.toml --change linear_damping=0.6 --change q^3=4
  switchid limits damper.csv --model damper.toml --noise F=0.5

The limit is the Cramér–Rao bound: no unbiased method errs less, on average over records like this one, under independent Gaussian
sensor noise of the given std. A term that the model gives as a number counts as known; where all are numbers, all are sought.
Of a model without inertia F is the output: its noise counts, and the motion as known.
Everything else comes from a fit: coefficients, the motion, and the sensors' noise where --noise does not name it."#;

/// Say what any method could reach on a recording: std of the coefficients, shortest record, earliest sight of a switch
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// The recording (CSV with a header, MAT or Parquet), or a section of it: DATA@t0:t1 in seconds
    data: String,
    #[command(flatten)]
    model: ModelArguments,
    /// Std of the sensors' noise, SI units: q=0.001,qd=0.01; else estimated
    #[arg(long, value_name = "CHANNEL=STD", value_delimiter = ',')]
    noise: Vec<String>,
    /// A coefficient's value behind a switch, by term or effect id: q^3=4; several make one change
    #[arg(long, value_name = "TERM=VALUE")]
    change: Vec<String>,
    /// Mean time between two false alarms that a detector is allowed
    #[arg(long, value_name = "S", allow_negative_numbers = true, default_value_t = Settings::default().false_alarm_interval)]
    false_alarm_interval: f64,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// What the limits are of, and the limits.
struct Limits<'a> {
    input: &'a Input,
    asked: &'a Asked,
    recording: &'a Recording,
    /// What the excitation did between samples; none where F is what the law gives.
    hold: Option<Hold>,
    law: Law,
    /// Std of the sensors' noise by channel.
    noise: Vec<(&'static str, f64)>,
    /// What the user should know of these limits.
    warnings: Vec<String>,
    /// Whether all coefficients are the model's numbers.
    numbers_only: bool,
    bound: Bound,
    /// Shortest record where the state at its start is known, s; none where F is what the law gives.
    after_switch: Option<f64>,
    /// Log-likelihood ratio at which a change is seen, nats.
    level: f64,
    detection: Option<Detection>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let data = std::slice::from_ref(&arguments.data);
    let input = Input::open(data, &arguments.model)?;
    let asked = Asked::read(arguments, &input.model)?;
    let found = Waiting::on("looking for the limits", || match input.model.is_force_law() {
        true => force::limits(&input, &asked),
        false => limits(&input, &asked),
    })?;
    found.warnings.iter().for_each(|warning| output::complain("warning", warning));
    if arguments.json { output::print_json(&report::Report::of(&found)) } else { output::print(&report::text(&found)) }
}

fn limits<'a>(input: &'a Input, asked: &'a Asked) -> Result<Limits<'a>, CommandError> {
    let refused = |source: LimitsError| CommandError::Limits { model: input.file.clone(), source };
    let massless = |source: ModelError| CommandError::Build { model: input.file.clone(), source: source.into() };
    input.model.check_inertia().map_err(massless)?;
    pointwise(input).map_err(refused)?;
    let recordings = input.held();
    let (recording, hold) = recordings[0];
    let evidence = Evidence::new(&recordings);
    let fit = best_as_given(&input.model, &evidence).ok_or_else(|| input.undetermined())?;
    let numbers_only = input.model.terms.iter().all(|entry| matches!(entry.given, Given::Known(_)));
    let law = law(&fit, numbers_only, recording.channels().excitation).map_err(refused)?;
    let sensors = asked.sensors(recording, &fit.noise)?;
    let pairs = evidence.pieces.iter().zip(&fit.states);
    let courses: Vec<Course> = pairs.map(|(piece, states)| piece.course(states)).collect();
    let bound_of = |start| bound(&law, &courses, sensors, start).map_err(refused);
    let (bound, after_switch) = (bound_of(Start::Unknown)?, bound_of(Start::Known)?.shortest_record);
    let level = level(asked.false_alarm_interval, recording.sample_time());
    // law and sensors have limits, so that what is refused now is the change
    let detection = match asked.change.as_slice() {
        [] => None,
        change => {
            let seen = law.changed(change).and_then(|changed| detection(&law, &changed, &courses, sensors, level));
            Some(seen.map_err(|source| asked.change_refused(&source))?)
        }
    };
    let noise = ["q", "qd"].into_iter().zip(sensors.0).filter_map(|(channel, std)| Some((channel, std?))).collect();
    let warnings = warnings(recording, is_evident(&fit), asked.noise_is_too_small(&sensors, recording));
    let hold = Some(hold);
    Ok(Limits {
        input,
        asked,
        recording,
        hold,
        law,
        noise,
        warnings,
        numbers_only,
        bound,
        after_switch,
        level,
        detection,
    })
}

/// Refuses a model with a term that one instant does not give, before anything is fitted.
fn pointwise(input: &Input) -> Result<(), LimitsError> {
    match input.model.terms.iter().find(|entry| !entry.term.is_pointwise()) {
        Some(entry) => Err(LimitsError::NotPointwise { term: entry.key.clone() }),
        None => Ok(()),
    }
}

/// The fitted law. In free motion the inertia only sets the scale.
fn law(fit: &Fit, numbers_only: bool, forced: bool) -> Result<Law, LimitsError> {
    let pairs: Vec<(Term, f64)> = fit.form.terms.iter().copied().zip(fit.coefficients.iter().copied()).collect();
    let is_sought = |index: &usize| match (numbers_only, fit.form.terms[*index]) {
        (true, Term::Inertia) => forced,
        (true, _) => true,
        (false, _) => fit.form.held[*index].is_none(),
    };
    let sought: Vec<usize> = (0..pairs.len()).filter(is_sought).collect();
    Law::new(&pairs, &sought)
}

/// What is to be said of limits of a law that leaves more than noise, or of sensors without any.
fn warnings(recording: &Recording, leaves_more: bool, is_noiseless: bool) -> Vec<String> {
    let source = recording.source();
    let mut warnings = Vec::new();
    if leaves_more {
        warnings.push(format!(
            "{source}: the law leaves more than sensor noise: it lacks something, or switches within the record \
             (`switchid diagnose` tells); the limits are those of a record that it explained"
        ));
    }
    if is_noiseless {
        warnings.push(format!(
            "{source}: hardly any sensor noise is to be seen, and the limits are small accordingly: \
             name it by --noise q=STD,qd=STD where you know it"
        ));
    }
    warnings
}

impl Limits<'_> {
    /// "maybe" terms that the fit dropped.
    fn dropped(&self) -> Vec<Term> {
        let terms = self.input.model.terms.iter().map(|entry| entry.term);
        terms.filter(|term| !self.law.terms().contains(term)).collect()
    }
}
