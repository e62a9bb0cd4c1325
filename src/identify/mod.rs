//! The streaming identifier: one sample in, one report out.
//!
//! [`Settings`] are checked once at construction; [`Identifier`] is plain data that clones, compares and serialises.
//! A step does a bounded amount of work, allocates nothing, and cannot fail.

mod identifier;
mod outputs;
mod parameters;
mod settings;

pub use identifier::{BuildError, Coefficient, Identifier, Output, Sample, Skipped, Status};
pub use outputs::{OutputDescription, OutputKind, OutputValue, Outputs, UNKNOWN};
pub use parameters::Parameter;
pub use settings::{Channels, Method, Settings, SettingsError};
