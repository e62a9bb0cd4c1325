//! How well a law explains a record, and what the record says about its coefficients.
//!
//! Everything stands on the innovations ε of a Kalman filter for (q, q̇) under a law with coefficients θ (Ljung,
//! *System Identification*, 2nd ed., ch. 7 and 10; Särkkä, *Bayesian Filtering and Smoothing*, ch. 16): with s the
//! variance that the filter states for ε, a record has the log-likelihood −½ Σ (ε²/s + ln s). The filter allows for
//! sensor noise in both channels and for a white force that the law does not have. As that force goes to zero the fit
//! becomes the maximum likelihood of the trajectory, with its initial state marginalised; as it grows, that of the
//! equation error.
//!
//! - [`DifferenceNoise`]: the sensors' noise before any law; [`RowsOfLength`]: first coefficients, from weak rows;
//! - [`Filter`]: N states and their covariance, from sample to sample, begun by [`initial_state`]; [`Rivals`]: under
//!   other process noise; [`smooth`]: the motion as all samples tell it;
//! - [`InnovationGate`]: readings that are no part of the motion;
//! - [`Pass`]: one run over a record: likelihood, score and Fisher information of the coefficients;
//! - [`AugmentedFilter`]: the state together with coefficients that may wander;
//! - [`ScoreTest`]: effects that the law does not have, tested in the stream, and [`LagTest`]: whether F acted
//!   later, both beside its [`OwnTerms`]; [`TermsAnew`]: with terms chosen anew; [`AddedEffect`]: one of the effects,
//!   added; [`EffectPosterior`]: whether that is the right one;
//! - [`TermSelection`]: which of the terms that it may have the law has;
//! - [`SandwichFactor`]: whether innovations are as independent as the filter says;
//! - [`RandomWalk`]: coefficients that wander, known from equations; `regression`: moments of equations, by blocks of
//!   time, and whether what a law leaves of them is white;
//! - `kinematics`: the motion where no law tells it, from how smooth it is;
//! - [`Information`]: sums of what is known of the coefficients, and [`Solution`], what follows from them; [`System`]
//!   solves them.

mod added_effect;
mod augmented_filter;
mod covariance;
mod difference_noise;
mod effect_posterior;
mod filter;
mod information;
mod initial_state;
mod innovation_gate;
mod kinematics;
mod lag_test;
mod odds;
mod one_more_coefficient;
mod pass;
mod random_walk;
mod regression;
mod rivals;
mod sandwich;
mod score_test;
mod smoother;
mod symmetric;
mod term_selection;
mod terms_anew;
mod track;
mod weak_start;

pub use added_effect::{AddedEffect, KnownEffect};
pub use augmented_filter::{AugmentedFilter, Start, Unknowns};
pub use covariance::Matrix;
pub use difference_noise::DifferenceNoise;
pub use effect_posterior::{EffectPosterior, LawWithEffect, WithAndWithout};
pub use filter::{Channel, Filter, Innovation, Noise, times, white_acceleration};
pub use information::{Information, Solution};
pub use initial_state::{initial_state, state_after_outage};
pub use innovation_gate::{InnovationGate, OUTLYING};
pub use kinematics::{FixedLagSmoother, Instant, LONGEST, MotionNoise};
pub use lag_test::{Lag, LagTest, ToldLag};
pub use odds::{BEYOND_CHANCE, SAMPLES_OF_A_VARIANCE, TWENTY_TO_ONE, UNLIKELY, log_sum};
pub use one_more_coefficient::OwnTerms;
pub use pass::{IntervalMap, Observation, Pass, gains};
pub use random_walk::{Equation, RandomWalk};
pub use regression::{Blocks, FEWEST, Moments, SURPRISE, Weight, Whiteness};
pub use rivals::{RIVALS, Rivals};
pub use sandwich::SandwichFactor;
pub use score_test::{Lacked, Missing, ScoreTest};
pub use smoother::{Smoothable, smooth};
pub use symmetric::{Lane, System, WIDTH, dot};
pub use term_selection::{TermSelection, price_of_a_term};
pub use terms_anew::{FreeTerms, TermsAnew};
pub use track::Track;
pub use weak_start::{OVERLAP, RowsOfLength, VARIATION};
