//! Laws whose coefficients are products of named parameters: `q/C`, `−α a q̇`.
//!
//! Plants speak the language of their drawing (mass, capacitance), laws that of their terms. A [`ParametricLaw`] is
//! read from TOML, the form in which a plant FMU carries its law:
//!
//! ```toml
//! name = "VanDerPol"
//! description = "…"
//! amplitude = 1.2                # of the sine excitation, in every stage unless set
//! omega = 1.1
//! [parameters]
//! C = { start = 1.0, description = "Capacitance" }
//! [terms]
//! q = "1/C"                      # a product: numbers and parameters, * and /, one leading minus
//! [effects.tip_drag]             # an effect of the user's own, hidden in the plant
//! expression = "abs(qd/v)^0.5*qd"
//! v = 0.1
//! ```

use crate::law::{Expression, Model, ModelError, Term, TermError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A parameter of a law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawParameter {
    /// Its name: letters, digits, underscores.
    pub name: String,
    /// Its value unless set.
    pub start: f64,
    /// What it is.
    pub description: String,
}

/// factor · Π parameterᵖᵒʷᵉʳ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Product {
    factor: f64,
    powers: Vec<(usize, i8)>,
}

/// A law with named parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParametricLaw {
    /// A name for it.
    pub name: String,
    /// One sentence, with the equation.
    pub description: String,
    /// Amplitude of the sine excitation unless set.
    pub amplitude: f64,
    /// Angular frequency of the sine excitation unless set, rad/s.
    pub omega: f64,
    /// Its parameters, in the order of the file.
    pub parameters: Vec<LawParameter>,
    /// The user's own effects, which act in every stage with a coefficient of the plant's.
    pub effects: Vec<Expression>,
    terms: Vec<(Term, Product)>,
}

/// Why a law is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ParametricLawError {
    /// The text is no TOML, or a key is missing or of the wrong type.
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
    /// A parameter's name cannot stand in a product.
    #[error("[parameters]: \"{name}\" is no name: a letter, then letters, digits and underscores")]
    Name {
        /// The name.
        name: String,
    },
    /// A user's own effect is refused.
    #[error(transparent)]
    Effect(Box<ModelError>),
    /// A factor is neither a number nor a parameter.
    #[error("[terms]: \"{factor}\" in \"{formula}\" is neither a finite number nor one of the parameters {known}")]
    Factor {
        /// The factor.
        factor: String,
        /// Where it stands.
        formula: String,
        /// The parameters there are.
        known: String,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    description: String,
    amplitude: f64,
    omega: f64,
    parameters: toml::Table,
    #[serde(default)]
    effects: toml::Table,
    terms: toml::Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParameterFile {
    start: f64,
    description: String,
}

impl ParametricLaw {
    /// Reads a law file.
    ///
    /// # Errors
    /// [`ParametricLawError`] names the key at fault.
    pub fn from_toml(text: &str) -> Result<ParametricLaw, ParametricLawError> {
        let file: File = toml::from_str(text).map_err(syntax)?;
        let parameters = file.parameters.into_iter().map(read_parameter).collect::<Result<Vec<_>, _>>()?;
        let read_term = |(key, formula): (&String, &toml::Value)| {
            let term = Term::parse(key).map_err(|source| ParametricLawError::Term { source })?;
            let formula = formula.as_str().map_or_else(|| formula.to_string(), Into::into);
            Ok((term, read_product(&formula, &parameters)?))
        };
        let terms = file.terms.iter().map(read_term).collect::<Result<Vec<_>, ParametricLawError>>()?;
        let read = Model::read_terms(&toml::Table::new(), &file.effects);
        let (_, effects) = read.map_err(|source| ParametricLawError::Effect(Box::new(source)))?;
        let (name, description) = (file.name, file.description);
        Ok(ParametricLaw {
            name,
            description,
            amplitude: file.amplitude,
            omega: file.omega,
            parameters,
            effects,
            terms,
        })
    }

    /// The terms, in the order of the file.
    pub fn terms(&self) -> Vec<Term> {
        self.terms.iter().map(|(term, _)| *term).collect()
    }

    /// The coefficients of the terms for these values of the parameters, in their orders.
    pub fn coefficients(&self, parameters: &[f64]) -> Vec<f64> {
        self.terms.iter().map(|(_, product)| product.value(parameters)).collect()
    }

    /// Names of the parameters on which the coefficient of a term depends.
    pub fn depends_on(&self, term: Term) -> impl Iterator<Item = &str> {
        let powers = self.terms.iter().filter(move |(own, _)| *own == term).flat_map(|(_, product)| &product.powers);
        powers.map(|(index, _)| self.parameters[*index].name.as_str())
    }
}

impl Product {
    fn value(&self, parameters: &[f64]) -> f64 {
        let powers = self.powers.iter().map(|(index, power)| (parameters[*index], *power));
        powers.fold(self.factor, |value, (base, power)| if power > 0 { value * base } else { value / base })
    }
}

fn syntax(error: toml::de::Error) -> ParametricLawError {
    ParametricLawError::Syntax { message: error.to_string() }
}

fn read_parameter((name, value): (String, toml::Value)) -> Result<LawParameter, ParametricLawError> {
    let legal = name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    if !legal || !name.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
        return Err(ParametricLawError::Name { name });
    }
    let ParameterFile { start, description } = value.try_into().map_err(syntax)?;
    Ok(LawParameter { name, start, description })
}

