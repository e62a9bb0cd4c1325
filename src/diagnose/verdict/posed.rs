//! A model put to recordings: its form with its best coefficients, its open inner parameters and "maybe" terms decided.

use super::case::{Case, Standing};
use super::diagnosis::{Diagnosis, diagnose};
use super::drifting::{steadied, wandering};
use super::errors::{TIE, WindowError};
use super::improve::{Addition, Improvement, add, improve};
use super::law::Law;
use super::sharpen::sharpened;
use super::timing::Clock;
use crate::diagnose::candidates::{contender, same_effect};
use crate::diagnose::judge::{COUNT, best_change, changes, delay_of};
use crate::identify::Recording;
use crate::law::{Effect, Given, Hold, Inner, Model, ModelTerm, Term};
use std::cell::OnceCell;

/// A model on recordings of one system.
#[derive(Clone, Debug)]
pub struct Posed {
    case: Case,
    terms: Vec<Term>,
    /// How much the displacement of each recording wandered, m, before that was taken out; empty where none does.
    wandering: Vec<f64>,
    /// Its law with the errors, once they were asked for.
    law: OnceCell<Option<(Law, [WindowError; COUNT])>>,
}

impl Posed {
    /// Puts a model to recordings; `hold` where it is known what the excitation did between samples. None where nothing
    /// moves, or the record is too short for the model's form.
    pub fn new(model: &Model, recordings: &[&Recording], hold: Option<Hold>) -> Option<Posed> {
        let all: Vec<Term> = model.terms.iter().map(|entry| entry.term).collect();
        let inertia = model.terms.iter().find(|entry| entry.term == Term::Inertia);
        let inertia = inertia.map_or(1.0, |entry| if let Given::Known(value) = entry.given { value } else { 1.0 });
        let posed =
            |recordings: &[&Recording]| Case::new(recordings, &all, &model.expressions, hold.or(model.hold), inertia);
        let case = posed(recordings)?;
        let is_open = |entry: &&ModelTerm| entry.open.contains(&true);
        let (open, settled): (Vec<&ModelTerm>, Vec<&ModelTerm>) = model.terms.iter().partition(is_open);
        let settled = settled.into_iter().map(|entry| entry.term).collect();
        let terms = open.iter().try_fold(settled, |terms, entry| with_open(&case, terms, entry.term))?;
        let terms = if open.len() > 1 { beside_each_other(&case, terms, open.len())? } else { terms };
        let maybe: Vec<Term> =
            model.terms.iter().filter(|entry| entry.given == Given::Maybe).map(|entry| entry.term).collect();
        let terms = without_idle(&case, terms, &maybe)?;
        Some(match steadied(&case, recordings, &terms, posed) {
            Some((case, drifts)) => Posed::of(case, terms, drifts.iter().map(wandering).collect()),
            None => Posed::of(case, terms, Vec::new()),
        })
    }

    fn of(case: Case, terms: Vec<Term>, wandering: Vec<f64>) -> Posed {
        Posed { case, terms, wandering, law: OnceCell::new() }
    }

    /// Which effect the model lacks.
    pub fn diagnose(&self) -> Option<Diagnosis> {
        diagnose(&self.case, &self.terms)
    }

    /// Effects added until nothing is missing that the catalogue has.
    pub fn improve(&self) -> Option<Improvement> {
        improve(&self.case, &self.terms)
    }

    /// An effect added, whatever its evidence. None where the record is too short for the law with it.
    pub fn add(&self, effect: Term) -> Option<Addition> {
        add(&self.case, &self.terms, effect)
    }

    /// The law of the model's form, and its held-out errors by window length (before and after alike).
    pub fn law(&self) -> Option<(Law, [WindowError; COUNT])> {
        let found = || {
            let standing = self.case.settled(self.case.stand(&self.terms)?);
            Some((self.case.law(&standing), self.case.errors_of(&standing)))
        };
        self.law.get_or_init(found).clone()
    }

