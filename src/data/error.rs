//! Why something that a user brought cannot be used.

use crate::identify::RecordingError;
use crate::law::ModelError;
use crate::simulate::ScenarioError;
use thiserror::Error;

/// Why a file cannot be used. `file` is its name as the user wrote it, `line` counts from 1 with the header as line 1.
#[derive(Debug, Error)]
pub enum DataError {
    /// It cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
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
        "{file}: line 1: there is no column \"{column}\" for {channel}; the columns are {columns}. Name the right one in the model: [columns] {channel} = \"...\""
    )]
    MissingColumn {
        /// The file.
        file: String,
        /// The column that was looked for.
        column: String,
        /// What it would hold.
        channel: &'static str,
        /// The columns there are.
        columns: String,
    },
    /// Neither displacement nor velocity.
    #[error(
        "{file}: line 1: there is no column \"q\" or \"qd\", and one of them is needed; the columns are {columns}. Name the right one in the model: [columns] q = \"...\""
    )]
    NoMotion {
        /// The file.
        file: String,
        /// The columns there are.
        columns: String,
    },
    /// Several columns fit.
    #[error("{file}: line 1: several columns are \"{column}\": {columns}. Rename all but one")]
    Ambiguous {
        /// The file.
        file: String,
        /// The column that was looked for.
        column: String,
        /// The headers that fit.
        columns: String,
    },
    /// A unit that is not known.
    #[error("{file}: line 1: column \"{column}\": unknown unit \"{unit}\" for {channel}; known are {known}")]
    UnknownUnit {
        /// The file.
        file: String,
        /// The header.
        column: String,
        /// The unit as written.
        unit: String,
        /// The quantity.
        channel: &'static str,
        /// The units that it may have.
        known: String,
    },
    /// A unit of another quantity.
    #[error(
        "{file}: line 1: column \"{column}\": {unit} is a unit of {quantity}, but {channel} is {expected}. Map another column to {channel}, or rename this one if its ending is no unit"
    )]
    WrongUnit {
        /// The file.
        file: String,
        /// The header.
        column: String,
        /// The unit as written.
        unit: String,
        /// What the unit measures.
        quantity: &'static str,
        /// The quantity.
        channel: &'static str,
        /// What it is.
        expected: &'static str,
    },
    /// Displacement and velocity of different kinds.
    #[error(
        "{file}: line 1: column \"{velocity}\" ({velocity_quantity}) is not the rate of column \"{displacement}\" ({displacement_quantity}): correct the units"
    )]
    UnitsDisagree {
        /// The file.
        file: String,
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
    #[error("{file}: line {line}: {found} cells under {expected} columns: complete the line or delete it")]
    Ragged {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// How many cells it has.
        found: u64,
        /// How many columns there are.
        expected: u64,
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
        "{file}: line {line}: column \"{column}\": \"{text}\" is not a finite number: correct it or delete the line"
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
        "{file}: line {line}: time does not increase: {previous} s on line {previous_line}, then {t} s. Sort the lines and delete duplicates"
    )]
    NotIncreasing {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// The time before, s.
        previous: f64,
        /// The line before.
        previous_line: u64,
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
    /// A column that never changes.
    #[error(
        "{file}: column \"{column}\" is {value} in every line: a motion that stands still determines no law. Check the sensor, or map another column to {channel}"
    )]
    Constant {
        /// The file.
        file: String,
        /// The header.
        column: String,
        /// The quantity.
        channel: &'static str,
        /// The value.
        value: f64,
    },
    /// The table cannot be read.
    #[error("{file}: line {line}: {reason}")]
    Table {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// What the reader says.
        reason: String,
    },
    /// The signals are no recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The model needs a quantity that is not measured.
    #[error(
        "{file}: the term \"{term}\" needs the excitation, but the file has no column \"F\": map one in the model, [columns] F = \"...\", or leave the term out"
    )]
    NeedsExcitation {
        /// The file.
        file: String,
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
}

fn span_hint(span: Option<(f64, f64)>) -> String {
    span.map_or_else(String::new, |(first, last)| format!("; the file runs from {first} s to {last} s"))
}
