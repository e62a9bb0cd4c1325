//! The command line: one file per command.
//!
//! Human text goes to stdout; `--json` prints exactly one JSON document there instead. Errors and warnings go to
//! stderr. Exit status: 0 done, 1 a gate or a check failed, 2 bad usage or bad input.

mod add;
mod check;
mod columns;
mod compare;
mod compare_report;
mod course;
mod diagnose;
mod effects;
mod error;
mod failing;
mod figures;
mod fmu;
mod identify;
mod improve;
mod init;
mod input;
mod limits;
mod looked;
mod manual;
mod output;
mod pictures;
mod progress;
#[cfg(feature = "pictures")]
mod report;
mod simulate;
mod stage_limit;
mod trace;
mod words;

use clap::{CommandFactory, Parser, Subcommand};
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
    Check(check::Arguments),
    Init(init::Arguments),
    Compare(compare::Arguments),
    Diagnose(diagnose::Arguments),
    Add(add::Arguments),
    Improve(improve::Arguments),
    #[cfg(feature = "pictures")]
    Report(report::Arguments),
    Fmu(fmu::Arguments),
    Identify(identify::Arguments),
    Limits(limits::Arguments),
    Simulate(simulate::Arguments),
    Effects(effects::Arguments),
    Completions(manual::CompletionArguments),
    Manual(manual::ManualArguments),
}

impl Command {
    fn run(self) -> Result<(), CommandError> {
        match self {
            Command::Check(arguments) => check::run(&arguments),
            Command::Init(arguments) => init::run(&arguments),
            Command::Effects(arguments) => effects::run(&arguments),
            Command::Completions(arguments) => manual::completions(&arguments, CommandLine::command()),
            Command::Manual(_) => manual::manual(CommandLine::command()),
            Command::Compare(arguments) => compare::run(&arguments),
            Command::Diagnose(arguments) => diagnose::run(&arguments),
            Command::Add(arguments) => add::run(&arguments),
            Command::Improve(arguments) => improve::run(&arguments),
            #[cfg(feature = "pictures")]
            Command::Report(arguments) => report::run(&arguments),
            Command::Fmu(arguments) => fmu::run(&arguments),
            Command::Identify(arguments) => identify::run(&arguments),
            Command::Limits(arguments) => limits::run(&arguments),
            Command::Simulate(arguments) => simulate::run(&arguments),
        }
    }
}

/// Reads the process's arguments, runs the command, reports its error on stderr: with `--json` as one line of JSON, the
/// last.
pub fn run() -> ExitCode {
    let json = std::env::args().any(|argument| argument == "--json");
    let command = match CommandLine::try_parse() {
        Ok(line) => line.command,
        Err(error) if json && error.use_stderr() => {
            output::complain_in_json(&error.to_string(), 2);
            return ExitCode::from(2);
        }
        Err(error) => error.exit(),
    };
    match command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            match json {
                true => output::complain_in_json(&error.to_string(), error.exit_status()),
                false => output::complain("error", &error.to_string()),
            }
            ExitCode::from(error.exit_status())
        }
    }
}
