//! Models without inertia: whether the record shows one.
//!
//! Without inertia a law has no motion of its own to be followed, so that nothing can be tried beside it. The law with it is fitted, and the one
//! without stands as the weak rows give it.

use super::diagnosis::{Diagnosis, Evidence, Finding, LEVEL, best_of_form, listed};
use super::fit::Fit;
use super::judge::Trial;
use super::start;
use crate::law::{Given, Model, ModelTerm, Term};
use nalgebra::DMatrix;

/// The diagnosis of a model without inertia on a forced record that shows one; none otherwise.
pub(super) fn massless(model: &Model, evidence: &Evidence) -> Option<Diagnosis> {
    if !evidence.forced() || model.terms.iter().any(|entry| entry.term == Term::Inertia) {
        return None;
    }
    let mut whole = model.clone();
    whole.terms.push(ModelTerm::new(Term::Inertia, Given::Fit));
    let with = best_of_form(&whole, evidence)?;
    let base = without_inertia(&with, evidence)?;
    let gain = with.log_likelihood - base.log_likelihood;
    let trial = Trial { count: 1, gain, fit: with };
    let physical = trial.coefficient() > 0.0;
    if !physical || trial.p_value(1) >= LEVEL {
        return None;
    }
    let (candidates, window) = listed(&base, &trial, evidence);
    Some(Diagnosis {
        finding: Finding::Missing,
        effect: Some("inertia".into()),
        candidates,
        indistinguishable: Vec::new(),
        beside: Vec::new(),
        base,
        improved: Some(trial),
        tried: 1,
        explained: 1.0,
        window,
    })
}

/// The law without the inertia that it has as its last term. What the inertia is worth is told by its own std.
fn without_inertia(with: &Fit, evidence: &Evidence) -> Option<Fit> {
    let last = with.form.terms.len() - 1;
    let form = with.form.without(last);
    let coefficients = start::starts(&form, &evidence.pieces).into_iter().next()?.coefficients;
    let worth = 0.5 * (with.coefficients[last] / with.std(last)).powi(2);
    let covariance = DMatrix::zeros(form.terms.len(), form.terms.len());
    Some(Fit {
        form,
        coefficients,
        covariance,
        log_likelihood: with.log_likelihood - worth,
        log_likelihood_if_right: f64::NEG_INFINITY,
        ..with.clone()
    })
}
