//! Spreadsheets: the first sheet with numbers, as the text that it would be exported to.

#[cfg(feature = "formats")]
use super::content::Content;
use super::error::DataError;
use super::rows::Source;
use super::text::Text;
#[cfg(feature = "formats")]
use calamine::{CellErrorType, Data, Range, Reader};

/// The sheet as text with tabs between cells, a line for each of its rows.
///
/// # Errors
/// [`DataError::Damaged`].
#[cfg(feature = "formats")]
pub(super) fn text(source: &Source, bytes: Vec<u8>) -> Result<Text, DataError> {
    let damaged = |reason: String| DataError::Damaged { file: source.file.clone(), kind: source.kind, reason };
    let cursor = std::io::Cursor::new(bytes);
    let mut book = calamine::open_workbook_auto_from_rs(cursor).map_err(|error| damaged(error.to_string()))?;
    for name in book.sheet_names() {
        let sheet = book.worksheet_range(&name).map_err(|error| damaged(error.to_string()))?;
        if sheet.used_cells().any(|(.., cell)| matches!(cell, Data::Float(_) | Data::Int(_))) {
            let text = Text::of(Content::of(lines(&sheet).into_bytes())).map_err(|error| source.unread(error))?;
            return text.ok_or_else(|| DataError::Foreign { file: source.file.clone() });
        }
    }
    Err(damaged("no sheet has numbers".into()))
}

/// Refuses the file.
#[cfg(not(feature = "formats"))]
pub(super) fn text(source: &Source, _bytes: Vec<u8>) -> Result<Text, DataError> {
    Err(DataError::LeftOut { file: source.file.clone(), kind: source.kind })
}

#[cfg(feature = "formats")]
fn lines(sheet: &Range<Data>) -> String {
    let above = sheet.start().map_or(0, |(row, _)| row as usize);
    let mut text = "\n".repeat(above);
    for row in sheet.rows() {
        let cells: Vec<String> = row.iter().map(cell).collect();
        text += &(cells.join("\t") + "\n");
    }
    text
}

#[cfg(feature = "formats")]
fn cell(cell: &Data) -> String {
    match cell {
        Data::DateTime(time) => {
            let (year, month, day, hour, minute, second, milli) = time.to_ymd_hms_milli();
            format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02}.{milli:03}")
        }
        // =NA(): no value
        Data::Error(CellErrorType::NA) => f64::NAN.to_string(),
        other => other.to_string().replace(['\t', '\n', '\r'], " "),
    }
}

#[cfg(test)]
mod tests {
    #[cfg(feature = "formats")]
    #[test]
    fn a_cell_without_a_value_is_none() {
        use super::*;
        let cells = [Data::Empty, Data::Error(CellErrorType::NA), Data::Float(0.5), Data::Error(CellErrorType::Div0)];
        assert_eq!(cells.each_ref().map(cell), ["", "NaN", "0.5", "#DIV/0!"]);
    }
}
