//! The one judge: how well a law predicts what it has not seen, in weak form, whatever the error is like.
//!
//! A law is a set of weak equations over windows of three lengths ([`windows`], [`record`]), solved for its noisiest
//! column ([`equation`]) by a robust regression ([`regression`]). Its error is that of equations it was not fitted to
//! ([`held_out`]); beside it stand what the sensors alone would leave ([`floor`]) and how likely a gain is by chance
//! ([`significance`]).

mod beginning;
mod change;
mod drift;
mod driven;
mod equation;
mod estimate;
mod floor;
mod held_out;
mod instruments;
mod memory;
mod pair_screen;
mod record;
mod regression;
mod significance;
mod windows;

pub(super) use change::{best_change, changes};
pub(super) use drift::{Drift, drift};
pub use equation::Target;
pub(super) use equation::{Equation, Role, delay_of, role};
pub(super) use estimate::{Estimate, estimate};
pub(super) use floor::{Bootstrap, Trial, floor, floor_of_law, noise_share};
pub(super) use held_out::{Folds, HeldOut, Joined, Screen};
pub(super) use instruments::instrumented;
pub(super) use memory::Memory;
pub(super) use pair_screen::{PairScreen, Partialled};
pub use record::Timing;
pub(super) use record::{Column, Record};
pub(super) use significance::Blocks;
pub(super) use windows::{COUNT, PRINCIPAL};
