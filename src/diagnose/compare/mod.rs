//! A model against recordings: how wrong it is, where, and how wrong it could at best be.

mod coefficients;
mod comparison;
mod force;
mod free_run;
mod locate;
mod memory_run;
mod record;
mod rows;
mod scan;
mod sentence;
mod series;
mod spectrum;
mod trajectory;
mod window;

pub use coefficients::{Estimate, Held};
pub use comparison::{Comparison, Error, Judged, NOISE_RATIO, Options, Side, Verdict, compare, compare_posed};
pub use force::{Left, Place};
pub use locate::{Bounds, Fail, Over};
