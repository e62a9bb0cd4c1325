//! Effects added to a law until nothing is missing that the catalogue has.

use super::diagnosis::{Diagnosis, Evidence, Finding, best_of_form, diagnose, diagnose_model};
use super::errors::Windows;
use super::fit::{Fit, refit};
use super::judge::Trial;
use super::massless::massless;
use super::search::search;
use super::variants::same_effect;
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
    /// Effects that the recordings cannot tell apart, the one that was added first.
    pub ties: Vec<Vec<String>>,
    /// Held-out error of the law.
    pub error: f64,
    /// The law.
    pub fit: Fit,
}

impl Step {
    fn of(fit: Fit, effect: Option<String>, evidence: &Evidence) -> Step {
        Step { effect, removed: Vec::new(), ties: Vec::new(), error: error(&fit, evidence), fit }
    }
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
    let mut last = diagnose_model(model, evidence)?;
    let first = last.base.clone();
    let original = first.form.terms.clone();
    let mut steps = vec![Step::of(first, None, evidence)];
    loop {
        let law = &steps[steps.len() - 1].fit;
        let (Finding::Missing, Some(found), true) = (last.finding, &last.improved, steps.len() <= STEPS) else {
            return Some(Improvement { steps, last });
        };
        steps.extend(one_by_one(law, found, &last, evidence));
        let (fit, removed) = without_superfluous(found.fit.clone(), &original, found.count, evidence);
        let effect = last.beside.last().or(last.effect.as_ref()).cloned();
        let ties = std::mem::take(&mut last.indistinguishable);
        last = diagnose(&fit, evidence);
        steps.push(Step { removed, ties, ..Step::of(fit, effect, evidence) });
    }
}

/// The steps to several effects before the last of them, the weightiest first.
fn one_by_one(law: &Fit, found: &Trial, last: &Diagnosis, evidence: &Evidence) -> Vec<Step> {
    let mut reached = law.clone();
    let mut steps = Vec::new();
    for candidate in last.candidates.iter().take(found.count - 1) {
        let coefficients: Vec<f64> = reached.coefficients.iter().copied().chain([candidate.coefficient]).collect();
        let Some(fit) = refit(&reached.form.with(candidate.term), &evidence.pieces, &coefficients, law.noise) else {
            break;
        };
        steps.push(Step::of(fit.clone(), Some(candidate.effect.clone()), evidence));
        reached = fit;
    }
    steps
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
    if let Some(Diagnosis { base, improved: Some(trial), .. }) =
        massless(model, evidence).filter(|_| effect == Term::Inertia)
    {
        let [error_before, error_after] = [&base, &trial.fit].map(|fit| error(fit, evidence));
        return Some(Addition { before: base, after: trial.fit, error_before, error_after });
    }
    let before = best_of_form(model, evidence)?;
    let trial = search(&before, &evidence.pieces, &[effect]).singles().into_iter().next()?;
    let [error_before, error_after] = [&before, &trial.fit].map(|fit| error(fit, evidence));
    Some(Addition { before, after: trial.fit, error_before, error_after })
}

/// Held-out error of a fitted law.
pub fn error(fit: &Fit, evidence: &Evidence) -> f64 {
    let terms = fit.form.terms.clone();
    let own = terms.len();
    Windows::new(&evidence.recordings, terms, own, &fit.form.expressions).error(fit, &evidence.pieces).0
}

/// The fit without effects that were added before the `newest` ones and are not worth ln N now, and their names.
///
/// Whether one may be is told by its std; whether it is, by the likelihood without it: beside a delay that is fitted too, a coefficient that
/// the law needs has a large std.
fn without_superfluous(mut fit: Fit, original: &[Term], newest: usize, evidence: &Evidence) -> (Fit, Vec<String>) {
    let mut removed = Vec::new();
    let price = fit.measurements.max(2.0).ln();
    let own = |term: &Term| original.iter().any(|other| same_effect(*term, *other));
    loop {
        let earlier = 0..fit.form.terms.len() - newest;
        let weak = |index: &usize| fit.coefficients[*index].abs() < (4.0 * price).sqrt() * fit.std(*index);
        let smaller = earlier.filter(|index| !own(&fit.form.terms[*index])).filter(weak).find_map(|index| {
            let mut coefficients = fit.coefficients.clone();
            coefficients.remove(index);
            let smaller = refit(&fit.form.without(index), &evidence.pieces, &coefficients, fit.noise)?;
            (fit.log_likelihood - smaller.log_likelihood < price).then_some((index, smaller))
        });
        let Some((index, smaller)) = smaller else { return (fit, removed) };
        removed.push(fit.form.effect_name(fit.form.terms[index]));
        fit = smaller;
    }
}

/// The model with a fitted law's numbers: its own terms under the names that the user wrote, then what was added.
pub fn improved_model(model: &Model, fit: &Fit) -> Model {
    let key = |term: Term| {
        let own = model.terms.iter().find(|entry| entry.term == term).map(|entry| entry.key.clone());
        own.unwrap_or_else(|| fit.form.effect_name(term))
    };
    let pairs = fit.form.terms.iter().zip(&fit.coefficients);
    let terms = pairs.map(|(term, value)| {
        let key = key(*term);
        let open = vec![false; model.inner_names(*term).len()];
        ModelTerm { key, open, ..ModelTerm::new(*term, Given::Known(*value)) }
    });
    let expressions = fit.form.expressions.clone();
    Model { terms: terms.collect(), expressions, ..model.clone() }
}
