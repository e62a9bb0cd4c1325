//! Plant and identifier FMUs in several importers, which must agree.

use crate::command::{root, run};
use crate::error::Error;
use crate::{fmu, python};
use std::process::Command;

/// Builds the FMUs, makes the environment of `harness/importers.txt`, runs every case and prints one table.
///
/// # Errors
/// Whatever step fails; an importer that differs is [`Error::Failed`] after the table was printed.
pub fn importers() -> Result<(), Error> {
    fmu::build()?;
    let interpreter = python::importers()?;
    let mut command = Command::new(interpreter);
    command.current_dir(root()).env("PYTHONPATH", root().join("harness"));
    run(command.args(["-m", "switchid_harness.importers", "--fmus", "target/fmu"]), python::NO_PYTHON)
}
