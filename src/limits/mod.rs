//! What any method could reach on a record: the Cramér–Rao bound of the coefficients and the earliest sight of a
//! switch.
//!
//! The readings of q and q̇ are the law's own motion plus independent Gaussian sensor noise; the motion has no noise of
//! its own, and its initial state is unknown. The Fisher information of the coefficients θ is that of all readings, the
//! state marginalised (Cramér, *Mathematical Methods of Statistics*, 32.3; Rao 1945):
//!
//! - J = Σ ψψᵀ/s over the innovations of a Kalman filter of the state, s their variances, ψ their sensitivities to θ
//!   ([`bound()`]); it equals the Schur complement of the information of (initial state, θ).
//! - std of θ_j ≥ √(J⁻¹)_jj; the mean of e, eq. (8), ≥ trace J⁻¹ ÷ Σθ².
//! - a known change of the law is seen once Σ|old − new motion|²/(2σ²) passes ln(false alarm interval ÷ sample time),
//!   the state at the switch known ([`detection()`]).
//!
//! Of a law that gives F for a motion that a machine imposes ([`force_bound`], [`force_detection`]) the readings of F
//! are its force plus noise, and the motion counts as known: what the sensors of q and q̇ leave open can only add.

mod bound;
mod course;
mod detection;
mod error;
mod force;
mod law;
mod marginal;
mod sensitivity;

pub(crate) use bound::ROUNDING;
pub use bound::{Bound, SETTLED_ERROR, bound};
pub(crate) use course::TURN;
pub use course::{Course, Sensors};
pub use detection::{Detection, detection, level};
pub use error::LimitsError;
pub use force::{Imposed, force_bound, force_detection};
pub use law::Law;
pub use marginal::Start;
