//! Which physical effect a model lacks, and where it fails.

mod fit;
mod judge;
mod piece;
mod run;
mod screen;
mod series;
mod smooth;
mod start;

pub use fit::{Fit, Form, fit, refit};
pub use judge::Trial;
pub use piece::Piece;
pub use screen::{Gain, screen};
