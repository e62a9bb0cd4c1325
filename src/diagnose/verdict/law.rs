//! A law with numbers, as it is printed and written.

use crate::diagnose::judge::{Equation, Estimate, Record, Target, Timing};
use crate::law::{Catalogue, Expression, Term};

/// A law's coefficients with their std.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// Its terms.
    pub terms: Vec<Term>,
    /// One coefficient for each.
    pub coefficients: Vec<f64>,
    /// Their std; 0 where held.
    pub std: Vec<f64>,
    /// Terms whose coefficients by least squares are biased by noise in the readings: these are those with even and odd readings as
    /// instruments.
    pub biased: Vec<Term>,
    /// What [`Term::Expression`] names.
    pub expressions: Vec<Expression>,
    /// When the recorded excitation acted.
    pub timing: Timing,
    /// How much later than recorded it acted, s, and std: sensor or drive. None without an excitation.
    pub delay: Option<[f64; 2]>,
    /// Which column its equations were solved for.
    pub target: Target,
}

impl Law {
    pub(in crate::diagnose) fn of(record: &Record, equation: &Equation, estimate: &Estimate) -> Law {
        let delayed = |[step, std]: [f64; 2]| [equation.timing.delay + step, std];
        Law {
            terms: equation.terms.clone(),
            coefficients: estimate.coefficients.clone(),
            std: estimate.std.clone(),
            biased: Vec::new(),
            expressions: record.expressions.clone(),
            timing: equation.timing,
            delay: estimate.delay.map(delayed),
            target: equation.target,
        }
    }

    /// The effect id of a term; the user's name of an expression.
    pub fn effect_name(&self, term: Term) -> String {
        effect_name(term, &self.expressions)
    }

    /// The canonical name of a term; the user's name of an expression.
    pub fn term_name(&self, term: Term) -> String {
        own_name(term, &self.expressions).unwrap_or_else(|| term.name())
    }
}

/// The effect id of a term; of an expression the name that the user gave it.
pub(super) fn effect_name(term: Term, expressions: &[Expression]) -> String {
    let id = || Catalogue::of(term).map_or_else(|| term.name(), |entry| entry.id.into());
    own_name(term, expressions).unwrap_or_else(id)
}

fn own_name(term: Term, expressions: &[Expression]) -> Option<String> {
    match term {
        Term::Expression(index) => expressions.get(usize::from(index)).map(|own| own.name().into()),
        _ => None,
    }
}
