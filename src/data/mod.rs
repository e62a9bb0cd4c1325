//! Opening what a user brings: recordings, model files, scenario files.
//!
//! A recording is a table of text (CSV and its relatives), a spreadsheet, a MAT file (version 5 or 7.3) whose vectors,
//! fields of structures, and columns of tables and time series are the columns, an MDF 4 or a Parquet file (all but
//! text with the feature `formats`); the content tells which. The model's `[columns]` say which column is which
//! quantity, else `t`, `q`, `qd` and `F` are looked for, else columns whose names, units or numbers tell; one of q, qd
//! and F may be absent. Values are SI unless the header says otherwise: `q [mm]`, `force (kN)`, `position_mm`.
//! `DATA@t0:t1` is the section t0 ≤ t < t1. Every error names file, line, column or key, and what would mend it, once
//! for each kind of fault; what is guessed is told; nothing is repaired or left out in silence.

#[cfg(feature = "formats")]
mod arrays;
mod cells;
mod content;
mod csv;
mod dialect;
mod encoding;
mod error;
mod files;
mod guess;
mod header;
mod instant;
mod kind;
#[cfg(feature = "formats")]
mod matlab;
#[cfg(feature = "formats")]
mod mdf;
#[cfg(feature = "formats")]
mod names;
mod number;
mod open;
#[cfg(feature = "formats")]
mod parquet;
mod preamble;
mod rows;
mod section;
mod spreadsheet;
mod stored;
mod text;

pub use error::DataError;
pub use files::{open_laws, open_model, open_scenario};
pub use kind::FileKind;
pub use open::{Opened, Taken, open_recording, open_stream};
pub use section::Section;
