//! What the FMUs' binaries bear: random FMI calls, simulated hours.

use crate::command::{cargo, run};
use crate::error::Error;
use crate::fmu::BINARIES;

const CARGO: &str = "install Rust from https://rustup.rs";

/// Sequences that every run of the tests tries: some seconds.
const BOUNDED: &str = "20000";

/// Builds the binaries and calls them; arguments go to the program (`--help` lists them).
///
/// # Errors
/// What cargo says; sequences that end the process or get what FMI does not have.
pub fn fuzz(arguments: &[String]) -> Result<(), Error> {
    on_binaries("fuzz", arguments)
}

/// Builds the binaries and steps the identifier's for simulated hours, 24 where none are given.
///
/// # Errors
/// What cargo says; a step that fails.
pub fn endurance(arguments: &[String]) -> Result<(), Error> {
    on_binaries("endurance", arguments)
}

fn on_binaries(program: &str, arguments: &[String]) -> Result<(), Error> {
    for package in BINARIES {
        run(cargo(&["build", "--quiet", "--release", "--package"]).arg(package), CARGO)?;
    }
    let run_it = ["run", "--quiet", "--release", "--package", "switchid-measure", "--bin", program, "--"];
    run(cargo(&run_it).args(arguments), CARGO)
}

/// The part that belongs to the tests.
///
/// # Errors
/// As [`fuzz`].
pub fn bounded() -> Result<(), Error> {
    fuzz(&["--sequences".into(), BOUNDED.into()])
}
