//! Plant and identifier FMUs stepped together under fmpy, gated, reported.

use crate::command::{root, run};
use crate::error::Error;
use crate::steps::Steps;
use crate::{fmu, python};
use std::path::Path;
use std::process::Command;

/// Builds the FMUs, makes the Python environment and runs the harness with the user's arguments.
///
/// # Errors
/// Whatever step fails; a gate that fails is [`Error::Failed`] after the table was printed.
pub fn crosscheck(arguments: &[String]) -> Result<(), Error> {
    let mut steps = Steps::new(3);
    let interpreter = steps.run("Python environment (target/python)", python::environment)?;
    steps.run("FMUs (target/fmu)", fmu::build)?;
    steps.run("cross-check", || {
        let mut command = harness(&interpreter);
        command.args(["-m", "switchid_harness", "--fmus", "target/fmu", "--out", "target/crosscheck"]).args(arguments);
        run(&mut command, python::NO_PYTHON)
    })
}

/// The environment's interpreter, started in the workspace's root with the harness on its path.
pub fn harness(interpreter: &Path) -> Command {
    let mut command = Command::new(interpreter);
    command.current_dir(root()).env("PYTHONPATH", root().join("harness"));
    command
}
