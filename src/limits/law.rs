//! The law whose limits are asked for.

use super::course::Course;
use super::error::LimitsError;
use crate::law::{Motion, Term};

/// A law with numbers, and which of them are sought.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    terms: Vec<Term>,
    coefficients: Vec<f64>,
    sought: Vec<usize>,
}

impl Law {
    /// A law of terms with their coefficients; `sought` are the positions of those that are to be estimated, the others
    /// are known.
    ///
    /// # Errors
    /// [`LimitsError`] for a term that is no function of (q, q̇, F) at one instant, and for a coefficient that is no
    /// number.
    pub fn new(pairs: &[(Term, f64)], sought: &[usize]) -> Result<Law, LimitsError> {
        for (term, value) in pairs {
            if !term.is_pointwise() {
                return Err(LimitsError::NotPointwise { term: term.name() });
            }
            if !value.is_finite() {
                return Err(LimitsError::Coefficient { term: term.name(), value: *value });
            }
        }
        let (terms, coefficients) = pairs.iter().copied().unzip();
        Ok(Law { terms, coefficients, sought: sought.to_vec() })
    }

    /// The same law with these coefficients; a term that it does not have joins it, known.
    ///
    /// # Errors
    /// As [`Law::new`].
    pub fn changed(&self, changes: &[(Term, f64)]) -> Result<Law, LimitsError> {
        let mut pairs: Vec<(Term, f64)> = self.terms.iter().copied().zip(self.coefficients.iter().copied()).collect();
        for (term, value) in changes {
            match pairs.iter_mut().find(|(own, _)| own == term) {
                Some((_, own)) => *own = *value,
                None => pairs.push((*term, *value)),
            }
        }
        Law::new(&pairs, &self.sought)
    }

    /// The terms.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Their coefficients.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Positions of the coefficients that are sought.
    pub fn sought(&self) -> &[usize] {
        &self.sought
    }

    /// Checks that the law can move along a course.
    ///
    /// # Errors
    /// [`LimitsError::NoInertia`] where the mass is not positive.
    pub fn check(&self, courses: &[Course]) -> Result<(), LimitsError> {
        let motion = self.motion();
        let states = courses.iter().flat_map(|course| &course.states);
        let massless =
            states.map(|state| (motion.mass(state.q), state.q)).find(|(mass, _)| mass.is_nan() || *mass <= 0.0);
        massless.map_or(Ok(()), |(mass, q)| Err(LimitsError::NoInertia { mass, q }))
    }

    pub(super) fn motion(&self) -> Motion<'_> {
        Motion::new(&self.terms, &self.coefficients)
    }
}
