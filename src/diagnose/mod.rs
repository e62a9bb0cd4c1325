//! Which physical effect a model lacks, and where it fails.
//!
//! Data takes one way: the motion that recordings show (`motion`) → a law as weak equations and its held-out errors
//! (`judge`) → every effect beside it (`candidates`) → the `verdict`. The likelihood (`fit`) sharpens coefficients;
//! `compare` shows where a law fails.

mod candidates;
mod compare;
mod fit;
mod judge;
mod motion;
mod piece;
mod products;
mod remarks;
mod scale;
mod verdict;

pub use crate::estimation::{Noise, Observation};
pub use candidates::same_effect;
pub use compare::{
    Bounds, Comparison, Error, Estimate, Fail, Held, Judged, Left, NOISE_RATIO, Options, Over, Place, Side, Verdict,
    compare, compare_posed,
};
pub use fit::{Evidence, Fit, Form, best_as_given, fit, is_evident, refit};
pub use judge::{Target, Timing};
pub use motion::{Kinematics, Sensors};
pub use piece::Piece;
pub use remarks::{Remark, remarks};
pub use verdict::{
    ADEQUATE, Addition, Candidate, Clock, Diagnosis, Doubt, Finding, Improvement, LEVEL, Law, Posed, StageDiagnosis,
    Step, Switched, WORTH, WindowError, diagnose_stages, improved_model, refitted_model,
};
