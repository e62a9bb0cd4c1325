//! The motion that recordings show, their sensors, and how these keep time.
//!
//! Everything is estimated from the recording alone, before any law: the sensors' noise ([`noise`]), how late and how
//! large q̇ is ([`kinematics`]), and the motion itself ([`spline`]), put on a uniform grid ([`nodes`]).

mod kinematics;
mod nodes;
mod noise;
mod smoothed;
mod spline;
mod track;

pub use kinematics::Kinematics;
pub(super) use nodes::{Impulse, Nodes};
pub(super) use noise::{rounding, sensor_noise};
pub(super) use smoothed::{Motion, period};
pub use spline::Sensors;
