//! The content of a file: its beginning in memory, the rest where it is until it is wanted.

use super::error::DataError;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Bytes of the beginning: thousands of lines, which tell kind and dialect of a table of any length.
const BEGINNING: u64 = 1 << 20;

/// The content of a file.
pub(super) struct Content {
    /// Its first bytes; all of a small file.
    pub(super) head: Vec<u8>,
    /// What follows them.
    pub(super) rest: Box<dyn Read>,
    /// How many bytes there are, as far as the system says.
    pub(super) length: u64,
}

impl Content {
    /// Opens a file and reads its beginning.
    ///
    /// # Errors
    /// [`DataError::Read`].
    pub(super) fn open(path: &Path) -> Result<Content, DataError> {
        Content::begin(path).map_err(|source| DataError::Read { file: path.display().to_string(), source })
    }

    fn begin(path: &Path) -> io::Result<Content> {
        let mut file = File::open(path)?;
        let length = file.metadata()?.len();
        let mut head = Vec::new();
        file.by_ref().take(BEGINNING).read_to_end(&mut head)?;
        Ok(Content { head, rest: Box::new(file), length })
    }

    /// Content that is in memory.
    pub(super) fn of(head: Vec<u8>) -> Content {
        let length = head.len() as u64;
        Content { head, rest: Box::new(io::empty()), length }
    }

    /// All of its bytes.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn all(mut self) -> io::Result<Vec<u8>> {
        self.head.reserve_exact(usize::try_from(self.length).unwrap_or(0).saturating_sub(self.head.len()));
        self.rest.read_to_end(&mut self.head)?;
        Ok(self.head)
    }
}