    /// Held-out errors of a law of these terms on the recordings, by window length. None where they are too short for
    /// it.
    pub fn errors(&self, terms: &[Term]) -> Option<[WindowError; COUNT]> {
        Some(self.case.errors_of(&self.case.settled(self.case.stand(terms)?)))
    }

    /// Errors of a law whose numbers are held, and whether they are what the sensors alone would leave.
    pub fn errors_of(&self, law: &Law) -> Option<([WindowError; COUNT], bool)> {
        self.case.errors_as_given(law)
    }

    /// Instants at which the recordings may have changed a law of these terms, in seconds of recorded time, gaps left
    /// out.
    pub(super) fn changes(&self, terms: &[Term]) -> Vec<f64> {
        self.case.stand(terms).map_or_else(Vec::new, |standing| changes(&self.case.record, &standing.equation))
    }

    /// The instant, on the same axis, at which these terms under two laws in place of one leave least.
    pub(super) fn change_of(&self, terms: &[Term]) -> Option<f64> {
        best_change(&self.case.record, &self.case.stand(terms)?.equation)
    }

    /// A law with the numbers of largest likelihood, where they leave no more than the judge's own.
    pub fn sharpened(&self, law: &Law, recordings: &[&Recording]) -> Law {
        sharpened(&self.case, law, recordings)
    }

    /// How the sensors keep time, as this law has it.
    pub fn clock(&self, law: &Law) -> Clock {
        Clock::of(&self.case, law, &self.wandering)
    }

    /// The model with the inner parameters that the judge found for those it left open; "maybe" terms that explain
    /// nothing stay in it.
    pub fn with_inner(&self, model: &Model) -> Model {
        let found = |entry: &ModelTerm| self.terms.iter().find(|term| same_effect(**term, entry.term)).copied();
        let with = |entry: &ModelTerm| match found(entry).filter(|_| entry.open.contains(&true)) {
            Some(term) => ModelTerm { term, open: vec![false; entry.open.len()], ..entry.clone() },
            None => entry.clone(),
        };
        Model { terms: model.terms.iter().map(with).collect(), ..model.clone() }
    }

    /// The law's terms: the model's, its open inner parameters fitted, without "maybe" terms that explain nothing.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }
}

/// The law with one more term whose inner parameters are fitted from a free start.
fn with_open(case: &Case, terms: Vec<Term>, term: Term) -> Option<Vec<Term>> {
    let fitted = if let Some(given) = delay_of(term) {
        let delay = case.delayed(&terms);
        match term.effect() {
            Some(effect @ Effect::ActuatorLag { .. }) => {
                let lag = case.lagged(&terms, delay.unwrap_or(given));
                effect.with_inner(&[lag]).map_or(term, Term::Effect)
            }
            _ => Term::Effect(Effect::ExcitationDelay { delay: Inner::new(delay.unwrap_or(0.0)) }),
        }
    } else {
        let before = case.stand(&terms)?;
        let base = (&before.held, before.floor);
        contender(&case.record, &case.folds, &before.equation, base, term).map_or(term, |found| found.term)
    };
    Some(terms.into_iter().chain([fitted]).collect())
}

/// The law whose last terms, `count` of them, have the inner parameters that suit them beside the others: each was
/// fitted before those that came after it.
fn beside_each_other(case: &Case, mut terms: Vec<Term>, count: usize) -> Option<Vec<Term>> {
    for _ in 0..count {
        let first = terms.remove(terms.len() - count);
        terms = with_open(case, terms, first)?;
    }
    Some(terms)
}

/// The law without "maybe" terms that lower no error.
fn without_idle(case: &Case, mut terms: Vec<Term>, maybe: &[Term]) -> Option<Vec<Term>> {
    loop {
        let standing: Standing = case.stand(&terms)?;
        let without = |index: usize| case.folds.judge(&standing.equation.without(index)).score(&standing.held);
        let all = (0..terms.len()).filter(|index| maybe.contains(&terms[*index]));
        let idlest = all.map(|index| (without(index), index)).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, index)) = idlest.filter(|(score, _)| *score < TIE * COUNT as f64) else { return Some(terms) };
        terms.remove(index);
    }
}
