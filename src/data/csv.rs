//! Reading a recording from CSV text.

use super::DataError;
use super::header::{Column, Layout};
use super::rows::{Rows, Signals, Source};
use crate::law::Model;
use ::csv::{ErrorKind, ReaderBuilder, StringRecord, Trim};

/// The signals that the model names.
pub(super) fn read(source: &Source, text: &str, model: &Model) -> Result<(Layout, Signals), DataError> {
    let start = text.trim_start();
    if start.is_empty() {
        return Err(DataError::Empty { file: source.file.clone() });
    }
    let offset = text[..text.len() - start.len()].matches('\n').count() as u64;
    let mut reader = ReaderBuilder::new().trim(Trim::All).delimiter(delimiter(start)).from_reader(start.as_bytes());
    let headers = reader.headers().map_err(|error| table(source, error, offset))?;
    let headers: Vec<String> = headers.iter().map(String::from).collect();
    let layout = Layout::find(source.kind, &source.file, &headers, model)?;
    let mut rows = Rows::new(source, &layout);
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| table(source, error, offset))? {
        let line = record.position().map_or(0, |position| position.line()) + offset;
        rows.push(line, |column| cell(source, &record, column, line))?;
    }
    let signals = rows.finish()?;
    Ok((layout, signals))
}

fn table(source: &Source, error: ::csv::Error, offset: u64) -> DataError {
    let file = source.file.clone();
    let line = error.position().map_or(1, |position| position.line()) + offset;
    match error.kind() {
        ErrorKind::UnequalLengths { expected_len, len, .. } => {
            DataError::Ragged { file, line, found: *len, expected: *expected_len }
        }
        _ => DataError::Table { file, line, reason: error.to_string() },
    }
}

fn cell(source: &Source, record: &StringRecord, column: &Column, line: u64) -> Result<f64, DataError> {
    let text = record.get(column.index).unwrap_or_default();
    let (file, header) = (source.file.clone(), column.header.clone());
    if text.is_empty() {
        return Err(DataError::EmptyCell { file, line, column: header });
    }
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number * column.factor),
        _ => Err(DataError::Cell { file, line, column: header, text: text.into() }),
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
