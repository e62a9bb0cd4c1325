//! The streaming identifier: one sample in, one report out.
//!
//! [`Settings`] are checked once at construction; [`Identifier`] is plain data that clones, compares and serialises.
//! A step does a bounded amount of work, allocates nothing, and cannot fail.

mod blocks;
mod capture;
mod deviation;
mod drift;
mod equations;
mod force_law;
mod forecast;
mod functional;
mod identification;
mod identifier;
mod known;
mod moving;
mod outputs;
mod parameters;
mod problem;
mod publication;
mod recording;
mod roughness;
mod saved;
mod scales;
mod section;
mod settings;
mod stage;
mod start;
mod structure;
mod tracker;
mod trials;
mod usual;
mod window;

pub use crate::evidence::Missing;
pub use force_law::{ForceFit, fit_force_law};
pub use identification::{Identification, Stage, choose_hold, identify_knowing, identify_recording, settings_for};
pub use identifier::{BuildError, Coefficient, Identifier, Output, Sample, Skipped, Status};
pub use outputs::{OutputDescription, OutputKind, OutputValue, Outputs, UNKNOWN};
pub use parameters::Parameter;
pub use recording::{Gap, Recording, RecordingError};
pub use saved::{SavedLaw, SavedLaws, SavedLawsError, SavedNoise};
pub use settings::{Channels, Method, Settings, SettingsError};
