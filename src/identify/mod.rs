//! The streaming identifier: one sample in, one report out.
//!
//! [`Settings`] are checked once at construction; [`Identifier`] is plain data that clones, compares and serialises.
//! A step does a bounded amount of work, allocates nothing, and cannot fail.

mod change;
mod check;
mod deviation;
mod drift;
mod faults;
mod force_law;
mod functional;
mod identification;
mod identifier;
mod library;
mod outputs;
mod packed;
mod packed_readings;
mod parameters;
mod problem;
mod published_method;
mod reading;
mod recording;
mod report;
mod sample;
mod section;
mod segment;
mod settings;
mod timing;
mod tracker;
mod validation;
mod window;

pub use crate::estimation::Missing;
pub use check::BuildError;
pub use force_law::{ForceFit, fit_force_law};
pub use identification::{
    Identification, SensorFault, Stage, carries_over_gaps, choose_hold, identify_knowing, identify_recording,
};
pub use identifier::Identifier;
pub use library::{SavedLaw, SavedLaws, SavedLawsError, SavedNoise};
pub use outputs::{OutputDescription, OutputKind, OutputValue, Outputs, UNKNOWN};
pub use parameters::Parameter;
pub use recording::{Gap, Recording, RecordingError, settings_for};
pub use report::{ByQuantity, Coefficient, Output, SensorState, Status};
pub use sample::{Sample, Skipped};
pub use settings::{Channels, Method, Settings, SettingsError};
