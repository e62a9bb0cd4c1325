//! Starting programs: their output goes to the terminal, a failure is an error that shows the command line.

use crate::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The workspace's root directory.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// Cargo itself, started in the workspace's root.
pub fn cargo(arguments: &[&str]) -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root());
    command
}

/// The command line, built in release mode.
///
/// # Errors
/// What [`run`] says.
pub fn built_switchid() -> Result<PathBuf, Error> {
    let mut command = cargo(&["build", "--quiet", "--release", "--package", "switchid", "--bin", "switchid"]);
    run(&mut command, "install Rust from https://rustup.rs")?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    Ok(target.join("release").join(format!("switchid{}", std::env::consts::EXE_SUFFIX)))
}

/// Runs the command to its end.
///
/// # Errors
/// [`Error::Start`] with `remedy`, or [`Error::Failed`].
pub fn run(command: &mut Command, remedy: &'static str) -> Result<(), Error> {
    let status = command.status().map_err(|source| start(command, source, remedy))?;
    if status.success() { Ok(()) } else { Err(Error::Failed { command: line(command), status }) }
}

/// Runs the command with its output kept back; whether it succeeded, and all it wrote.
///
/// # Errors
/// [`Error::Start`] with `remedy`.
pub fn probe(command: &mut Command, remedy: &'static str) -> Result<(bool, String), Error> {
    let output = command.stdin(Stdio::null()).output().map_err(|source| start(command, source, remedy))?;
    let text = [output.stdout, output.stderr].concat();
    Ok((output.status.success(), String::from_utf8_lossy(&text).trim().to_string()))
}

fn start(command: &Command, source: std::io::Error, remedy: &'static str) -> Error {
    Error::Start { program: command.get_program().to_string_lossy().into_owned(), source, remedy }
}

fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}
