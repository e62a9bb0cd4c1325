//! The effects that a law may lack, and how each of them does beside it.

mod contest;
mod grid;
mod pairs;

pub(super) use contest::{Contender, TRAP, contender, contest, narrowed};
pub(super) use pairs::best_pairs;
pub use grid::same_effect;
