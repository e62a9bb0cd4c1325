//! The command line: one file per command.
//!
//! Human text goes to stdout; `--json` prints exactly one JSON document there instead. Errors and warnings go to stderr. Exit status:
//! 0 done, 1 a gate or a check failed, 2 bad usage or bad input.

mod add;
mod compare;
mod compare_report;
mod diagnose;
mod error;
mod fmu;
mod identify;
mod improve;
mod input;
mod limits;
mod output;
#[cfg(feature = "pictures")]
mod picture;
#[cfg(not(feature = "pictures"))]
#[path = "no_picture.rs"]
mod picture;
mod progress;
mod simulate;
mod stage_limit;
mod trace;
mod words;

use clap::{Parser, Subcommand};
use error::CommandError;
use std::process::ExitCode;

/// Watches a vibrating system, identifies its equation of motion, and notices when the law switches.
#[derive(Parser)]
#[command(name = "switchid", version, about, max_term_width = 110)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Compare(compare::Arguments),
    Diagnose(diagnose::Arguments),
    Add(add::Arguments),
    Improve(improve::Arguments),
    Fmu(fmu::Arguments),
    Identify(identify::Arguments),
    Limits(limits::Arguments),
    Simulate(simulate::Arguments),
}

impl Command {
    fn run(self) -> Result<(), CommandError> {
        match self {
            Command::Compare(arguments) => compare::run(&arguments),
            Command::Diagnose(arguments) => diagnose::run(&arguments),
            Command::Add(arguments) => add::run(&arguments),
            Command::Improve(arguments) => improve::run(&arguments),
            Command::Fmu(arguments) => fmu::run(&arguments),
            Command::Identify(arguments) => identify::run(&arguments),
            Command::Limits(arguments) => limits::run(&arguments),
            Command::Simulate(arguments) => simulate::run(&arguments),
        }
    }
}

/// Reads the process's arguments, runs the command, reports its error.
pub fn run() -> ExitCode {
    match CommandLine::parse().command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::complain("error", &error.to_string());
            ExitCode::from(error.exit_status())
        }
    }
}
