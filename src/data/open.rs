//! Opening a recording, whatever kind of file it is in.

use super::header::{Column, Layout};
use super::kind::FileKind;
use super::rows::{Signals, Source};
use super::{DataError, csv, files, stored};
use crate::identify::{Recording, RecordingError};
use crate::law::{Given, Model, Term, Units};

/// A recording, and how its file was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The recording, SI units.
    pub recording: Recording,
    /// Which column was taken for which quantity in which unit, one line each: `q = column "position_mm" in mm`.
    pub columns: Vec<String>,
    /// What is known of the units of coefficients.
    pub units: Units,
}

/// Opens `DATA` or `DATA@t0:t1` and takes from it the columns that the model names. The content tells what kind of file it
/// is: CSV, MAT (5, 7.3) or Parquet.
///
/// # Errors
/// [`DataError`] names file, line and column (or variable and sample), and what would mend it.
pub fn open_recording(data: &str, model: &Model) -> Result<Opened, DataError> {
    let (source, bytes) = Source::open(data)?;
    let (layout, signals) = read(&source, bytes, model)?;
    let unmet = model.terms.iter().find(|entry| model.uses_excitation(entry.term) && layout.excitation.is_none());
    if let Some(entry) = unmet {
        let (file, kind) = (source.file, source.kind);
        return Err(DataError::NeedsExcitation { file, kind, term: entry.key.clone() });
    }
    let [t, q, qd, excitation] = signals;
    let of = |column: &Option<Column>, values| column.as_ref().map(|_| values);
    let recording = Recording::new(data, t, of(&layout.q, q), of(&layout.qd, qd), of(&layout.excitation, excitation))
        .map_err(|error| locate(error, &source, &layout))?;
    let held = model.position(Term::Inertia).is_some_and(|place| matches!(model.terms[place].given, Given::Known(_)));
    Ok(Opened { recording, columns: layout.describe(), units: layout.units(held) })
}

fn read(source: &Source, bytes: Vec<u8>, model: &Model) -> Result<(Layout, Signals), DataError> {
    match source.kind {
        FileKind::Csv => csv::read(source, &files::text(&source.file, bytes)?, model),
        _ => stored::read(source, bytes, model),
    }
}

/// A motion that stands still is named by its column.
fn locate(error: RecordingError, source: &Source, layout: &Layout) -> DataError {
    let column = match &error {
        RecordingError::Constant { channel: "q", .. } => &layout.q,
        RecordingError::Constant { channel: "qd", .. } => &layout.qd,
        _ => &None,
    };
    match (error, column) {
        (RecordingError::Constant { channel, value, .. }, Some(column)) => {
            let (file, kind) = (source.file.clone(), source.kind);
            DataError::Constant { file, kind, column: column.header.clone(), channel, value }
        }
        (error, _) => DataError::Recording(error),
    }
}
