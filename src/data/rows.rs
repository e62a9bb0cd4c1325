//! From the rows of any table to the signals of a section, in SI units.

use super::header::{Column, Layout};
use super::kind::FileKind;
use super::section::Section;
use super::{DataError, files};
use crate::identify::Recording;

/// The file that is being read.
pub(super) struct Source<'a> {
    /// The argument, with its section.
    pub(super) data: &'a str,
    /// The file's name.
    pub(super) file: String,
    pub(super) kind: FileKind,
    section: Section,
}

impl<'a> Source<'a> {
    /// The source that `DATA` or `DATA@t0:t1` names, and the content of its file.
    pub(super) fn open(data: &'a str) -> Result<(Source<'a>, Vec<u8>), DataError> {
        let section = Section::parse(data)?;
        let bytes = files::bytes(&section.path)?;
        let kind = FileKind::of(&bytes);
        Ok((Source { data, file: section.path.display().to_string(), kind, section }, bytes))
    }
}

/// Values of t, q, qd, F in SI units; empty where there is no such column.
pub(super) type Signals = [Vec<f64>; 4];

/// Takes rows one by one and keeps those of the section.
pub(super) struct Rows<'a> {
    source: &'a Source<'a>,
    layout: &'a Layout,
    signals: Signals,
    /// Time and number of the row before.
    last: Option<(f64, u64)>,
    /// Time of the first row.
    first: Option<f64>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(source: &'a Source<'a>, layout: &'a Layout) -> Rows<'a> {
        Rows { source, layout, signals: Signals::default(), last: None, first: None }
    }

    /// Takes the row of that number. Outside the section only its time is looked at.
    pub(super) fn push(&mut self, row: u64, cell: impl Fn(&Column) -> Result<f64, DataError>) -> Result<(), DataError> {
        let t = cell(&self.layout.t)?;
        if let Some((previous, previous_row)) = self.last.filter(|(previous, _)| t <= *previous) {
            let (file, kind) = (self.source.file.clone(), self.source.kind);
            return Err(DataError::NotIncreasing { file, kind, row, previous, previous_row, t });
        }
        self.last = Some((t, row));
        self.first.get_or_insert(t);
        if !self.source.section.contains(t) {
            return Ok(());
        }
        self.signals[0].push(t);
        for (slot, column) in [&self.layout.q, &self.layout.qd, &self.layout.excitation].into_iter().enumerate() {
            if let Some(column) = column {
                self.signals[slot + 1].push(cell(column)?);
            }
        }
        Ok(())
    }

    /// The signals, if there are samples enough.
    pub(super) fn finish(self) -> Result<Signals, DataError> {
        let count = self.signals[0].len();
        if count >= Recording::MINIMUM {
            return Ok(self.signals);
        }
        let span = match (self.first, self.last, self.source.section.is_whole()) {
            (Some(first), Some((last, _)), false) => Some((first, last)),
            _ => None,
        };
        Err(DataError::TooFew { data: self.source.data.into(), count, needed: Recording::MINIMUM, span })
    }
}
