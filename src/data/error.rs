//! Why something that a user brought cannot be used.

use super::kind::FileKind;
use crate::identify::{RecordingError, SavedLawsError};
use crate::law::ModelError;
use crate::simulate::ScenarioError;
use std::mem::discriminant;
use thiserror::Error;

/// Why a file cannot be used. `file` is its name as the user wrote it, `line` counts from 1 with the header as line 1,
/// `row` is a line of CSV or counts samples from 1.
#[derive(Debug, Error)]
pub enum DataError {
    /// It cannot be opened or read.
    #[error("{file}: cannot be read: {source}{}", mending(source))]
    Read {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// It is empty.
    #[error("{file}: the file is empty: it needs a header such as t,q,qd,F and one line per sample")]
    Empty {
        /// The file.
        file: String,
    },
    /// Text without a table.
    #[error(
        "{file}: cannot be read as a table: no line has two numbers or more with a comma, semicolon, tab, blank or | between them; \
         it needs a header such as t,q,qd,F and one line per sample"
    )]
    NoTable {
        /// The file.
        file: String,
    },
    /// A kind of file that others convert.
    #[error("{file}: cannot be read: it is {what}; {how}")]
    Convert {
        /// The file.
        file: String,
        /// What it is.
        what: &'static str,
        /// How it becomes readable.
        how: &'static str,
    },
    /// Faults of several kinds.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Several(Vec<DataError>),
    /// A fault that comes again and again.
    #[error("{first} ({others} more {row}s like it, the last one {row} {last})")]
    Repeated {
        /// Its first occurrence.
        first: Box<DataError>,
        /// How many more there are.
        others: u64,
        /// What a row is called.
        row: &'static str,
        /// The last one.
        last: u64,
    },
    /// Time stamps too coarse to tell samples apart.
    #[error(
        "{file}: {} \"{column}\" repeats the time before in {repeated} of {count} {}s: its digits are too few for this rate. Export more of \
         them, or name the rate in its place: --columns t=1000Hz",
        kind.column(), kind.row()
    )]
    CoarseTime {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The column.
        column: String,
        /// How many rows repeat the time before.
        repeated: u64,
        /// How many rows there are.
        count: u64,
    },
    /// A cell that is neither date nor clock time, below others that are.
    #[error(
        "{file}: line {line}: column \"{column}\": \"{text}\" is no date or clock time such as 2024-05-01 12:00:00.25: correct it or delete the line"
    )]
    NoInstant {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// The header.
        column: String,
        /// The cell.
        text: String,
    },
    /// It is of no known kind.
    #[error(
        "{file}: cannot be read: this is neither CSV text (UTF-8) nor a MAT file of version 5 or 7.3 nor Parquet; export it as one of these, or as a spreadsheet (in MATLAB: save with -v7)"
    )]
    Foreign {
        /// The file.
        file: String,
    },
    /// Its kind is one that this build does not read.
    #[error(
        "{file}: this is a {} file, which this build of switchid does not read: build it with the feature \"formats\" (on by default), or convert the file to CSV",
        kind.name()
    )]
    LeftOut {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
    },
    /// It breaks off, or its bytes make no sense.
    #[error("{file}: this {} file is damaged, incomplete or of a form that is not supported: {reason}. Copy or export it again", kind.name())]
    Damaged {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// What was found.
        reason: String,
    },
    /// A column that holds no signal.
    #[error(
        "{file}: {0} \"{column}\" is {what}, but a vector of real numbers is needed: convert it, or name another {0} in the model's [columns]",
        kind.column()
    )]
    NotAVector {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The column.
        column: String,
        /// What it is instead.
        what: String,
    },
    /// Columns of different length.
    #[error(
        "{file}: {0} \"{column}\" has {count} values, but \"{first}\" has {expected}: all {0}s of a recording must be equally long",
        kind.column()
    )]
    UnequalLength {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The column.
        column: String,
        /// How many values it has.
        count: usize,
        /// The column that it is compared with.
        first: String,
        /// How many values that one has.
        expected: usize,
    },
    /// A value that is missing or infinite.
    #[error(
        "{file}: {0} {row}: {1} \"{column}\" is {value}, not a finite number, or one that no sensor reads: correct it or delete the {0}",
        kind.row(), kind.column()
    )]
    NotFinite {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The row.
        row: u64,
        /// The column.
        column: String,
        /// What stands there.
        value: String,
    },
    /// A reading that the sensor did not give, where every one is needed.
    #[error("{0}; `switchid identify` alone takes it as a reading that is missing, and goes on")]
    Missing(Box<DataError>),
    /// A sample time or sampling rate that is none.
    #[error(
        "{file}: variable \"{variable}\" is {found}: as the distance of two samples (dt, Ts in s) or the sampling rate (fs in Hz) it must be one positive number"
    )]
    SampleTime {
        /// The file.
        file: String,
        /// The variable.
        variable: String,
        /// What it is.
        found: String,
    },
    /// The section is no `t0:t1`.
    #[error("{data}: \"{section}\" is no section: write two times in seconds, DATA@1.5:20")]
    Section {
        /// The argument.
        data: String,
        /// What stands after the `@`.
        section: String,
    },
    /// A column that must be there is not.
    #[error(
        "{file}: {}there is no {1} \"{column}\" for {channel}; the {1}s are {columns}. Name the right one: --columns {channel}=NAME, or in the model: [columns] {channel} = \"...\"{2}",
        kind.heading(), kind.column(), time_hint(*kind, channel)
    )]
    MissingColumn {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The column that was looked for.
        column: String,
        /// What it would hold.
        channel: &'static str,
        /// The columns there are.
        columns: String,
    },
    /// Neither displacement nor velocity.
    #[error(
        "{file}: {}there is no {1} \"q\" or \"qd\", and one of them is needed; the {1}s are {columns}. Name the right one: --columns q=NAME (or its position, from 1), or in the model: [columns] q = \"...\"",
        kind.heading(), kind.column()
    )]
    NoMotion {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The columns there are.
        columns: String,
    },
    /// Several columns fit.
    #[error("{file}: {}several {}s are \"{column}\": {columns}. Rename all but one", kind.heading(), kind.column())]
    Ambiguous {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The column that was looked for.
        column: String,
        /// The headers that fit.
        columns: String,
    },
    /// One column for two quantities.
    #[error(
        "{file}: {}{} \"{column}\" is taken for {first} and for {second}: name another one in the model's [columns], or rename it where \
         {second} is not measured",
        kind.heading(), kind.column()
    )]
    Shared {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The column.
        column: String,
        /// One quantity.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// A unit that is not known.
    #[error("{file}: {}{} \"{column}\": unknown unit \"{unit}\" for {channel}; known are {known}", kind.heading(), kind.column())]
    UnknownUnit {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The header.
        column: String,
        /// The unit as written.
        unit: String,
        /// The quantity.
        channel: &'static str,
        /// The units that it may have.
        known: Box<str>,
    },
    /// An acceleration in place of a motion or a force.
    #[error(
        "{file}: {}{} \"{column}\" is an acceleration, but {channel} is none: name the column of a displacement or velocity; where only \
         accelerations were measured, integrate them once with their mean taken out, and name the result qd",
        kind.heading(), kind.column()
    )]
    Acceleration {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The header.
        column: String,
        /// The quantity.
        channel: &'static str,
    },
    /// A unit of another quantity.
    #[error(
        "{file}: {}{1} \"{column}\": {unit} is a unit of {quantity}, but {channel} is {expected}. Map another {1} to {channel}, or rename this one if its ending is no unit",
        kind.heading(), kind.column()
    )]
    WrongUnit {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The header.
        column: Box<str>,
        /// The unit as written.
        unit: Box<str>,
        /// What the unit measures.
        quantity: &'static str,
        /// The quantity.
        channel: &'static str,
        /// What it is.
        expected: &'static str,
    },
    /// The model names another unit than the header.
    #[error(
        "{file}: \"{column}\" is in {unit}, but the model says [units] {channel} = \"{declared}\": take one of them out, or correct it"
    )]
    UnitContradicts {
        /// The file.
        file: String,
        /// The header.
        column: String,
        /// The header's unit.
        unit: &'static str,
        /// The quantity.
        channel: &'static str,
        /// The model's unit.
        declared: Box<str>,
    },
    /// Displacement and velocity of different kinds.
    #[error(
        "{file}: {}{1} \"{velocity}\" ({velocity_quantity}) is not the rate of {1} \"{displacement}\" ({displacement_quantity}): correct the units",
        kind.heading(), kind.column()
    )]
    UnitsDisagree {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The displacement's header.
        displacement: String,
        /// What it measures.
        displacement_quantity: &'static str,
        /// The velocity's header.
        velocity: String,
        /// What it measures.
        velocity_quantity: &'static str,
    },
    /// A line that is no row of the table.
    #[error(
        "{file}: line {line}: {found} cells under {expected} columns: {}",
        if *both { "where the comma is also the decimal mark, export with semicolons or decimal points" } else { "complete the line or delete it" }
    )]
    Ragged {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// How many cells it has.
        found: usize,
        /// How many columns there are.
        expected: usize,
        /// Whether commas seem to separate cells and decimals alike.
        both: bool,
    },
    /// A cell without a value.
    #[error("{file}: line {line}: column \"{column}\" is empty: fill in the value or delete the line")]
    EmptyCell {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// The header.
        column: String,
    },
    /// A cell that is no number.
    #[error(
        "{file}: line {line}: column \"{column}\": \"{text}\" is not a finite number, or one that no sensor reads: correct it or delete the line"
    )]
    Cell {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// The header.
        column: String,
        /// The cell.
        text: String,
    },
    /// Time that does not increase.
    #[error(
        "{file}: {0} {row}: time does not increase: {previous} s on {0} {previous_row}, then {t} s. Sort the {0}s and delete duplicates",
        kind.row()
    )]
    NotIncreasing {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The row.
        row: u64,
        /// The time before, s.
        previous: f64,
        /// The row before.
        previous_row: u64,
        /// The time, s.
        t: f64,
    },
    /// No sample, or too few.
    #[error("{data}: {count} samples are too few: at least {needed} are needed{}", span_hint(*.span))]
    TooFew {
        /// The file, with its section.
        data: String,
        /// How many samples there are.
        count: usize,
        /// How many it takes.
        needed: usize,
        /// The times that the file holds, s; where a section was asked for.
        span: Option<(f64, f64)>,
    },
    /// A column without any reading.
    #[error(
        "{file}: {0} \"{column}\" has no value at all: check the sensor or the export, or map another {0} to {channel}",
        kind.column()
    )]
    NoReading {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The header.
        column: String,
        /// The quantity.
        channel: &'static str,
    },
    /// A column that never changes.
    #[error(
        "{file}: {0} \"{column}\" is {value} in every {1}: a motion that stands still determines no law. Check the sensor, or map another {0} to {channel}",
        kind.column(), kind.row()
    )]
    Constant {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The header.
        column: String,
        /// The quantity.
        channel: &'static str,
        /// The value.
        value: f64,
    },
    /// The signals are no recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The model needs a quantity that is not measured.
    #[error(
        "{file}: the term \"{term}\" needs the excitation, but the file has no {} \"F\": map one in the model, [columns] F = \"...\", or leave the term out",
        kind.column()
    )]
    NeedsExcitation {
        /// The file.
        file: String,
        /// What kind of file it is.
        kind: FileKind,
        /// The term.
        term: String,
    },
    /// A model file is refused.
    #[error("{file}: {source}")]
    Model {
        /// The file.
        file: String,
        /// Why.
        source: ModelError,
    },
    /// A scenario file is refused.
    #[error("{file}: {source}")]
    Scenario {
        /// The file.
        file: String,
        /// Why.
        source: ScenarioError,
    },
    /// A file of known laws is refused.
    #[error("{file}: {source}")]
    Laws {
        /// The file.
        file: String,
        /// Why.
        source: SavedLawsError,
    },
}

