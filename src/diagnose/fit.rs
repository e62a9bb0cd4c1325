//! The best coefficients that a form of law can have, over any number of pieces.
//!
//! The prediction-error method of the streaming identifier, with the whole record at hand: Gauss–Newton steps on the innovations'
//! likelihood, sensor noise from the innovations, process noise from two rival filters, from much of it down to what the data want.
//! Terms that no state gives (memory, delay, expressions of time) are series along the smoothed motion, renewed with it.

use super::descent::Descent;
use super::diagnosis::effect_name;
use super::means::is_series;
use super::piece::Piece;
use super::run::Sums;
use super::start;
use crate::evidence::{Noise, Pass};
use crate::law::{Expression, State, Term};
use nalgebra::{DMatrix, DVector};

/// Guesses from which a fit begins, at most.
const STARTS: usize = 4;

/// Factor by which the inertia has grown in a fit that forgets its excitation.
const FORGETFUL: f64 = 30.0;

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
    /// Covariance of what is sought: coefficients in the order of the terms, terms that the state gives first, then logarithms of inner
    /// parameters.
    pub covariance: DMatrix<f64>,
    /// Noise levels: the sensors', and the white acceleration that the law leaves unexplained.
    pub noise: Noise,
    /// Log-likelihood of all pieces.
    pub log_likelihood: f64,
    /// The same with all error in the sensors: as if the law were right.
    pub log_likelihood_if_right: f64,
    /// Number of scalar measurements.
    pub measurements: f64,
    /// What each stretch of the record says, under variances that its innovations have; coefficients before all else.
    pub by_stretch: Vec<Sums>,
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

    /// The effect id of a term; the user's name of an expression.
    pub fn effect_name(&self, term: Term) -> String {
        if matches!(term, Term::Expression(_)) { self.term_name(term) } else { effect_name(term) }
    }

    /// The canonical name of a term; the user's name of an expression.
    pub fn term_name(&self, term: Term) -> String {
        match term {
            Term::Expression(index) => {
                self.expressions.get(usize::from(index)).map_or_else(|| term.name(), |own| own.name().into())
            }
            _ => term.name(),
        }
    }

    pub(super) fn inertia(&self) -> Option<usize> {
        self.terms.iter().position(|term| *term == Term::Inertia)
    }
}

impl Fit {
    /// By how much the record speaks for an error of the law, nats: what the likelihood gains from a white acceleration that the law does
    /// not have.
    pub fn lack(&self) -> f64 {
        (self.log_likelihood - self.log_likelihood_if_right).max(0.0)
    }

    /// Number of coefficients that are sought.
    pub(super) fn unknowns(&self) -> usize {
        Parts::of(&self.form).unknowns.len()
    }

    /// Std of the coefficient of that position; 0 where it is held.
    pub fn std(&self, index: usize) -> f64 {
        let unknowns = Parts::of(&self.form).unknowns;
        let row = unknowns.iter().position(|unknown| *unknown == index);
        row.map_or(0.0, |row| self.covariance[(row, row)].max(0.0).sqrt())
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

/// Fits the form to the pieces; none where nothing can be made of them: no motion, or coefficients that no row determines.
///
/// The likelihood has another maximum where the inertia grows without bounds: the excitation is forgotten, and process noise drives the
/// motion. A descent that runs there begins again from the next guess.
pub fn fit(form: &Form, pieces: &[Piece]) -> Option<Fit> {
    let mut best: Option<Fit> = None;
    for begin in start::starts(form, pieces).into_iter().take(STARTS) {
        let Some(fitted) = refit(form, pieces, &begin.coefficients, begin.noise) else { continue };
        let kept = form.inertia().is_none_or(|index| {
            let ratio = fitted.coefficients[index] / begin.coefficients[index];
            (0.0..FORGETFUL).contains(&ratio) && begin.coefficients[index] > 0.0
        });
        if best.as_ref().is_none_or(|best| fitted.log_likelihood > best.log_likelihood) {
            best = Some(fitted);
        }
        if kept {
            break;
        }
    }
    best
}

/// Fits the form from coefficients and noise that are near already. The likelihood may have two maxima, one that leaves error to the law
/// and one that leaves it all to the sensors: both are tried.
pub fn refit(form: &Form, pieces: &[Piece], coefficients: &[f64], noise: Noise) -> Option<Fit> {
    let mut descent = Descent::new(form, pieces, coefficients, noise)?;
    let mut pass = descent.pass();
    descent.renew_series(&mut pass);
    best_of(descent, pass)
}

/// The better of the maxima that a descent comes to: with error of the law, and with all error in the sensors.
pub(super) fn best_of(mut descent: Descent, mut pass: Pass) -> Option<Fit> {
    let mut loud = descent.descend(&mut pass)?;
    if loud.noise.process <= start::negligible(&loud.noise) {
        loud.log_likelihood_if_right = loud.log_likelihood;
        return Some(loud);
    }
    loud.log_likelihood_if_right = descent.quieten(&mut pass, loud.log_likelihood);
    if loud.log_likelihood_if_right <= loud.log_likelihood {
        return Some(loud);
    }
    let quiet = descent.descend(&mut pass).filter(|quiet| quiet.log_likelihood > loud.log_likelihood);
    let quiet = quiet.map(|quiet| Fit { log_likelihood_if_right: loud.log_likelihood_if_right, ..quiet });
    Some(quiet.unwrap_or(loud))
}

/// A step and the covariance behind it.
pub(super) struct Solved {
    pub(super) step: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
}

/// Solves information · step = score, columns scaled to unit diagonal, by pseudo-inverse. None where a run left no numbers: the singular
/// value decomposition of those would not end.
pub(super) fn solve(information: &DMatrix<f64>, score: &DVector<f64>) -> Option<Solved> {
    solve_damped(information, score, 0.0)
}

/// The same with that part of each diagonal added to it; the covariance is that of the solution without.
pub(super) fn solve_damped(information: &DMatrix<f64>, score: &DVector<f64>, damping: f64) -> Option<Solved> {
    let n = score.len();
    if !information.iter().chain(score.iter()).all(|value| value.is_finite()) {
        return None;
    }
    if n == 0 {
        return Some(Solved { step: DVector::zeros(0), covariance: DMatrix::zeros(0, 0) });
    }
    let scale = DVector::from_fn(n, |row, _| {
        let diagonal = information[(row, row)];
        if diagonal > 0.0 { diagonal.sqrt().recip() } else { 0.0 }
    });
    let scaled = DMatrix::from_fn(n, n, |row, column| information[(row, column)] * scale[row] * scale[column]);
    let unscaled = |inverse: &DMatrix<f64>| {
        DMatrix::from_fn(n, n, |row, column| inverse[(row, column)] * scale[row] * scale[column])
    };
    let covariance = unscaled(&scaled.clone().pseudo_inverse(1e-12).ok()?);
    let step = match damping {
        0.0 => &covariance * score,
        _ => unscaled(&(scaled + DMatrix::identity(n, n) * damping).pseudo_inverse(1e-12).ok()?) * score,
    };
    step.iter().all(|value| value.is_finite()).then_some(Solved { step, covariance })
}
