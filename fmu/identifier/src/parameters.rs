//! From the FMU's parameters to a model and settings.

use serde::{Deserialize, Serialize};
use switchid::identify::{Method, Parameter, Settings};
use switchid::law::{Hold, Model, ModelError, ModelTerm, NamedLaw, Term, TermError};
use switchid_fmu_slave::{Description, ValueError, Values};
use thiserror::Error;

/// Why the choice of terms is refused.
#[derive(Debug, Error)]
pub enum TermsError {
    /// Not a term at all.
    #[error("parameter terms: {source}; choose among {known}")]
    Text {
        /// Why it is none.
        source: TermError,
        /// Those it may be.
        known: String,
    },
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
    /// A term that stands there twice.
    #[error("parameter terms: {first:?} and {second:?} are the same term: leave one of them out")]
    Twice {
        /// As written first.
        first: String,
        /// As written then.
        second: String,
    },
    /// A law of motion without inertia.
    #[error("parameter terms: there is no inertia among them, which a law of motion needs: add qdd")]
    NoInertia,
    /// Both parameters choose.
    #[error("parameters terms and model both choose the terms: leave terms empty, or model at {AS_PACKAGED}")]
    Both,
    /// Terms that make no model.
    #[error("parameter terms: {0}")]
    Model(#[from] ModelError),
}

/// The item of the parameter `model` that leaves the choice to the package.
const AS_PACKAGED: &str = "as_packaged";

/// The value references of the parameters.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Parameters {
    terms: usize,
    model: usize,
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
            model: position(description, "model")?,
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

    /// The model with the terms that the user named or chose, or all of it.
    ///
    /// # Errors
    /// [`TermsError`].
    pub fn model(&self, library: &Model, values: &Values) -> Result<Model, TermsError> {
        let separates = |letter: char| letter.is_whitespace() || matches!(letter, ',' | ';');
        let words = || values.text(self.terms).split(separates).filter(|word| !word.is_empty());
        let chosen = values.integer(self.model);
        match (chosen, words().next()) {
            (2.., Some(_)) => Err(TermsError::Both),
            (2.., None) => Ok(named(library, chosen)?),
            (_, None) => Ok(library.clone()),
            (_, Some(_)) => choose(library, words()),
        }
    }
}

/// The named law of that number, counted from 2.
fn named(library: &Model, number: i32) -> Result<Model, TermsError> {
    let terms: Vec<Term> = library.terms.iter().map(|entry| entry.term).collect();
    match NamedLaw::among(&terms).get(number as usize - 2) {
        Some(law) => Ok(library.with_terms(law.terms.iter().copied())?),
        None => Ok(library.clone()),
    }
}

/// The library with these of its terms, each by its name, an effect's id, or the name that its outputs have.
fn choose<'a>(library: &Model, words: impl Iterator<Item = &'a str>) -> Result<Model, TermsError> {
    let mut places: Vec<(usize, &str)> = Vec::new();
    for word in words {
        let place = find(library, word)?;
        if let Some((_, first)) = places.iter().find(|(known, _)| *known == place) {
            return Err(TermsError::Twice { first: (*first).into(), second: word.into() });
        }
        places.push((place, word));
    }
    let is_inertial = |(place, _): &(usize, &str)| library.terms[*place].term.is_inertial();
    if !library.is_force_law() && !places.iter().any(is_inertial) {
        // the outputs of this FMU are those of a law of motion
        return Err(TermsError::NoInertia);
    }
    let model = library.with_terms(places.iter().map(|(place, _)| library.terms[*place].key.as_str()))?;
    if !library.is_force_law() {
        model.check_inertia()?;
    }
    Ok(model)
}

/// Where the term stands in the library.
fn find(library: &Model, word: &str) -> Result<usize, TermsError> {
    let bare = word.strip_prefix("coef.").unwrap_or(word);
    let is_named = |entry: &ModelTerm| entry.key == bare || entry.term.fmu_name() == bare;
    if let Some(place) = library.terms.iter().position(is_named) {
        return Ok(place);
    }
    let known = || library.terms.iter().map(|entry| entry.term.name()).collect::<Vec<_>>().join(" ");
    let term = Term::parse(bare).map_err(|source| TermsError::Text { source, known: known() })?;
    library.position(term).ok_or_else(|| TermsError::NoOutput { term, known: known() })
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
