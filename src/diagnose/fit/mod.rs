//! The likelihood: best coefficients of a form where all error is the sensors' noise and a white acceleration.
//!
//! It sharpens what the judge has named, and says what a law's motion and noise are; it decides nothing.

mod course;
mod descent;
mod evidence;
mod exogenous;
mod form;
mod inner_slopes;
mod loop_run;
mod means;
mod noise_covariance;
mod outcome;
mod refit;
mod run;
mod start;

pub use evidence::{Evidence, best_as_given, is_evident};
pub use form::{Fit, Form};
pub use refit::{fit, refit};
