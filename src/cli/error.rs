//! Why a command did not do its work.

use crate::data::DataError;
use crate::fmu::FmuError;
use crate::identify::BuildError;
use crate::simulate::{SimulateError, UnknownBuiltin};
use thiserror::Error;

/// Why a command did not do its work.
#[derive(Debug, Error)]
pub(super) enum CommandError {
    /// A file is at fault.
    #[error(transparent)]
    Data(#[from] DataError),
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
    /// A file cannot be written.
    #[error("{file}: cannot be written: {reason}")]
    Write {
        /// The file, or "standard output".
        file: String,
        /// What the system says.
        reason: String,
    },
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
