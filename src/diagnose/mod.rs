//! Which physical effect a model lacks, and where it fails.

mod coefficients;
mod compare;
mod free_run;
mod noise;
mod piece;
mod record;
mod rows;
mod trajectory;
mod window;

pub use coefficients::{Estimate, Held};
pub use compare::{Comparison, Error, Options, Side, Verdict, compare};
pub use piece::Piece;
