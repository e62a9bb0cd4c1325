//! Plant and identifier FMUs stepped together under fmpy, gated, reported.

use crate::command::{root, run};
use crate::error::Error;
use crate::steps::Steps;
use crate::{fmu, python};
use std::path::Path;
use std::process::Command;

/// Builds the FMUs and the command line, makes the Python environment and runs the harness with the user's arguments.
///
/// # Errors
/// [`Error::Usage`] before anything is built; whatever step fails; a gate that fails is [`Error::Failed`] after the
/// table was printed.
pub fn crosscheck(arguments: &[String]) -> Result<(), Error> {
    check(arguments)?;
    let mut steps = Steps::new(4);
    let interpreter = steps.run("Python environment (target/python)", python::environment)?;
    steps.run("FMUs (target/fmu)", fmu::build)?;
    steps.run("command line", fmu::build_command)?;
    steps.run("cross-check", || {
        let mut command = harness(&interpreter);
        command.args(["-m", "switchid_harness", "--fmus", "target/fmu", "--out", "target/crosscheck"]).args(arguments);
        run(&mut command, python::NO_PYTHON)
    })
}

/// Refuses what the harness would refuse, before minutes go into building.
fn check(arguments: &[String]) -> Result<(), Error> {
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let number = || rest.clone().next().is_some_and(|value| value.parse::<u32>().is_ok());
        match argument.as_str() {
            "--quick" => {}
            "--seed" | "--jobs" if number() => {
                rest.next();
            }
            "--seed" | "--jobs" => return Err(Error::Usage { text: format!("{argument} needs a whole number") }),
            _ => return Err(Error::Usage { text: format!("crosscheck knows no \"{argument}\"") }),
        }
    }
    Ok(())
}

/// The environment's interpreter, started in the workspace's root with the harness on its path.
pub fn harness(interpreter: &Path) -> Command {
    let mut command = Command::new(interpreter);
    command.current_dir(root()).env("PYTHONPATH", root().join("harness"));
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(line: &str) -> Option<String> {
        let arguments: Vec<String> = line.split_whitespace().map(String::from).collect();
        check(&arguments).err().map(|error| error.to_string())
    }

    #[test]
    fn wrong_arguments_are_refused_before_anything_is_built() {
        assert_eq!(refused("--seed 12 --quick --jobs 1"), None);
        assert!(refused("--seed --quick").unwrap().contains("--seed needs a whole number"));
        assert!(refused("--seed -3").unwrap().contains("--seed needs"));
        assert!(refused("--sed 3").unwrap().contains("\"--sed\""));
    }
}
