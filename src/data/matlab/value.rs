//! A value of MATLAB's, whatever file it came from.

use super::super::arrays::Unfit;
use super::super::names::check_vector;

/// First number of an array that refers to objects.
const REFERENCE: f64 = 0xDD00_0000_u32 as f64;

/// Numbers that are in memory, or in the file until they are asked for.
pub(super) trait Numbers {
    /// All of them, column by column.
    fn read(&self) -> Result<Vec<f64>, Unfit>;
}

impl Numbers for Vec<f64> {
    fn read(&self) -> Result<Vec<f64>, Unfit> {
        Ok(self.clone())
    }
}

/// A value of MATLAB's.
pub(super) enum Value {
    /// An array of real numbers; one that refers to objects too.
    Numbers {
        /// Its extents.
        shape: Vec<usize>,
        /// Its numbers.
        numbers: Box<dyn Numbers>,
    },
    /// Complex numbers: their real and imaginary parts.
    Complex {
        /// Real parts.
        real: Vec<f64>,
        /// Imaginary parts.
        imaginary: Vec<f64>,
    },
    /// A row of characters.
    Text(String),
    /// A cell array, column by column.
    Cells(Vec<Value>),
    /// A structure's fields.
    Structure(Vec<(String, Value)>),
    /// An object of a class: what refers to it.
    Object(Box<Value>),
    /// What holds no signal: `a sparse matrix`.
    Other(&'static str),
}

impl Value {
    /// Its numbers, where it is a vector of them.
    pub(super) fn vector(&self) -> Result<Vec<f64>, Unfit> {
        let is = |what: &str| Err(Unfit::Is(what.into()));
        match self {
            Value::Numbers { shape, numbers } => {
                check_vector(shape)?;
                numbers.read()
            }
            Value::Complex { .. } => is("complex"),
            Value::Text(_) => is("text"),
            Value::Cells(_) => is("a cell array"),
            Value::Structure(_) => is("a structure"),
            Value::Object(_) => is("an object of a class that is not read"),
            Value::Other(what) => is(what),
        }
    }

    /// Its only number.
    pub(super) fn number(&self) -> Option<f64> {
        let Value::Numbers { shape, numbers } = self else { return None };
        (shape.iter().product::<usize>() == 1).then(|| numbers.read().ok()?.first().copied()).flatten()
    }

    /// Its characters.
    pub(super) fn text(&self) -> Option<&str> {
        if let Value::Text(text) = self { Some(text) } else { None }
    }

    /// The texts of a cell array.
    pub(super) fn texts(&self) -> Vec<&str> {
        if let Value::Cells(cells) = self { cells.iter().filter_map(Value::text).collect() } else { Vec::new() }
    }

    /// A field of a structure.
    pub(super) fn field(&self, name: &str) -> Option<&Value> {
        let Value::Structure(fields) = self else { return None };
        fields.iter().find(|(field, _)| field == name).map(|(_, value)| value)
    }

    /// The number of the only object that it refers to: after the mark the extents with their count, then the objects'
    /// numbers, then their class's.
    pub(super) fn object(&self) -> Option<usize> {
        let referring = match self {
            Value::Object(reference) => reference,
            other => other,
        };
        let Value::Numbers { shape, numbers } = referring else { return None };
        // Signals are long; a reference to one object is not, and only it is read here.
        if shape.iter().product::<usize>() != 6 {
            return None;
        }
        match numbers.read().ok()?[..] {
            [REFERENCE, 2.0, 1.0, 1.0, object, _] => Some(object as usize),
            _ => None,
        }
    }
}
