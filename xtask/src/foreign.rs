//! The binaries of other platforms stepped here, beside this machine's: the same values, bit by bit or to rounding.
//!
//! Windows' run under Wine, those of 64-bit ARM under QEMU.

use crate::command::{cargo, probe, root, run};
use crate::error::Error;
use crate::files::{file, write};
use crate::fmu::BINARIES;
use crate::platforms;
use std::path::{Path, PathBuf};
use std::process::Command;
use switchid::fmu::{DUFFING, Fmu, identifier, plant};
use switchid::law::Model;
use switchid_fmu_package::{AARCH64_LINUX, LINUX64, Platform, WIN64};

/// What runs the programs of another platform.
struct Emulator {
    platform: Platform,
    /// What it is called, with the arguments that come before the program.
    programs: &'static [&'static [&'static str]],
    remedy: &'static str,
}

/// Debian's wine64 is not on the path.
const WINE: Emulator = Emulator {
    platform: WIN64,
    programs: &[&["wine64"], &["wine"], &["/usr/lib/wine/wine64"]],
    remedy: "install Wine (Debian: `apt-get install wine64`)",
};

/// The C library of ARM lies where Debian puts it.
const QEMU: Emulator = Emulator {
    platform: AARCH64_LINUX,
    programs: &[
        &["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"],
        &["qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu"],
    ],
    remedy: "install QEMU and ARM's C library (Debian: `apt-get install qemu-user libc6-arm64-cross`)",
};

/// Largest relative difference of an output: sine, cosine and exponential come from two C libraries and differ in the
/// last bits; filters pass that on.
const ROUNDING: f64 = 1e-6;

/// Steps taken: with the settings below the identifier has a law by then.
const STEPS: &str = "4000";

/// The one function that Rust's library needs and Wine before version 9 does not have.
const RANDOM: &str = "#include <stddef.h>\n\
     unsigned char __stdcall SystemFunction036(void *data, unsigned long length);\n\
     __declspec(dllexport) int ProcessPrng(unsigned char *data, size_t length) {\n\
     \x20   return SystemFunction036(data, (unsigned long)length);\n\
     }\n";

/// A library and the program that steps it.
pub struct Stepper {
    replay: PathBuf,
    library: PathBuf,
}

/// Compares the binaries that `cargo xtask fmu --platforms` built.
///
/// # Errors
/// What cargo, pip and the emulators say; outputs that differ.
pub fn compare() -> Result<(), Error> {
    let own = platforms::build_replay(LINUX64)?;
    for emulator in [WINE, QEMU] {
        let program = emulator.find()?;
        let replay = platforms::build_replay(emulator.platform)?;
        for (package, (fmu, settings)) in BINARIES.into_iter().zip(subjects()?) {
            let stepper = |platform, replay: &Path| Stepper {
                replay: replay.to_path_buf(),
                library: platforms::path(platform, package),
            };
            let [linux, foreign] = [stepper(LINUX64, &own), stepper(emulator.platform, &replay)];
            emulator.step_both(program, &fmu, settings, &linux, &foreign)?;
        }
    }
    Ok(())
}

/// The same of the identifier under Wine alone, built without optimisation, which changes no number: a minute, not ten.
/// The Linux one is that of `cargo xtask fmu`. Without Wine nothing is done, unless in CI.
///
/// # Errors
/// As [`compare`].
pub fn compare_quickly(linux: &Stepper) -> Result<(), Error> {
    let program = match WINE.find() {
        Err(error) if std::env::var_os("CI").is_none() => {
            eprintln!("{error}: the Windows binary is not tried");
            return Ok(());
        }
        found => found?,
    };
    let (replay, library) = platforms::build_for_wine(BINARIES[0])?;
    let [(fmu, settings), _] = subjects()?;
    WINE.step_both(program, &fmu, settings, linux, &Stepper { replay, library })
}

/// This machine's identifier as `cargo xtask fmu` built it, and what steps it, copied aside: what is built meanwhile
/// replaces both.
///
/// # Errors
/// What cargo says; a file that cannot be copied.
pub fn own_stepper() -> Result<Stepper, Error> {
    let arguments = ["build", "--quiet", "--release", "--package", "switchid-fmu-slave", "--features", "host", "--bin"];
    run(cargo(&arguments).arg("switchid-fmu-replay"), "install Rust from https://rustup.rs")?;
    let [release, aside] = ["target/release", "target/foreign"].map(|folder| root().join(folder));
    std::fs::create_dir_all(&aside).map_err(file("create", &aside))?;
    let copied = |name: &str| {
        let [from, to] = [&release, &aside].map(|folder| folder.join(name));
        std::fs::copy(&from, &to).map_err(file("copy", &from)).map(|_| to)
    };
    Ok(Stepper { replay: copied("switchid-fmu-replay")?, library: copied(&LINUX64.file(BINARIES[0]))? })
}

/// Each FMU with parameters under which something happens.
fn subjects() -> Result<[(Fmu, &'static [&'static str]); 2], Error> {
    let identifier = identifier("SwitchedIdentifier", &Model::cubic_library())?;
    Ok([(identifier, &["model=3"]), (plant(DUFFING)?, &["noise.q=0.01"])])
}

