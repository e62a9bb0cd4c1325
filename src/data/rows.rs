//! From the rows of any table to the signals of a section, in SI units.

use super::content::Content;
use super::error::DataError;
use super::header::{Column, Layout};
use super::kind::{self, FileKind};
use super::section::Section;
use crate::identify::Recording;

/// The file that is being read.
pub(super) struct Source<'a> {
    /// The argument, with its section.
    pub(super) data: &'a str,
    /// The file's name.
    pub(super) file: String,
    pub(super) kind: FileKind,
    /// Whether readings may be missing.
    bears_missing: bool,
    section: Section,
}

impl<'a> Source<'a> {
    /// The source that `DATA` or `DATA@t0:t1` names, and the content of its file; whether readings may be missing.
    pub(super) fn open(data: &'a str, bears_missing: bool) -> Result<(Source<'a>, Content), DataError> {
        let section = Section::parse(data)?;
        let mut content = Content::open(&section.path)?;
        let file = section.path.display().to_string();
        if kind::is_archive(&content.head) {
            content = Content::of(content.all().map_err(|source| DataError::Read { file: file.clone(), source })?);
        }
        let kind = FileKind::of(&content.head);
        Ok((Source { data, file, kind, bears_missing, section }, content))
    }

    /// Why the file could not be read.
    pub(super) fn unread(&self, source: std::io::Error) -> DataError {
        DataError::Read { file: self.file.clone(), source }
    }

    /// The same source, its kind told more closely.
    pub(super) fn as_kind(&self, kind: FileKind) -> Source<'a> {
        let (data, bears_missing) = (self.data, self.bears_missing);
        Source { data, file: self.file.clone(), kind, bears_missing, section: self.section.clone() }
    }
}

/// Values of t, q, qd, F in SI units, NaN where a reading is missing; empty where there is no such column.
pub(super) type Signals = [Vec<f64>; 4];

/// A kind of fault: its first occurrence, how many more there are, and the row of the last one.
struct Fault {
    first: DataError,
    others: u64,
    last: u64,
}

/// Takes rows one by one and keeps those of the section.
pub(super) struct Rows<'a> {
    source: &'a Source<'a>,
    layout: &'a Layout,
    signals: Signals,
    /// Time and number of the row before.
    last: Option<(f64, u64)>,
    /// Time of the first row.
    first: Option<f64>,
    /// How many rows came.
    count: u64,
    faults: Vec<Fault>,
}

impl<'a> Rows<'a> {
    /// For at most so many rows.
    pub(super) fn new(source: &'a Source<'a>, layout: &'a Layout, count: usize) -> Rows<'a> {
        let mut signals = Signals::default();
        let kept = [true, layout.q.is_some(), layout.qd.is_some(), layout.excitation.is_some()];
        if source.section.is_whole() {
            signals.iter_mut().zip(kept).filter(|(_, kept)| *kept).for_each(|(signal, _)| signal.reserve_exact(count));
        }
        Rows { source, layout, signals, last: None, first: None, count: 0, faults: Vec::new() }
    }

    /// Takes the row of that number and time. Outside the section only its time is looked at.
    pub(super) fn push(
        &mut self,
        row: u64,
        t: Result<f64, DataError>,
        cell: impl Fn(&Column) -> Result<f64, DataError>,
    ) {
        self.count += 1;
        let t = match t {
            Ok(t) => t,
            Err(error) => return self.refuse(row, error.of_time()),
        };
        let before = self.last.replace((t, row));
        if let Some((previous, previous_row)) = before.filter(|(previous, _)| t <= *previous) {
            let (file, kind) = (self.source.file.clone(), self.source.kind);
            return self.refuse(row, DataError::NotIncreasing { file, kind, row, previous, previous_row, t });
        }
        self.first.get_or_insert(t);
        if !self.source.section.contains(t) {
            return;
        }
        let mut values = [t, 0.0, 0.0, 0.0];
        let columns = [&self.layout.q, &self.layout.qd, &self.layout.excitation];
        for (value, column) in values[1..].iter_mut().zip(columns) {
            match column.as_ref().map(&cell) {
                Some(Ok(found)) => *value = found,
                Some(Err(DataError::Missing(_))) if self.source.bears_missing => *value = f64::NAN,
                Some(Err(error)) => return self.refuse(row, error),
                None => {}
            }
        }
        self.signals[0].push(t);
        for (slot, column) in columns.into_iter().enumerate() {
            if column.is_some() {
                self.signals[slot + 1].push(values[slot + 1]);
            }
        }
    }

    /// Keeps a fault: once with its place, the others of its kind as their number.
    pub(super) fn refuse(&mut self, row: u64, error: DataError) {
        match self.faults.iter_mut().find(|fault| fault.first.is_like(&error)) {
            Some(fault) => {
                fault.others += 1;
                fault.last = row;
            }
            None => self.faults.push(Fault { first: error, others: 0, last: row }),
        }
    }

    /// The signals, if there are samples enough and nothing is at fault.
    pub(super) fn finish(self) -> Result<Signals, DataError> {
        if !self.faults.is_empty() {
            return Err(self.faulty());
        }
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

    fn faulty(self) -> DataError {
        let Rows { source, layout, count, faults, .. } = self;
        let coarse = |fault: &Fault| match fault.first {
            DataError::NotIncreasing { previous, t, .. } => previous == t && 4 * (fault.others + 1) > count,
            _ => false,
        };
        if let Some(fault) = faults.iter().find(|fault| coarse(fault)) {
            let (file, kind, column) = (source.file.clone(), source.kind, layout.t.header.clone());
            return DataError::CoarseTime { file, kind, column, repeated: fault.others + 1, count };
        }
        let mut errors: Vec<DataError> = faults.into_iter().map(|fault| fault.told(source)).collect();
        if errors.len() == 1 { errors.remove(0) } else { DataError::Several(errors) }
    }
}

impl Fault {
    fn told(self, source: &Source) -> DataError {
        match self.others {
            0 => self.first,
            others => {
                let row = source.kind.row();
                DataError::Repeated { first: Box::new(self.first), others, row, last: self.last }
            }
        }
    }
}
