//! `cargo xtask fmu`: builds the binaries and packs the example FMUs under `target/fmu/`.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use switchid::law::Model;
use switchid_fmu_package::{Fmu, LINUX64, PackageError, identifier};
use thiserror::Error;

/// Name of the default identifier.
const IDENTIFIER: &str = "SwitchedIdentifier";

/// Why FMUs cannot be built.
#[derive(Debug, Error)]
pub enum FmuError {
    /// Cargo could not be run, or a file not be read or written.
    #[error("{path}: {source}")]
    File {
        /// Which one.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Cargo failed.
    #[error("cargo build --release -p {package} failed ({status})")]
    Build {
        /// The package.
        package: &'static str,
        /// How it ended.
        status: ExitStatus,
    },
    /// An FMU cannot be packed.
    #[error(transparent)]
    Package(#[from] PackageError),
}

/// Builds the binaries, apart from each other and from the rest so that no feature of the command line gets in, and
/// writes the FMUs. Returns their paths.
///
/// # Errors
/// [`FmuError`].
pub fn build(root: &Path) -> Result<Vec<PathBuf>, FmuError> {
    let identifier_binary = build_binary(root, "switchid-fmu-identifier")?;
    let fmus = [(IDENTIFIER, default_identifier()?.with_binary(LINUX64, "so", identifier_binary))];
    fmus.into_iter().map(|(name, fmu)| write(&root.join(format!("target/fmu/{name}.fmu")), &fmu.to_bytes()?)).collect()
}

/// Writes `modelDescription.xml` of the default identifier at the root.
///
/// # Errors
/// [`FmuError`].
pub fn write_model_description(root: &Path) -> Result<PathBuf, FmuError> {
    write(&root.join("modelDescription.xml"), default_identifier()?.xml().as_bytes())
}

fn default_identifier() -> Result<Fmu, PackageError> {
    identifier(IDENTIFIER, &Model::cubic_library())
}

fn build_binary(root: &Path, package: &'static str) -> Result<Vec<u8>, FmuError> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let target = root.join("target");
    let status = Command::new(&cargo)
        .args(["build", "--release", "--package", package, "--target-dir"])
        .arg(&target)
        .current_dir(root)
        .status()
        .map_err(|source| FmuError::File { path: cargo.into(), source })?;
    if !status.success() {
        return Err(FmuError::Build { package, status });
    }
    let path = target.join("release").join(format!("lib{}.so", package.replace('-', "_")));
    std::fs::read(&path).map_err(|source| FmuError::File { path, source })
}

fn write(path: &Path, content: &[u8]) -> Result<PathBuf, FmuError> {
    let failed = |source| FmuError::File { path: path.to_path_buf(), source };
    if let Some(directory) = path.parent() {
        std::fs::create_dir_all(directory).map_err(failed)?;
    }
    std::fs::write(path, content).map_err(failed)?;
    Ok(path.to_path_buf())
}
