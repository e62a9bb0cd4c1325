//! Laws in which the force is the output: a machine imposes q, and F = Σ θ_j f_j(q, q̇) is measured (dampers, mounts,
//! joints).
//!
//! There is no motion to predict, so nothing is integrated: with the motion known, F is a linear regression on the
//! features, of rows [features of the free terms…, F less the known terms, 1].
//!
//! - `features`: the regressors under the Gaussian belief of what the motion was, from q, from q̇, or from both, and
//!   what that leaves open of the force;
//! - `changes`: at which instant the law switched;
//! - `segment`: the law of one stage; `tracker`: the stages, one after the other;
//! - `fit`: one law over a whole recording.

mod changes;
mod features;
mod fit;
mod segment;
mod tracker;

pub use fit::{ForceFit, fit_force_law};
pub use tracker::ForceTracker;
