//! Effects added to a law until nothing is missing that the catalogue has.

use super::diagnosis::{Diagnosis, Evidence, Finding, best_of_form, diagnose, effect_name};
use super::errors::Windows;
use super::fit::{Fit, refit};
use super::search::search;
use crate::law::{Given, Model, ModelTerm, Term};

/// Most effects that are added.
const STEPS: usize = 6;

/// One step of the staircase.
#[derive(Clone, Debug)]
pub struct Step {
    /// The effect that was added; none for the model as it came.
    pub effect: Option<String>,
    /// Effects that it made superfluous, taken out again.
    pub removed: Vec<String>,
    /// Held-out error of the law.
    pub error: f64,
    /// The law.
    pub fit: Fit,
}

/// A law improved as far as the catalogue goes.
#[derive(Clone, Debug)]
pub struct Improvement {
    /// The steps, the model as it came first.
    pub steps: Vec<Step>,
    /// Diagnosis of the last law.
    pub last: Diagnosis,
}

/// Diagnoses and adds until the law is adequate, or what is left is not in the catalogue.
///
/// None where the record determines no law of the model's form.
pub fn improve(model: &Model, evidence: &Evidence) -> Option<Improvement> {
    let first = best_of_form(model, evidence)?;
    let original = first.form.terms.clone();
    let mut steps = vec![Step { effect: None, removed: Vec::new(), error: error(&first, evidence), fit: first }];
    loop {
        let law = &steps[steps.len() - 1].fit;
        let last = diagnose(law, evidence);
        let (Finding::Missing, Some(found), true) = (last.finding, &last.improved, steps.len() <= STEPS) else {
            return Some(Improvement { steps, last });
        };
        let (fit, removed) = without_superfluous(found.fit.clone(), &original, evidence);
        let effect = Some(effect_name(found.term));
        steps.push(Step { effect, removed, error: error(&fit, evidence), fit });
    }
}

/// An effect in the law: fitted with it, and its held-out errors before and after.
#[derive(Clone, Debug)]
pub struct Addition {
    /// The law without it.
    pub before: Fit,
    /// The law with it as its last term.
    pub after: Fit,
    /// Held-out error without it.
    pub error_before: f64,
    /// Held-out error with it.
    pub error_after: f64,
}

/// Adds an effect to a model, whatever its evidence. None where the record determines no law with it.
pub fn add(model: &Model, effect: Term, evidence: &Evidence) -> Option<Addition> {
    let before = best_of_form(model, evidence)?;
    let trial = search(&before, &evidence.pieces, &[effect]).trials.into_iter().next()?;
    let [error_before, error_after] = [&before, &trial.fit].map(|fit| error(fit, evidence));
    Some(Addition { before, after: trial.fit, error_before, error_after })
}

/// Held-out error of a fitted law.
pub fn error(fit: &Fit, evidence: &Evidence) -> f64 {
    let terms = fit.form.terms.clone();
    let own = terms.len();
    Windows::new(&evidence.recordings, terms, own, &fit.form.expressions).error(fit, &evidence.pieces).0
}

/// The fit without effects that were added earlier and are now worth less than ln N, and their names.
fn without_superfluous(mut fit: Fit, original: &[Term], evidence: &Evidence) -> (Fit, Vec<String>) {
    let mut removed = Vec::new();
    let price = (2.0 * fit.measurements.max(2.0).ln()).sqrt();
    loop {
        let newest = fit.form.terms.len() - 1;
        let weak = |index: &usize| {
            !original.contains(&fit.form.terms[*index]) && fit.coefficients[*index].abs() < price * fit.std(*index)
        };
        let Some(index) = (0..newest).find(weak) else { return (fit, removed) };
        let mut coefficients = fit.coefficients.clone();
        coefficients.remove(index);
        let Some(smaller) = refit(&fit.form.without(index), &evidence.pieces, &coefficients, fit.noise) else {
            return (fit, removed);
        };
        removed.push(effect_name(fit.form.terms[index]));
        fit = smaller;
    }
}

/// The model with a fitted law's numbers: its own terms under the names that the user wrote, then what was added.
pub fn improved_model(model: &Model, fit: &Fit) -> Model {
    let key = |term: Term| {
        let own = model.terms.iter().find(|entry| entry.term == term).map(|entry| entry.key.clone());
        own.unwrap_or_else(|| effect_name(term))
    };
    let pairs = fit.form.terms.iter().zip(&fit.coefficients);
    let terms = pairs.map(|(term, value)| {
        let key = key(*term);
        ModelTerm { key, ..ModelTerm::new(*term, Given::Known(*value)) }
    });
    Model { terms: terms.collect(), ..model.clone() }
}
