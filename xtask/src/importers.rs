//! Plant and identifier FMUs in several importers, which must agree.

use crate::command::{cargo, root, run};
use crate::error::Error;
use crate::{fmu, libclang, python};
use std::path::PathBuf;
use std::process::Command;

/// The program of the `fmi` crate, at the version that was tried.
const FMI_SIM: [&str; 4] = ["install", "fmi-sim", "--version", "0.7.0"];

/// Builds the FMUs, makes the environment of `harness/importers.txt`, runs every case and prints one table.
///
/// # Errors
/// Whatever step fails; an importer that differs is [`Error::Failed`] after the table was printed.
pub fn importers() -> Result<(), Error> {
    fmu::build()?;
    let interpreter = python::importers()?;
    let mut command = Command::new(interpreter);
    command.current_dir(root()).env("PYTHONPATH", root().join("harness")).env("SWITCHID_FMI_SIM", fmi_sim()?);
    run(command.args(["-m", "switchid_harness.importers", "--fmus", "target/fmu"]), python::NO_PYTHON)
}

/// fmi-sim, built once, in some minutes.
fn fmi_sim() -> Result<PathBuf, Error> {
    let folder = root().join("target/fmi-sim");
    let program = folder.join("bin/fmi-sim");
    if !program.exists() {
        let mut install = cargo(&FMI_SIM);
        install.args(["--quiet", "--locked", "--root"]).arg(&folder).arg("--target-dir").arg(folder.join("build"));
        libclang::provide(&mut install)?;
        run(&mut install, "install Rust from https://rustup.rs")?;
        std::fs::remove_dir_all(folder.join("build")).map_err(crate::files::file("remove", &folder))?;
    }
    Ok(program)
}
