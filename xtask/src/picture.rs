//! The README's picture, docs/switching.svg: simulated, identified and drawn anew.

use crate::command::{root, run};
use crate::crosscheck::harness;
use crate::error::Error;
use crate::{fmu, python};
use std::path::Path;
use std::process::Command;

/// Where the record, its truth and the trace are kept.
const FOLDER: &str = "target/picture";
const COMMAND: &str = "target/release/switchid-harness";

/// Simulates the record, identifies its laws with `docs/duffing.toml`, and draws motion, coefficients and alarms.
///
/// # Errors
/// Whatever step fails.
pub fn picture() -> Result<(), Error> {
    let folder = root().join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|source| Error::File {
        action: "create",
        path: folder.clone(),
        source,
    })?;
    let interpreter = python::environment()?;
    fmu::build_command()?;
    let [record, truth, trace] = ["record.csv", "record.truth.json", "trace.csv"].map(|name| folder.join(name));
    switchid(&["simulate", "duffing-sine", "--noise", "0.01", "--force", "-o"], &record, &[])?;
    switchid(&["identify", "--model", "docs/duffing.toml", "--force", "--trace"], &trace, &[&record])?;
    let mut command = harness(&interpreter);
    command.args(["-m", "switchid_harness.picture"]).args([&record, &truth, &trace]).arg("docs/switching.svg");
    run(&mut command, python::NO_PYTHON)
}

fn switchid(arguments: &[&str], output: &Path, rest: &[&Path]) -> Result<(), Error> {
    let mut command = Command::new(root().join(COMMAND));
    command.current_dir(root()).args(arguments).arg(output).args(rest);
    run(&mut command, "run `cargo build --release --package switchid-harness-command`")
}
