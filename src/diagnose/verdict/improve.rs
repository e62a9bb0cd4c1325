//! Effects added to a law until nothing is missing that the catalogue has.

use super::case::{Case, Standing};
use super::diagnosis::{Diagnosis, Finding, diagnose};
use super::errors::{TIE, WindowError};
use super::law::Law;
use crate::diagnose::candidates::{contender, same_effect};
use crate::diagnose::judge::{COUNT, PRINCIPAL, delay_of};
use crate::law::Term;

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
    /// Held-out errors of the law, by window length.
    pub errors: [WindowError; COUNT],
    /// The law.
    pub law: Law,
}

impl Step {
    /// Held-out error at the principal length.
    pub fn error(&self) -> f64 {
        self.errors[PRINCIPAL].after
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

/// Diagnoses and adds until the law is adequate, or what is left is not in the catalogue. None where the record is too short.
pub(in crate::diagnose) fn improve(case: &Case, terms: &[Term]) -> Option<Improvement> {
    let first = case.stand(terms)?;
    let mut steps = vec![Step {
        effect: None,
        removed: Vec::new(),
        ties: Vec::new(),
        errors: case.errors_of(&first),
        law: case.law(&first),
    }];
    let mut law = terms.to_vec();
    let mut standing = first;
    let mut last = diagnose(case, &law)?;
    while last.finding == Finding::Missing && steps.len() <= STEPS {
        let Some(added) = last.candidates.first().map(|candidate| candidate.term) else { break };
        let joined: Vec<Term> = law.iter().copied().chain([added]).collect();
        let Some(next) = case.stand(&joined) else { break };
        let Some((smaller, next, removed)) = without_superfluous(case, (joined, next), terms, added) else { break };
        if !(next.held.score(&standing.held) < 0.0 || delay_of(added).is_some()) {
            break;
        }
        let ties = std::mem::take(&mut last.indistinguishable);
        let step =
            Step { effect: last.effect.clone(), removed, ties, errors: case.errors_of(&next), law: case.law(&next) };
        steps.push(step);
        (law, standing) = (smaller, next);
        last = diagnose(case, &law)?;
    }
    Some(Improvement { steps, last })
}

/// The law without effects that were added before and are not worth the word beside the newest one.
fn without_superfluous(
    case: &Case,
    (mut terms, mut standing): (Vec<Term>, Standing),
    original: &[Term],
    newest: Term,
) -> Option<(Vec<Term>, Standing, Vec<String>)> {
    let mut removed = Vec::new();
    loop {
        let added = |term: &Term| {
            let own = original.iter().any(|own| same_effect(*own, *term));
            *term != newest && !own && delay_of(*term).is_none()
        };
        let weakest = (0..terms.len()).filter(|index| added(&terms[*index])).find_map(|index| {
            let equation = standing.equation.without(index);
            let held = case.folds.judge(&equation);
            (held.score(&standing.held) < TIE * COUNT as f64).then_some((index, equation))
        });
        let Some((index, equation)) = weakest else { return Some((terms, standing, removed)) };
        let law = case.law(&standing);
        removed.push(law.effect_name(terms.remove(index)));
        standing = case.of(equation)?;
    }
}

/// An effect in the law, and the errors without and with it.
#[derive(Clone, Debug)]
pub struct Addition {
    /// The law without it.
    pub before: Law,
    /// The law with it as its last term.
    pub after: Law,
    /// Errors by window length.
    pub errors: [WindowError; COUNT],
}

/// Adds an effect to a law, whatever its evidence. None where the record is too short for the law with it.
pub(in crate::diagnose) fn add(case: &Case, terms: &[Term], effect: Term) -> Option<Addition> {
    let before = case.stand(terms)?;
    let found = contender(&case.record, &case.folds, &before.equation, &before.held, effect)?;
    let after = case.of(before.equation.with(&case.record, found.term))?;
    let errors = case.errors_of(&after);
    let errors = std::array::from_fn(|which| WindowError { before: before.held.errors[which], ..errors[which] });
    Some(Addition { before: case.law(&before), after: case.law(&after), errors })
}
