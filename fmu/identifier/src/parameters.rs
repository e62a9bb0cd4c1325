//! From the FMU's parameters to a model and settings.

use serde::{Deserialize, Serialize};
use switchid::identify::{Method, Parameter, Settings};
use switchid::law::{Hold, Model, ModelError, Term, TermError};
use switchid_fmu_slave::{Description, ValueError, Values};
use thiserror::Error;

/// Why `terms` is refused.
#[derive(Debug, Error)]
pub enum TermsError {
    /// Not a term at all.
    #[error("parameter terms: {0}")]
    Text(#[from] TermError),
    /// A term for which this FMU has no outputs.
    #[error(
        "parameter terms: this FMU has no output coef.{}; choose among {known}, or package an FMU for your model with \
         switchid fmu --model", term.fmu_name()
    )]
    NoOutput {
        /// The term.
        term: Term,
        /// Those it may be.
        known: String,
    },
    /// Terms that make no model.
    #[error("parameter terms: {0}")]
    Model(#[from] ModelError),
}

/// The value references of the parameters.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Parameters {
    terms: usize,
    method: usize,
    hold: usize,
    numbers: Vec<usize>,
}

impl Parameters {
    /// Finds every parameter among the variables.
    ///
    /// # Errors
    /// [`ValueError::NoSuchName`] when one is missing.
    pub fn find(description: &Description) -> Result<Parameters, ValueError> {
        let numbers = Parameter::ALL.iter().map(|parameter| position(description, parameter.name));
        Ok(Parameters {
            terms: position(description, "terms")?,
            method: position(description, "method")?,
            hold: position(description, "hold")?,
            numbers: numbers.collect::<Result<_, _>>()?,
        })
    }

    /// The settings that the parameters ask for; not checked yet.
    pub fn settings(&self, values: &Values) -> Settings {
        let mut settings = Settings {
            method: pick(&Method::ALL, values.integer(self.method)),
            hold: pick(&Hold::ALL, values.integer(self.hold)),
            ..Settings::default()
        };
        for (parameter, reference) in Parameter::ALL.iter().zip(&self.numbers) {
            parameter.set(&mut settings, values.real(*reference));
        }
        settings
    }

    /// The model with the terms that the user named, or all of it.
    ///
    /// # Errors
    /// [`TermsError`].
    pub fn model(&self, library: &Model, values: &Values) -> Result<Model, TermsError> {
        let names: Vec<&str> = values.text(self.terms).split_whitespace().collect();
        if names.is_empty() {
            return Ok(library.clone());
        }
        for name in &names {
            let term = Term::parse(name)?;
            if library.position(term).is_none() {
                let known: Vec<String> = library.terms.iter().map(|entry| entry.term.name()).collect();
                return Err(TermsError::NoOutput { term, known: known.join(" ") });
            }
        }
        let model = library.with_terms(names)?;
        if !library.is_force_law() {
            // the outputs of this FMU are those of a law of motion
            model.check_inertia()?;
        }
        Ok(model)
    }
}

/// The item of that number, counted from 1; the slave has checked the range.
fn pick<T: Copy>(items: &[T], number: i32) -> T {
    usize::try_from(number - 1).ok().and_then(|index| items.get(index)).copied().unwrap_or(items[0])
}

/// Where the variable of that name stands.
///
/// # Errors
/// [`ValueError::NoSuchName`].
pub fn position(description: &Description, name: &str) -> Result<usize, ValueError> {
    description.position(name).ok_or_else(|| ValueError::NoSuchName { name: name.into() })
}
