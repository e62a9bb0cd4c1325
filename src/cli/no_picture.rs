//! What stands in for `picture` in a build without the feature `pictures`: pictures are refused before any work.

use super::error::CommandError;
use std::path::Path;

/// A picture, which there is none of.
pub(super) enum Picture {}

impl Picture {
    /// Refuses the file.
    ///
    /// # Errors
    /// [`CommandError::NoPictures`].
    pub(super) fn open(path: &Path, _overwrite: bool) -> Result<Picture, CommandError> {
        Err(CommandError::NoPictures { file: path.display().to_string() })
    }

    /// What [`Picture::open`] never lets happen.
    ///
    /// # Errors
    /// None.
    pub(super) fn staircase(self, _stairs: &[(String, f64)], _floor: f64) -> Result<(), CommandError> {
        match self {}
    }
}
