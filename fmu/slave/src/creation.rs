//! `fmi2Instantiate` from its arguments on: where the resources are, whether they belong to this host's XML.

use crate::ctypes::{CO_SIMULATION, MODEL_EXCHANGE};
use crate::description::{INTERFACE_FILE, Interface};
use crate::location;
use crate::memory::{self, OutOfMemory};
use crate::slave::{Slave, SlaveError};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why there is no instance.
#[derive(Debug, Error)]
pub enum CreationError {
    /// Model exchange was asked for where there is none.
    #[error("this FMU is for co-simulation only: instantiate it with fmi2CoSimulation")]
    NotCoSimulation,
    /// Neither of the two.
    #[error("fmuType is {found}: it must be fmi2ModelExchange, 0, or fmi2CoSimulation, 1")]
    UnknownType {
        /// What was passed.
        found: u32,
    },
    /// The host passed no resource location.
    #[error("fmuResourceLocation is NULL: this FMU reads its variables from there; pass file:///…/resources")]
    NoLocation,
    /// The resource directory has no interface.
    #[error("{path}: {source}: fmuResourceLocation {location:?} must name the unpacked FMU's resources directory")]
    Missing {
        /// The file that was looked for.
        path: PathBuf,
        /// What the host passed.
        location: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The interface cannot be read.
    #[error("{path}: {source}: package the FMU anew")]
    Interface {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: serde_json::Error,
    },
    /// Host and resources disagree on which FMU this is.
    #[error("GUID {given} is not the one of these resources, {expected}: modelDescription.xml and resources differ")]
    Guid {
        /// As passed by the host.
        given: String,
        /// As in the resources.
        expected: String,
    },
    /// There is too little memory.
    #[error(transparent)]
    Memory(#[from] OutOfMemory),
    /// The slave refuses its resources.
    #[error("{0}")]
    Slave(SlaveError),
}

/// What the host passes, as Rust reads it.
pub struct Request<'a> {
    /// `fmi2ModelExchange` or `fmi2CoSimulation`.
    pub kind: u32,
    /// GUID that the host read in the XML.
    pub guid: &'a str,
    /// The resource location, if any.
    pub location: Option<&'a [u8]>,
}

/// Reads what an instance is made of.
///
/// # Errors
/// [`CreationError`].
pub fn read<S: Slave>(request: &Request) -> Result<(Interface, S), CreationError> {
    if ![CO_SIMULATION, MODEL_EXCHANGE].contains(&request.kind) {
        return Err(CreationError::UnknownType { found: request.kind });
    }
    memory::ask(S::ROOM)?;
    let resources = find_resources(request.location.ok_or(CreationError::NoLocation)?);
    let interface = read_interface(&resources, request)?;
    let bare = |guid: &str| guid.trim_matches(['{', '}']).to_string();
    if bare(&interface.guid) != bare(request.guid) {
        return Err(CreationError::Guid { given: request.guid.into(), expected: interface.guid });
    }
    if request.kind == MODEL_EXCHANGE && !interface.description.model_exchange {
        return Err(CreationError::NotCoSimulation);
    }
    let slave = S::instantiate(&resources, &interface.description).map_err(CreationError::Slave)?;
    Ok((interface, slave))
}

fn find_resources(location: &[u8]) -> PathBuf {
    let candidates = location::candidates(location);
    let found = candidates.iter().find(|path| path.join(INTERFACE_FILE).is_file());
    found.unwrap_or(&candidates[0]).clone()
}

fn read_interface(resources: &Path, request: &Request) -> Result<Interface, CreationError> {
    let path = resources.join(INTERFACE_FILE);
    let text = std::fs::read_to_string(&path).map_err(|source| CreationError::Missing {
        path: path.clone(),
        location: String::from_utf8_lossy(request.location.unwrap_or_default()).into_owned(),
        source,
    })?;
    serde_json::from_str(&text).map_err(|source| CreationError::Interface { path, source })
}
