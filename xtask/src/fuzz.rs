//! Random FMI calls on the FMUs' binaries.

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
    for package in BINARIES {
        run(cargo(&["build", "--quiet", "--release", "--package"]).arg(package), CARGO)?;
    }
    let program = ["run", "--quiet", "--release", "--package", "switchid-measure", "--bin", "fuzz", "--"];
    run(cargo(&program).args(arguments), CARGO)
}

/// The part that belongs to the tests.
///
/// # Errors
/// As [`fuzz`].
pub fn bounded() -> Result<(), Error> {
    fuzz(&["--sequences".into(), BOUNDED.into()])
}
