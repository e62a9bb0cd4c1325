//! Which physical effect a model lacks, and where it fails.

mod beside;
mod coefficients;
mod compare;
mod conclude;
mod cooling;
mod decide;
mod depends;
mod descent;
mod diagnosis;
mod errors;
mod fit;
mod force;
mod free_run;
mod improve;
mod inner_slopes;
mod judge;
mod levels;
mod locate;
mod loop_run;
mod massless;
mod means;
mod memory_run;
mod noise;
mod piece;
mod place;
mod proposal;
mod record;
mod rows;
mod run;
mod scan;
mod screen;
mod search;
mod sentence;
mod series;
mod smooth;
mod sound;
mod spectrum;
mod start;
mod switched;
mod tableau;
mod trajectory;
mod variants;
mod window;

pub use coefficients::{Estimate, Held};
pub use compare::{Comparison, Error, NOISE_RATIO, Options, Side, Verdict, compare};
pub use decide::{Decision, Reach, Visible, decide, visible};
pub use depends::{Dependence, Source, depends_on};
pub use diagnosis::{
    Candidate, Diagnosis, Evidence, Finding, LEVEL, best_as_given, best_of_form, candidates, diagnose, diagnose_model,
    effect_name, excess, is_evident,
};
pub use fit::{Fit, Form, fit, refit};
pub use improve::{Addition, Improvement, Step, add, error, improve, improved_model};
pub use judge::Trial;
pub use locate::{Bounds, Fail, Over};
pub use piece::Piece;
pub use place::Removal;
pub use proposal::{Proposal, Proposals};
pub use screen::{Gain, screen};
pub use search::{Search, search};
pub use switched::{StageDiagnosis, Switched, diagnose_stages};
pub use variants::{Scale, Variant, same_effect, variants};
