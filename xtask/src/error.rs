//! What can go wrong in a chore, and what would mend it.

use std::path::PathBuf;
use thiserror::Error;

/// Why a chore stopped.
#[derive(Debug, Error)]
pub enum Error {
    /// The command line is not understood.
    #[error("{text}\n\n{}", crate::USAGE)]
    Usage {
        /// What is wrong with it.
        text: String,
    },
    /// A program cannot be started.
    #[error("cannot start \"{program}\" ({source}): {remedy}")]
    Start {
        /// The program.
        program: String,
        /// What the operating system said.
        source: std::io::Error,
        /// What would mend it.
        remedy: &'static str,
    },
    /// A program ended with a failure.
    #[error("\"{command}\" failed ({status}); its message stands above")]
    Failed {
        /// The command line.
        command: String,
        /// Its exit status.
        status: std::process::ExitStatus,
    },
    /// A file cannot be read, written or removed.
    #[error("cannot {action} {path}: {source}")]
    File {
        /// What was tried.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// No Python environment can be made.
    #[error(
        "no Python environment can be made with \"{python}\" ({version}): {reason}\n\
         Install what is missing (Debian, Ubuntu: `apt-get install python3 python3-venv`; Fedora: `dnf install python3`) \
         or set PYTHON to another Python from 3.10 on, and run the command again."
    )]
    Environment {
        /// The interpreter that was tried.
        python: String,
        /// What it says its version is.
        version: String,
        /// What failed.
        reason: String,
    },
    /// Packages cannot be installed.
    #[error(
        "the packages of {requirements} cannot be installed: pip's message stands above. They come from PyPI: check the \
         network (behind a proxy set HTTPS_PROXY; for a mirror set PIP_INDEX_URL) and run the command again."
    )]
    Packages {
        /// The file that names them.
        requirements: PathBuf,
    },
    /// The environment has no libclang.
    #[error(
        "no libclang in the Python environment: {reason}\nRemove target/python and run the command again, or set LIBCLANG_PATH"
    )]
    Libclang {
        /// What Python says.
        reason: String,
    },
    /// An FMU cannot be described.
    #[error(transparent)]
    Fmu(#[from] switchid::fmu::FmuError),
    /// An FMU cannot be packed.
    #[error(transparent)]
    Package(#[from] switchid_fmu_package::PackageError),
    /// A document lacks what is tested.
    #[error("{path}: {text}")]
    Document {
        /// The document.
        path: PathBuf,
        /// What it lacks.
        text: &'static str,
    },
    /// Real records are needed and not there.
    #[error(
        "{text}: set SWITCHID_DATA to the directory that holds emps/, silverbox/ and dropbear/; in CI no test may be skipped"
    )]
    Data {
        /// What is missing.
        text: String,
    },
    /// Real records are measured and not there.
    #[error("{text}: set SWITCHID_DATA to the directory that holds emps/, silverbox/ and real/")]
    Records {
        /// What is missing or wrong.
        text: String,
    },
    /// The table of reference answers cannot be read.
    #[error("xtask/src/real/reference.toml: {0}")]
    Reference(#[from] toml::de::Error),
    /// A platform's binary gives other values.
    #[error("{fmu} of {platform} gives other values than that of this machine")]
    Platforms {
        /// The FMU.
        fmu: String,
        /// Its platform.
        platform: &'static str,
    },
    /// A platform's binary is not as it must be.
    #[error("{path} {what}")]
    Binary {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// What was measured cannot be written as JSON.
    #[error("no JSON of what was measured: {0}")]
    Json(#[from] serde_json::Error),
    /// Figures do not reach their floors.
    #[error("{} floors missed: {}", missed.len(), missed.join("; "))]
    Floors {
        /// The figures' names.
        missed: Vec<String>,
    },
    /// Some steps failed.
    #[error("{} of {total} steps failed: {}", failed.len(), failed.join(", "))]
    Steps {
        /// The names of those that failed.
        failed: Vec<String>,
        /// How many there were.
        total: usize,
    },
}
