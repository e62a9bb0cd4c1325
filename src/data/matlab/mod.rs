//! MAT files: the variables of both formats as columns, those of MATLAB's tables, timetables and time series included.

mod columns;
mod hdf5;
mod mat5;
mod objects;
mod value;

use super::arrays::{Arrays, Unfit};
use super::error::DataError;
use super::kind::FileKind;
use super::names::{self, Name};
use super::rows::Source;
use columns::{Column, Content};
use objects::Objects;
use value::Value;

/// The variables of a file.
pub(super) struct Variables {
    named: Vec<(String, Value)>,
    objects: Objects,
}

/// Reads the variables of a MAT file, or of plain HDF5.
///
/// # Errors
/// [`DataError::Damaged`].
pub(super) fn open(source: &Source, bytes: Vec<u8>) -> Result<Variables, DataError> {
    let read = if source.kind == FileKind::Hdf5 { hdf5::read(bytes) } else { mat5::read(&bytes) };
    let (named, objects) = read.map_err(|reason| {
        let (file, kind) = (source.file.clone(), source.kind);
        DataError::Damaged { file, kind, reason }
    })?;
    Ok(Variables { named, objects })
}

impl Variables {
    fn columns(&self) -> Vec<Column<'_>> {
        columns::columns(&self.named, &self.objects)
    }
}

impl Arrays for Variables {
    fn names(&self) -> Vec<String> {
        let columns = self.columns();
        let names: Vec<Name> = columns.iter().map(|column| column.name.clone()).collect();
        let headers = names::headers(&names).into_iter().zip(&columns);
        headers
            .map(|(header, column)| column.unit.map_or(header.clone(), |unit| format!("{header} [{unit}]")))
            .collect()
    }

    fn values(&self, index: usize) -> Result<Vec<f64>, Unfit> {
        match self.columns().into_iter().nth(index).map(|column| column.content) {
            Some(Content::Stored(value)) => value.vector(),
            Some(Content::Times(times)) => times,
            None => Err(Unfit::Is("absent".into())),
        }
    }
}
