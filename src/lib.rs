//! Rapid identification of switched systems.
//!
//! A vibrating system is watched sample by sample: displacement `q`, velocity `q̇` and excitation `F`. The identifier
//! keeps the equation of motion that explains them, notices when the system switches to another law, and re-identifies
//! it. A diagnosis says which physical effect a model lacks. Everything is in SI units; terms stand on the left, the
//! excitation on the right, `m q̈ + c q̇ + k₁ q + k₃ q³ = F`.
//!
//! # A first identification
//!
//! A [`Model`] names the terms that the law may have; an [`Identifier`] takes one [`Sample`] after the other. Its
//! [`Output`] and coefficients hold after each of them.
//!
//! ```
//! use switchid::simulate::{Builtin, record};
//! use switchid::{Identifier, Model, Sample, Settings};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let model = Model::from_toml("terms = { qdd = 'fit', qd = 'fit', q = 'fit', 'q^3' = 'fit' }")?;
//! let mut identifier = Identifier::new(&model, Settings::default())?;
//!
//! // a Duffing oscillator whose law switches at 18 s, read by noisy sensors; your own samples in its place
//! let plant = Builtin::DuffingSine.scenario().with_noise(0.01);
//! for reading in record(&plant)?.iter().take_while(|reading| reading.t < 30.0) {
//!     identifier.step(Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation })?;
//! }
//!
//! let output = identifier.output();
//! assert!(output.valid && output.switch_count == 1);
//! for coefficient in identifier.coefficients() {
//!     println!("{} = {} ± {:?}", coefficient.term, coefficient.value, coefficient.std);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # A first diagnosis
//!
//! A [`Recording`] holds what was measured; [`diagnose_stages`] says whether the model's form explains it down to its
//! sensors ([`Finding::Adequate`]), or which effect of the [catalogue](law::Catalogue) it lacks ([`Finding::Missing`]).
//!
//! ```
//! use switchid::simulate::{Scenario, columns, record};
//! use switchid::{Finding, Model, Recording, diagnose_stages};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let plant = Scenario::from_toml(
//!     r#"
//!     terms = ["qdd", "qd", "q"]
//!     duration = 20.0
//!     excitation = { kind = "multisine", from = 0.1, to = 2.0, count = 12, rms = 1.0 }
//!     noise = { q = 0.001, qd = 0.001 }
//!     hidden = { coulomb_friction = 0.3 }
//!     stage = [{ start = 0.0, coefficients = [1.0, 0.3, 4.0] }]
//!     "#,
//! )?;
//! let [t, q, qd, force] = columns(&record(&plant)?);
//! let recording = Recording::new("rig", t, Some(q), Some(qd), Some(force))?;
//!
//! let model = Model::from_toml("terms = { qdd = 'fit', qd = 'fit', q = 'fit' }")?;
//! let found = diagnose_stages(&model, &[&recording], None);
//! assert_eq!(found.finding(), Some(Finding::Missing));
//! let effect = found.principal().and_then(|diagnosis| diagnosis.effect.as_deref());
//! assert_eq!(effect, Some("coulomb_friction"));
//! # Ok(())
//! # }
//! ```
//!
//! # Modules
//!
//! | module | what it is | where to start |
//! |---|---|---|
//! | [`law`] | terms, the catalogue of effects, models and their files, units, integration in time | [`law::Model`] |
//! | [`identify`] | the streaming identifier, whole recordings, laws that return | [`identify::Identifier`], [`identify::identify_recording`] |
//! | [`diagnose`] | which effect a law lacks, and where a model fails | [`diagnose_stages`], [`diagnose::compare()`] |
//! | [`limits`] | what any method could reach on a record: the Cramér–Rao bound, the earliest sight of a switch | [`limits::bound()`] |
//! | [`simulate`] | plants whose law is known: scenarios, excitations, sensor noise | [`simulate::Scenario`], [`simulate::record`] |
//! | [`weak`] | the law as integrals against variations, and their solution | [`weak::Regression`] |
#![cfg_attr(
    feature = "cli",
    doc = "| [`data`] | recordings, models and scenarios from files | [`data::open_recording`] |"
)]
#![cfg_attr(
    feature = "cli",
    doc = "| [`report`] | figures, described once, as SVG, PNG or HTML | [`report::Figure`] |"
)]
#![cfg_attr(feature = "cli", doc = "| [`cli`] | the command line | [`cli::run`] |")]
#![cfg_attr(
    feature = "fmu",
    doc = "| [`fmu`] | what our FMUs are: variables, units, resources | [`fmu::identifier()`] |"
)]
//!
//! Without the default features (`cli`, `formats`, `pictures`) only the heart is built: it opens no file, reads no
//! clock, prints nothing, and the same samples give the same bits.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "cli")]
pub mod data;
pub mod diagnose;
mod estimation;
mod evidence;
#[cfg(feature = "fmu")]
pub mod fmu;
pub mod identify;
pub mod law;
pub mod limits;
#[cfg(feature = "cli")]
pub mod report;
pub mod simulate;
pub mod weak;

pub use diagnose::{Candidate, Comparison, Diagnosis, Finding, Improvement, Posed, compare, diagnose_stages};
pub use identify::{
    BuildError, Coefficient, Identification, Identifier, Method, Output, Recording, Sample, SavedLaws, Settings, Stage,
    Status, identify_recording,
};
pub use law::{Given, Hold, Model, Term};

/// The README's library example, compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct ReadmeDoctests;
