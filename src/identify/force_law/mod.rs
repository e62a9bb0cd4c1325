//! Laws in which the force is the output: a machine imposes q, and F = Σ θ_j f_j(q, q̇) is measured (dampers, mounts,
//! joints).
//!
//! There is no motion to predict, so nothing is integrated: with the motion known, F is a linear regression on the
//! features, of rows [features of the free terms…, F less the known terms, 1].
//!
//! - `kinematics`, `noise`, `smoother`: what the motion was, as a Gaussian belief, from q, from q̇, or from both;
//! - `features`: the regressors under that belief, and what it leaves open of the force;
//! - `whiteness`: whether what the regression leaves is white, and its variances where it is not;
//! - `changes`: at which instant the law switched;
//! - `segment`: the law of one stage; `tracker`: the stages, one after the other;
//! - `fit`: one law over a whole recording.

mod changes;
mod features;
mod fit;
mod kinematics;
mod noise;
mod segment;
mod smoother;
mod tracker;
mod whiteness;

pub use fit::{ForceFit, fit_force_law};
pub use tracker::ForceTracker;
