//! Files that store a recording column by column: MAT, MDF and Parquet. Without the feature `formats` they are refused
//! by name.

use super::error::DataError;
use super::header::Layout;
#[cfg(feature = "formats")]
use super::kind::FileKind;
use super::rows::{Signals, Source};
#[cfg(feature = "formats")]
use super::{arrays, matlab, mdf, parquet};
use crate::law::Model;

/// The signals that the model names.
#[cfg(feature = "formats")]
pub(super) fn read(source: &Source, bytes: Vec<u8>, model: &Model) -> Result<(Layout, Signals), DataError> {
    match source.kind {
        FileKind::Mat5 | FileKind::Hdf5 => arrays::read(source, &matlab::open(source, bytes)?, model),
        FileKind::Mdf => arrays::read(source, &mdf::open(source, bytes)?, model),
        FileKind::Parquet => arrays::read(source, &parquet::open(source, bytes)?, model),
        FileKind::Csv { .. } | FileKind::Spreadsheet => Err(DataError::Foreign { file: source.file.clone() }),
    }
}

/// Refuses the file.
#[cfg(not(feature = "formats"))]
pub(super) fn read(source: &Source, _bytes: Vec<u8>, _model: &Model) -> Result<(Layout, Signals), DataError> {
    Err(DataError::LeftOut { file: source.file.clone(), kind: source.kind })
}
