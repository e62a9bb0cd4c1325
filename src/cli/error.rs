//! Why a command did not do its work.

use super::words::digits;
use crate::data::DataError;
use crate::fmu::FmuError;
use crate::identify::BuildError;
use crate::limits::LimitsError;
use crate::simulate::{SimulateError, UnknownBuiltin};
use thiserror::Error;

/// Why a command did not do its work.
#[derive(Debug, Error)]
pub(super) enum CommandError {
    /// A file is at fault.
    #[error(transparent)]
    Data(Box<DataError>),
    /// Neither a file nor a built-in scenario.
    #[error("{argument}: there is no such file, and {source}")]
    NoScenario {
        /// The argument.
        argument: String,
        /// The names there are.
        source: UnknownBuiltin,
    },
    /// The scenario cannot be followed.
    #[error("{scenario}: {source}")]
    Simulate {
        /// The scenario's name or file.
        scenario: String,
        /// Why.
        source: SimulateError,
    },
    /// Settings or model are refused.
    #[error("{model}: {source}")]
    Build {
        /// The model's file.
        model: String,
        /// Why.
        source: BuildError,
    },
    /// Free motion of a model without inertia.
    #[error(
        "{data}: there is no excitation, and {model} has no inertia: add inertia = 1.0 to its [terms], or the column of the excitation, \
         so that forces have a scale"
    )]
    NoScale {
        /// The recording.
        data: String,
        /// The model's file.
        model: String,
    },
    /// There is no FMU of the model.
    #[error("{model}: {source}")]
    Fmu {
        /// The model's file.
        model: String,
        /// Why.
        source: FmuError,
    },
    /// The prebuilt binary of an FMU is not there.
    #[error(
        "{folder}: there is no libswitchid_fmu_{kind}.so (or .dll, .dylib): build it with `cargo build --release -p switchid-fmu-{kind}`, or say where it lies with --binaries DIR"
    )]
    NoBinary {
        /// Which one.
        kind: &'static str,
        /// Where it was looked for.
        folder: String,
    },
    /// A file cannot be read.
    #[error("{file}: cannot be read: {reason}")]
    Read {
        /// The file.
        file: String,
        /// What the system says.
        reason: String,
    },
    /// A number of the command line is out of range.
    #[error("--{option} {value} is out of range: it must be {range}")]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A window that no part of a record fills.
    #[error(
        "--window {window} s does not fit this record: it must lie between {} s (four samples) and {} s (half of the record); leave it \
         out to have one chosen",
        digits(*least, 4), digits(*most, 4)
    )]
    Window {
        /// What was asked for, s.
        window: f64,
        /// Four samples, s.
        least: f64,
        /// Half the shortest record, s.
        most: f64,
    },
    /// No law can be fitted.
    #[error(
        "{data}: no law of the form of {model} can be determined: the record is too short or hardly moves, or terms are \
         proportional to each other on it; give a longer record or fewer terms"
    )]
    Undetermined {
        /// The recordings.
        data: String,
        /// The model's file.
        model: String,
    },
    /// An effect that neither the catalogue nor the model has.
    #[error("there is no effect \"{effect}\"{}: write one of {}", did_you_mean(.nearest), .known.join(", "))]
    NoEffect {
        /// What was asked for.
        effect: String,
        /// Names that are spelled much like it.
        nearest: Vec<String>,
        /// All names.
        known: Vec<String>,
    },
    /// An effect that the model has already.
    #[error("{model} has the effect \"{effect}\" already (key \"{key}\"): nothing is added")]
    Present {
        /// The effect.
        effect: String,
        /// The model's file.
        model: String,
        /// Its key there.
        key: String,
    },
    /// An effect whose coefficient no fit with it determines.
    #[error(
        "{data}: this record does not determine \"{effect}\": its force vanishes there or is that of the other terms"
    )]
    NotDetermined {
        /// The recordings.
        data: String,
        /// The effect.
        effect: String,
    },
    /// A law that has no limits.
    #[error("{model}: {source}")]
    Limits {
        /// The model's file.
        model: String,
        /// Why.
        source: LimitsError,
    },
    /// Numbers by name that cannot be read.
    #[error("--{option} {text}: {reason}; write {example}")]
    Named {
        /// The option.
        option: &'static str,
        /// What was written.
        text: String,
        /// What is wrong.
        reason: String,
        /// How it is written.
        example: &'static str,
    },
    /// A file that would be overwritten.
    #[error("{file}: exists already: name another file with {option}, or add --force to overwrite it")]
    Exists {
        /// The option.
        option: &'static str,
        /// The file.
        file: String,
    },
    /// Two options that name one file.
    #[error("{option} {file} is the file of {other} too: name another file")]
    Twice {
        /// The option.
        option: &'static str,
        /// Its file.
        file: String,
        /// The other option.
        other: &'static str,
    },
    /// A picture whose format its file's extension does not tell.
    #[cfg(feature = "pictures")]
    #[error("--picture {file}: the extension says the format: write OUT.svg, OUT.png or OUT.html")]
    PictureKind {
        /// The file.
        file: String,
    },
    /// Two documents on one standard output.
    #[error("{option} - writes to standard output, where --json prints its document: name a file")]
    TwoDocuments {
        /// The option.
        option: &'static str,
    },
    /// A file that the command reads would be overwritten.
    #[error("{option} {file} would overwrite {input}, which this command reads: name another file")]
    Input {
        /// The option.
        option: &'static str,
        /// Its file.
        file: String,
        /// The file that is read.
        input: String,
    },
    /// A picture that this build cannot draw.
    #[cfg(not(feature = "pictures"))]
    #[error("{file}: this build of switchid draws no pictures: build it with the feature \"pictures\" (on by default)")]
    NoPictures {
        /// The file.
        file: String,
    },
    /// A picture that cannot be drawn.
    #[cfg(feature = "pictures")]
    #[error("{file}: cannot be drawn: {reason}")]
    Draw {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
    /// A file cannot be written.
    #[error("{file}: cannot be written: {reason}")]
    Write {
        /// The file, or "standard output".
        file: String,
        /// What the system says.
        reason: String,
    },
}

impl From<DataError> for CommandError {
    fn from(error: DataError) -> CommandError {
        CommandError::Data(Box::new(error))
    }
}

impl CommandError {
    /// 2: everything that can go wrong so far is the user's to mend.
    pub(super) fn exit_status(&self) -> u8 {
        2
    }

    /// A failure to write `file`.
    pub(super) fn write(file: &str, reason: impl ToString) -> CommandError {
        CommandError::Write { file: file.into(), reason: reason.to_string() }
    }
}

fn did_you_mean(nearest: &[String]) -> String {
    if nearest.is_empty() { String::new() } else { format!(" (did you mean {}?)", nearest.join(" or ")) }
}
