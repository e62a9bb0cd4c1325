//! Which physical effect a model lacks, and where it fails.

mod fit;
mod judge;
mod piece;
mod run;
mod screen;
mod search;
mod series;
mod smooth;
mod start;
mod variants;

pub use fit::{Fit, Form, fit, refit};
pub use judge::Trial;
pub use piece::Piece;
pub use screen::{Gain, screen};
pub use search::{Search, search};
pub use variants::{Scale, Variant, same_effect, variants};
