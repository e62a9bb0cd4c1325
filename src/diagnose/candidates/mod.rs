//! The effects that a law may lack, and how each of them does beside it.

mod contest;
mod grid;

pub(super) use contest::{Contender, TRAP, contender, contest};
pub use grid::same_effect;
