//! The example FMUs, packed under `target/fmu/`, and the other release binaries that the cross-check steps and calls.

use crate::command::{cargo, root, run};
use crate::error::Error;
use crate::files::{file, write};
use crate::{licences, platforms};
use switchid::fmu::{DUFFING, VAN_DER_POL, identifier, plant};
use switchid::law::Model;
use switchid_fmu_package::{Fmu, LINUX64, Platform};

/// Name of the default identifier.
const IDENTIFIER: &str = "SwitchedIdentifier";

/// The crates of the two binaries.
pub const BINARIES: [&str; 2] = ["switchid-fmu-identifier", "switchid-fmu-plant"];

/// `cargo xtask fmu`: the default identifier's `modelDescription.xml` at the root and the list of licences made anew,
/// and the FMUs, for this machine or for every platform. No other chore writes those files: the tests that find them
/// stale must see them as they were checked in.
///
/// # Errors
/// What cargo or the packaging says.
pub fn renew(every_platform: bool) -> Result<(), Error> {
    write(&licences::file(), licences::text()?.as_bytes())?;
    write(&root().join("modelDescription.xml"), default_identifier()?.xml().as_bytes())?;
    if every_platform { build_everywhere() } else { build() }
}

/// Builds the binaries for this machine, apart from the rest so that no feature of the command line gets in, and writes
/// the three FMUs into `target/fmu`.
///
/// # Errors
/// What cargo or the packaging says.
pub fn build() -> Result<(), Error> {
    let [identifier, plant] = BINARIES.map(|package| build_binary(package).map(|binary| vec![(LINUX64, binary)]));
    pack_all(&identifier?, &plant?)
}

/// The same with the binaries of every platform that can be built from Linux.
///
/// # Errors
/// What cargo or the packaging says.
pub fn build_everywhere() -> Result<(), Error> {
    platforms::build(&BINARIES)?;
    let [identifier, plant] = BINARIES.map(platforms::binaries);
    pack_all(&identifier?, &plant?)
}

fn pack_all(identifier: &[(Platform, Vec<u8>)], plants: &[(Platform, Vec<u8>)]) -> Result<(), Error> {
    let with = |fmu: Fmu, binaries: &[(Platform, Vec<u8>)]| {
        binaries.iter().fold(fmu, |fmu, (platform, binary)| fmu.with_binary(*platform, binary.clone()))
    };
    pack(with(default_identifier()?, identifier))?;
    [DUFFING, VAN_DER_POL].into_iter().try_for_each(|law| pack(with(plant(law)?, plants)))
}

fn default_identifier() -> Result<Fmu, Error> {
    Ok(identifier(IDENTIFIER, &Model::cubic_library())?)
}

fn pack(fmu: Fmu) -> Result<(), Error> {
    let directory = root().join("target/fmu");
    std::fs::create_dir_all(&directory).map_err(file("create", &directory))?;
    write(&directory.join(format!("{}.fmu", fmu.name())), &fmu.to_bytes()?)
}

/// The harness's command line, `target/release/switchid-harness`: without MAT, Parquet and pictures, which would take
/// longer to build than the cross-check takes to run. Beside this program, whose library it shares.
///
/// # Errors
/// What cargo says.
pub fn build_command() -> Result<(), Error> {
    let packages = ["--package", "xtask", "--package", "switchid-harness-command"];
    let mut command = cargo(&["build", "--quiet", "--release", "--bin", "switchid-harness", "--target-dir"]);
    run(command.arg(root().join("target")).args(packages), "install Rust from https://rustup.rs")
}

/// A package's dynamic library without symbols, which would be three quarters of it.
fn build_binary(package: &str) -> Result<Vec<u8>, Error> {
    let arguments = ["rustc", "--quiet", "--release", "--package", package, "--lib", "--crate-type", "cdylib"];
    let strip = ["--", "-C", "strip=symbols"];
    run(cargo(&arguments).args(strip), "install Rust from https://rustup.rs")?;
    let path = root().join("target/release").join(LINUX64.file(package));
    std::fs::read(&path).map_err(file("read", &path))
}
