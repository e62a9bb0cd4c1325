//! What our FMUs are: the variables, units and resources of an identifier for a model, and of a plant for a law.
//!
//! model → interface → [`Fmu`], to which the binaries of `fmu/identifier` or `fmu/plant` are added as bytes. Ports are
//! in SI units: where the model names a unit of q, qd or F, they declare the SI unit of that quantity, else none, so
//! that they connect to anything.

mod description;
mod error;
mod identifier;
mod plant;
mod plant_of_model;
mod ports;
mod specimen;

pub use error::FmuError;
pub use identifier::{identifier, identifier_description, identifier_knowing};
pub use plant::{DUFFING, STAGES, VAN_DER_POL, plant, plant_description};
pub use plant_of_model::plant_of_model;
pub use switchid_fmu_package::{Fmu, PackageError, Platform};
