//! The command line under measurement: started, timed, its JSON read.

use super::clock;
use crate::command::built_switchid;
use crate::error::Error;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Exit status of a Rust program that panicked.
const PANICKED: i32 = 101;

/// A `switchid` and the folder in which it writes.
pub struct Binary {
    program: PathBuf,
    folder: tempfile::TempDir,
}

/// What a run came to.
pub struct Answer {
    /// Its JSON, or why there is none.
    pub document: Result<Value, Failure>,
    /// CPU time, s; the time that passed where the system does not tell.
    pub seconds: f64,
}

/// A run without an answer.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Whether the program crashed, in place of saying what is wrong.
    pub crashed: bool,
    /// What it said.
    pub text: String,
}

impl Binary {
    /// That program, or the release one of the sources.
    ///
    /// # Errors
    /// [`Error::Failed`] when it cannot be built, [`Error::File`] when there is no such program or no folder for its
    /// files.
    pub fn new(given: Option<&Path>) -> Result<Binary, Error> {
        let program = given.map_or_else(built_switchid, |path| Ok(path.to_path_buf()))?;
        let program = program.canonicalize().map_err(file("find", &program))?;
        let folder = tempfile::tempdir().map_err(file("create", &std::env::temp_dir()))?;
        Ok(Binary { program, folder })
    }

    /// Writes a file into the folder in which the program runs.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn write(&self, name: &str, text: &str) -> Result<(), Error> {
        let path = self.folder.path().join(name);
        std::fs::write(&path, text).map_err(file("write", &path))
    }

    /// Copies a file into that folder, under its own name, which is given back.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn copy(&self, from: &Path) -> Result<String, Error> {
        let name = from.file_name().unwrap_or_default().to_string_lossy().into_owned();
        std::fs::copy(from, self.folder.path().join(&name)).map_err(file("copy", from))?;
        Ok(name)
    }

    /// Runs the program with `--json`.
    ///
    /// # Errors
    /// [`Error::Start`]; what the program itself refuses is an answer.
    pub fn ask(&self, arguments: &[&str]) -> Result<Answer, Error> {
        let mut command = Command::new(&self.program);
        command.args(arguments).arg("--json").current_dir(self.folder.path()).stdin(Stdio::null());
        let (output, seconds) = clock::timed(|| command.output());
        let output = output.map_err(|source| Error::Start {
            program: self.program.display().to_string(),
            source,
            remedy: "give --switchid the path of a switchid that runs here",
        })?;
        Ok(Answer { document: document(&output), seconds })
    }
}

/// The one JSON document of a run that ended well.
fn document(output: &Output) -> Result<Value, Failure> {
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        let crashed = output.status.code().is_none_or(|code| code == PANICKED);
        let last = said.lines().rfind(|line| line.contains("error") || line.contains("panicked")).unwrap_or(&said);
        return Err(Failure { crashed, text: last.trim().to_string() });
    }
    serde_json::from_slice(&output.stdout)
        .map_err(|error| Failure { crashed: false, text: format!("no JSON: {error}") })
}

fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    let path = path.to_path_buf();
    move |source| Error::File { action, path, source }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::process::ExitStatusExt;
    use std::process::ExitStatus;

    /// A run that ended with this wait status: an exit code times 256, or a signal.
    fn ended(status: i32, stdout: &str, stderr: &str) -> Result<Value, Failure> {
        document(&Output { status: ExitStatus::from_raw(status), stdout: stdout.into(), stderr: stderr.into() })
    }

    #[test]
    fn a_crash_is_told_from_a_refusal() {
        assert_eq!(ended(0, "{\"verdict\": \"adequate\"}", "warning").unwrap()["verdict"], "adequate");
        let refused = ended(2 << 8, "", "switchid: warning: x\nswitchid: error: too short\n").unwrap_err();
        assert!(!refused.crashed);
        assert_eq!(refused.text, "switchid: error: too short");
        let panicked = ended(101 << 8, "", "\nthread 'main' panicked at errors.rs:76:\nindex\n").unwrap_err();
        assert!(panicked.crashed && panicked.text.contains("errors.rs:76"));
        assert!(ended(9, "", "").unwrap_err().crashed, "killed by a signal");
        assert!(!ended(0, "no document", "").unwrap_err().crashed);
    }
}
