//! A model file: which terms a law may have, what is known of them, and which columns of a recording it reads.

use super::{Hold, Term, TermError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What the user knows of a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Given {
    /// Estimated; the term stays in the law.
    Fit,
    /// Known and held at this value.
    Known(f64),
    /// Evidence decides whether the law has the term.
    Maybe,
}

/// One term of a model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelTerm {
    /// What the coefficient multiplies.
    pub term: Term,
    /// What is known of the coefficient.
    pub given: Given,
    /// The name the user wrote: an effect id stays one when the model is written again.
    pub key: String,
}

/// Which column of a measurement holds which quantity; `None` is the default name, which need not be there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Columns {
    /// Time, s.
    pub t: Option<String>,
    /// Displacement.
    pub q: Option<String>,
    /// Velocity.
    pub qd: Option<String>,
    /// Excitation.
    #[serde(rename = "F")]
    pub excitation: Option<String>,
}

/// A model of one coordinate, as its TOML file says it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// The user's name for it.
    pub name: String,
    /// What the excitation does between samples, where the file says so.
    pub hold: Option<Hold>,
    /// Which columns of a measurement it reads.
    pub columns: Columns,
    /// The terms on the left-hand side, in the order of the file.
    pub terms: Vec<ModelTerm>,
    /// Terms of U₀ that are total time derivatives, `q^n*qd`: their variation integrates to zero, so that no data can
    /// determine them. They are kept to be reported.
    pub potential: Vec<Term>,
}

