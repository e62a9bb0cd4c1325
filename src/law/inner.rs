//! Inner parameters of an effect: what its equation holds besides the coefficient, such as the gap of a dead zone.

use serde::{Deserialize, Serialize};
use std::hash::{Hash, Hasher};
use thiserror::Error;

/// The value of an inner parameter, compared and hashed by its bits, so that a term can be a key.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Inner(f64);

impl Inner {
    /// The number as a value; −0 counts as 0.
    pub const fn new(value: f64) -> Inner {
        Inner(if value == 0.0 { 0.0 } else { value })
    }

    /// The number.
    #[inline]
    pub const fn value(self) -> f64 {
        self.0
    }
}

impl PartialEq for Inner {
    fn eq(&self, other: &Inner) -> bool {
        self.0.to_bits() == other.0.to_bits()
    }
}

impl Eq for Inner {}

impl Hash for Inner {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.to_bits().hash(state);
    }
}

/// What an inner parameter is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InnerUnit {
    /// The coordinate's unit, m.
    Coordinate,
    /// The coordinate's unit per second, m/s.
    Velocity,
    /// s.
    Time,
    /// rad/s.
    AngularFrequency,
    /// Radians per unit of the coordinate, rad/m.
    WaveNumber,
    /// A pure number.
    Number,
}

/// The values that an inner parameter may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InnerRange {
    /// Greater than 0.
    Positive,
    /// 0 or greater.
    NotNegative,
    /// At least this.
    AtLeast(f64),
    /// Any number.
    Any,
    /// One of two numbers.
    Either(f64, f64),
}

impl InnerRange {
    /// Whether the value is finite and allowed.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                InnerRange::Positive => value > 0.0,
                InnerRange::NotNegative => value >= 0.0,
                InnerRange::AtLeast(least) => value >= least,
                InnerRange::Any => true,
                InnerRange::Either(one, other) => value == one || value == other,
            }
    }
}

impl std::fmt::Display for InnerRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            InnerRange::Positive => f.write_str("a number greater than 0"),
            InnerRange::NotNegative => f.write_str("0 or a positive number"),
            InnerRange::AtLeast(least) => write!(f, "a number not below {least}"),
            InnerRange::Any => f.write_str("a finite number"),
            InnerRange::Either(one, other) => write!(f, "{one} or {other}"),
        }
    }
}

/// One inner parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InnerParameter {
    /// Its name in model files.
    pub name: &'static str,
    /// Its value where none is given.
    pub default: f64,
    /// What it is measured in.
    pub unit: InnerUnit,
    /// What it may be.
    pub range: InnerRange,
    /// One phrase on what it is.
    pub description: &'static str,
}

/// Why inner parameters are refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum InnerError {
    /// The effect has no parameter of that name.
    #[error("\"{name}\" is no inner parameter of {effect}: {}", known_names(.known))]
    Unknown {
        /// The effect's id.
        effect: String,
        /// The name.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// A value outside its range.
    #[error("{effect}: {name} = {value} is out of range: it must be {range}")]
    Range {
        /// The effect's id.
        effect: String,
        /// The parameter.
        name: String,
        /// Its value.
        value: f64,
        /// What it may be.
        range: InnerRange,
    },
    /// Not one value for each parameter.
    #[error("{effect} has {expected} inner parameters, not {found}")]
    Count {
        /// The effect's id.
        effect: String,
        /// How many parameters it has.
        expected: usize,
        /// How many values were given.
        found: usize,
    },
}

fn known_names(names: &[String]) -> String {
    match names {
        [] => "it has none".into(),
        _ => format!("write one of {}", names.join(", ")),
    }
}
