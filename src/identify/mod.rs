//! The streaming identifier: one sample in, one report out.
//!
//! [`Settings`] are checked once at construction; [`Identifier`] is plain data that clones, compares and serialises.
//! A step does a bounded amount of work, allocates nothing, and cannot fail.

mod deviation;
mod identifier;
mod problem;
mod scales;
mod settings;
mod stage;
mod start;
mod structure;
mod tracker;
mod window;

pub use identifier::{BuildError, Coefficient, Identifier, Output, Sample, Skipped, Status};
pub use settings::{Channels, Method, Settings, SettingsError};