/// Why a model is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ModelError {
    /// The text is no TOML, or a key has the wrong type.
    #[error("{message}")]
    Syntax {
        /// What the TOML reader says, with line and column.
        message: String,
    },
    /// A key of `[terms]` is no term.
    #[error("[terms]: {source}")]
    Term {
        /// Which text, and why.
        source: TermError,
    },
    /// Two keys name the same term.
    #[error("[terms]: \"{first}\" and \"{second}\" are the same term: keep one")]
    Twice {
        /// The first key.
        first: String,
        /// The second key.
        second: String,
    },
    /// The value of a term is none of the three things it may be.
    #[error("[terms]: \"{key}\" = {value}: write \"fit\", \"maybe\" or a finite number")]
    Given {
        /// The key.
        key: String,
        /// Its value as written.
        value: String,
    },
    /// No terms at all.
    #[error("[terms] is empty: name at least one term, for example inertia = \"fit\"")]
    NoTerms,
    /// Without inertia there is no equation of motion to integrate.
    #[error("[terms] has no inertia: add inertia = \"fit\" (or its known value)")]
    NoInertia,
    /// More terms than the estimator is built for.
    #[error("[terms] has {count} terms; at most {max} are supported")]
    TooMany {
        /// How many there are.
        count: usize,
        /// How many there may be.
        max: usize,
    },
    /// More than one coordinate.
    #[error("coordinates = {names:?}: this version identifies one coordinate, named q")]
    Coordinates {
        /// The names given.
        names: Vec<String>,
    },
    /// A term of U₀ that is no total time derivative.
    #[error(
        "[potential]: \"{key}\": only total time derivatives (qd, q*qd, q^2*qd …) may stand here; write other terms in [terms]"
    )]
    Potential {
        /// The key.
        key: String,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<String>,
    coordinates: Option<Vec<String>>,
    hold: Option<Hold>,
    #[serde(default)]
    columns: ColumnsFile,
    #[serde(default)]
    terms: toml::Table,
    #[serde(default)]
    potential: toml::Table,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct ColumnsFile {
    t: Option<String>,
    q: Option<String>,
    qd: Option<String>,
    #[serde(rename = "F")]
    excitation: Option<String>,
}

impl Model {
    /// The most terms a model may have.
    pub const MAX_TERMS: usize = 32;

    /// The default identifier's model: the full cubic library of eq. (11), all "maybe" but the inertia, and the
    /// constant times δq̇, which integrates to zero.
    pub fn cubic_library() -> Model {
        let powers = [(0, 0), (1, 0), (0, 1), (0, 2), (2, 0), (1, 1), (0, 3), (3, 0), (2, 1), (1, 2)];
        let maybe = powers.map(|(q, qd)| (Term::power(q, qd), Given::Maybe));
        let terms = std::iter::once((Term::Inertia, Given::Fit)).chain(maybe);
        Model { potential: vec![Term::power(0, 1)], ..Model::of("full cubic library", terms) }
    }

    /// A model of these terms, each under its canonical name.
    pub fn of(name: &str, terms: impl IntoIterator<Item = (Term, Given)>) -> Model {
        let terms = terms.into_iter().map(|(term, given)| ModelTerm { term, given, key: term.name() }).collect();
        Model { name: name.into(), hold: None, columns: Columns::default(), terms, potential: Vec::new() }
    }

    /// Reads a model file.
    ///
    /// # Errors
    /// [`ModelError`] names the key at fault and what would mend it.
    pub fn from_toml(text: &str) -> Result<Model, ModelError> {
        let file: File = toml::from_str(text).map_err(|error| ModelError::Syntax { message: error.to_string() })?;
        if let Some(names) = file.coordinates.filter(|names| names.as_slice() != ["q"]) {
            return Err(ModelError::Coordinates { names });
        }
        let terms = file.terms.iter().map(|(key, value)| read_term(key, value)).collect::<Result<Vec<_>, _>>()?;
        let potential = file.potential.keys().map(|key| read_potential(key)).collect::<Result<Vec<_>, _>>()?;
        let model = Model {
            name: file.name.unwrap_or_else(|| "unnamed".into()),
            hold: file.hold,
            columns: Columns {
                t: file.columns.t,
                q: file.columns.q,
                qd: file.columns.qd,
                excitation: file.columns.excitation,
            },
            terms,
            potential,
        };
        model.check()?;
        Ok(model)
    }

    /// Writes the model as a file that [`Model::from_toml`] reads back to the same model.
    pub fn to_toml(&self) -> String {
        let quote = |text: &str| toml::Value::from(text).to_string();
        let mut text = format!("name = {}\ncoordinates = [\"q\"]\n", quote(&self.name));
        if let Some(hold) = self.hold {
            text += &format!("hold = \"{hold}\"\n");
        }
        let columns =
            [("t", &self.columns.t), ("q", &self.columns.q), ("qd", &self.columns.qd), ("F", &self.columns.excitation)];
        if columns.iter().any(|(_, column)| column.is_some()) {
            text += "\n[columns]\n";
        }
        for (name, column) in columns.iter().filter_map(|(name, column)| Some((name, column.as_deref()?))) {
            text += &format!("{name} = {}\n", quote(column));
        }
        text += "\n[terms]\n";
        for term in &self.terms {
            let value = match term.given {
                Given::Fit => "\"fit\"".to_string(),
                Given::Maybe => "\"maybe\"".to_string(),
                Given::Known(value) => toml::Value::from(value).to_string(),
            };
            text += &format!("{} = {value}\n", quote(&term.key));
        }
        if !self.potential.is_empty() {
            text += "\n[potential]\n";
        }
        for term in &self.potential {
            text += &format!("{} = \"maybe\"\n", quote(&term.name()));
        }
        text
    }

    /// The model with only the named terms, each "fit", as the FMU parameter `terms` asks.
    ///
    /// # Errors
    /// [`ModelError::Term`] for a text that is no term; what [`Model::check`] refuses.
    pub fn with_terms<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> Result<Model, ModelError> {
        let terms = names
            .into_iter()
            .map(|name| {
                let term = Term::parse(name).map_err(|source| ModelError::Term { source })?;
                Ok(ModelTerm { term, given: Given::Fit, key: name.into() })
            })
            .collect::<Result<Vec<_>, ModelError>>()?;
        let model = Model { terms, potential: Vec::new(), ..self.clone() };
        model.check()?;
        Ok(model)
    }

    /// Where the term stands among [`Model::terms`].
    pub fn position(&self, term: Term) -> Option<usize> {
        self.terms.iter().position(|entry| entry.term == term)
    }

    /// Checks what the TOML reader cannot: each term once, an inertia, not too many.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check(&self) -> Result<(), ModelError> {
        if self.terms.is_empty() {
            return Err(ModelError::NoTerms);
        }
        if self.terms.len() > Model::MAX_TERMS {
            return Err(ModelError::TooMany { count: self.terms.len(), max: Model::MAX_TERMS });
        }
        for (index, entry) in self.terms.iter().enumerate() {
            if let Some(first) = self.terms[..index].iter().find(|other| other.term == entry.term) {
                return Err(ModelError::Twice { first: first.key.clone(), second: entry.key.clone() });
            }
        }
        self.position(Term::Inertia).map(|_| ()).ok_or(ModelError::NoInertia)
    }
}

fn read_term(key: &str, value: &toml::Value) -> Result<ModelTerm, ModelError> {
    let term = Term::parse(key).map_err(|source| ModelError::Term { source })?;
    let number = value.as_float().or_else(|| value.as_integer().map(|n| n as f64));
    let given = match (value.as_str(), number) {
        (Some("fit"), _) => Given::Fit,
        (Some("maybe"), _) => Given::Maybe,
        (None, Some(number)) if number.is_finite() => Given::Known(number),
        _ => return Err(ModelError::Given { key: key.into(), value: value.to_string() }),
    };
    Ok(ModelTerm { term, given, key: key.into() })
}

fn read_potential(key: &str) -> Result<Term, ModelError> {
    match Term::parse(key) {
        Ok(term @ Term::Monomial(powers)) if powers.qd == 1 && powers.excitation == 0 => Ok(term),
        _ => Err(ModelError::Potential { key: key.into() }),
    }
}
