//! The `switchid` command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    switchid::cli::run()
}
