//! Whether a record speaks for a change of the law.
//!
//! Everything stands on the information and score that a filter run gives about the coefficients
//! ([`crate::estimation`]): they make its likelihood Gaussian there, and every hypothesis about the coefficients a log
//! Bayes factor in nats.
//!
//! - [`BayesFactor`]: which of two priors of the coefficients a record speaks for;
//! - [`SingleChange`]: a change of one coefficient alone;
//! - [`Bank`]: hypotheses that the law switched at one of many instants (Willsky and Jones, IEEE TAC 21, 1976).

mod bayes_factor;
mod hypotheses;
mod single_change;
mod switch_size;

pub use bayes_factor::{BayesFactor, GaussianPrior};
pub use hypotheses::{Bank, Law, Suspect};
pub use single_change::{OWN, either};
pub use switch_size::{INERTIA_SPREAD, SWITCH_SIZE};