fn read_product(formula: &str, parameters: &[LawParameter]) -> Result<Product, ParametricLawError> {
    let (sign, rest) = match formula.trim().strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, formula),
    };
    let mut product = Product { factor: sign, powers: Vec::new() };
    let mut start = 0;
    for end in rest.match_indices(['*', '/']).map(|(end, _)| end).chain([rest.len()]) {
        let power = if start > 0 && rest[..start].ends_with('/') { -1 } else { 1 };
        let factor = rest[start..end].trim();
        if let Some(index) = parameters.iter().position(|parameter| parameter.name == factor) {
            product.powers.push((index, power));
        } else {
            let number =
                factor.parse::<f64>().ok().filter(|number| number.is_finite() && (power > 0 || *number != 0.0));
            let number = number.ok_or_else(|| unknown_factor(factor, formula, parameters))?;
            product.factor *= if power > 0 { number } else { number.recip() };
        }
        start = end + 1;
    }
    Ok(product)
}

fn unknown_factor(factor: &str, formula: &str, parameters: &[LawParameter]) -> ParametricLawError {
    let known = parameters.iter().map(|parameter| parameter.name.as_str()).collect::<Vec<_>>().join(", ");
    ParametricLawError::Factor { factor: factor.into(), formula: formula.into(), known }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(terms: &str) -> Result<ParametricLaw, ParametricLawError> {
        ParametricLaw::from_toml(&format!(
            "name = \"x\"\ndescription = \"x\"\namplitude = 1.0\nomega = 1.0\n[parameters]\n\
             b = {{ start = 1.0, description = \"b\" }}\na = {{ start = 2.0, description = \"a\" }}\n[terms]\n{terms}"
        ))
    }

    #[test]
    fn coefficients_are_products_of_parameters() {
        let law = law("qdd = \"a\"\nqd = \"-a*b\"\nq = \"3/b\"\n\"q^3\" = \" 0.5 * a / b / b \"\n1 = \"-2\"").unwrap();
        assert_eq!(law.parameters[0].name, "b");
        assert_eq!(law.coefficients(&[4.0, 10.0]), [10.0, -40.0, 0.75, 0.3125, -2.0]);
        assert_eq!(law.depends_on(Term::power(0, 1)).collect::<Vec<_>>(), ["a", "b"]);
    }

    #[test]
    fn a_law_carries_effects_of_the_users_own() {
        let law = law("qdd = \"a\"\n[effects.drag]\nexpression = \"abs(qd/v)*qd\"\nv = 0.1").unwrap();
        assert_eq!((law.effects[0].name(), law.effects[0].values()), ("drag", &[0.1][..]));
    }

    #[test]
    fn what_is_no_product_is_refused_by_name() {
        for (terms, named) in [
            ("qdd = \"a*d\"", "\"d\" in \"a*d\""),
            ("qdd = \"a/0\"", "\"0\""),
            ("qdd = \"a*\"", "\"\""),
            ("qdd = \"\"", "\"\""),
            ("qqq = \"a\"", "qqq"),
            ("qdd = \"a\"\n[effects.drag]\nexpression = \"qd*\"", "[effects.drag]"),
        ] {
            let error = law(terms).unwrap_err().to_string();
            assert!(error.contains(named), "{terms}: {error}");
        }
    }
}
