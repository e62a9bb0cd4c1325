//! A law with numbers, as it is printed and written.

use crate::diagnose::judge::{Equation, Estimate, Record, Target, Timing};
use crate::law::{Expression, Term};

/// A law's coefficients with their std.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// Its terms.
    pub terms: Vec<Term>,
    /// One coefficient for each.
    pub coefficients: Vec<f64>,
    /// Their std; 0 where held.
    pub std: Vec<f64>,
    /// Terms whose coefficients by least squares are biased by noise in the readings: these are those with even and odd
    /// readings as instruments.
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
}
