//! AddressSanitizer over what is unsafe: readings and writings outside an allocation, after its end, leaks.

use crate::command::{cargo, root, run};
use crate::error::Error;
use crate::fmu::BINARIES;
use std::path::PathBuf;
use std::process::Command;

const CARGO: &str = "install Rust from https://rustup.rs";

/// What the standard library of this target comes with a sanitizer for.
const TARGET: &str = "x86_64-unknown-linux-gnu";

/// Whether this machine is such a one.
const HERE: bool = cfg!(all(target_os = "linux", target_arch = "x86_64"));

/// The slave's tests with the sanitizer in them: some seconds, a part of every run of the tests.
///
/// # Errors
/// What cargo says; what the sanitizer finds.
pub fn slave() -> Result<(), Error> {
    if !HERE {
        eprintln!("nothing is sanitized on this machine, only on {TARGET}");
        return Ok(());
    }
    run(&mut sanitized(&["test", "--quiet", "--package", "switchid-fmu-slave"]), CARGO)
}

/// The same, and random FMI calls on binaries that are sanitized as a whole; arguments go to `fuzz`.
///
/// # Errors
/// As [`slave`].
pub fn sanitize(arguments: &[String]) -> Result<(), Error> {
    slave()?;
    if !HERE {
        return Ok(());
    }
    for package in BINARIES {
        run(&mut sanitized(&["build", "--quiet", "--lib", "--package", package]), CARGO)?;
    }
    let program = ["rustc", "--quiet", "--package", "switchid-measure", "--bin", "fuzz", "--"];
    // the libraries find the sanitizer's functions in the program that loads them
    run(sanitized(&program).args(["-C", "link-arg=-Wl,--export-dynamic"]), CARGO)?;
    let built = directory().join(TARGET).join("debug");
    let mut fuzz = Command::new(built.join("fuzz"));
    fuzz.arg("--libraries").arg(&built).args(arguments).current_dir(root());
    run(fuzz.env("ASAN_OPTIONS", OPTIONS), CARGO)
}

/// A refused allocation is an answer that the tests ask for, and no error.
const OPTIONS: &str = "allocator_may_return_null=1";

fn directory() -> PathBuf {
    root().join("target/sanitized")
}

/// Cargo with the sanitizer switched on, an option that the stable compiler takes only when it is told that it may.
fn sanitized(arguments: &[&str]) -> Command {
    let (chore, rest) = arguments.split_at(1);
    let mut command = cargo(chore);
    command.args(["--target", TARGET, "--target-dir"]).arg(directory()).args(rest);
    command.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=address").env("ASAN_OPTIONS", OPTIONS);
    command
}
