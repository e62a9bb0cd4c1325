//! Writes `modelDescription.xml` and packs FMUs.
//!
//! model → [`Description`](switchid_fmu_slave::Description) → XML with its GUID → [`Fmu`] → bytes of the archive. The
//! same input gives the same bytes. No I/O: binaries come in and archives go out as bytes.

mod archive;
mod documentation;
mod identifier;
mod plant;
mod variables;
mod xml;

pub use archive::{Fmu, LINUX64, PackageError};
pub use identifier::{identifier, identifier_description};
pub use plant::{DUFFING, STAGES, VAN_DER_POL, plant, plant_description};
pub use xml::model_description;
