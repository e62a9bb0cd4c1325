//! The values of an FMU's variables, by value reference, and the checks that every slave needs.

use crate::description::{Causality, Description, Kind, Variable};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// One variable's value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// A real number.
    Real(f64),
    /// A whole number, or the number of an enumeration's item.
    Integer(i32),
    /// True or false.
    Boolean(bool),
    /// A text.
    Text(String),
}

impl Value {
    /// FMI's name of the type.
    pub fn type_name(&self) -> &'static str {
        match self {
            Value::Real(_) => "Real",
            Value::Integer(_) => "Integer",
            Value::Boolean(_) => "Boolean",
            Value::Text(_) => "String",
        }
    }
}

/// Why a value cannot be read, or a parameter is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ValueError {
    /// No variable has that value reference.
    #[error("value reference {reference} is unknown: this FMU's go from 0 to {last}")]
    Unknown {
        /// The reference.
        reference: usize,
        /// The largest that exists.
        last: usize,
    },
    /// No variable has that name.
    #[error("this FMU has no variable {name:?}: its interface.json does not fit its binary; package it anew")]
    NoSuchName {
        /// The name.
        name: String,
    },
    /// The variable is of another type.
    #[error("{name} is of type {actual}, not {asked}: call the function of its type")]
    WrongType {
        /// The variable.
        name: String,
        /// Its type.
        actual: &'static str,
        /// The type of the call.
        asked: &'static str,
    },
    /// An output cannot be set.
    #[error("{name} is what the FMU computes: it cannot be set")]
    Output {
        /// The variable.
        name: String,
    },
    /// A fixed parameter cannot be set once the simulation runs.
    #[error("{name} is a fixed parameter: set it before fmi2ExitInitializationMode, or reset first")]
    Fixed {
        /// The variable.
        name: String,
    },
    /// An input that may change at events only.
    #[error("{name} is a discrete input: set it in event mode")]
    Discrete {
        /// The variable.
        name: String,
    },
    /// A parameter outside its range.
    #[error("{name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// The parameter.
        name: String,
        /// Its value.
        value: String,
        /// What is allowed.
        range: String,
    },
}

/// All values of one instance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values(Vec<Value>);

impl Values {
    /// The start values.
    pub fn start(description: &Description) -> Values {
        let start = |variable: &Variable| match &variable.kind {
            Kind::Real { start, .. } => Value::Real(*start),
            Kind::Integer { start, .. } | Kind::Enumeration { start, .. } => Value::Integer(*start),
            Kind::Boolean { start } => Value::Boolean(*start),
            Kind::String { start } => Value::Text(start.clone()),
        };
        Values(description.variables.iter().map(start).collect())
    }

    /// The value at that reference.
    ///
    /// # Errors
    /// [`ValueError::Unknown`].
    pub fn get(&self, reference: usize) -> Result<&Value, ValueError> {
        let last = self.0.len().saturating_sub(1);
        self.0.get(reference).ok_or(ValueError::Unknown { reference, last })
    }

    /// Puts a value; what is no variable, or of another type, stays as it is.
    pub fn put(&mut self, reference: usize, value: Value) {
        if let Some(slot) = self.0.get_mut(reference).filter(|slot| slot.type_name() == value.type_name()) {
            *slot = value;
        }
    }

    /// The real number at that reference; NaN where there is none.
    pub fn real(&self, reference: usize) -> f64 {
        match self.0.get(reference) {
            Some(Value::Real(value)) => *value,
            _ => f64::NAN,
        }
    }

    /// The whole number at that reference; 0 where there is none.
    pub fn integer(&self, reference: usize) -> i32 {
        match self.0.get(reference) {
            Some(Value::Integer(value)) => *value,
            _ => 0,
        }
    }

    /// The text at that reference; empty where there is none.
    pub fn text(&self, reference: usize) -> &str {
        match self.0.get(reference) {
            Some(Value::Text(value)) => value,
            _ => "",
        }
    }

    /// Names of the parameters that are no longer at their start values.
    pub fn changed_parameters<'a>(&self, description: &'a Description) -> Vec<&'a str> {
        let start = Values::start(description);
        let all = description.variables.iter().zip(self.0.iter().zip(&start.0));
        let changed = all.filter(|(variable, (now, start))| variable.causality == Causality::Parameter && now != start);
        changed.map(|(variable, _)| variable.name.as_str()).collect()
    }

    /// Whether the other values are those of the same variables, by type.
    pub fn same_shape(&self, other: &Values) -> bool {
        let types = |values: &Values| values.0.iter().map(Value::type_name).collect::<Vec<_>>();
        types(self) == types(other)
    }

    /// Checks every parameter against its range.
    ///
    /// # Errors
    /// [`ValueError::OutOfRange`] for the first that is outside.
    pub fn check_parameters(&self, description: &Description) -> Result<(), ValueError> {
        let parameters = description.variables.iter().zip(&self.0);
        for (variable, value) in parameters.filter(|(variable, _)| variable.causality == Causality::Parameter) {
            check_range(description, variable, value)?;
        }
        Ok(())
    }
}

fn check_range(description: &Description, variable: &Variable, value: &Value) -> Result<(), ValueError> {
    let (inside, shown, range) = match (&variable.kind, value) {
        (Kind::Real { min, max, .. }, Value::Real(value)) => {
            let inside =
                value.is_finite() && min.is_none_or(|min| *value >= min) && max.is_none_or(|max| *value <= max);
            (inside, value.to_string(), range_text(*min, *max, "a finite number"))
        }
        (Kind::Integer { min, max, .. }, Value::Integer(value)) => {
            let inside = min.is_none_or(|min| *value >= min) && max.is_none_or(|max| *value <= max);
            (inside, value.to_string(), range_text(*min, *max, "a whole number"))
        }
        (Kind::Enumeration { of, .. }, Value::Integer(value)) => {
            let count = description.item_count(of);
            ((1..=count).contains(value), value.to_string(), format!("an item of {of}, 1 to {count}"))
        }
        _ => return Ok(()),
    };
    if inside {
        return Ok(());
    }
    Err(ValueError::OutOfRange { name: variable.name.clone(), value: shown, range })
}

fn range_text<T: std::fmt::Display>(min: Option<T>, max: Option<T>, what: &str) -> String {
    match (min, max) {
        (Some(min), Some(max)) => format!("{what} from {min} to {max}"),
        (Some(min), None) => format!("{what}, {min} or more"),
        (None, Some(max)) => format!("{what}, {max} or less"),
        (None, None) => what.into(),
    }
}