impl DataError {
    /// Whether it is the same fault of the same column in another row.
    pub(super) fn is_like(&self, other: &DataError) -> bool {
        match (self, other) {
            (DataError::Missing(one), DataError::Missing(other)) => one.is_like(other),
            _ => discriminant(self) == discriminant(other) && self.column() == other.column(),
        }
    }

    /// The fault of a cell in which the sensor gave no reading.
    pub(super) fn missing(self) -> DataError {
        DataError::Missing(Box::new(self))
    }

    /// The same fault of a time, which no command takes as missing.
    pub(super) fn of_time(self) -> DataError {
        if let DataError::Missing(error) = self { *error } else { self }
    }

    fn column(&self) -> Option<&str> {
        match self {
            DataError::Cell { column, .. } | DataError::EmptyCell { column, .. } => Some(column),
            DataError::NotFinite { column, .. } | DataError::NoInstant { column, .. } => Some(column),
            _ => None,
        }
    }
}

/// A rate may stand in place of times.
fn time_hint(kind: FileKind, channel: &str) -> &'static str {
    match channel {
        "t" if kind.is_mat() => "; or save a scalar dt or Ts (s) or fs (Hz) with the signals",
        "t" => "; or a rate in its place: --columns t=1000Hz",
        _ => "",
    }
}

fn span_hint(span: Option<(f64, f64)>) -> String {
    span.map_or_else(String::new, |(first, last)| format!("; the file runs from {first} s to {last} s"))
}

/// What helps where the system refuses a file.
fn mending(refused: &std::io::Error) -> &'static str {
    match refused.kind() {
        std::io::ErrorKind::NotFound => "; a path counts from the folder in which the command is called",
        std::io::ErrorKind::PermissionDenied => "; allow this user to read it",
        std::io::ErrorKind::IsADirectory => "; name a file in it",
        _ => "",
    }
}
