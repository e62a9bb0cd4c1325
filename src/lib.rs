//! Rapid identification of switched systems.
//!
//! A vibrating system is watched sample by sample: displacement `q`, velocity `q̇` and excitation `F`. The
//! identifier keeps the equation of motion that explains them, notices when the system switches to another law, and
//! re-identifies it. Data takes one way through the modules:
//!
//! measurement → [`law`] → [`weak`] rows → [`estimation`] → [`evidence`] → switch ([`identify`])
//!
//! Terms stand on the left, the excitation on the right, `m q̈ + c q̇ + k₁ q + k₃ q³ = F`.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "cli")]
pub mod data;
pub mod diagnose;
pub mod estimation;
pub mod evidence;
#[cfg(feature = "fmu")]
pub mod fmu;
pub mod identify;
pub mod law;
pub mod limits;
pub mod simulate;
pub mod weak;

/// The README's library example, compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct ReadmeDoctests;
