//! The law in weak form: integrals against variations instead of derivatives of data.
//!
//! For a variation φ = δq that vanishes with its derivative at both ends of [T₁, T₂], eq. (1) of the method reads,
//! terms on the left,
//!
//! ```text
//! ∫ Σ_j θ_j f_j φ dt = ∫ F φ dt,   ∫ q̈ φ dt = −∫ q̇ φ' dt = ∫ q φ'' dt
//! ```
//!
//! which is what integration by parts gives. (The publication prints its weak equations (7) and (10) with signs that do
//! not follow from its own (5) and (9).) One interval and one variation give one linear equation in θ, a [`Row`]; many
//! of them an overdetermined system, solved by pseudo-inverse ([`Regression`]). Terms linear in q̇ are integrated by
//! parts, so that they need no velocity: ∫ qᵃ q̇ φ dt = −∫ qᵃ⁺¹/(a+1) φ' dt. A constant times δq̇ gives ∫ φ' dt = 0
//! whatever the data.

mod functional;
mod regression;
mod row;
mod unmeasured;
mod variation;

pub(crate) use functional::{Functional, Pole, signal};
pub use regression::{Direction, Fit, Regression};
pub use row::{Row, Section};
pub(crate) use unmeasured::{differentiate, integrate};
pub use variation::Variation;
