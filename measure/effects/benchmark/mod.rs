//! Plants with an effect that their model lacks, drawn from a seed, and what a diagnosis of their records comes to.
//!
//! A draw chooses mass, natural frequency, damping, size of the motion, excitation, effect and its inner parameters;
//! the strength of the effect is the RMS of its force ÷ RMS of F, noise is a share of each channel's std. The
//! diagnosis sees the noisy record and the model's terms, nothing else; [`judge()`] then compares its answer with the
//! truth.

mod base;
mod drive;
mod generator;
mod judge;
mod outside;
mod plant;
mod problem;
mod run;
mod secret;
mod sensors;
mod through_fmu;

pub use judge::{Answer, Outcome, judge};
pub use outside::Outside;
pub use problem::{Setting, draw};
pub use secret::{Secret, pair};
pub use sensors::Sensors;
