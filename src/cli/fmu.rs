//! `switchid fmu`: an FMU for a model out of the prebuilt binary.

use super::error::CommandError;
use super::output::{self, Targets};
use crate::data::{self, DataError};
use crate::fmu::{Fmu, FmuError, Platform, identifier_knowing, plant_of_model};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

const EXAMPLE: &str = r#"Examples:
  switchid fmu --model axis.toml -o Axis.fmu
  switchid fmu --model axis.toml -o Axis.fmu --known-laws laws.toml
  switchid fmu --model axis.toml -o AxisPlant.fmu --plant
  switchid fmu --model axis.toml -o Axis.fmu --binaries target/release

The first identifies the model's law in any simulator that imports FMI 2.0 for co-simulation, the second recognises
laws that `switchid identify --save-laws` saved, from its first sample on; the third is a plant with the model's law, whose terms must all have numbers. Ports are in SI units: where the model's [units]
name a quantity, they declare its SI unit.

The binaries come from `cargo build --release -p switchid-fmu-identifier -p switchid-fmu-plant`, for this machine; those of every
platform, each in a folder of its own, from `cargo xtask fmu --platforms` (then --binaries target/fmu-binaries)."#;

/// Make an FMU: an identifier for a model, or a plant with its law
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// The model file (TOML)
    #[arg(long, short)]
    model: PathBuf,
    /// Where to write the FMU; it is named after the file
    #[arg(short, long, value_name = "X.fmu")]
    output: PathBuf,
    /// Laws that the identifier recognises from its first sample on, as `identify --save-laws` wrote them
    #[arg(long, value_name = "FILE", conflicts_with = "plant")]
    known_laws: Option<PathBuf>,
    /// Make a plant with the model's law in place of an identifier
    #[arg(long)]
    plant: bool,
    /// Where the prebuilt binaries lie; else beside this executable
    #[arg(long, value_name = "DIR")]
    binaries: Option<PathBuf>,
    /// Overwrite files where they exist
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    fmu: String,
    kind: &'static str,
    name: String,
    guid: String,
    platforms: Vec<&'static str>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let inputs: Vec<PathBuf> = [&arguments.model].into_iter().chain(&arguments.known_laws).cloned().collect();
    let target = Targets::new(inputs, arguments.force).claim("-o", &arguments.output)?;
    let model = data::open_model(&arguments.model)?;
    let name = name(&arguments.output);
    let refused = |source: FmuError| match (source, &arguments.known_laws) {
        (FmuError::Laws(source), Some(path)) => {
            CommandError::from(DataError::Laws { file: path.display().to_string(), source })
        }
        (source, _) => CommandError::Fmu { model: arguments.model.display().to_string(), source },
    };
    let known = arguments.known_laws.as_deref().map(data::open_laws).transpose()?;
    let fmu = match arguments.plant {
        true => plant_of_model(&name, &model),
        false => identifier_knowing(&name, &model, &known.unwrap_or_default()),
    };
    let fmu = fmu.map_err(refused)?;
    let (fmu, platforms) = with_binaries(fmu, arguments)?;
    let bytes = fmu.to_bytes().map_err(|source| refused(source.into()))?;
    let file = arguments.output.display().to_string();
    target.write_bytes(&bytes)?;
    let report = Report { fmu: file, kind: kind(arguments), name, guid: fmu.guid().into(), platforms };
    if arguments.json { output::print_json(&report) } else { output::print(&text(&report)) }
}

fn kind(arguments: &Arguments) -> &'static str {
    if arguments.plant { "plant" } else { "identifier" }
}

fn text(report: &Report) -> String {
    let Report { fmu, kind, name, platforms, .. } = report;
    format!("{fmu}: {kind} {name} for {}\n", platforms.join(", "))
}

/// The FMU's name: that of the file, with underscores for what cannot be in a name.
fn name(output: &Path) -> String {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let legal = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    let name: String = stem.chars().map(legal).collect();
    if name.starts_with(|letter: char| letter.is_ascii_alphabetic()) { name } else { format!("Model_{name}") }
}

/// The FMU with the binary of every platform that is there.
fn with_binaries(mut fmu: Fmu, arguments: &Arguments) -> Result<(Fmu, Vec<&'static str>), CommandError> {
    let folder = match &arguments.binaries {
        Some(folder) => folder.clone(),
        None => beside_executable()?,
    };
    let mut platforms = Vec::new();
    for platform in Platform::ALL {
        let Some(path) = binary(&folder, platform, kind(arguments)) else { continue };
        let read =
            |error: std::io::Error| CommandError::Read { file: path.display().to_string(), reason: error.to_string() };
        fmu = fmu.with_binary(platform, std::fs::read(&path).map_err(read)?);
        platforms.push(platform.name);
    }
    if platforms.is_empty() {
        return Err(CommandError::NoBinary { kind: kind(arguments), folder: folder.display().to_string() });
    }
    Ok((fmu, platforms))
}

/// The binary in the platform's own folder; in the folder itself lie those of this machine, and those whose ending
/// names the platform.
fn binary(folder: &Path, platform: Platform, kind: &str) -> Option<PathBuf> {
    let file = platform.file(&format!("switchid-fmu-{kind}"));
    let own = folder.join(platform.name).join(&file);
    let named = |_: &PathBuf| platform.extension != "so" || Platform::of_this_machine() == Some(platform);
    let beside = Some(folder.join(file)).filter(named);
    [Some(own), beside].into_iter().flatten().find(|path| path.is_file())
}

fn beside_executable() -> Result<PathBuf, CommandError> {
    let failed = |error: std::io::Error| CommandError::Read {
        file: "the path of this executable".into(),
        reason: error.to_string(),
    };
    let executable = std::env::current_exe().map_err(failed)?;
    Ok(executable.parent().map_or_else(PathBuf::new, Path::to_path_buf))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_legal_in_fmi() {
        let named = |path: &str| name(Path::new(path));
        assert_eq!(named("out/Axis.fmu"), "Axis");
        assert_eq!(named("my axis-2.fmu"), "my_axis_2");
        assert_eq!(named("3.fmu"), "Model_3");
    }
}
