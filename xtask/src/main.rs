//! Chores of the project: `cargo xtask crosscheck | test | fmu | bench`.

mod command;
mod crosscheck;
mod error;
mod fmu;
mod libclang;
mod python;
mod readme;
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
  test               every test
  fmu                builds SwitchedIdentifier.fmu, Duffing.fmu, VanDerPol.fmu into target/fmu,
                     and modelDescription.xml at the root anew
  bench [ARGUMENT..] cost per sample by phase, terms and window; arguments go to the
                     benchmark (--help lists them)";

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
    match (name.as_str(), rest) {
        ("crosscheck", rest) => crosscheck::crosscheck(rest),
        ("test", []) => test::test(),
        ("fmu", []) => fmu::renew(),
        ("bench", rest) => {
            let bench = ["bench", "--package", "switchid", "--bench", "step", "--"];
            command::run(command::cargo(&bench).args(rest), "install Rust from https://rustup.rs")
        }
        ("--help" | "-h" | "help", _) => {
            println!("{USAGE}");
            Ok(())
        }
        _ => Err(Error::Usage { text: format!("no such chore: \"{}\"", arguments.join(" ")) }),
    }
}
