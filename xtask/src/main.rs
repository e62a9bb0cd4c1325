//! Chores of the project: `cargo xtask fmu`.

mod fmu;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let command = std::env::args().nth(1).unwrap_or_default();
    let outcome = match command.as_str() {
        "fmu" => fmu::write_model_description(&root).and_then(|_| fmu::build(&root)),
        _ => {
            eprintln!("usage: cargo xtask fmu");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(paths) => {
            paths.iter().for_each(|path| println!("{}", path.display()));
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
