//! The command line as the cross-check calls it: without MAT, Parquet and pictures, which take minutes to build.

use std::process::ExitCode;

fn main() -> ExitCode {
    switchid::cli::run()
}
