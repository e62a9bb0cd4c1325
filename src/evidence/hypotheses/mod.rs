//! Hypotheses that the law switched, at many instants at once.
//!
//! - `no_change`: the null hypothesis; `hypothesis`: a switch after one sample; `bank`: all of them;
//! - `instant`: how well they together know when it was.

mod bank;
mod hypothesis;
mod instant;
mod no_change;

pub use bank::{Bank, Suspect};
pub use hypothesis::Law;
