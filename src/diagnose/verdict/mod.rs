//! What a record says of a law: which effect it lacks, what that explains, and what is left.

mod case;
mod diagnosis;
mod drifting;
mod errors;
mod exchange;
mod improve;
mod law;
mod model;
mod posed;
mod remainder;
mod sharpen;
mod stages;
mod timing;

pub use diagnosis::{Candidate, Diagnosis, Doubt, Finding, LEVEL, WORTH};
pub use errors::{ADEQUATE, WindowError, are_adequate};
pub use improve::{Addition, Improvement, Step};
pub use law::Law;
pub use model::{improved_model, refitted_model};
pub use posed::Posed;
pub use stages::{StageDiagnosis, Switched, diagnose_stages};
pub use timing::Clock;
