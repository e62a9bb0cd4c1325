//! Opening what a user brings: recordings, model files, scenario files.
//!
//! A recording is a CSV file with a header. The model's `[columns]` say which column is which quantity, else `t`, `q`,
//! `qd` and `F` are looked for; one of q, qd and F may be absent. Values are SI unless the header says otherwise:
//! `q [mm]`, `force (kN)`, `position_mm`. `DATA@t0:t1` is the section t0 ≤ t < t1. Every error names file,
//! line, column or key, and what would mend it; nothing is repaired or left out in silence.

mod csv;
mod error;
mod files;
mod header;
mod section;
mod unit;

pub use csv::{Opened, open_recording};
pub use error::DataError;
pub use files::{open_model, open_scenario};
pub use section::Section;
