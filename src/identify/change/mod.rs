//! Whether the law has changed: the law in use beside the stream, and what evidence against it decides.
//!
//! - `law_in_use`: its innovations, run along with the stream;
//! - `adaptive_noise`: how loud the sensors are now, in terms of what the law's record knows;
//! - `empirical_null`: the evidence of a switch that the law meets without one;
//! - `decision`: the threshold that evidence must pass;
//! - `prediction`: the free prediction of eq. (4), and how far it deviates.

mod adaptive_noise;
mod decision;
mod empirical_null;
mod law_in_use;
mod prediction;

pub use decision::{Decision, SUSPENSE, false_alarm_level};
pub use empirical_null::EmpiricalNull;
pub use law_in_use::{LONGEST_ERROR, LawInUse};
pub use prediction::Prediction;
