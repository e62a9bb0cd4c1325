//! The motion as readings tell it where no law does: smooth, and no more.
//!
//! - `filter`: (q, q̇, q̈) driven by a white jerk;
//! - `noise`: how rough the motion is and how noisy its sensors;
//! - `fixed_lag`: the motion a few samples ago, as all readings up to now tell it.

mod filter;
mod fixed_lag;
mod noise;

pub use fixed_lag::{FixedLagSmoother, Instant, LONGEST};
pub use noise::MotionNoise;
