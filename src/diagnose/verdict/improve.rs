//! Effects added to a law until nothing is missing that the catalogue has.

use super::case::{Case, Standing};
use super::diagnosis::{Diagnosis, Finding, diagnose};
use super::errors::{TIE, WindowError};
use super::exchange::{Exchange, Seen, added, joined, paired, seen, tuned};
use super::law::Law;
use crate::diagnose::candidates::{contender, same_effect};
use crate::diagnose::judge::{COUNT, PRINCIPAL, delay_of};
use crate::law::{Catalogue, Term};

/// Most effects that are added: none of twelve real records has borne more than four.
const STEPS: usize = 6;

/// One step of the staircase.
#[derive(Clone, Debug)]
pub struct Step {
    /// The effect that was added; none for the model as it came.
    pub effect: Option<String>,
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

/// Diagnoses and adds until the law is adequate, or what is left is not in the catalogue. None where the record is too
/// short.
pub(in crate::diagnose) fn improve(case: &Case, terms: &[Term]) -> Option<Improvement> {
    let mut search =
        Search { case, original: terms, terms: terms.to_vec(), standing: case.stand(terms)?, ties: Vec::new() };
    let mut last = diagnose(case, terms)?;
    for _ in 0..STEPS {
        let went_on = match last.finding {
            Finding::Missing => search.add(&last),
            Finding::Unexplained => search.pair(),
            Finding::Adequate => false,
        };
        if !went_on {
            break;
        }
        search.settle();
        last = diagnose(case, &search.terms)?;
    }
    Some(Improvement { steps: search.staircase()?, last })
}

/// A law on its way to what the record shows.
struct Search<'a> {
    case: &'a Case,
    original: &'a [Term],
    terms: Vec<Term>,
    standing: Standing,
    /// What added effects cannot be told from.
    ties: Vec<(Term, Vec<Vec<String>>)>,
}

impl Search<'_> {
    /// Adds what a diagnosis names; false where it does not help.
    fn add(&mut self, found: &Diagnosis) -> bool {
        let Some(named) = found.candidates.first().map(|candidate| candidate.term) else { return false };
        let terms = joined(&self.terms, named);
        let Some(standing) = self.case.stand(&terms) else { return false };
        let helps = standing.held.score(&self.standing.held) < 0.0 || delay_of(named).is_some();
        helps && self.take(Exchange { terms, standing, ties: found.indistinguishable.clone() }, 1)
    }

    /// Exchanges added effects until all stand.
    fn settle(&mut self) {
        self.tune();
        for round in 0..STEPS {
            let pairs = round == 0 && added(self.original, &self.terms).len() == 2;
            if !(self.exchange() || pairs && self.pair()) {
                break;
            }
        }
    }

    /// Seeks inner parameters of added effects anew beside each other, where there are several: each was found before
    /// those that came after it.
    fn tune(&mut self) {
        let own = added(self.original, &self.terms);
        let rest: Vec<Term> =
            (0..self.terms.len()).filter(|place| !own.contains(place)).map(|place| self.terms[place]).collect();
        let Some(base) = self.case.stand(&rest).filter(|_| own.len() > 1) else { return };
        let terms = tuned(self.case, self.original, &self.terms, &base);
        let Some(standing) = self.case.stand(&terms) else { return };
        if standing.held.score(&self.standing.held) < 0.0 {
            (self.terms, self.standing) = (terms, standing);
        }
    }

    /// Exchanges one added effect for a better one; false where all stand.
    fn exchange(&mut self) -> bool {
        if added(self.original, &self.terms).len() < 2 {
            return false;
        }
        let Seen { exchange, ties } = seen(self.case, self.original, &self.terms, &self.standing);
        self.ties.extend(ties);
        exchange.is_some_and(|exchange| self.take(exchange, 1))
    }

    /// Takes the best pair of effects; false where none is better, or one of the two makes the other superfluous: alone
    /// no diagnosis names it.
    fn pair(&mut self) -> bool {
        paired(self.case, self.original, &self.terms, &self.standing).is_some_and(|pair| self.take(pair, 2))
    }

    /// Takes a law, less what its newest effect makes superfluous; false where fewer than so many added effects are
    /// left.
    fn take(&mut self, Exchange { terms, standing, ties }: Exchange, fewest: usize) -> bool {
        let Some(newest) = terms.last().copied() else { return false };
        let Some((terms, standing)) = without_superfluous(self.case, (terms, standing), self.original, newest) else {
            return false;
        };
        let late = terms.iter().filter(|term| delay_of(**term).is_some()).count();
        if added(self.original, &terms).len() + late < fewest {
            return false;
        }
        (self.terms, self.standing) = (terms, standing);
        self.ties.push((newest, ties));
        true
    }

    /// The effects that the law has in the end, each time the one that helps most.
    fn staircase(&self) -> Option<Vec<Step>> {
        let mut left: Vec<Term> =
            self.terms.iter().copied().filter(|term| !self.original.iter().any(|own| own == term)).collect();
        let mut terms = self.original.to_vec();
        let mut standing = self.case.stand(&terms)?;
        let mut steps = vec![self.step(None, &standing)];
        while !left.is_empty() {
            let tried = left.iter().map(|term| Some((*term, self.case.stand(&joined(&terms, *term))?)));
            let score = |(_, next): &(Term, Standing)| next.held.score(&standing.held);
            let (best, next) = tried.flatten().min_by(|a, b| score(a).total_cmp(&score(b)))?;
            left.retain(|term| *term != best);
            terms.push(best);
            steps.push(self.step(Some(best), &next));
            standing = next;
        }
        Some(steps)
    }

    fn step(&self, effect: Option<Term>, standing: &Standing) -> Step {
        let same = |term: Term| effect.is_some_and(|effect| same_effect(effect, term));
        let ties = self.ties.iter().rev().find(|(term, _)| same(*term)).map(|(_, ties)| ties.clone());
        Step {
            effect: effect.map(Catalogue::name_of),
            ties: ties.unwrap_or_default(),
            errors: self.case.errors_of(&self.case.settled(standing.clone())),
            law: self.case.law(standing),
        }
    }
}

/// The law without effects that were added before and are not worth the word beside the newest one.
fn without_superfluous(
    case: &Case,
    (mut terms, mut standing): (Vec<Term>, Standing),
    original: &[Term],
    newest: Term,
) -> Option<(Vec<Term>, Standing)> {
    loop {
        let old = added(original, &terms).into_iter().filter(|place| terms[*place] != newest);
        let weakest = old.into_iter().find_map(|place| {
            let equation = standing.equation.without(place);
            let held = case.folds.judge(&equation);
            (held.score(&standing.held) < TIE * COUNT as f64).then_some((place, equation))
        });
        let Some((place, equation)) = weakest else { return Some((terms, standing)) };
        terms.remove(place);
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
    let found = contender(&case.record, &case.folds, &before.equation, (&before.held, before.floor), effect)?;
    let after = case.of(before.equation.with(&case.record, found.term))?;
    let errors = case.errors_of(&after);
    let errors = std::array::from_fn(|which| WindowError { before: before.held.errors[which], ..errors[which] });
    Some(Addition { before: case.law(&before), after: case.law(&after), errors })
}
