//! Opening a recording, whatever kind of file it is in.

use super::content::Content;
use super::error::DataError;
use super::header::{Column, Layout};
use super::kind::FileKind;
use super::rows::{Signals, Source};
use super::text::Text;
use super::{csv, kind, spreadsheet, stored};
use crate::identify::{Recording, RecordingError};
use crate::law::{Channel, Given, Model, Term, Unit, Units};

/// A recording, and how its file was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The recording, SI units.
    pub recording: Recording,
    /// Which column was taken for which quantity in which unit, one line each: `q = column "position_mm" in mm`.
    pub columns: Vec<String>,
    /// In one line, what was guessed of the file's form and columns; none where nothing had to be.
    pub guessed: Option<String>,
    /// The columns that were taken.
    pub taken: Vec<Taken>,
    /// What is known of the units of coefficients.
    pub units: Units,
}

/// A column that was taken for a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Taken {
    /// The quantity.
    pub channel: Channel,
    /// The column's header, or the rate that stands in place of times.
    pub column: String,
    /// Its unit, where header or model names one.
    pub unit: Option<Unit>,
    /// What told that it is this quantity, where nobody named it.
    pub guessed: Option<&'static str>,
}

/// Opens `DATA` or `DATA@t0:t1` and takes from it the columns that the model names. The content tells what kind of file
/// it is: text, a spreadsheet, MAT (5, 7.3) or Parquet.
///
/// # Errors
/// [`DataError`] names file, line and column (or variable and sample), and what would mend it.
pub fn open_recording(data: &str, model: &Model) -> Result<Opened, DataError> {
    open(data, model, false)
}

/// The same for a stream, which goes on where a sensor gives no reading: an empty cell, NaN, or what the format has for
/// no value makes its sample [incomplete](Recording::incomplete).
///
/// # Errors
/// The same; a time that is missing, and a column without any reading.
pub fn open_stream(data: &str, model: &Model) -> Result<Opened, DataError> {
    open(data, model, true)
}

fn open(data: &str, model: &Model, bears_missing: bool) -> Result<Opened, DataError> {
    let (source, content) = Source::open(data, bears_missing)?;
    let (layout, signals, form) = read(&source, content, model)?;
    let unmet = model.terms.iter().find(|entry| entry.term.uses_excitation() && layout.excitation.is_none());
    if let Some(entry) = unmet {
        let (file, kind) = (source.file, source.kind);
        return Err(DataError::NeedsExcitation { file, kind, term: entry.key.clone() });
    }
    let [t, q, qd, excitation] = signals;
    let of = |column: &Option<Column>, values| column.as_ref().map(|_| values);
    let [q, qd, excitation] = [of(&layout.q, q), of(&layout.qd, qd), of(&layout.excitation, excitation)];
    let recording = Recording::with_missing(data, t, q, qd, excitation);
    let recording = recording.map_err(|error| locate(error, &source, &layout))?;
    let held = model.position(Term::Inertia).is_some_and(|place| matches!(model.terms[place].given, Given::Known(_)));
    let guessed = guessed(data, form, layout.guesses());
    Ok(Opened { recording, columns: layout.describe(), guessed, taken: taken(&layout), units: layout.units(held) })
}

/// One line of what was guessed.
fn guessed(data: &str, form: Vec<String>, columns: Vec<String>) -> Option<String> {
    let columns = match columns.is_empty() {
        true => None,
        false => Some(format!("{}; else name them with --columns", columns.join(", "))),
    };
    let said: Vec<String> = form.into_iter().chain(columns).collect();
    (!said.is_empty()).then(|| format!("{data}: read with {}", said.join(", ")))
}

fn taken(layout: &Layout) -> Vec<Taken> {
    let taken = |(channel, column): (Channel, &Column)| Taken {
        channel,
        column: column.header.clone(),
        unit: column.unit,
        guessed: column.guessed,
    };
    layout.columns().map(taken).collect()
}

/// The columns, the signals, and how the file was taken where that is not plain.
fn read(source: &Source, content: Content, model: &Model) -> Result<(Layout, Signals, Vec<String>), DataError> {
    let all = |content: Content| content.all().map_err(|error| source.unread(error));
    match source.kind {
        FileKind::Csv { .. } => {
            let file = || source.file.clone();
            if let Some((what, how)) = kind::foreign(&content.head) {
                return Err(DataError::Convert { file: file(), what, how });
            }
            let text = Text::of(content).map_err(|error| source.unread(error))?;
            csv::read(source, text.ok_or_else(|| DataError::Foreign { file: file() })?, model)
        }
        FileKind::Spreadsheet => csv::read(source, spreadsheet::text(source, all(content)?)?, model),
        _ => stored::read(source, all(content)?, model).map(|(layout, signals)| (layout, signals, Vec::new())),
    }
}

/// A motion that stands still, or is never read, is named by its column.
fn locate(error: RecordingError, source: &Source, layout: &Layout) -> DataError {
    let (file, kind) = (source.file.clone(), source.kind);
    let column = |channel: &str| match channel {
        "q" => layout.q.as_ref(),
        "qd" => layout.qd.as_ref(),
        _ => layout.excitation.as_ref(),
    };
    let header = |channel: &str| column(channel).map(|column| column.header.clone()).unwrap_or_default();
    match error {
        RecordingError::Constant { channel, value, .. } => {
            DataError::Constant { file, kind, column: header(channel), channel, value }
        }
        RecordingError::NoReading { channel, .. } => {
            DataError::NoReading { file, kind, column: header(channel), channel }
        }
        error => DataError::Recording(error),
    }
}
