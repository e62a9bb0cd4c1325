//! What a record says of a law: which effect it lacks, what that explains, and what is left.

mod case;
mod contained;
mod diagnosis;
mod doubt;
mod drifting;
mod entry;
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
mod untold;

pub use diagnosis::{Diagnosis, Finding};
pub use doubt::{Doubt, LEVEL, WORTH};
pub use entry::Candidate;
pub use errors::{ADEQUATE, WindowError, are_adequate};
pub use improve::{Addition, Improvement, Step};
pub use law::Law;
pub use model::{improved_model, refitted_model};
pub use posed::Posed;
pub use stages::{StageDiagnosis, Switched, diagnose_stages};
pub use timing::Clock;
