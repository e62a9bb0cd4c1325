//! Why there is no FMU of a model or a law.

use crate::identify::SavedLawsError;
use crate::law::ModelError;
use crate::simulate::ParametricLawError;
use switchid_fmu_package::PackageError;
use thiserror::Error;

/// Why there is no FMU.
#[derive(Debug, Error)]
pub enum FmuError {
    /// The model is refused.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The known laws are refused.
    #[error(transparent)]
    Laws(#[from] SavedLawsError),
    /// The law of a plant is refused.
    #[error(transparent)]
    Law(#[from] ParametricLawError),
    /// A plant of a law whose numbers are not all known.
    #[error("[terms]: a plant needs numbers, but {terms} have none: write them, or let `switchid improve` find them")]
    NoNumbers {
        /// The keys of these terms, with the inner parameter where that is what lacks.
        terms: String,
    },
    /// A term of a law without inertia that needs the past.
    #[error(
        "[terms]: the force of \"{key}\" needs the past, which the plant FMU of a law without inertia does not keep: take it out, or \
         `switchid simulate` the model"
    )]
    Memory {
        /// The key.
        key: String,
    },
    /// The interface or the archive cannot be written.
    #[error(transparent)]
    Package(#[from] PackageError),
}
