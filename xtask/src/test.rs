//! Every test there is; `.ci/run` calls it.

use crate::command::{cargo, run};
use crate::crosscheck::harness;
use crate::error::Error;
use crate::steps::Steps;
use crate::{binaries, fmu, foreign, libclang, licences, python, readme, sanitize};
use std::path::Path;
use std::process::Command;

const CARGO: &str = "install Rust from https://rustup.rs";
const CHECK: &str = "switchid-fmu-check";

/// Runs every step, also after one failed, and names those that did.
///
/// # Errors
/// [`Error::Steps`]; [`Error::Data`] when real records are missing in CI.
pub fn test() -> Result<(), Error> {
    let mut steps = Steps::new(17);
    steps.check("real records", real_records);
    steps.check("licences of the FMUs' crates", licences::check);
    steps.check("format", || cargo_run(&["fmt", "--all", "--check"]));
    // each has a folder of its own to build in, and none keeps both processors busy
    let fmus = steps.begin("FMUs", fmu::build);
    let sanitized = steps.begin("slave under AddressSanitizer", sanitize::slave);
    steps.check("clippy", || cargo_run(&clippy(&["--workspace", "--exclude", CHECK, "--all-targets"])));
    steps.wait(sanitized);
    steps.wait(fmus);
    let imported = steps.begin("FMUs through the fmi crate", fmi_crate);
    let own = foreign::own_stepper();
    let wine = steps.begin("Windows binary under Wine", || foreign::compare_quickly(&own?));
    steps.check("clippy, heart alone", || cargo_run(&clippy(&["--package", "switchid", "--no-default-features"])));
    steps.check("clippy, command line without formats and pictures", || {
        cargo_run(&clippy(&["--package", "switchid", "--no-default-features", "--features", "cli"]))
    });
    steps.check("documentation", documentation);
    steps.wait(imported);
    steps.check("Rust tests", || {
        cargo_run(&["test", "--release", "--quiet", "--no-fail-fast", "--workspace", "--exclude", CHECK])
    });
    steps.check("random FMI calls", binaries::bounded);
    steps.check("command line of the cross-check", fmu::build_command);
    let interpreter = steps.run("Python environment", python::environment);
    let harness = steps.begin("harness tests", || pytest(&interpreter?));
    steps.check("commands of the documents", readme::commands);
    steps.wait(harness);
    steps.wait(wine);
    steps.finish()
}

fn cargo_run(arguments: &[&str]) -> Result<(), Error> {
    run(&mut cargo(arguments), CARGO)
}

fn clippy<'a>(selection: &[&'a str]) -> Vec<&'a str> {
    [&["clippy", "--release", "--quiet"], selection, &["--", "--deny", "warnings"]].concat()
}

fn documentation() -> Result<(), Error> {
    let arguments = ["doc", "--release", "--quiet", "--no-deps", "--workspace", "--exclude", CHECK];
    run(cargo(&arguments).env("RUSTDOCFLAGS", "--deny warnings"), CARGO)
}

fn fmi_crate() -> Result<(), Error> {
    let mut command = cargo(&["test", "--profile", "tried", "--quiet", "--package", CHECK]);
    libclang::provide(&mut command)?;
    run(&mut command, CARGO)
}

fn pytest(interpreter: &Path) -> Result<(), Error> {
    let mut command: Command = harness(interpreter);
    run(command.args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "harness/tests"]), python::NO_PYTHON)
}

/// Tests on real records are skipped where there are none, which CI must not do.
fn real_records() -> Result<(), Error> {
    let problem = match std::env::var_os("SWITCHID_DATA") {
        None => "SWITCHID_DATA is not set".to_string(),
        Some(directory) => match missing_record(Path::new(&directory)) {
            None => return Ok(()),
            Some(missing) => format!("{missing} is not there"),
        },
    };
    if std::env::var_os("CI").is_some() {
        return Err(Error::Data { text: problem });
    }
    eprintln!("{problem}: tests on real records are skipped");
    Ok(())
}

fn missing_record(directory: &Path) -> Option<String> {
    let files = ["emps/emps_train_tidy.csv", "silverbox/silverbox_tidy.csv", "dropbear/dropbear.csv"];
    let missing = files.into_iter().map(|file| directory.join(file)).find(|path| !path.is_file())?;
    Some(missing.display().to_string())
}
