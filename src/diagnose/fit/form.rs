//! A form of law, and what a fit of it is.

use super::means::is_series;
use crate::estimation::{Noise, Solution};
use crate::law::{Expression, State, Term};

/// A form of law: which terms it has, and what is known of each coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// The terms, inertia among them.
    pub terms: Vec<Term>,
    /// Their coefficients where held; `None` where sought.
    pub held: Vec<Option<f64>>,
    /// Which inner parameters of each are sought beside them.
    pub open: Vec<Vec<bool>>,
    /// What [`Term::Expression`] names.
    pub expressions: Vec<Expression>,
}

/// A form with its best coefficients.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The form.
    pub form: Form,
    /// One coefficient per term.
    pub coefficients: Vec<f64>,
    /// What the record says of all that is sought: coefficients in the order of the terms, terms that the state gives
    /// first, then logarithms of inner parameters, then beginnings.
    pub(super) solution: Solution,
    /// Noise levels: the sensors', and the white acceleration that the law leaves unexplained.
    pub noise: Noise,
    /// Log-likelihood of all pieces.
    pub log_likelihood: f64,
    /// The same with all error in the sensors: as if the law were right.
    pub log_likelihood_if_right: f64,
    /// Number of scalar measurements.
    pub measurements: f64,
    /// Smoothed states at every sample, one list per piece.
    pub states: Vec<Vec<State>>,
    /// How far from rest the memories of its effects began, piece by piece.
    pub beginnings: Vec<f64>,
}

impl Form {
    /// A form of these terms, inner parameters as they are; `held` says which coefficients are known.
    pub fn new(terms: Vec<Term>, held: Vec<Option<f64>>, expressions: Vec<Expression>) -> Form {
        Form { open: vec![Vec::new(); terms.len()], terms, held, expressions }
    }

    /// Positions of the terms that the state gives and whose coefficients are sought.
    pub(super) fn free(&self) -> Vec<usize> {
        let parts = Parts::of(self);
        parts.free.iter().map(|position| parts.of_state[*position]).collect()
    }

    /// The form with every coefficient sought; without excitation the inertia stays at what it is, or 1.
    pub fn freed(&self, forced: bool) -> Form {
        let held = self.terms.iter().zip(&self.held).map(|(term, held)| match term {
            Term::Inertia if !forced => Some(held.unwrap_or(1.0)),
            _ => None,
        });
        Form { held: held.collect(), ..self.clone() }
    }

    /// The form with one more term, sought with its inner parameters.
    pub fn with(&self, term: Term) -> Form {
        let mut form = self.clone();
        form.terms.push(term);
        form.held.push(None);
        form.open.push(vec![true; term.effect().map_or(0, |effect| effect.inner().len())]);
        form
    }

    /// The form without the term of that position.
    pub fn without(&self, index: usize) -> Form {
        let mut form = self.clone();
        form.terms.remove(index);
        form.held.remove(index);
        form.open.remove(index);
        form
    }

    pub(super) fn inertia(&self) -> Option<usize> {
        self.terms.iter().position(|term| *term == Term::Inertia)
    }
}

impl Fit {
    /// By how much the record speaks for an error of the law, nats: what the likelihood gains from a white acceleration
    /// that the law does not have.
    pub fn lack(&self) -> f64 {
        (self.log_likelihood - self.log_likelihood_if_right).max(0.0)
    }

    /// Std of the coefficient of that position; 0 where it is held, infinite where the record leaves it open.
    pub fn std(&self, index: usize) -> f64 {
        let unknowns = Parts::of(&self.form).unknowns;
        let row = unknowns.iter().position(|unknown| *unknown == index);
        row.map_or(0.0, |row| self.solution.std(row, 1.0))
    }
}

/// The terms of a form by the way they enter a run.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    /// Positions of the terms that the state gives.
    pub(super) of_state: Vec<usize>,
    /// Positions of the series.
    pub(super) series: Vec<usize>,
    /// Which of the former are sought, as positions among them.
    pub(super) free: Vec<usize>,
    /// Positions of all that is sought, in the order of a run's unknowns.
    pub(super) unknowns: Vec<usize>,
}

impl Parts {
    pub(super) fn of(form: &Form) -> Parts {
        let (series, of_state): (Vec<usize>, Vec<usize>) =
            (0..form.terms.len()).partition(|index| is_series(form.terms[*index]));
        let sought = |index: &usize| form.held[*index].is_none();
        let free: Vec<usize> = (0..of_state.len()).filter(|position| sought(&of_state[*position])).collect();
        let unknowns = free.iter().map(|position| of_state[*position]).chain(series.iter().copied()).collect();
        Parts { of_state, series, free, unknowns }
    }
}
