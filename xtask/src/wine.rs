//! The Windows binaries stepped under Wine beside the Linux ones: the same values, bit by bit or to rounding.

use crate::command::root;
use crate::error::Error;
use crate::fmu::{BINARIES, file, write};
use crate::platforms;
use std::path::{Path, PathBuf};
use std::process::Command;
use switchid::fmu::{DUFFING, Fmu, identifier, plant};
use switchid::law::Model;
use switchid_fmu_package::{LINUX64, WIN64};

const WINE: &str = "install Wine (Debian: `apt-get install wine64`)";

/// Largest relative difference of an output: sine, cosine and exponential come from two C libraries and differ in the last
/// bits; filters pass that on.
const ROUNDING: f64 = 1e-6;

/// Steps taken: with the settings below the identifier has a law by then.
const STEPS: &str = "4000";

/// Builds the program that steps, for both platforms, and compares what it prints. The FMUs' binaries must be there.
///
/// # Errors
/// What cargo and Wine say; outputs that differ.
pub fn compare() -> Result<(), Error> {
    let replay = [platforms::build_replay(LINUX64)?, platforms::build_replay(WIN64)?];
    let library = Model::cubic_library();
    let fmus =
        [(identifier("SwitchedIdentifier", &library)?, &["model=3"][..]), (plant(DUFFING)?, &["noise.q=0.01"][..])];
    for ((fmu, settings), package) in fmus.iter().zip(BINARIES) {
        let folder = unpack(fmu)?;
        let said =
            [(LINUX64, None), (WIN64, Some("wine64"))].into_iter().zip(&replay).map(|((platform, wine), program)| {
                step(program, wine, &folder, &platforms::path(platform, package), settings)
            });
        let said = said.collect::<Result<Vec<String>, Error>>()?;
        let (count, worst) = difference(&said[0], &said[1]).ok_or_else(|| differ(fmu.name()))?;
        println!("{}: {count} outputs after {STEPS} steps, largest relative difference {worst:.1e}", fmu.name());
        if worst > ROUNDING {
            return Err(differ(fmu.name()));
        }
    }
    Ok(())
}

fn differ(name: &str) -> Error {
    Error::Platforms { fmu: name.into() }
}

fn unpack(fmu: &Fmu) -> Result<PathBuf, Error> {
    let folder = root().join("target/replay").join(fmu.name());
    for (path, content) in fmu.files().filter(|(path, _)| path.starts_with("resources/")) {
        let path = folder.join(path);
        let parent = path.parent().unwrap_or(&folder);
        std::fs::create_dir_all(parent).map_err(file("create", parent))?;
        write(&path, content)?;
    }
    Ok(folder)
}

fn step(program: &Path, wine: Option<&str>, folder: &Path, library: &Path, settings: &[&str]) -> Result<String, Error> {
    let mut command = Command::new(wine.map_or(program.as_os_str(), |wine| wine.as_ref()));
    command.args(wine.map(|_| program)).args([folder, library]).arg(STEPS).args(settings).env("WINEDEBUG", "-all");
    let output = command.output().map_err(|source| Error::Start { program: "wine64".into(), source, remedy: WINE })?;
    if !output.status.success() {
        eprint!("{}", String::from_utf8_lossy(&output.stderr));
        return Err(Error::Failed { command: format!("{command:?}"), status: output.status });
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// How many values there are, and the largest relative difference; `None` where the lists are not of the same outputs.
fn difference(one: &str, other: &str) -> Option<(usize, f64)> {
    let read = |line: &str| {
        let mut words = line.split_whitespace();
        Some((words.next()?.to_string(), f64::from_bits(u64::from_str_radix(words.next()?, 16).ok()?)))
    };
    let (one, other): (Vec<_>, Vec<_>) = (one.lines().map(read).collect(), other.lines().map(read).collect());
    if one.len() != other.len() || one.is_empty() {
        return None;
    }
    let mut worst = 0.0_f64;
    for pair in one.iter().zip(&other) {
        let (Some((name, value)), Some((same, found))) = pair else { return None };
        if name != same {
            return None;
        }
        let scale = value.abs().max(1e-6);
        worst = worst.max(if value == found { 0.0 } else { (value - found).abs() / scale });
    }
    Some((one.len(), worst))
}

#[cfg(test)]
mod tests {
    use super::difference;

    #[test]
    fn lists_of_values_are_compared_by_name_and_size() {
        let line = |name: &str, value: f64| format!("{name} {:016x} {value:e}\n", value.to_bits());
        let (one, close) = (line("a", 2.0) + &line("b", 1.0), line("a", 2.0) + &line("b", 1.5));
        assert_eq!(difference(&one, &one), Some((2, 0.0)));
        assert_eq!(difference(&one, &close), Some((2, 0.5)));
        assert_eq!(difference(&one, &line("a", 2.0)), None);
        assert_eq!(difference(&line("a", 1.0), &line("b", 1.0)), None);
        assert_eq!(difference("", ""), None);
    }
}
