//! Provides libclang for `fmu/check`: from PyPI, through the harness's Python environment.

use crate::command::probe;
use crate::error::Error;
use crate::python;
use std::path::Path;
use std::process::Command;

const WHERE: &str = "import clang, os; print(os.path.join(os.path.dirname(clang.__file__), 'native'), end='')";
const NO_COMPILER: &str = "install a C compiler (Debian, Ubuntu: `apt-get install gcc`); Rust links with it too";

/// Sets the command's environment so that bindgen finds libclang, and the C compiler's own headers, which libclang from
/// PyPI comes without. What the user has set stays.
///
/// # Errors
/// What the Python environment says, or that there is no C compiler.
pub fn provide(command: &mut Command) -> Result<(), Error> {
    provide_from(&python::environment()?, command)
}

/// The same from the environment with that interpreter.
fn provide_from(interpreter: &Path, command: &mut Command) -> Result<(), Error> {
    if std::env::var_os("LIBCLANG_PATH").is_none() {
        let (found, directory) = probe(Command::new(interpreter).args(["-c", WHERE]), python::NO_PYTHON)?;
        if !found {
            return Err(Error::Libclang { reason: directory });
        }
        command.env("LIBCLANG_PATH", directory);
    }
    if std::env::var_os("BINDGEN_EXTRA_CLANG_ARGS").is_none() {
        let (_, include) = probe(Command::new("cc").arg("-print-file-name=include"), NO_COMPILER)?;
        command.env("BINDGEN_EXTRA_CLANG_ARGS", format!("-I{include}"));
    }
    Ok(())
}
