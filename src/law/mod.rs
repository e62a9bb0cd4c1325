//! Laws of motion as sums of terms.
//!
//! A law of one coordinate q reads `Σ θ_j f_j(q̈, q̇, q, F) = F`: coefficients θ on the left, the measured excitation F
//! on the right with its coefficient fixed to 1 (or, unforced, with the inertia fixed to 1 and F = 0). Each
//! [`Term`] is one f: the inertia q̈, a product of powers `q^a q̇^b F^c`, or a named physical effect of the catalogue.

mod catalogue;
mod compiled;
mod dimension;
mod drive;
mod dynamics;
mod effect;
mod expression;
mod formula;
mod formulated;
mod history;
mod hold;
mod hysteresis_loop;
mod inner;
mod inner_parameters;
mod intervals;
mod linear_memory;
mod linearized;
mod memory;
mod model;
mod model_error;
mod model_file;
mod motion;
mod named_laws;
pub(crate) mod numerals;
mod own;
mod pointwise;
mod quadrature;
mod reversal;
mod series;
mod sliding;
mod term;
mod text;
mod unit;
mod units;

pub use catalogue::{Catalogue, Entry, Sign};
pub(crate) use compiled::Compiled;
pub use dimension::Dimension;
pub use drive::{BandLimited, Drive};
pub(crate) use drive::{NODES, REACH, look_ahead};
pub(crate) use dynamics::MAX_MEMORY;
pub use dynamics::{Dynamics, DynamicsError, Phase};
pub use effect::Effect;
pub use expression::Expression;
pub use formula::FormulaError;
pub use history::{History, Samples};
pub use hold::Hold;
pub use inner::{Inner, InnerError, InnerParameter, InnerRange, InnerUnit};
pub(crate) use intervals::{Line, interval_forces};
pub(crate) use linearized::Linearized;
pub use model::{Columns, Given, Model, ModelTerm};
pub use model_error::ModelError;
pub use motion::{Motion, State};
pub use named_laws::NamedLaw;
pub use own::Own;
pub(crate) use quadrature::GAUSS;
pub use series::{Trajectory, forgets, term_series};
pub(crate) use term::raised;
pub use term::{Monomial, Term, TermError};
pub use text::equation;
pub use unit::{Channel, Quantity, Unit};
pub use units::{ColumnUnits, SiUnit, Units, unit_of};
