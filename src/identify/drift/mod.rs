//! Coefficients that move while the record runs.
//!
//! - `weak_rows`: where no constant law explains the record; random walks measured by weak rows of many
//!   lengths (`variation_length`), for motions of whatever period (`oscillation`);
//! - `augmented`: away from a law that explained its record; filters of the state together with the coefficients, on
//!   trial at an alarm.

mod augmented;
mod oscillation;
mod variation_length;
mod weak_rows;

pub use augmented::{AugmentedDrift, Before, INSTANTS};
pub use weak_rows::WeakRowDrift;
