//! The Python environment of the harness: `target/python`, made from `harness/requirements.txt`.
//!
//! Needs a Python from 3.10 on (`python3`, or what `PYTHON` names) and nothing else: where the interpreter comes
//! without ensurepip (Debian without python3-venv), pip itself is fetched from PyPI and run from its wheel.

use crate::command::{probe, root, run};
use crate::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What would mend a missing interpreter.
pub const NO_PYTHON: &str =
    "install Python 3.10 or later (Debian, Ubuntu: `apt-get install python3`), or set PYTHON to one";
const PIP_VERSION: &str = "26.3";
const PIP_SHA256: &str = "f3b60b20ffaadd4415ed7957212a38ac63fa4c5fa375bd0f4a797777940fad13";
const IS_RECENT: &str = "import sys; print(sys.version.split()[0]); sys.exit(sys.version_info < (3, 10))";
const HAS_ENSUREPIP: &str = "import ensurepip";

/// The interpreter of an environment that holds what `harness/requirements.txt` names; made anew only when that
/// file or the interpreter changed.
///
/// # Errors
/// [`Error::Environment`], [`Error::Packages`], [`Error::File`]: each says what would mend it.
pub fn environment() -> Result<PathBuf, Error> {
    let program = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    make(&Host::find(program)?, &root().join("target/python"), &root().join("harness/requirements.txt"))
}

/// The folder of an environment that holds zig and its cargo command, some 300 MB, from `xtask/platforms.txt`.
///
/// # Errors
/// As [`environment`].
pub fn platforms() -> Result<PathBuf, Error> {
    let program = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let directory = root().join("target/python-platforms");
    make(&Host::find(program)?, &directory, &root().join("xtask/platforms.txt"))?;
    Ok(directory)
}

/// The interpreter of an environment that holds the importers of `harness/importers.txt`.
///
/// # Errors
/// As [`environment`].
pub fn importers() -> Result<PathBuf, Error> {
    let program = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    make(&Host::find(program)?, &root().join("target/python-importers"), &root().join("harness/importers.txt"))
}

fn make(host: &Host, directory: &Path, requirements: &Path) -> Result<PathBuf, Error> {
    let interpreter = directory.join("bin/python");
    let stamp = directory.join("made-from");
    let wanted = format!("{} {}\n{}", host.program, host.version, read(requirements)?);
    if interpreter.exists() && std::fs::read_to_string(&stamp).is_ok_and(|found| found == wanted) {
        return Ok(interpreter);
    }
    remove(directory)?;
    host.create(directory)?;
    install(&interpreter, directory, requirements)?;
    write(&stamp, wanted.as_bytes())?;
    Ok(interpreter)
}

/// The interpreter found on the machine.
struct Host {
    program: String,
    version: String,
}

impl Host {
    fn find(program: String) -> Result<Host, Error> {
        let (recent, version) = probe(Command::new(&program).args(["-c", IS_RECENT]), NO_PYTHON)?;
        let host = Host { program, version };
        if recent { Ok(host) } else { Err(host.error("Python 3.10 or later is needed".into())) }
    }

    fn create(&self, directory: &Path) -> Result<(), Error> {
        let (has_ensurepip, _) = probe(Command::new(&self.program).args(["-c", HAS_ENSUREPIP]), NO_PYTHON)?;
        let mut command = Command::new(&self.program);
        command.args(["-m", "venv"]);
        if !has_ensurepip {
            command.arg("--without-pip");
        }
        match probe(command.arg(directory), NO_PYTHON)? {
            (true, _) => Ok(()),
            (false, reason) => Err(self.error(reason)),
        }
    }

    fn error(&self, reason: String) -> Error {
        Error::Environment { python: self.program.clone(), version: self.version.clone(), reason }
    }
}

fn install(interpreter: &Path, directory: &Path, requirements: &Path) -> Result<(), Error> {
    let mut command = Command::new(interpreter);
    match directory.join("bin/pip").exists() {
        true => command.args(["-m", "pip"]),
        false => command.arg(fetched_pip(interpreter, directory)?),
    };
    command.args(["install", "--quiet", "--no-deps", "--disable-pip-version-check", "--requirement"]).arg(requirements);
    run(&mut command, NO_PYTHON).map_err(|_| Error::Packages { requirements: requirements.to_path_buf() })
}

