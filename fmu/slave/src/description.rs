//! What an FMU says of itself: its variables, their kinds, ranges and start values.
//!
//! One [`Description`] is the source of both `modelDescription.xml` (written by the packager) and
//! `resources/interface.json` (read by the slave). A variable's value reference is its position in the list.

use serde::{Deserialize, Serialize};

/// The file in an FMU's resources that holds the [`Interface`].
pub const INTERFACE_FILE: &str = "interface.json";

/// What `resources/interface.json` holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interface {
    /// The GUID of `modelDescription.xml`, derived from its content.
    pub guid: String,
    /// The variables.
    pub description: Description,
}

/// An FMU's interface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Description {
    /// Name of the model and, with it, of the binary: letters, digits, underscores.
    pub name: String,
    /// One sentence on what the FMU does.
    pub description: String,
    /// Version of the tool that wrote it.
    pub version: String,
    /// Step that a simulator should take unless told otherwise, s.
    pub default_step: f64,
    /// How long a simulation lasts unless told otherwise, s.
    pub default_duration: f64,
    /// Units that the variables refer to.
    pub units: Vec<Unit>,
    /// Whether it can be integrated by the host too: model exchange beside co-simulation.
    #[serde(default)]
    pub model_exchange: bool,
    /// Enumerations that the variables refer to.
    pub enumerations: Vec<Enumeration>,
    /// The variables; position is value reference.
    pub variables: Vec<Variable>,
}

/// A unit by its SI exponents.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// Its symbol.
    pub name: String,
    /// Exponents of kg, m, s, A, rad.
    pub exponents: [i8; 5],
}

/// An enumeration; its items are numbered from 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Enumeration {
    /// Its name.
    pub name: String,
    /// Name and description of each item.
    pub items: Vec<(String, String)>,
}

/// What a variable is to the outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Causality {
    /// Set before the simulation, then fixed.
    Parameter,
    /// Set before every step.
    Input,
    /// Written by the slave.
    Output,
    /// Written by the slave, and no port: to look at.
    Local,
    /// The time.
    Independent,
}

/// When an input or output may change; a parameter never does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Variability {
    /// Only from step to step, or never; what is no real number must be this.
    Discrete,
    /// At any time.
    Continuous,
}

/// A variable's type with what belongs to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A real number.
    Real {
        /// Start value; for an output, its value before the first step unless the slave computes another.
        start: f64,
        /// Smallest allowed value.
        min: Option<f64>,
        /// Largest allowed value.
        max: Option<f64>,
        /// Name of its unit.
        unit: Option<String>,
    },
    /// A whole number.
    Integer {
        /// Start value.
        start: i32,
        /// Smallest allowed value.
        min: Option<i32>,
        /// Largest allowed value.
        max: Option<i32>,
    },
    /// An item of an enumeration.
    Enumeration {
        /// Name of the enumeration.
        of: String,
        /// Number of the item at the start.
        start: i32,
    },
    /// True or false.
    Boolean {
        /// Start value.
        start: bool,
    },
    /// A text.
    String {
        /// Start value.
        start: String,
    },
}

/// One variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Its name, structured as FMI 2.0 asks: `stage[1].k3`.
    pub name: String,
    /// One sentence, with what a user must know to set or read it.
    pub description: String,
    /// What it is to the outside.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Type, range, start value.
    pub kind: Kind,
    /// For an output: names of the parameters that its value before the first step depends on.
    pub depends_on: Vec<String>,
    /// Name of the continuous state whose derivative in time it is.
    #[serde(default)]
    pub derivative_of: Option<String>,
    /// Names of the continuous states and inputs that it depends on at the same instant.
    #[serde(default)]
    pub follows: Vec<String>,
}

impl Description {
    /// Position, and so value reference, of the variable of that name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|variable| variable.name == name)
    }

    /// Position of the time, where it is a variable.
    pub fn time(&self) -> Option<usize> {
        self.variables.iter().position(|variable| variable.causality == Causality::Independent)
    }

    /// How many items the enumeration has.
    pub fn item_count(&self, enumeration: &str) -> i32 {
        let found = self.enumerations.iter().find(|candidate| candidate.name == enumeration);
        found.map_or(0, |enumeration| enumeration.items.len() as i32)
    }
}
