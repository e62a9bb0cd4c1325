//! Chores of the project, and the measuring programs behind the figures of its documents: `cargo xtask --help`.

mod binaries;
mod command;
mod crosscheck;
mod error;
mod files;
mod fmu;
mod foreign;
mod importers;
mod inspect;
mod libclang;
mod licences;
mod platforms;
mod python;
mod readme;
mod real;
mod sanitize;
mod steps;
mod test;

use error::Error;
use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask CHORE

  crosscheck [--seed N] [--quick] [--jobs N]
                     steps plant and identifier FMUs together under fmpy, has the command line find
                     a hidden effect, gates the figures,
                     writes target/crosscheck/report.html and report.json
  test               every test, also those of the measuring programs
  fmu [--platforms]  builds SwitchedIdentifier.fmu, Duffing.fmu, VanDerPol.fmu into target/fmu, for this
                     machine or for Linux (x86-64, ARM) and Windows, and modelDescription.xml at the root
                     and the list of licences anew
  foreign [--quick]  steps the binaries that `fmu --platforms` built, Windows' under Wine and ARM's under QEMU,
                     beside this machine's; quickly: the identifier alone, under Wine, built for it after `fmu`
  fuzz [--sequences N] [--seed S] [--threads N]
                     random FMI calls and changed states on the identifier's and the plants' binaries
  sanitize [--sequences N] [--seed S] [--threads N]
                     tests of the slave's crate and random FMI calls with AddressSanitizer in all of it
  endurance [HOURS]  cost, memory and accuracy of the identifier's FMU over simulated hours
  importers          plant and identifier in fmpy, fmpy.ssp, ecospy, libcosimpy and fmi-sim: equal
                     trajectories
  bench [ARGUMENT..] cost per sample by phase, terms and window; arguments go to the
                     benchmark (--help lists them)
  bench interface    what the FMU's interface costs: starting, a step, its state copied
  figures [SEEDS] [SCENARIO] | --against-limits [FIRST..END] [ROW] [--only TEXT] [--threads N]
                     errors, delays, missed switches and false alarms of the built-in scenarios; beside
                     what any method could reach
  effects [--help]   the benchmark of hidden effects: which a diagnosis finds, at what strength and noise
  faults [--seeds N] [--first SEED] [--only TEXT] [--threads N] [--cells]
                     what faults of sensors, clocks and masters do to `valid`, switches and delays
  large [--rows N]   memory and time of the commands on a recording of five million rows, beside its columns and
                     the identifier alone
  known-laws [SEEDS] how soon laws that return are known
  dropbear FOLDER [PICTURE.svg]
                     a real record that switches and drifts, FOLDER that of dropbear.csv
  study [--help]     the published method, ours and what is possible: measures what is missing in
                     target/study, writes docs/study.md and its pictures
  real [--only NAME].. [--json OUT] [--switchid PATH] [--page]
                     what the command line makes of the real records in $SWITCHID_DATA, beside an
                     independent regression's answers; status 1 where a figure misses its floor.
                     NAME is a record, transfer or silverbox; PATH is a built command line
  picture            draws docs/switching.svg anew: motion, true and identified coefficients, alarms";

/// The crate of the measuring programs.
const MEASURE: &str = "switchid-measure";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match chore(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(if matches!(error, Error::Usage { .. }) { 2 } else { 1 })
        }
    }
}

fn chore(arguments: &[String]) -> Result<(), Error> {
    let (name, rest) = arguments.split_first().ok_or_else(|| Error::Usage { text: "which chore?".into() })?;
    // `cargo xtask effects -- --draws 1` says the same as without the dashes
    let rest = rest.strip_prefix(&["--".to_string()]).unwrap_or(rest);
    match (name.as_str(), rest) {
        ("crosscheck", rest) => crosscheck::crosscheck(rest),
        ("test", []) => test::test(),
        ("fmu", []) => fmu::renew(false),
        ("fmu", [platforms]) if platforms == "--platforms" => fmu::renew(true),
        ("foreign", []) => foreign::compare(),
        ("foreign", [quick]) if quick == "--quick" => foreign::compare_quickly(&foreign::own_stepper()?),
        ("fuzz", rest) => binaries::fuzz(rest),
        ("sanitize", rest) => sanitize::sanitize(rest),
        ("endurance", rest) => binaries::endurance(rest),
        ("importers", []) => importers::importers(),
        ("bench", [interface]) if interface == "interface" => {
            cargo(&["bench", "--package", MEASURE, "--bench", "interface"], &[])
        }
        ("bench", rest) => cargo(&["bench", "--package", MEASURE, "--bench", "step", "--"], rest),
        (program @ ("figures" | "study" | "effects" | "faults" | "known-laws" | "dropbear" | "picture"), rest) => {
            cargo(&["run", "--quiet", "--release", "--package", MEASURE, "--bin", program, "--"], rest)
        }
        ("large", rest) => large(rest),
        ("real", rest) => real::real(rest),
        ("--help" | "-h" | "help", _) => {
            println!("{USAGE}");
            Ok(())
        }
        _ => Err(Error::Usage { text: format!("no such chore: \"{}\"", arguments.join(" ")) }),
    }
}

fn large(arguments: &[String]) -> Result<(), Error> {
    let switchid = command::built_switchid()?.display().to_string();
    let program =
        ["run", "--quiet", "--release", "--package", MEASURE, "--bin", "large", "--", "--switchid", &switchid];
    cargo(&program, arguments)
}

fn cargo(chore: &[&str], arguments: &[String]) -> Result<(), Error> {
    command::run(command::cargo(chore).args(arguments), "install Rust from https://rustup.rs")
}