fn fetched_pip(interpreter: &Path, directory: &Path) -> Result<PathBuf, Error> {
    eprintln!("this Python comes without pip: fetching pip {PIP_VERSION}");
    let wheel = directory.join(format!("pip-{PIP_VERSION}-py3-none-any.whl"));
    let script = directory.join("fetch_pip.py");
    write(&script, include_bytes!("fetch_pip.py"))?;
    run(Command::new(interpreter).arg(&script).args([PIP_VERSION, PIP_SHA256]).arg(&wheel), NO_PYTHON)?;
    Ok(wheel.join("pip"))
}

fn read(path: &Path) -> Result<String, Error> {
    std::fs::read_to_string(path).map_err(|source| Error::File { action: "read", path: path.into(), source })
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    std::fs::write(path, bytes).map_err(|source| Error::File { action: "write", path: path.into(), source })
}

fn remove(directory: &Path) -> Result<(), Error> {
    if !directory.exists() {
        return Ok(());
    }
    std::fs::remove_dir_all(directory).map_err(|source| Error::File {
        action: "remove the outdated",
        path: directory.into(),
        source,
    })
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    /// A directory of the test's own, with a shell script in it that stands in for Python.
    fn stand_in(name: &str, script: &str) -> (PathBuf, String) {
        let directory = std::env::temp_dir().join(format!("switchid-xtask-{name}-{}", std::process::id()));
        std::fs::create_dir_all(directory.join("environment/bin")).unwrap();
        let program = directory.join("python");
        // written by a process of its own: what another test starts meanwhile would inherit the open file, and keep it
        // from being run
        let write = r#"printf '#!/bin/sh\n%s\n' "$2" > "$1" && chmod 755 "$1""#;
        let written = Command::new("/bin/sh").args(["-c", write, "sh"]).arg(&program).arg(script).status().unwrap();
        assert!(written.success());
        std::fs::write(directory.join("requirements.txt"), "fmpy==0.3.32\n").unwrap();
        (directory, program.display().to_string())
    }

    const NO_VENV: &str = r#"case "$*" in *venv*) echo "No module named venv"; exit 1;; *) echo 3.12.1;; esac"#;

    #[test]
    fn a_missing_interpreter_is_named_with_what_to_install() {
        let text = Host::find("/nowhere/python3".into()).err().unwrap().to_string();
        assert!(text.contains("/nowhere/python3") && text.contains("apt-get install python3"), "{text}");
    }

    #[test]
    fn an_old_interpreter_is_refused_with_its_version() {
        let (directory, program) = stand_in("old", "echo 3.8.19; exit 1");
        let text = Host::find(program).err().unwrap().to_string();
        assert!(text.contains("3.8.19") && text.contains("3.10"), "{text}");
        std::fs::remove_dir_all(directory).unwrap();
    }

    #[test]
    fn a_python_without_venv_says_which_package_to_install() {
        let (directory, program) = stand_in("no-venv", NO_VENV);
        let host = Host::find(program).unwrap();
        let text =
            make(&host, &directory.join("environment"), &directory.join("requirements.txt")).unwrap_err().to_string();
        assert!(text.contains("No module named venv") && text.contains("python3-venv"), "{text}");
        std::fs::remove_dir_all(directory).unwrap();
    }

    #[test]
    fn an_environment_is_kept_until_its_requirements_change() {
        let (directory, program) = stand_in("kept", NO_VENV);
        let (environment, requirements) = (directory.join("environment"), directory.join("requirements.txt"));
        let host = Host::find(program.clone()).unwrap();
        std::fs::write(environment.join("bin/python"), "").unwrap();
        std::fs::write(environment.join("made-from"), format!("{program} 3.12.1\nfmpy==0.3.32\n")).unwrap();
        assert_eq!(make(&host, &environment, &requirements).unwrap(), environment.join("bin/python"));
        std::fs::write(&requirements, "fmpy==0.3.33\n").unwrap();
        assert!(make(&host, &environment, &requirements).is_err());
        std::fs::remove_dir_all(directory).unwrap();
    }
}
