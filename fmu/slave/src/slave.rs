//! What a slave must do; all of FMI is done for it.

use crate::description::Description;
use crate::log::Log;
use crate::values::Values;
use serde::{Serialize, de::DeserializeOwned};
use std::path::Path;

/// Why a slave cannot do what was asked: a text that says what, where, and how to mend it.
pub type SlaveError = Box<dyn std::error::Error>;

/// A co-simulation slave as plain data: saving and restoring it is a copy.
///
/// No threads, no thread-locals, no globals; what it reads from its resources it reads in `instantiate`.
pub trait Slave: Clone + Serialize + DeserializeOwned + 'static {
    /// Bytes that one instance takes at most until its first step, with its variables and what building it takes on the
    /// way, but for what [`Slave::start`] asks for itself; a test measures them.
    const ROOM: usize;

    /// Reads the resources.
    ///
    /// # Errors
    /// What is missing or does not fit.
    fn instantiate(resources: &Path, description: &Description) -> Result<Self, SlaveError>;

    /// Takes the parameters and writes the outputs at the start time, s. Called on a slave as instantiated, possibly
    /// several times before the first step; ranges given in the description have been checked.
    ///
    /// # Errors
    /// Which parameter is refused, and why.
    fn start(&mut self, time: f64, values: &mut Values, log: &mut Log) -> Result<(), SlaveError>;

    /// As [`Slave::start`], for a host that integrates it; only where the description says that it can.
    ///
    /// # Errors
    /// Which parameter is refused, and why.
    fn start_continuous(&mut self, _time: f64, _values: &mut Values, _log: &mut Log) -> Result<(), SlaveError> {
        Err("this FMU is for co-simulation only".into())
    }

    /// The equations of motion after [`Slave::start_continuous`].
    fn continuous(&mut self) -> Option<&mut dyn Continuous> {
        None
    }

    /// Steps from `time` over `step` (both s, finite, step ≥ 0): inputs hold at `time`, outputs at `time + step`. Bad
    /// data is no error: it is skipped and said in the log.
    ///
    /// # Errors
    /// Only what leaves the slave unable to go on.
    fn step(&mut self, time: f64, step: f64, values: &mut Values, log: &mut Log) -> Result<(), SlaveError>;
}

/// Ordinary differential equations ẋ = f(t, x, inputs) that a host integrates; between events they are smooth.
pub trait Continuous {
    /// Moves on to that time, s.
    fn set_time(&mut self, time: f64);

    /// x, in the order of the description's derivatives.
    fn states(&self) -> Vec<f64>;

    /// Takes x, of the same length.
    fn set_states(&mut self, states: &[f64]);

    /// ẋ for the inputs as they are.
    fn derivatives(&self, values: &Values) -> Vec<f64>;

    /// Takes what changes at the present time; when the next event is, s.
    fn settle(&mut self, values: &Values, log: &mut Log) -> Option<f64>;

    /// Writes every output.
    fn show(&self, values: &mut Values);
}
