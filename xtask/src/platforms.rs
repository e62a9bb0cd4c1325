//! The FMUs' binaries for every platform that can be built from Linux, by zig's C compiler and linker.
//!
//! They need a C library no newer than [`GLIBC`], hold no path of the building machine and no symbol but the standard's.

use crate::command::{cargo, root, run};
use crate::error::Error;
use crate::files::{file, write};
use crate::python;
use std::path::{Path, PathBuf};
use switchid_fmu_package::{AARCH64_LINUX, LINUX64, Platform, WIN64};

/// The oldest C library that the Linux binaries run with, of 2012.
const GLIBC: &str = "2.17";

/// Platform, and Rust's name of it.
const TARGETS: [(Platform, &str); 3] = [
    (LINUX64, "x86_64-unknown-linux-gnu"),
    (AARCH64_LINUX, "aarch64-unknown-linux-gnu"),
    (WIN64, "x86_64-pc-windows-gnu"),
];

/// Builds these packages for every platform into `target/fmu-binaries`, a folder each.
///
/// # Errors
/// What rustup, pip and cargo say.
pub fn build(packages: &[&str]) -> Result<(), Error> {
    let environment = python::platforms()?;
    let mut targets = std::process::Command::new("rustup");
    run(targets.args(["--quiet", "target", "add"]).args(TARGETS.map(|(_, target)| target)), RUSTUP)?;
    for (platform, target) in TARGETS {
        build_one(&environment, platform, target, packages)?;
    }
    Ok(())
}

const RUSTUP: &str = "install Rust from https://rustup.rs";

fn build_one(environment: &Path, platform: Platform, target: &str, packages: &[&str]) -> Result<(), Error> {
    let packages_named: Vec<&str> = packages.iter().flat_map(|package| ["--package", package]).collect();
    let built = zigbuild(environment, platform, target, &packages_named)?;
    for package in packages {
        let (built, kept) = (built.join(platform.file(package)), path(platform, package));
        let folder = kept.parent().unwrap_or(&kept);
        std::fs::create_dir_all(folder).map_err(file("create", folder))?;
        write(&kept, &std::fs::read(&built).map_err(file("read", &built))?)?;
    }
    Ok(())
}

/// Builds for a platform; the folder of what was built.
fn zigbuild(environment: &Path, platform: Platform, target: &str, arguments: &[&str]) -> Result<PathBuf, Error> {
    let wanted = if platform == WIN64 { target.to_string() } else { format!("{target}.{GLIBC}") };
    let directory = root().join("target/platforms");
    let mut command = cargo(&["zigbuild", "--quiet", "--profile", "fmu", "--target", &wanted, "--target-dir"]);
    command.arg(&directory).args(arguments);
    command.env("PATH", path_with(environment)).env("CARGO_ENCODED_RUSTFLAGS", flags());
    run(&mut command, RUSTUP)?;
    Ok(directory.join(target).join("fmu"))
}

/// The program that steps an FMU and prints its outputs, for a platform.
///
/// # Errors
/// What pip and cargo say.
pub fn build_replay(platform: Platform) -> Result<PathBuf, Error> {
    let environment = python::platforms()?;
    let target = TARGETS.into_iter().find(|(own, _)| *own == platform).map_or("", |(_, target)| target);
    let arguments = ["--package", "switchid-fmu-slave", "--features", "host", "--bin", "switchid-fmu-replay"];
    let folder = zigbuild(&environment, platform, target, &arguments)?;
    Ok(folder.join(if platform == WIN64 { "switchid-fmu-replay.exe" } else { "switchid-fmu-replay" }))
}

/// What was built of a package.
///
/// # Errors
/// A file that cannot be read.
pub fn binaries(package: &str) -> Result<Vec<(Platform, Vec<u8>)>, Error> {
    let read = |(platform, _): (Platform, &str)| {
        let path = path(platform, package);
        Ok((platform, std::fs::read(&path).map_err(file("read", &path))?))
    };
    TARGETS.into_iter().map(read).collect()
}

/// Where a package's binary for a platform lies.
pub fn path(platform: Platform, package: &str) -> PathBuf {
    root().join("target/fmu-binaries").join(platform.name).join(platform.file(package))
}

/// The environment's programs first: cargo finds `zigbuild` there, and that finds zig.
fn path_with(environment: &Path) -> std::ffi::OsString {
    let mut path = environment.join("bin").into_os_string();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    path
}

/// The machine's paths are no one's business, and the same sources give the same binary in another folder.
fn flags() -> std::ffi::OsString {
    let home = |variable: &str, below: &str| {
        let own = std::env::var_os("HOME").map(|home| PathBuf::from(home).join(below));
        std::env::var_os(variable).map(PathBuf::from).or(own)
    };
    let folders = [
        (Some(root()), "switchid"),
        (home("CARGO_HOME", ".cargo"), "cargo"),
        (home("RUSTUP_HOME", ".rustup"), "rustup"),
    ];
    let mut flags = std::ffi::OsString::new();
    for (from, to) in folders.into_iter().filter_map(|(from, to)| Some((from?, to))) {
        if !flags.is_empty() {
            flags.push("\u{1f}");
        }
        flags.push("--remap-path-prefix=");
        flags.push(from);
        flags.push(format!("={to}"));
    }
    flags
}
