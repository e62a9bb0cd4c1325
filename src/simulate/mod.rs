//! Plants whose law is known: schedules of stages, excitations, sensor noise.
//!
//! A [`Scenario`] says everything about a plant; [`Plant`] integrates it. The law switches at the start of each
//! [`Stage`], exactly at the instant given; the excitation is evaluated on a grid `t_k = k · sample_time` and held from
//! `t_k` to `t_{k+1}`, as in a sampled actuator. What a plant shows at time t is a function of t alone: it does not
//! depend on the communication steps that led there, unless its excitation comes from outside ([`DrivenPlant`]). What
//! is smooth between its events can be integrated by others ([`ContinuousPlant`]). Measured values ([`Reading`]) and
//! truth ([`Truth`]) are apart.

mod builtin;
mod check;
mod continuous;
mod driven;
mod error;
mod excitation;
mod hidden;
mod imposed;
mod noise;
mod parametric;
mod plant;
mod plants;
mod random;
mod reading;
mod scenario;
mod scenario_file;
mod term_names;

pub use builtin::{Builtin, UnknownBuiltin};
pub use continuous::ContinuousPlant;
pub use driven::DrivenPlant;
pub use error::ScenarioError;
pub use excitation::{Excitation, ExcitationKind};
pub use hidden::Hidden;
pub use imposed::Specimen;
pub use parametric::{LawParameter, ParametricLaw, ParametricLawError};
pub use plant::{Plant, PlantError, SimulateError, Truth, is_smooth, record};
pub use reading::{Reading, columns};
pub use scenario::{Scenario, SensorNoise, Stage};
