//! What the user asked for: noise and changes by name.

use crate::cli::error::CommandError;
use crate::cli::input::{ModelArguments, is_noiseless};
use crate::cli::pictures::PictureArguments;
use crate::estimation::Noise;
use crate::identify::{Recording, Settings};
use crate::law::{Model, ModelError, Term};
use crate::limits::{LimitsError, Sensors};
use clap::Args;

/// Place of F among the channels.
const FORCE: usize = 2;

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
pub(in crate::cli) struct Arguments {
    /// The recording (text, spreadsheet, MAT, MDF 4 or Parquet), or a section of it: DATA@t0:t1 in seconds
    pub(super) data: String,
    #[command(flatten)]
    pub(super) model: ModelArguments,
    /// Std of the sensors' noise, SI units: q=0.001,qd=0.01; else estimated
    #[arg(long, value_name = "CHANNEL=STD", value_delimiter = ',')]
    noise: Vec<String>,
    /// A coefficient's value behind a switch, by term or effect id: q^3=4; several make one change
    #[arg(long, value_name = "TERM=VALUE")]
    change: Vec<String>,
    /// Mean time between two false alarms that a detector is allowed
    #[arg(long, value_name = "S", allow_negative_numbers = true, default_value_t = Settings::default().false_alarm_interval)]
    false_alarm_interval: f64,
    #[command(flatten)]
    pub(super) picture: PictureArguments,
    /// Overwrite files where they exist
    #[arg(long)]
    pub(super) force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(super) json: bool,
}

/// Options, read.
pub(super) struct Asked {
    /// Std of the noise of q, q̇ and F where named.
    noise: [Option<f64>; 3],
    /// New coefficients.
    pub(super) change: Vec<(Term, f64)>,
    /// The same as it was written.
    change_text: String,
    /// Mean time between two false alarms, s.
    pub(super) false_alarm_interval: f64,
}

impl Asked {
    /// Reads the options.
    ///
    /// # Errors
    /// What cannot be read, by option and text.
    pub(super) fn read(arguments: &Arguments, model: &Model) -> Result<Asked, CommandError> {
        let interval = arguments.false_alarm_interval;
        if !(interval > 0.0 && interval.is_finite()) {
            let (option, range) = ("false-alarm-interval", "a positive number of seconds");
            return Err(CommandError::Option { option, value: interval, range });
        }
        let mut noise = [None; 3];
        for text in &arguments.noise {
            let (channel, std) = std_of(text)?;
            if (channel == FORCE) != model.is_force_law() {
                let reason = match model.is_force_law() {
                    true => "the model has no inertia, so that F is its output and the motion counts as known",
                    false => "there is no sensor \"F\" among those of a law of motion, whose F counts as exact",
                };
                return Err(named_error("noise", text, reason));
            }
            noise[channel] = Some(std);
        }
        let change_text = arguments.change.join(" --change ");
        Ok(Asked { noise, change: changes(&arguments.change, model)?, change_text, false_alarm_interval: interval })
    }

    /// Std of the noise of F, where it is named.
    pub(super) fn noise_of_force(&self) -> Option<f64> {
        self.noise[FORCE]
    }

    /// The sensors of a recording: as named, else as estimated.
    ///
    /// # Errors
    /// Noise of a quantity that is not measured.
    pub(super) fn sensors(&self, recording: &Recording, estimated: &Noise) -> Result<Sensors, CommandError> {
        let measured = [recording.channels().q, recording.channels().qd];
        let std = [0, 1].map(|channel| {
            let std = self.noise[channel].unwrap_or_else(|| estimated.sensor[channel].sqrt());
            measured[channel].then_some(std)
        });
        for (channel, name) in ["q", "qd"].into_iter().enumerate() {
            if let (Some(named), false) = (self.noise[channel], measured[channel]) {
                let reason = format!("{} has no {name}", recording.source());
                return Err(named_error("noise", &format!("{name}={named}"), &reason));
            }
        }
        Ok(Sensors(std))
    }

    /// Why a law with the changes is none.
    pub(super) fn change_refused(&self, source: &LimitsError) -> CommandError {
        named_error("change", &self.change_text, &source.to_string())
    }

    /// Whether noise that was not named is estimated as none.
    pub(super) fn noise_is_too_small(&self, sensors: &Sensors, recording: &Recording) -> bool {
        let small = is_noiseless(sensors.0, recording);
        (0..2).any(|channel| self.noise[channel].is_none() && small[channel])
    }
}

/// `q=0.001`: the channel and its std.
fn std_of(text: &str) -> Result<(usize, f64), CommandError> {
    let refuse = |reason: &str| named_error("noise", text, reason);
    let (name, value) = text.split_once('=').ok_or_else(|| refuse("there is no \"=\""))?;
    let channel = ["q", "qd", "F"].iter().position(|channel| *channel == name.trim());
    let channel = channel.ok_or_else(|| refuse(&format!("there is no sensor \"{}\"", name.trim())))?;
    let std = value.trim().parse().ok().filter(|std: &f64| *std > 0.0 && std.is_finite());
    Ok((channel, std.ok_or_else(|| refuse("the std must be a positive number"))?))
}

/// Every change, each of another term.
fn changes(texts: &[String], model: &Model) -> Result<Vec<(Term, f64)>, CommandError> {
    let mut changes: Vec<(Term, f64)> = Vec::new();
    for text in texts {
        let (term, value) = change(text, model)?;
        if changes.iter().any(|(other, _)| *other == term) {
            let reason = format!("{} is given twice: keep one of them", term.name());
            return Err(named_error("change", text, &reason));
        }
        changes.push((term, value));
    }
    Ok(changes)
}

/// `q^3=4`: the term and its new coefficient.
fn change(text: &str, model: &Model) -> Result<(Term, f64), CommandError> {
    let refuse = |reason: &str| named_error("change", text, reason);
    let (name, value) = text.rsplit_once('=').ok_or_else(|| refuse("there is no \"=\""))?;
    let value = value.trim().parse().ok().filter(|value: &f64| value.is_finite());
    let value = value.ok_or_else(|| refuse("the new coefficient must be a number"))?;
    let term = match model.named(name.trim()) {
        Ok(entry) => entry.term,
        Err(ModelError::Term { source }) => return Err(refuse(&source.to_string())),
        Err(source) => return Err(refuse(&source.to_string())),
    };
    let own = model.terms.iter().find(|entry| entry.key == name.trim() || entry.term.name() == term.name());
    match own {
        Some(entry) => Ok((entry.term, value)),
        None if !term.is_pointwise() => {
            Err(refuse(&format!("{} depends on more than q, q̇ and F of one instant: it has no limits", quoted(term))))
        }
        None if model.inner_names(term).is_empty() => Ok((term, value)),
        None => {
            let inner = model.inner_names(term).join(", ");
            Err(refuse(&format!("{term} has inner parameters ({inner}): give the model this term with the number 0")))
        }
    }
}

fn quoted(term: Term) -> String {
    format!("\"{}\"", term.name())
}

fn named_error(option: &'static str, text: &str, reason: &str) -> CommandError {
    let example = match option {
        "noise" => {
            "--noise q=0.001,qd=0.01 with the std of what is measured, --noise F=0.5 for a model without inertia"
        }
        _ => "--change TERM=VALUE, as in --change linear_damping=0.6 or --change q^3=4",
    };
    CommandError::Named { option, text: text.into(), reason: reason.into(), example }
}
