//! Reading a recording from a CSV file.

use super::header::{Column, Layout};
use super::section::Section;
use super::{DataError, files};
use crate::identify::{Recording, RecordingError};
use crate::law::Model;
use ::csv::{ErrorKind, ReaderBuilder, StringRecord, Trim};

/// A recording, and how its file was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The recording, SI units.
    pub recording: Recording,
    /// Which column was taken for which quantity in which unit, one line each: `q = column "position_mm" in mm`.
    pub columns: Vec<String>,
}

/// Opens `DATA` or `DATA@t0:t1` and takes from it the columns that the model names.
///
/// # Errors
/// [`DataError`] names file, line and column, and what would mend it.
pub fn open_recording(data: &str, model: &Model) -> Result<Opened, DataError> {
    let section = Section::parse(data)?;
    let file = section.path.display().to_string();
    let text = files::read(&section.path)?;
    if text.trim().is_empty() {
        return Err(DataError::Empty { file });
    }
    let table = Table { data, file: &file, section: &section };
    let (layout, signals) = table.read(&text, model)?;
    let unmet = model.terms.iter().find(|entry| model.uses_excitation(entry.term) && layout.excitation.is_none());
    if let Some(entry) = unmet {
        return Err(DataError::NeedsExcitation { file, term: entry.key.clone() });
    }
    let [t, q, qd, excitation] = signals;
    let of = |column: &Option<Column>, values| column.as_ref().map(|_| values);
    let recording = Recording::new(data, t, of(&layout.q, q), of(&layout.qd, qd), of(&layout.excitation, excitation))
        .map_err(|error| locate(error, &file, &layout))?;
    Ok(Opened { recording, columns: layout.describe() })
}

/// A motion that stands still is named by its column.
fn locate(error: RecordingError, file: &str, layout: &Layout) -> DataError {
    let column = match &error {
        RecordingError::Constant { channel: "q", .. } => &layout.q,
        RecordingError::Constant { channel: "qd", .. } => &layout.qd,
        _ => &None,
    };
    match (error, column) {
        (RecordingError::Constant { channel, value, .. }, Some(column)) => {
            DataError::Constant { file: file.into(), column: column.header.clone(), channel, value }
        }
        (error, _) => DataError::Recording(error),
    }
}

struct Table<'a> {
    data: &'a str,
    file: &'a str,
    section: &'a Section,
}

/// Values of t, q, qd, F in SI units; empty where there is no such column.
type Signals = [Vec<f64>; 4];

impl Table<'_> {
    fn read(&self, text: &str, model: &Model) -> Result<(Layout, Signals), DataError> {
        let mut reader =
            ReaderBuilder::new().trim(Trim::All).delimiter(delimiter(text)).from_reader(text.trim_start().as_bytes());
        let skipped = text.len() - text.trim_start().len();
        let offset = text[..skipped].matches('\n').count() as u64;
        let headers: Vec<String> =
            reader.headers().map_err(|error| self.table(error, offset))?.iter().map(String::from).collect();
        let layout = Layout::find(self.file, &headers, &model.columns)?;
        let mut rows = Rows { table: self, layout: &layout, signals: Signals::default(), last: None, first: None };
        let mut record = StringRecord::new();
        while reader.read_record(&mut record).map_err(|error| self.table(error, offset))? {
            let line = record.position().map_or(0, |position| position.line()) + offset;
            rows.push(&record, line)?;
        }
        let signals = rows.finish()?;
        Ok((layout, signals))
    }

    fn table(&self, error: ::csv::Error, offset: u64) -> DataError {
        let file = self.file.to_string();
        let line = error.position().map_or(1, |position| position.line()) + offset;
        match error.kind() {
            ErrorKind::UnequalLengths { expected_len, len, .. } => {
                DataError::Ragged { file, line, found: *len, expected: *expected_len }
            }
            _ => DataError::Table { file, line, reason: error.to_string() },
        }
    }
}

struct Rows<'a> {
    table: &'a Table<'a>,
    layout: &'a Layout,
    signals: Signals,
    /// Time and line of the row before.
    last: Option<(f64, u64)>,
    /// Time of the first row.
    first: Option<f64>,
}

impl Rows<'_> {
    /// Takes one row. Outside the section only its time is looked at.
    fn push(&mut self, record: &StringRecord, line: u64) -> Result<(), DataError> {
        let t = self.cell(record, &self.layout.t, line)?;
        if let Some((previous, previous_line)) = self.last.filter(|(previous, _)| t <= *previous) {
            let file = self.table.file.into();
            return Err(DataError::NotIncreasing { file, line, previous, previous_line, t });
        }
        self.last = Some((t, line));
        self.first.get_or_insert(t);
        if !self.table.section.contains(t) {
            return Ok(());
        }
        self.signals[0].push(t);
        for (slot, column) in [&self.layout.q, &self.layout.qd, &self.layout.excitation].into_iter().enumerate() {
            if let Some(column) = column {
                let value = self.cell(record, column, line)?;
                self.signals[slot + 1].push(value);
            }
        }
        Ok(())
    }

    fn cell(&self, record: &StringRecord, column: &Column, line: u64) -> Result<f64, DataError> {
        let text = record.get(column.index).unwrap_or_default();
        let (file, header) = (self.table.file.to_string(), column.header.clone());
        if text.is_empty() {
            return Err(DataError::EmptyCell { file, line, column: header });
        }
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number * column.factor),
            _ => Err(DataError::Cell { file, line, column: header, text: text.into() }),
        }
    }

    fn finish(self) -> Result<Signals, DataError> {
        let count = self.signals[0].len();
        if count >= Recording::MINIMUM {
            return Ok(self.signals);
        }
        let span = match (self.first, self.last, self.table.section.is_whole()) {
            (Some(first), Some((last, _)), false) => Some((first, last)),
            _ => None,
        };
        Err(DataError::TooFew { data: self.table.data.into(), count, needed: Recording::MINIMUM, span })
    }
}

/// The comma, unless the header has none and has semicolons or tabs instead.
fn delimiter(text: &str) -> u8 {
    let header = text.trim_start().lines().next().unwrap_or_default();
    [b',', b';', b'\t'].into_iter().find(|mark| header.as_bytes().contains(mark)).unwrap_or(b',')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_tells_the_delimiter() {
        assert_eq!(delimiter("t,q;r\n1;2"), b',');
        assert_eq!(delimiter("t;q\n1,0;2,0"), b';');
        assert_eq!(delimiter("t\tq"), b'\t');
    }
}
