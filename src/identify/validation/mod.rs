//! When a law is good enough: to be shown, to be weighed against a switch, to be validated.
//!
//! - `bounds`: what its stated error may be;
//! - `stability`: what a wrong structure or a wrong minimum makes up does not survive more data;
//! - `constancy`: estimates of one law in a growing record agree.

mod bounds;
mod constancy;
mod stability;

pub use bounds::{DOUBTED, SURE, TRUSTED, VALIDATED};
pub use constancy::Constancy;
pub use stability::{Stability, is_one_law};
