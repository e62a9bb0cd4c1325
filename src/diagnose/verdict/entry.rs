//! A candidate beside a law, with what decides about it.

use super::case::{Case, Standing};
use super::doubt::{Doubt, SURE, WORTH, doubt_of_gain};
use super::errors::{WindowError, are_adequate, errors};
use super::untold::drives;
use crate::diagnose::candidates::{Contender, TRAP};
use crate::diagnose::judge::{Blocks, COUNT, PRINCIPAL, delay_of, estimate};
use crate::law::{Catalogue, Term};
use std::cell::OnceCell;

/// A candidate beside the law.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Its effect id, or the name of a user's expression.
    pub effect: String,
    /// The candidate itself.
    pub term: Term,
    /// Inner parameters by name, fitted.
    pub inner: Vec<(String, f64)>,
    /// Its coefficient.
    pub coefficient: f64,
    /// Std of it, over blocks of the record.
    pub std: f64,
    /// Held-out errors by window length; the principal ones are those at 0.3 T₀.
    pub errors: [WindowError; COUNT],
    /// Probability of a gain this large by chance, all candidates counted; none where the record is too short to tell.
    pub p_value: Option<f64>,
    /// S = Σ ln(error after ÷ before) over the window lengths.
    pub score: f64,
    /// Share of it that the law's own terms are.
    pub resemblance: f64,
    /// Why it is not named; none where it could be.
    pub doubt: Option<Doubt>,
}

impl Candidate {
    /// Its errors at the principal length.
    pub fn error(&self) -> WindowError {
        self.errors[PRINCIPAL]
    }
}

/// A contender with what decides about it.
pub(super) struct Entry {
    pub(super) contender: Contender,
    pub(super) standing: Option<Standing>,
    pub(super) p_value: Option<f64>,
    pub(super) doubt: Option<Doubt>,
    /// Its coefficient and std beside the law, once they were asked for.
    pub(super) coefficient: OnceCell<[f64; 2]>,
}

impl Entry {
    pub(super) fn new(contender: Contender) -> Entry {
        Entry { contender, standing: None, p_value: None, doubt: None, coefficient: OnceCell::new() }
    }

    /// Coefficient and std.
    fn measured(&self, case: &Case, standing: &Standing) -> [f64; 2] {
        *self.coefficient.get_or_init(|| self.estimated(case, standing))
    }

    fn estimated(&self, case: &Case, standing: &Standing) -> [f64; 2] {
        if let Some((late, own)) = delay_of(self.contender.term).zip(self.standing.as_ref()) {
            return [1.0, own.estimate.delay.map_or(f64::NAN, |[_, std]| std / late)];
        }
        let equation = standing.equation.with(&case.record, self.contender.term);
        let inertia = equation.terms.iter().position(|term| *term == Term::Inertia);
        let blocks = Blocks::new(&case.record, &self.contender.held);
        let found = estimate(&case.record, &equation, &blocks, case.inertia);
        let backward = |values: &[f64]| inertia.is_some_and(|index| values[index] <= 0.0);
        let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
        match found {
            Some(found) if !backward(&found.coefficients) => [last(&found.coefficients), last(&found.std)],
            _ => [f64::NAN; 2],
        }
    }

    /// What bars it whatever its gain.
    pub(super) fn barred(&self, case: &Case, standing: &Standing) -> Option<Doubt> {
        let [coefficient, std] = self.measured(case, standing);
        if !self.contender.allows(coefficient) || drives(case, standing, self.contender.term, [coefficient, std]) {
            return Some(Doubt::Sign);
        }
        if self.contender.resemblance >= TRAP {
            return Some(Doubt::Trap);
        }
        let is_sure = coefficient.abs() > SURE * std;
        (!is_sure).then_some(Doubt::Uncertain)
    }

    /// Whether the law with it leaves what the sensors alone would where the law without leaves clearly more: the law's
    /// own terms pass for it by their errors, and then there are none.
    pub(super) fn leaves_no_error(&self, case: &Case, standing: &Standing) -> bool {
        let [coefficient, std] = self.measured(case, standing);
        let gains =
            |floor: &[f64; COUNT]| doubt_of_gain(&self.contender.before, &self.contender.held, None, floor).is_none();
        let is_sure = coefficient.abs() > SURE * std;
        if !(is_sure && gains(&standing.floor) && gains(&case.settled(standing.clone()).floor)) {
            return false;
        }
        let law: Vec<Term> = standing.equation.terms.iter().copied().chain([self.contender.term]).collect();
        case.stand(&law).is_some_and(|whole| are_adequate(&case.errors_of(&case.settled(whole))))
    }

    /// Its effect id, or the name of a user's expression.
    pub(super) fn name(&self) -> String {
        Catalogue::name_of(self.contender.term)
    }

    /// What its gain leaves to doubt.
    pub(super) fn doubted(&self, floor: &[f64; COUNT]) -> Option<Doubt> {
        doubt_of_gain(&self.contender.before, &self.contender.held, self.p_value, floor)
    }

    /// Whether a candidate that holds q̈, and was tried on half of the readings, is worth the word on all of them.
    pub(super) fn is_worth_it(&self, case: &Case, standing: &Standing) -> bool {
        if !case.record.accelerates(self.contender.term) {
            return true;
        }
        let law: Vec<Term> = standing.equation.terms.iter().copied().chain([self.contender.term]).collect();
        let whole = case.stand(&law);
        whole.is_some_and(|whole| whole.held.score(&standing.held) <= COUNT as f64 * WORTH.ln())
    }

    pub(super) fn describe(&self, case: &Case, standing: &Standing) -> Candidate {
        let [coefficient, std] = self.measured(case, standing);
        let term = self.contender.term;
        let inner = term.inner_named(&case.record.expressions);
        Candidate {
            effect: self.name(),
            term,
            inner,
            coefficient,
            std,
            errors: errors(&case.record, &self.contender.before, &self.contender.held, &standing.floor),
            p_value: self.p_value,
            score: self.contender.score,
            resemblance: self.contender.resemblance,
            doubt: self.doubt,
        }
    }
}
