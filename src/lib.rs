//! Rapid identification of switched systems.
//!
//! A vibrating system is watched sample by sample: displacement `q`, velocity `q̇` and excitation `F`. The
//! identifier keeps the equation of motion that explains them, notices when the system switches to another law, and
//! re-identifies it. Data takes one way through the modules:
//!
//! measurement → [`law`] → [`weak`] rows → coefficients → [`evidence`] → switch ([`identify`])
//!
//! Terms stand on the left, the excitation on the right, `m q̈ + c q̇ + k₁ q + k₃ q³ = F`.

pub mod evidence;
pub mod identify;
pub mod law;
pub mod simulate;
pub mod weak;
