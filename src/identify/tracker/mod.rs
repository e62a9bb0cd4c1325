//! The streaming identifier of a law of motion: acquire, track, suspect, re-identify, recognise, follow.
//!
//! - `regime`: where it stands, and every transition;
//! - `state`: all that it holds; `published`: the law as last made known; `show`: the outputs, derived from both;
//! - `new_record`: how the record of another law begins; `alternatives`: other fits of the record;
//! - `sighting`, `recognition`: laws seen before; `drifting`: coefficients that move; `validated`: laws worth showing;
//! - `switching`: the law has changed; `step`: what a reading does;
//! - `intake`: what of the stream enters the record; `faulted`: an alarm that is a sensor's fault.

mod alternatives;
mod drifting;
mod faulted;
mod intake;
mod new_record;
mod published;
mod recognition;
mod regime;
mod show;
mod sighting;
mod state;
mod step;
mod switching;
mod validated;

pub use state::Tracker;
