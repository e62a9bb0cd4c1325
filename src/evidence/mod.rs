//! How well a law explains a record, and how much better another one would.
//!
//! Everything stands on the innovations ε of a Kalman filter for (q, q̇) under a law with coefficients θ (Ljung, *System
//! Identification*, 2nd ed., ch. 7 and 10; Särkkä, *Bayesian Filtering and Smoothing*, ch. 16): with s the variance that
//! the filter states for ε, a record has the log-likelihood −½ Σ (ε²/s + ln s). The filter allows for sensor noise in both
//! channels and for a white force that the law does not have. As that force goes to zero the fit becomes the maximum
//! likelihood of the trajectory, with its initial state marginalised; as it grows, that of the equation error.
//!
//! - [`Filter`]: the state and its covariance, from sample to sample;
//! - [`Guard`]: readings that are no part of the motion;
//! - [`Pass`]: one run over a record: likelihood, score and Fisher information of the coefficients;
//! - [`Joint`]: the state together with coefficients that may wander;
//! - [`Lack`]: effects that the law does not have, by the score test in the stream;
//! - [`Information`]: sums of them, and their solution;
//! - [`Weighing`]: which of two beliefs about the coefficients a record speaks for;
//! - [`Single`]: a change of one coefficient alone;
//! - [`Bank`]: hypotheses that the law switched at one of many instants (Willsky and Jones, IEEE TAC 21, 1976).

mod bank;
mod filter;
mod guard;
mod information;
mod joint;
mod lack;
mod pass;
mod single;
mod symmetric;
mod weighing;

pub use bank::{Bank, Law, Suspect};
pub use filter::{Channel, Filter, Innovation, Noise};
pub use guard::Guard;
pub use information::{Information, Solution};
pub use joint::{Joint, Start, Unknowns};
pub use lack::{Lack, Missing};
pub use pass::{Observation, Pass, RIVALS, Track, gains};
pub use single::either;
pub use symmetric::{LogSum, System};
pub use weighing::{Belief, Weighing};
