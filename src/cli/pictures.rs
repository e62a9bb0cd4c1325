//! `--picture OUT.svg|.png|.html`: what a command found, drawn.

use super::error::CommandError;
#[cfg(feature = "pictures")]
use super::output::Target;
use super::output::Targets;
use crate::report::Figure;
#[cfg(feature = "pictures")]
use crate::report::{self, Block};
use clap::Args;
use std::path::PathBuf;

/// Where a picture goes.
#[derive(Args, Default)]
pub(super) struct PictureArguments {
    /// Draw what was found into this file; its extension says how: .svg, .png or .html (to be zoomed)
    #[arg(long, value_name = "OUT.svg|png|html")]
    picture: Option<PathBuf>,
}

/// How a picture is drawn.
#[cfg(feature = "pictures")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Svg,
    Png,
    Html,
}

/// A picture to be drawn into a file.
#[cfg(feature = "pictures")]
pub(super) struct Picture {
    target: Target,
    file: String,
    kind: Kind,
}

/// A picture, which a build without the feature `pictures` has none of.
#[cfg(not(feature = "pictures"))]
pub(super) enum Picture {}

impl PictureArguments {
    /// The picture that is asked for.
    ///
    /// # Errors
    /// [`CommandError::PictureKind`]; what [`Targets::claim`] refuses.
    #[cfg(feature = "pictures")]
    pub(super) fn open(&self, targets: &mut Targets) -> Result<Option<Picture>, CommandError> {
        let Some(path) = &self.picture else { return Ok(None) };
        let file = path.display().to_string();
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let kind = match extension.as_deref() {
            Some("svg") => Kind::Svg,
            Some("png") => Kind::Png,
            Some("html" | "htm") => Kind::Html,
            _ => return Err(CommandError::PictureKind { file }),
        };
        Ok(Some(Picture { target: targets.claim("--picture", path)?, file, kind }))
    }

    /// Refuses any picture before any work.
    ///
    /// # Errors
    /// [`CommandError::NoPictures`].
    #[cfg(not(feature = "pictures"))]
    pub(super) fn open(&self, _targets: &mut Targets) -> Result<Option<Picture>, CommandError> {
        let refused = |path: &PathBuf| Err(CommandError::NoPictures { file: path.display().to_string() });
        self.picture.as_ref().map_or(Ok(None), refused)
    }
}

impl Picture {
    /// Draws it.
    ///
    /// # Errors
    /// [`CommandError::Draw`] says what the drawing failed on; what writing says.
    #[cfg(feature = "pictures")]
    pub(super) fn draw(&self, figure: &Figure) -> Result<(), CommandError> {
        let failed = |reason: String| CommandError::Draw { file: self.file.clone(), reason };
        match self.kind {
            Kind::Svg => self.target.write(&report::svg(figure).map_err(failed)?),
            Kind::Png => self.target.write_bytes(&report::png(figure).map_err(failed)?),
            Kind::Html => self.target.write(&report::page(&figure.title, &[Block::Figure(figure.clone())])),
        }
    }

    /// What [`PictureArguments::open`] never lets happen.
    ///
    /// # Errors
    /// None.
    #[cfg(not(feature = "pictures"))]
    pub(super) fn draw(&self, _figure: &Figure) -> Result<(), CommandError> {
        match *self {}
    }
}
