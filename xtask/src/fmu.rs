//! The example FMUs, packed under `target/fmu/`, and the other release binaries that the cross-check steps and calls.

use crate::command::{cargo, root, run};
use crate::error::Error;
use std::path::{Path, PathBuf};
use switchid::fmu::{DUFFING, VAN_DER_POL, identifier, plant};
use switchid::law::Model;
use switchid_fmu_package::{Fmu, LINUX64};

/// Name of the default identifier.
const IDENTIFIER: &str = "SwitchedIdentifier";

/// `cargo xtask fmu`: what [`build`] does, and the default identifier's `modelDescription.xml` at the root made anew. No
/// other chore writes that file: the test that finds it stale must see it as it was checked in.
///
/// # Errors
/// What cargo or the packaging says.
pub fn renew() -> Result<(), Error> {
    write(&root().join("modelDescription.xml"), default_identifier()?.xml().as_bytes())?;
    build()
}

/// Builds the binaries, apart from the rest so that no feature of the command line gets in, and writes the three FMUs
/// into `target/fmu`.
///
/// # Errors
/// What cargo or the packaging says.
pub fn build() -> Result<(), Error> {
    let identifier_binary = build_binary("switchid-fmu-identifier")?;
    let plant_binary = build_binary("switchid-fmu-plant")?;
    pack(default_identifier()?.with_binary(LINUX64, "so", identifier_binary))?;
    for law in [DUFFING, VAN_DER_POL] {
        pack(plant(law)?.with_binary(LINUX64, "so", plant_binary.clone()))?;
    }
    Ok(())
}

fn default_identifier() -> Result<Fmu, Error> {
    Ok(identifier(IDENTIFIER, &Model::cubic_library())?)
}

fn pack(fmu: Fmu) -> Result<(), Error> {
    let directory = root().join("target/fmu");
    std::fs::create_dir_all(&directory).map_err(file("create", &directory))?;
    write(&directory.join(format!("{}.fmu", fmu.name())), &fmu.to_bytes()?)
}

/// The harness's command line, `target/release/switchid-harness`: without MAT, Parquet and pictures, which would take longer to
/// build than the cross-check takes to run.
///
/// # Errors
/// What cargo says.
pub fn build_command() -> Result<(), Error> {
    build_package("switchid-harness-command").map(|_| ())
}

fn build_binary(package: &str) -> Result<Vec<u8>, Error> {
    let path = build_package(package)?.join(format!("lib{}.so", package.replace('-', "_")));
    std::fs::read(&path).map_err(file("read", &path))
}

/// Builds one package apart from the others, so that it gets the features that it asks for and no more; where its binary lies.
fn build_package(package: &str) -> Result<PathBuf, Error> {
    let target = root().join("target");
    let mut command = cargo(&["build", "--quiet", "--release", "--package", package, "--target-dir"]);
    run(command.arg(&target), "install Rust from https://rustup.rs")?;
    Ok(target.join("release"))
}

fn write(path: &Path, content: &[u8]) -> Result<(), Error> {
    if std::fs::read(path).is_ok_and(|present| present == content) {
        return Ok(());
    }
    std::fs::write(path, content).map_err(file("write", path))
}

fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    let path = path.to_path_buf();
    move |source| Error::File { action, path, source }
}
