//! Whether the law has changed: the law in use beside the stream, and what evidence against it decides.
//!
//! - `law_in_use`: its innovations, run along with the stream;
//! - `adaptive_noise`: how loud the sensors are now, in terms of what the law's record knows;
//! - `decision`: the threshold that evidence must pass;
//! - `prediction`: the free prediction of eq. (4), and how far it deviates.

mod adaptive_noise;
mod decision;
mod law_in_use;
mod prediction;

pub use decision::{Decision, SUSPENSE, false_alarm_level};
pub use law_in_use::{LONGEST_ERROR, LawInUse};
pub use prediction::Prediction;
