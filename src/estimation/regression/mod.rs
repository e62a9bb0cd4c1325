//! Linear regression over a record whose rows come one by one.
//!
//! - `moments`: sums of the rows' products, and what follows from them; `blocks`: the same by blocks of time;
//! - `whiteness`: whether what a law leaves is white, and its variances where it is not.

mod blocks;
mod moments;
mod whiteness;

pub use blocks::{Blocks, FEWEST};
pub use moments::{Moments, Weight};
pub use whiteness::{SURPRISE, Whiteness};
