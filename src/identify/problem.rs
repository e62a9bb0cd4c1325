//! What is sought: the model's terms, split into known and free coefficients.

use super::settings::{Channels, Settings};
use super::timing::Timing;
use crate::law::{Effect, Expression, Given, Model, Motion, Term};
use crate::weak::Row;
use serde::{Deserialize, Serialize};

/// The identification problem, fixed at construction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Problem {
    /// All terms of the model.
    pub terms: Vec<Term>,
    /// The user's own effects that they name.
    pub own: Vec<Expression>,
    /// Positions of the free terms among `terms`.
    pub free: Vec<usize>,
    /// The free terms themselves.
    pub free_terms: Vec<Term>,
    /// Which free terms evidence may drop.
    pub maybe: Vec<bool>,
    /// Coefficients where known, 0 elsewhere; one for each of `terms`, then that of the effect that the model lacks.
    pub known: Vec<f64>,
    /// Position of the inertia among `terms`.
    pub inertia: usize,
    /// Which quantities are measured.
    pub channels: Channels,
    /// When the excitation acts.
    pub timing: Timing,
}

impl Problem {
    /// Splits the model's terms. Without an excitation the inertia is fixed to 1, or to its known value.
    pub fn new(model: &Model, settings: &Settings) -> Problem {
        let channels = settings.channels;
        let given = |term: Term, given: Given| match (term, given) {
            (Term::Inertia, Given::Fit | Given::Maybe) if !channels.excitation => Given::Known(1.0),
            (Term::Inertia, Given::Maybe) => Given::Fit,
            _ => given,
        };
        let entries: Vec<(Term, Given)> =
            model.terms.iter().map(|entry| (entry.term, given(entry.term, entry.given))).collect();
        let free: Vec<usize> = (0..entries.len()).filter(|index| entries[*index].1.is_free()).collect();
        let known = |(_, given): &(Term, Given)| if let Given::Known(value) = given { *value } else { 0.0 };
        Problem {
            terms: entries.iter().map(|(term, _)| *term).collect(),
            own: model.expressions.clone(),
            free_terms: free.iter().map(|index| entries[*index].0).collect(),
            maybe: free.iter().map(|index| entries[*index].1 == Given::Maybe).collect(),
            known: entries.iter().map(known).chain([0.0]).collect(),
            inertia: model.position(Term::Inertia).unwrap_or(0),
            free,
            channels,
            timing: Timing::new(settings.hold),
        }
    }

    /// The law of these terms with these coefficients.
    pub fn motion<'a>(&'a self, terms: &'a [Term], coefficients: &'a [f64]) -> Motion<'a> {
        Motion::new(terms, coefficients).with(&self.own)
    }

    /// The model's terms and a place for an effect that it lacks: its coefficient is 0 but where a record asks for it.
    pub fn terms_and_effect(&self) -> Vec<Term> {
        self.terms.iter().copied().chain([Term::Effect(Effect::CoulombFriction)]).collect()
    }

    /// Number of free coefficients.
    pub fn n(&self) -> usize {
        self.free.len()
    }

    /// Whether F is what the law gives: no term multiplies q̈.
    pub fn is_force_law(&self) -> bool {
        self.terms.iter().all(|term| !term.is_inertial())
    }

    /// Position of the inertia among the free coefficients, where it is one.
    pub fn free_inertia(&self) -> Option<usize> {
        self.free.iter().position(|index| *index == self.inertia)
    }

    /// The weak equation in the free coefficients: writes its left side, returns its right side.
    pub fn weak_equation(&self, row: &Row, left: &mut [f64]) -> f64 {
        for (entry, index) in left.iter_mut().zip(&self.free) {
            *entry = row.terms[*index];
        }
        let known: f64 = row.terms.iter().zip(&self.known).map(|(integral, value)| integral * value).sum();
        row.excitation - known
    }

    /// The names of free terms that no data so far tell apart: `qdd and q together`.
    pub fn together(&self, free: &[usize]) -> String {
        let mut names: Vec<String> = free.iter().map(|index| self.free_terms[*index].name()).collect();
        match names.pop() {
            Some(last) if names.is_empty() => last,
            Some(last) => format!("{} and {last} together", names.join(", ")),
            None => String::new(),
        }
    }

    /// Writes free coefficients into all of them.
    pub fn scatter(&self, free: &[f64], all: &mut [f64]) {
        for (value, index) in free.iter().zip(&self.free) {
            all[*index] = *value;
        }
    }
}
