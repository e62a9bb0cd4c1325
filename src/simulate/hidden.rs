//! Effects that a plant has besides the terms of its law: what a model of the plant may lack.
//!
//! ```toml
//! [hidden]
//! coulomb_friction = 0.3
//! dead_zone_stiffness = { coefficient = 2.0, gap = 0.1 }
//! tip_drag = { coefficient = 0.2, v = 0.1, expression = "abs(qd/v)^0.5*qd" }
//! ```

use super::error::ScenarioError;
use crate::law::{Expression, Given, Model, ModelError, ModelTerm, Term};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

/// Terms with numbers, the same in every stage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hidden {
    entries: Vec<(Term, f64)>,
    expressions: Vec<Expression>,
}

impl Hidden {
    /// Adds a term with its coefficient; an inner parameter is in the term.
    pub fn push(&mut self, term: Term, coefficient: f64) {
        self.entries.push((term, coefficient));
    }

    /// Adds an effect of the user's own with its coefficient.
    pub fn push_expression(&mut self, expression: Expression, coefficient: f64) {
        self.push(expression.term(self.expressions.len()), coefficient);
        self.expressions.push(expression);
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The terms, in their order.
    pub fn terms(&self) -> impl Iterator<Item = Term> + '_ {
        self.entries.iter().map(|(term, _)| *term)
    }

    /// Their coefficients.
    pub fn coefficients(&self) -> impl Iterator<Item = f64> + '_ {
        self.entries.iter().map(|(_, coefficient)| *coefficient)
    }

    /// The formulas that its terms name.
    pub fn expressions(&self) -> &[Expression] {
        &self.expressions
    }

    /// Reads the table `[hidden]`.
    ///
    /// # Errors
    /// [`ScenarioError::Hidden`] or [`ScenarioError::HiddenNumber`] names the key at fault.
    pub fn from_table(table: &toml::Table) -> Result<Hidden, ScenarioError> {
        let mut hidden = Hidden::default();
        for (key, value) in table {
            let (entry, expression) = read(key, value)?;
            let Given::Known(coefficient) = entry.given else {
                return Err(ScenarioError::HiddenNumber { key: key.clone(), name: "coefficient".into() });
            };
            match expression {
                Some(expression) => hidden.push_expression(expression, coefficient),
                None => hidden.push(entry.term, coefficient),
            }
        }
        Ok(hidden)
    }

    /// Writes the table `[hidden]`.
    pub fn to_table(&self) -> toml::Table {
        self.entries.iter().map(|(term, coefficient)| self.write(*term, *coefficient)).collect()
    }

    fn write(&self, term: Term, coefficient: f64) -> (String, toml::Value) {
        let mut table = toml::Table::new();
        table.insert("coefficient".into(), coefficient.into());
        let mut put = |name: &str, value: f64| table.insert(name.into(), value.into());
        let name = match term {
            Term::Effect(effect) => {
                effect.inner().iter().zip(effect.inner_values()).for_each(|(inner, value)| {
                    put(inner.name, value);
                });
                term.name()
            }
            Term::Expression(own) => {
                let expression = &self.expressions[own.place()];
                expression.parameters().iter().zip(expression.values()).for_each(|(name, value)| {
                    put(name, *value);
                });
                table.insert("expression".into(), expression.text().into());
                expression.name().into()
            }
            _ => term.name(),
        };
        (name, table.into())
    }
}

/// One entry, with its formula where it is the user's own. Every inner parameter must have a number.
fn read(key: &str, value: &toml::Value) -> Result<(ModelTerm, Option<Expression>), ScenarioError> {
    let refused = |source: ModelError| ScenarioError::Hidden { source: Box::new(source) };
    let mut table = toml::Table::new();
    let mut effects = toml::Table::new();
    let mut value = value.clone();
    if let Some(formula) = value.as_table_mut().and_then(|entry| entry.remove("expression")) {
        effects.insert(key.into(), toml::Table::from_iter([("expression".to_string(), formula)]).into());
    }
    table.insert(key.into(), value);
    let (mut terms, mut expressions) = Model::read_terms(&table, &effects).map_err(refused)?;
    let Some(entry) = terms.pop() else {
        return Err(ScenarioError::HiddenNumber { key: key.into(), name: key.into() });
    };
    let names = match (&entry.term, expressions.first()) {
        (_, Some(expression)) => expression.parameters().to_vec(),
        (term, None) => {
            term.effect().map_or(Vec::new(), |effect| effect.inner().iter().map(|i| i.name.into()).collect())
        }
    };
    match entry.open.iter().zip(names).find(|(open, _)| **open) {
        Some((_, name)) => Err(ScenarioError::HiddenNumber { key: key.into(), name }),
        None => Ok((entry, expressions.pop())),
    }
}

/// What a binary form holds: terms, coefficients, expressions.
type Binary = (Vec<(Term, f64)>, Vec<Expression>);

impl Serialize for Hidden {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match serializer.is_human_readable() {
            true => self.to_table().serialize(serializer),
            false => (&self.entries, &self.expressions).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Hidden {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Hidden, D::Error> {
        if deserializer.is_human_readable() {
            return Hidden::from_table(&toml::Table::deserialize(deserializer)?).map_err(D::Error::custom);
        }
        let (entries, expressions) = Binary::deserialize(deserializer)?;
        Ok(Hidden { entries, expressions })
    }
}
