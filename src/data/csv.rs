//! Reading a recording from text: CSV and its relatives.

use super::cells::Separator;
use super::dialect::{Dialect, is_comment, lines, split_lines};
use super::error::DataError;
use super::guess;
use super::header::{Column, Headings, Layout, TimeBase};
use super::instant::{DAY, Instant};
use super::kind::FileKind;
use super::number::number;
use super::preamble;
use super::rows::{Rows, Signals, Source};
use super::text::Text;
use crate::identify::Recording;
use crate::law::Model;

/// Rows from which columns without names are told apart.
const LOOKED_AT: usize = 4000;

/// The signals that the model names, or that the file seems to hold; how the file was taken, where that is not plain.
pub(super) fn read(source: &Source, text: Text, model: &Model) -> Result<(Layout, Signals, Vec<String>), DataError> {
    let head = text.head.as_str();
    if head.trim().is_empty() {
        return Err(DataError::Empty { file: source.file.clone() });
    }
    let dialect = Dialect::of(head).filter(|dialect| dialect.headers.len() > 1);
    let dialect = dialect.ok_or_else(|| DataError::NoTable { file: source.file.clone() })?;
    let source = &source.as_kind(source.kind.under(dialect.header.unwrap_or(0)));
    let mut headings = Headings::of(source.kind, &source.file, &dialect.headers);
    headings.dated = dialect.sample.iter().map(|cell| Instant::parse(cell).is_some()).collect();
    headings.rate = preamble::rate(head, &dialect);
    if dialect.header.is_none() {
        headings.by_content = guess::by_content(&columns(head, &dialect));
    }
    let layout = Layout::find(&headings, model)?;
    let signals = Reader::new(source, &layout, &dialect, text.lines).read(text)?;
    Ok((layout, signals, dialect.describe()))
}

/// Reads lines into rows.
struct Reader<'a> {
    source: &'a Source<'a>,
    layout: &'a Layout,
    dialect: &'a Dialect,
    rows: Rows<'a>,
    clock: Option<Clock>,
    /// Rows that came.
    row: usize,
}

/// Seconds since the first instant of a column; a clock without dates goes on after midnight.
struct Clock {
    origin: Instant,
    last: f64,
    midnights: f64,
}

impl Clock {
    fn seconds(&mut self, instant: Instant) -> f64 {
        let mut t = instant.since(self.origin) + self.midnights;
        if instant.day.is_none() && t < self.last - 0.5 * DAY {
            self.midnights += DAY;
            t += DAY;
        }
        self.last = t;
        t
    }
}

impl<'a> Reader<'a> {
    fn new(source: &'a Source<'a>, layout: &'a Layout, dialect: &'a Dialect, count: usize) -> Reader<'a> {
        let rows = Rows::new(source, layout, count);
        let first = (layout.time_base == TimeBase::Stamps).then(|| dialect.sample.get(layout.t.index)).flatten();
        let origin = first.filter(|cell| number(cell, dialect.decimal).is_none()).and_then(|cell| Instant::parse(cell));
        let clock = origin.map(|origin| Clock { origin, last: 0.0, midnights: 0.0 });
        Reader { source, layout, dialect, rows, clock, row: 0 }
    }

    fn read(mut self, text: Text) -> Result<Signals, DataError> {
        let mut above = 0;
        for block in text.blocks() {
            let block = block.map_err(|error| self.source.unread(error))?;
            above += self.take(&block, above);
        }
        self.rows.finish()
    }

    /// Takes the lines of a block of the text above which there are so many; how many these are.
    fn take(&mut self, block: &str, above: u64) -> u64 {
        let mut cells = Vec::new();
        let mut count = 0;
        for text in split_lines(block) {
            count += 1;
            let line = above + count;
            if line >= self.dialect.first && !text.trim_start().is_empty() && !is_comment(text) {
                self.dialect.separator.split(text, &mut cells);
                self.take_row(&mut cells, line);
            }
        }
        count
    }

    fn take_row(&mut self, cells: &mut Vec<&str>, line: u64) {
        let expected = self.dialect.headers.len();
        while cells.len() > expected && cells.last() == Some(&"") {
            cells.pop();
        }
        let row = self.row;
        self.row += 1;
        if cells.len() != expected {
            let (file, found) = (self.source.file.clone(), cells.len());
            let both = self.dialect.separator == Separator::Mark(',') && found == 2 * expected;
            return self.rows.refuse(line, DataError::Ragged { file, line, found, expected, both });
        }
        let t = self.time(cells, row, line);
        let (source, dialect) = (self.source, self.dialect);
        self.rows.push(line, t, |column| cell(source, dialect, cells, column, line));
    }

    fn time(&mut self, cells: &[&str], index: usize, line: u64) -> Result<f64, DataError> {
        let column = &self.layout.t;
        if let TimeBase::Grid(step) = self.layout.time_base {
            return Ok(index as f64 * step);
        }
        let Some(clock) = &mut self.clock else {
            return cell(self.source, self.dialect, cells, column, line);
        };
        let text = cells.get(column.index).copied().unwrap_or_default();
        let (file, header) = (self.source.file.clone(), column.header.clone());
        let instant =
            Instant::parse(text).ok_or(DataError::NoInstant { file, line, column: header, text: text.into() });
        instant.map(|instant| clock.seconds(instant))
    }
}

fn cell(source: &Source, dialect: &Dialect, cells: &[&str], column: &Column, line: u64) -> Result<f64, DataError> {
    let text = cells.get(column.index).copied().unwrap_or_default();
    let number = number(text, dialect.decimal);
    if let Some(reading) = number.filter(|number| Recording::is_reading(*number)) {
        return Ok(reading * column.factor);
    }
    let (file, column) = (source.file.clone(), column.header.clone());
    Err(match number {
        _ if text.is_empty() => DataError::EmptyCell { file, line, column }.missing(),
        Some(number) if number.is_nan() => DataError::Cell { file, line, column, text: text.into() }.missing(),
        _ => DataError::Cell { file, line, column, text: text.into() },
    })
}

/// The first numbers of every column; NaN where there is none.
fn columns(text: &str, dialect: &Dialect) -> Vec<Vec<f64>> {
    let mut columns = vec![Vec::new(); dialect.headers.len()];
    let mut cells = Vec::new();
    let body = lines(text).filter(|line| line.number >= dialect.first && !is_comment(line.text));
    for line in body.take(LOOKED_AT) {
        dialect.separator.split(line.text, &mut cells);
        for (column, cell) in columns.iter_mut().zip(&cells) {
            column.push(number(cell, dialect.decimal).unwrap_or(f64::NAN));
        }
    }
    columns
}

impl FileKind {
    /// The same kind with its header in that line.
    fn under(self, line: u64) -> FileKind {
        match self {
            FileKind::Csv { .. } => FileKind::Csv { header: line },
            other => other,
        }
    }
}