impl Emulator {
    fn find(&self) -> Result<&'static [&'static str], Error> {
        let starts = |words: &&&[&str]| {
            probe(Command::new(words[0]).arg("--version"), self.remedy).is_ok_and(|(works, _)| works)
        };
        self.programs.iter().find(starts).copied().ok_or_else(|| Error::Start {
            program: self.programs[0][0].into(),
            source: std::io::Error::from(std::io::ErrorKind::NotFound),
            remedy: self.remedy,
        })
    }

    fn step_both(
        &self,
        words: &[&str],
        fmu: &Fmu,
        settings: &[&str],
        linux: &Stepper,
        foreign: &Stepper,
    ) -> Result<(), Error> {
        let folder = unpack(fmu)?;
        let mut native = Command::new(&linux.replay);
        native.args([&folder, &linux.library]);
        let mut emulated = Command::new(words[0]);
        emulated.args(&words[1..]).arg(&foreign.replay);
        emulated.args([&folder, &foreign.library].map(|path| self.path(path)));
        if self.platform == WIN64 {
            emulated.env("WINEDEBUG", "-all").env("WINEPREFIX", root().join("target/wine"));
            provide_random(foreign.replay.parent().unwrap_or(Path::new(".")))?;
        }
        let [one, other] = [step(native, settings, self.remedy)?, step(emulated, settings, self.remedy)?];
        let differ = || Error::Platforms { fmu: fmu.name().into(), platform: self.platform.name };
        let (count, worst) = difference(&one, &other).ok_or_else(differ)?;
        let (name, platform) = (fmu.name(), self.platform.name);
        println!("{name}, {platform}: {count} outputs after {STEPS} steps, largest relative difference {worst:.1e}");
        if worst > ROUNDING { Err(differ()) } else { Ok(()) }
    }

    /// A path as the emulated program reads it.
    fn path(&self, path: &Path) -> String {
        if self.platform == WIN64 { windows_path(path) } else { path.display().to_string() }
    }
}

/// Wine's drive Z is the root directory.
fn windows_path(path: &Path) -> String {
    format!("Z:{}", path.display()).replace('/', "\\")
}

/// Puts the library with the function that Wine may lack beside the program.
fn provide_random(folder: &Path) -> Result<(), Error> {
    let source = root().join("target/wine-random.c");
    write(&source, RANDOM.as_bytes())?;
    let library = folder.join("bcryptprimitives.dll");
    if library.exists() {
        return Ok(());
    }
    let mut compile = platforms::zig_compiler()?;
    compile.args(["-target", "x86_64-windows-gnu", "-shared", "-o"]).args([&library, &source]).arg("-ladvapi32");
    run(&mut compile, WINE.remedy)
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

fn step(mut command: Command, settings: &[&str], remedy: &'static str) -> Result<String, Error> {
    command.arg(STEPS).args(settings);
    let output = command.output().map_err(|source| Error::Start {
        program: command.get_program().to_string_lossy().into_owned(),
        source,
        remedy,
    })?;
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
    use super::{difference, windows_path};
    use std::path::Path;

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

    #[test]
    fn wine_reads_paths_as_windows_does() {
        assert_eq!(windows_path(Path::new("/a b/c.dll")), "Z:\\a b\\c.dll");
    }
}
