//! Which physical effect a model lacks, and where it fails.

mod coefficients;
mod compare;
mod force;
mod free_run;
mod locate;
mod noise;
mod piece;
mod record;
mod rows;
mod scan;
mod sentence;
mod series;
mod spectrum;
mod trajectory;
mod window;

pub use coefficients::{Estimate, Held};
pub use compare::{Comparison, Error, NOISE_RATIO, Options, Side, Verdict, compare};
pub use locate::{Bounds, Fail, Over};
pub use piece::Piece;
