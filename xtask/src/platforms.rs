//! The FMUs' binaries for every platform that can be built from Linux, by zig's C compiler and linker.
//!
//! They need a C library no newer than [`GLIBC`], hold no path of the building machine and no symbol but the
//! standard's.

use crate::command::{root, run};
use crate::error::Error;
use crate::files::{file, write};
use crate::inspect::{functions, inspect};
use crate::python;
use std::path::{Path, PathBuf};
use std::process::Command;
use switchid_fmu_package::{AARCH64_LINUX, LINUX64, Platform, WIN64};

/// The oldest C library that the Linux binaries run with is 2.17, of 2012.
const GLIBC: u32 = 17;

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
    let mut targets = Command::new("rustup");
    run(targets.args(["--quiet", "target", "add"]).args(TARGETS.map(|(_, target)| target)), RUSTUP)?;
    for (platform, target) in TARGETS {
        build_one(&environment, platform, target, packages)?;
    }
    Ok(())
}

const RUSTUP: &str = "install Rust from https://rustup.rs";

fn build_one(environment: &Path, platform: Platform, target: &str, packages: &[&str]) -> Result<(), Error> {
    for package in packages {
        let exchange = package.ends_with("-plant");
        let mut library = vec!["--package", package, "--lib", "--crate-type", "cdylib"];
        let list = format!("link-arg={}", exports_file(exchange)?.display());
        if platform == WIN64 {
            library.extend(["--", "-C", &list]);
        }
        let built = zigbuild(environment, platform, target, &library)?.join(platform.file(package));
        let content = std::fs::read(&built).map_err(file("read", &built))?;
        inspect(&built, &content, exchange, GLIBC)?;
        let kept = path(platform, package);
        let folder = kept.parent().unwrap_or(&kept);
        std::fs::create_dir_all(folder).map_err(file("create", folder))?;
        write(&kept, &content)?;
    }
    Ok(())
}

/// The list of what a Windows library exports, as its linker reads it: without one it exports everything.
fn exports_file(exchange: bool) -> Result<PathBuf, Error> {
    let folder = root().join("target/platforms");
    std::fs::create_dir_all(&folder).map_err(file("create", &folder))?;
    let path = folder.join(if exchange { "exchange.def" } else { "slave.def" });
    write(&path, format!("EXPORTS\n{}\n", functions(exchange).join("\n")).as_bytes())?;
    Ok(path)
}

/// Builds one crate for a platform as it is shipped; the folder of what was built.
fn zigbuild(environment: &Path, platform: Platform, target: &str, arguments: &[&str]) -> Result<PathBuf, Error> {
    zigbuild_as("fmu", environment, platform, target, arguments)
}

fn zigbuild_as(
    profile: &str,
    environment: &Path,
    platform: Platform,
    target: &str,
    arguments: &[&str],
) -> Result<PathBuf, Error> {
    let wanted = if platform == WIN64 { target.to_string() } else { format!("{target}.2.{GLIBC}") };
    let directory = root().join("target/platforms");
    let mut command = Command::new(environment.join("bin/cargo-zigbuild"));
    command.args(["rustc", "--quiet", "--profile", profile, "--target", &wanted, "--target-dir"]);
    command.arg(&directory).args(arguments).current_dir(root());
    command.env("PATH", path_with(environment)).env("CARGO_ENCODED_RUSTFLAGS", flags());
    run(&mut command, RUSTUP)?;
    Ok(directory.join(target).join(profile))
}

/// What builds the program that steps an FMU and prints its outputs.
const REPLAY: [&str; 6] = ["--package", "switchid-fmu-slave", "--features", "host", "--bin", "switchid-fmu-replay"];

/// That program for a platform.
///
/// # Errors
/// What pip and cargo say.
pub fn build_replay(platform: Platform) -> Result<PathBuf, Error> {
    let environment = python::platforms()?;
    let target = TARGETS.into_iter().find(|(own, _)| *own == platform).map_or("", |(_, target)| target);
    let folder = zigbuild(&environment, platform, target, &REPLAY)?;
    Ok(folder.join(if platform == WIN64 { "switchid-fmu-replay.exe" } else { "switchid-fmu-replay" }))
}

/// That program and a package's library for Windows, built to be tried and not to be shipped.
///
/// # Errors
/// What rustup, pip and cargo say.
pub fn build_for_wine(package: &str) -> Result<(PathBuf, PathBuf), Error> {
    let environment = python::platforms()?;
    let (platform, target) = TARGETS[2];
    run(Command::new("rustup").args(["--quiet", "target", "add", target]), RUSTUP)?;
    let build = |arguments: &[&str]| zigbuild_as("tried", &environment, platform, target, arguments);
    let library = build(&["--package", package, "--lib", "--crate-type", "cdylib"])?.join(platform.file(package));
    Ok((build(&REPLAY)?.join("switchid-fmu-replay.exe"), library))
}

/// The C compiler that comes with zig.
///
/// # Errors
/// What pip says.
pub fn zig_compiler() -> Result<Command, Error> {
    let mut command = Command::new(python::platforms()?.join("bin/python"));
    command.args(["-m", "ziglang", "cc"]);
    Ok(command)
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
