//! The segment estimator: the law of the record since the last switch, refined filter run by filter run.
//!
//! - `weak_start`: first coefficients, from weak rows alone;
//! - `state`: what a segment holds; `refinement`: how it goes on; `lacking`: which effect its law lacks;
//! - `noise_covariance`, `prior`: its parts;
//! - `motion_scales`: how large the motion is; `convergence`: how much longer the record has to get;
//! - `judgement`: whether the law may be shown, validated, or replaced.

mod convergence;
mod judgement;
mod lacking;
mod motion_scales;
mod noise_covariance;
mod prior;
mod refinement;
mod state;
mod weak_start;

pub use motion_scales::MotionScales;
pub use prior::Prior;
pub use refinement::{GROWTH, IN_THE_SENSORS};
pub use state::{NOISE_MEMORY, Segment};
pub use weak_start::{Guess, WeakStart};
