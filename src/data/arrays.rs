//! Recordings whose columns are stored one after the other: the variables of a MAT file, the columns of Parquet.

use super::error::DataError;
use super::header::{Column, Headings, Layout, TimeBase};
use super::rows::{Rows, Signals, Source};
use crate::identify::Recording;
use crate::law::Model;

/// Why a stored column cannot be a signal.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Unfit {
    /// It is something else than a vector of real numbers: `text`, `a 3 × 100 matrix`.
    Is(String),
    /// Its bytes make no sense.
    Damaged(String),
}

/// A file of named columns.
pub(super) trait Arrays {
    /// The names of its columns, with their units where they have any.
    fn names(&self) -> Vec<String>;

    /// The numbers of a column; NaN where there is none.
    fn values(&self, index: usize) -> Result<Vec<f64>, Unfit>;
}

/// A column whose numbers are in memory.
struct Stored<'a> {
    column: &'a Column,
    values: Vec<f64>,
}

/// The signals that the model names.
pub(super) fn read(source: &Source, arrays: &impl Arrays, model: &Model) -> Result<(Layout, Signals), DataError> {
    let names = arrays.names();
    let layout = Layout::find(&Headings::of(source.kind, &source.file, &names), model)?;
    let load = |column| load(source, arrays, column);
    let measured = [&layout.q, &layout.qd, &layout.excitation].into_iter().flatten();
    let mut stored = measured.map(load).collect::<Result<Vec<_>, _>>()?;
    let count = stored.first().map_or(0, |first| first.values.len());
    let t = match layout.time_base {
        TimeBase::Stamps => load(&layout.t)?,
        TimeBase::Grid(step) => {
            Stored { column: &layout.t, values: (0..count).map(|index| index as f64 * step).collect() }
        }
        base => Stored { column: &layout.t, values: grid(source, load(&layout.t)?, base, count)? },
    };
    stored.push(t);
    check_lengths(source, &stored)?;
    let mut rows = Rows::new(source, &layout, count);
    for index in 0..count {
        let t = cell(source, &stored, &layout.t, index);
        rows.push(index as u64 + 1, t, |column| cell(source, &stored, column, index));
    }
    let signals = rows.finish()?;
    Ok((layout, signals))
}

fn load<'a>(source: &Source, arrays: &impl Arrays, column: &'a Column) -> Result<Stored<'a>, DataError> {
    let (file, kind) = (source.file.clone(), source.kind);
    match arrays.values(column.index) {
        Ok(values) => Ok(Stored { column, values }),
        Err(Unfit::Is(what)) => Err(DataError::NotAVector { file, kind, column: column.header.clone(), what }),
        Err(Unfit::Damaged(reason)) => Err(DataError::Damaged { file, kind, reason }),
    }
}

/// Times 0, h, 2h … in the unit of the column, from a single step or rate.
fn grid(source: &Source, stored: Stored, base: TimeBase, count: usize) -> Result<Vec<f64>, DataError> {
    let refused = |found: String| {
        let (file, variable) = (source.file.clone(), stored.column.header.clone());
        DataError::SampleTime { file, variable, found }
    };
    match stored.values[..] {
        [value] if value > 0.0 && value.is_finite() => {
            let at = |index: usize| if base == TimeBase::Rate { index as f64 / value } else { index as f64 * value };
            Ok((0..count).map(at).collect())
        }
        [value] => Err(refused(value.to_string())),
        _ => Err(refused(format!("{} numbers", stored.values.len()))),
    }
}

fn check_lengths(source: &Source, stored: &[Stored]) -> Result<(), DataError> {
    let Some((first, others)) = stored.split_first() else { return Ok(()) };
    let Some(other) = others.iter().find(|other| other.values.len() != first.values.len()) else { return Ok(()) };
    Err(DataError::UnequalLength {
        file: source.file.clone(),
        kind: source.kind,
        column: other.column.header.clone(),
        count: other.values.len(),
        first: first.column.header.clone(),
        expected: first.values.len(),
    })
}

fn cell(source: &Source, stored: &[Stored], column: &Column, index: usize) -> Result<f64, DataError> {
    let values = stored.iter().find(|stored| stored.column == column).map_or(&[][..], |stored| &stored.values);
    let value = values.get(index).copied().unwrap_or(f64::NAN);
    if Recording::is_reading(value) {
        return Ok(value * column.factor);
    }
    let (file, kind, column) = (source.file.clone(), source.kind, column.header.clone());
    let error = DataError::NotFinite { file, kind, row: index as u64 + 1, column, value: value.to_string() };
    Err(if value.is_nan() { error.missing() } else { error })
}
