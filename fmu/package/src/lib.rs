//! Writes `modelDescription.xml` and packs FMUs.
//!
//! [`Description`](switchid_fmu_slave::Description) → XML with its GUID → [`Fmu`] → bytes of the archive. The
//! same input gives the same bytes. No I/O: binaries come in and archives go out as bytes. What the variables of an
//! identifier or a plant are is said in `switchid::fmu`.

mod archive;
pub mod documentation;
mod platform;
mod terminals;
pub mod variables;
mod xml;

pub use archive::{Fmu, PackageError};
pub use platform::{AARCH64_LINUX, DARWIN64, LINUX64, Platform, WIN64};
pub use xml::model_description;
