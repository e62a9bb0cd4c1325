//! The library of known laws: kept when they were validated, weighed by new records, written to a file and read again.
//!
//! - `known_law`: one law; `known_laws`: all of them, and what a record says on each against "some other law";
//! - `trials`: a filter run of each over a new record;
//! - `mixture`: what else a recognised law may be, until its trial has confirmed it;
//! - `saved`: the library as a text.

mod known_law;
mod known_laws;
mod mixture;
mod saved;
mod trials;

pub use known_law::{Estimate, KnownLaw};
pub use known_laws::{KnownLaws, ROOM, Weighed};
pub use mixture::Mixture;
pub use saved::{SavedLaw, SavedLaws, SavedLawsError, SavedNoise};
pub use trials::{Trials, Verdict};
