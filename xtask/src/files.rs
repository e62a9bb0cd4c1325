//! Files that chores write, and what went wrong with them.

use crate::error::Error;
use std::path::Path;

/// Writes a file where its content changes.
///
/// # Errors
/// [`Error::File`].
pub fn write(path: &Path, content: &[u8]) -> Result<(), Error> {
    if std::fs::read(path).is_ok_and(|present| present == content) {
        return Ok(());
    }
    std::fs::write(path, content).map_err(file("write", path))
}

/// The error of an action on a file.
pub fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    let path = path.to_path_buf();
    move |source| Error::File { action, path, source }
}
