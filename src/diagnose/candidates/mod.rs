//! The effects that a law may lack, and how each of them does beside it.

mod contest;
mod grid;
mod pairs;

pub(super) use contest::{Contender, TRAP, contender, contest};
pub use grid::same_effect;
pub(super) use pairs::Pairs;
