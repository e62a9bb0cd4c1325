//! The FMI 2.0 C interface of a co-simulation slave, once, for any slave written in Rust; of one that can be integrated
//! from outside, that of model exchange too.
//!
//! A dynamic library implements [`Slave`] and calls [`export!`], and [`export_exchange!`] where it is a [`Continuous`]
//! too; variables, names and GUID come from `resources/interface.json` ([`description`]), so that one binary serves
//! every model. All `unsafe` of the project is here. What the slave promises its hosts:
//!
//! - no panic crosses the interface, `fmi2Discard` is never returned, no threads, no thread-locals, no globals;
//! - a refused call changes nothing and says in the log why;
//! - bad data in an input is skipped and said in the log, and the step returns `fmi2OK`: hosts exist that end the
//!   simulation on anything else, and data that is missing once is no reason to lose an experiment.

pub mod calls;
mod creation;
#[doc(hidden)]
pub mod ctypes;
pub mod description;
mod exchange;
#[doc(hidden)]
pub mod exchange_interface;
mod export;
#[cfg(feature = "host")]
pub mod host;
mod instance;
#[doc(hidden)]
pub mod interface;
mod location;
mod log;
pub mod memory;
mod seal;
mod slave;
mod states;
mod values;

pub use calls::{Call, Phase};
pub use description::{
    Causality, Description, Enumeration, INTERFACE_FILE, Interface, Kind, Unit, Variability, Variable,
};
pub use log::{Category, Log, seconds};
pub use slave::{Continuous, Slave, SlaveError};
pub use values::{Value, ValueError, Values};
