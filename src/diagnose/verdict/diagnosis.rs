//! Which physical effect a law lacks, as the judge sees it.
//!
//! Every candidate is fitted beside the law with what time and sensors may explain; the one that lowers the held-out errors most is named
//! where that is no chance (a sign-flip test over blocks, all candidates counted) and worth the word, or is large in every window. Nothing
//! that a record cannot tell is claimed: a candidate that the law's own terms nearly are, one whose sign physics forbids, one that its own
//! std swallows.

use super::case::{Case, Standing};
use super::errors::{ADEQUATE, TIE, WindowError, are_adequate, errors};
use super::law::{Law, effect_name};
use super::remainder;
use crate::diagnose::candidates::{Contender, contest};
use crate::diagnose::judge::{COUNT, HeldOut, PRINCIPAL, delay_of};
use crate::law::{Catalogue, Effect, Inner, State, Term};

/// Chance, shared among all candidates tried, below which a gain is none.
pub const LEVEL: f64 = 0.01;

/// Mean ratio of errors that is worth the word: 5 %.
pub const WORTH: f64 = 0.95;

/// Ratio of errors beyond the sensors' in every window that needs no test: a third of the energy is gone.
pub(super) const LARGE: f64 = 0.816;

/// Ratio of errors in one window that disqualifies: 2 % worse.
pub(super) const WORSE: f64 = 1.02;

/// Most candidates in a tie.
const TIED: usize = 3;

/// Share of a candidate that the law's own terms are, from which it cannot be told from them: what little error its readings have is then
/// ten times as large in its coefficient.
const TRAP: f64 = 0.99;

/// Std that a coefficient must be away from 0.
pub(super) const SURE: f64 = 2.0;

/// What a diagnosis comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// An effect is missing.
    Missing,
    /// The law explains its record down to the sensors.
    Adequate,
    /// More is left than the sensors explain, and no effect of the catalogue passes.
    Unexplained,
}

/// Why a candidate is not named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// Physics forbids its sign.
    Sign,
    /// The law's own terms, the excitation among them, nearly are it.
    Trap,
    /// Its coefficient is within its uncertainty.
    Uncertain,
    /// It makes the error worse in a window.
    Worse,
    /// Its gain may be chance, or is too small to speak of.
    Chance,
}

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

/// A diagnosis of one law on a set of recordings.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// What it comes to.
    pub finding: Finding,
    /// The effect that is missing.
    pub effect: Option<String>,
    /// The candidates, best first.
    pub candidates: Vec<Candidate>,
    /// Candidates that this record cannot tell apart, the best first.
    pub indistinguishable: Vec<Vec<String>>,
    /// Share of the error's energy beyond the sensors' that the answer takes away; the best candidate's where none is named.
    pub explained: f64,
    /// What remains, in a sentence.
    pub left: String,
    /// Errors without and with the answer, by window length.
    pub errors: [WindowError; COUNT],
    /// T₀, s.
    pub period: f64,
    /// How long the record is, s.
    pub duration: f64,
    /// The law as it is, fitted.
    pub base: Law,
    /// The law with the effect that is missing.
    pub improved: Option<Law>,
    /// Candidates tried, inner parameters counted apart.
    pub tried: usize,
    /// Whether the record is long enough for a test of significance.
    pub is_testable: bool,
}

impl Candidate {
    /// Its errors at the principal length.
    pub fn error(&self) -> WindowError {
        self.errors[PRINCIPAL]
    }
}

/// A contender with what decides about it.
struct Entry {
    contender: Contender,
    standing: Option<Standing>,
    p_value: Option<f64>,
    doubt: Option<Doubt>,
}

/// Diagnoses a law of these terms. None where the record is too short for them.
pub(in crate::diagnose) fn diagnose(case: &Case, terms: &[Term]) -> Option<Diagnosis> {
    let standing = case.stand(terms)?;
    let (mut entries, tried) = entries(case, &standing, terms);
    let named = entries.iter().position(|entry| entry.doubt.is_none());
    let winner = named.map(|best| smallest(case, &standing, &entries, best));
    let ties = winner.map_or_else(Vec::new, |winner| ties(case, &entries, winner));
    let improved = winner.and_then(|winner| {
        let term = entries[winner].contender.term;
        let law: Vec<Term> = terms.iter().copied().chain([term]).collect();
        entries[winner].standing.clone().or_else(|| case.stand(&law))
    });
    if let Some(winner) = winner {
        let first = entries.remove(winner);
        entries.insert(0, first);
    }
    Some(conclude(case, standing, improved, &entries, (ties, tried)))
}

/// Every candidate beside the law, the best first.
fn entries(case: &Case, standing: &Standing, terms: &[Term]) -> (Vec<Entry>, usize) {
    let (found, tried) = contest(&case.record, &case.folds, &standing.equation, &standing.held);
    let mut entries: Vec<Entry> = found.into_iter().map(Entry::new).collect();
    weigh(case, standing, &mut entries);
    let late = late(case, terms, &entries);
    if !late.is_empty() {
        entries.extend(late);
        entries.sort_by(|a, b| a.contender.score.total_cmp(&b.contender.score));
        weigh(case, standing, &mut entries);
    }
    (entries, tried)
}

/// Significance and doubt of every candidate among all that physics and the law's own terms leave.
fn weigh(case: &Case, standing: &Standing, entries: &mut [Entry]) {
    for entry in entries.iter_mut() {
        entry.doubt = entry.barred(case, standing);
    }
    let (mut left, _): (Vec<&mut Entry>, Vec<&mut Entry>) = entries.iter_mut().partition(|entry| entry.doubt.is_none());
    let gains =
        |entry: &&mut Entry| standing.blocks.gains(&case.record, &entry.contender.before, &entry.contender.held);
    let values = standing.blocks.p_values(&left.iter().map(gains).collect::<Vec<_>>());
    for (index, entry) in left.iter_mut().enumerate() {
        entry.p_value = values.as_ref().map(|values| values[index]);
        entry.doubt = entry.doubted(&standing.floor);
        if entry.doubt.is_none() && !entry.is_worth_it(case, standing) {
            entry.doubt = Some(Doubt::Chance);
        }
    }
}

/// An excitation that acts later than recorded, at once or gradually, as effects among the others: where the law stands better so than with
/// any of them. Only where it acts late at all a lag is tried, for to first order the two are one.
fn late(case: &Case, terms: &[Term], others: &[Entry]) -> Vec<Entry> {
    let moves = case.record.forced && terms.contains(&Term::Inertia);
    if !moves || terms.iter().any(|term| delay_of(*term).is_some()) {
        return Vec::new();
    }
    let Some(late) = case.delayed(terms) else { return Vec::new() };
    let before = case.folds.judge(&case.punctual(terms));
    let delay = acting_late(case, terms, &before, Effect::ExcitationDelay { delay: Inner::new(late) });
    let lag = delay.as_ref().and_then(|_| Effect::lag(case.lagged(terms, late)));
    let lag = lag.and_then(|lag| acting_late(case, terms, &before, lag));
    let better = |own: &Entry| {
        let score = own.contender.score;
        let taken = |other: &Entry| other.doubt.is_none() && other.contender.held.score(&before) <= score;
        !others.iter().any(taken)
    };
    [delay, lag].into_iter().flatten().filter(better).collect()
}

/// The law with an excitation that acts late, against the punctual one; none where it does not.
fn acting_late(case: &Case, terms: &[Term], before: &HeldOut, effect: Effect) -> Option<Entry> {
    let term = Term::Effect(effect);
    let law: Vec<Term> = terms.iter().copied().chain([term]).collect();
    let standing = case.stand(&law)?;
    // the column beside it may take any delay back, and find the record late instead
    let [step, std] = standing.estimate.delay?;
    let timing = standing.equation.timing;
    // half a sample is also what a held force is late when it is read as a straight line
    if timing.delay + timing.lag + step <= 0.5 * case.record.sample_time + SURE * std {
        return None;
    }
    let (score, held) = (standing.held.score(before), standing.held.clone());
    let contender = Contender { term, before: before.clone(), held, score, resemblance: 0.0 };
    Some(Entry { standing: Some(standing), ..Entry::new(contender) })
}

impl Entry {
    fn new(contender: Contender) -> Entry {
        Entry { contender, standing: None, p_value: None, doubt: None }
    }

    /// Coefficient and std.
    fn coefficient(&self, case: &Case, standing: &Standing) -> [f64; 2] {
        if let Some((late, own)) = delay_of(self.contender.term).zip(self.standing.as_ref()) {
            return [1.0, own.estimate.delay.map_or(f64::NAN, |[_, std]| std / late)];
        }
        let equation = standing.equation.with(&case.record, self.contender.term);
        let inertia = equation.terms.iter().position(|term| *term == Term::Inertia);
        let found = case.estimated(equation);
        let backward = |values: &[f64]| inertia.is_some_and(|index| values[index] <= 0.0);
        let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
        match found {
            Some(found) if !backward(&found.coefficients) => [last(&found.coefficients), last(&found.std)],
            _ => [f64::NAN; 2],
        }
    }

    /// What bars it whatever its gain.
    fn barred(&self, case: &Case, standing: &Standing) -> Option<Doubt> {
        let [coefficient, std] = self.coefficient(case, standing);
        if !self.contender.allows(coefficient) || self.drives(case, standing, coefficient, std) {
            return Some(Doubt::Sign);
        }
        if self.contender.resemblance >= TRAP {
            return Some(Doubt::Trap);
        }
        let is_sure = coefficient.abs() > SURE * std;
        (!is_sure).then_some(Doubt::Uncertain)
    }

    /// Whether dry friction that changes along the way would push somewhere on it: the law's own friction and it, two std nearer to none.
    fn drives(&self, case: &Case, standing: &Standing, coefficient: f64, std: f64) -> bool {
        let term = self.contender.term;
        if !matches!(term, Term::Effect(Effect::PositionDependentFriction { .. })) {
            return false;
        }
        let nearer = coefficient.signum() * (coefficient.abs() - SURE * std).max(0.0);
        let with = standing.equation.with(&case.record, term);
        let Some(found) = case.estimated(with.clone()) else { return false };
        let values = found.coefficients.iter().map(|value| if *value == coefficient { nearer } else { *value });
        let dry = |term: Term| term.effect().is_some_and(Effect::is_dry);
        let friction: Vec<(Term, f64)> =
            with.terms.iter().copied().zip(values).filter(|(term, _)| dry(*term)).collect();
        let states = case.record.motions.iter().flat_map(|motion| motion.states()).flatten();
        let power = |State { q, qd }: State| -> f64 {
            friction.iter().map(|(term, value)| value * term.force(q, qd, 0.0) * qd).sum()
        };
        states.map(power).any(|power| power < 0.0)
    }

    /// Whether it may be what is there though the law's own terms nearly are it: not where it holds the target, for then it is that.
    fn may_be(&self, case: &Case) -> bool {
        may_be(case, self.contender.term, self.doubt)
    }

    /// What its gain leaves to doubt.
    fn doubted(&self, floor: &[f64; COUNT]) -> Option<Doubt> {
        doubt_of_gain(&self.contender.before, &self.contender.held, self.p_value, floor)
    }

    /// Whether a candidate that holds q̈, and was tried on half of the readings, is worth the word on all of them.
    fn is_worth_it(&self, case: &Case, standing: &Standing) -> bool {
        if !case.record.accelerates(self.contender.term) {
            return true;
        }
        let law: Vec<Term> = standing.equation.terms.iter().copied().chain([self.contender.term]).collect();
        let whole = case.stand(&law);
        whole.is_some_and(|whole| whole.held.score(&standing.held) <= COUNT as f64 * WORTH.ln())
    }

    fn describe(&self, case: &Case, standing: &Standing) -> Candidate {
        let [coefficient, std] = self.coefficient(case, standing);
        let term = self.contender.term;
        let inner = term.effect().map_or_else(Vec::new, |effect| {
            let names = effect.inner().iter().map(|parameter| parameter.name.to_string());
            names.zip(effect.inner_values()).collect()
        });
        Candidate {
            effect: effect_name(term, &case.record.expressions),
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

/// What a gain from one law to another leaves to doubt, with its probability by chance and the floor of the first.
pub(super) fn doubt_of_gain(
    before: &HeldOut,
    after: &HeldOut,
    p_value: Option<f64>,
    floor: &[f64; COUNT],
) -> Option<Doubt> {
    let ratios = after.ratios(before);
    if ratios.iter().any(|ratio| *ratio > WORSE) || after.errors.iter().any(|error| *error >= 1.0) {
        return Some(Doubt::Worse);
    }
    let mean = after.score(before) / ratios.len().max(1) as f64;
    let significant = p_value.is_some_and(|p| p < LEVEL) && mean.exp() <= WORTH;
    (!(is_large(before, after, floor) || significant)).then_some(Doubt::Chance)
}

/// Whether a gain takes a third of the energy that the sensors do not explain in every window that has such, in two at least.
pub(super) fn is_large(before: &HeldOut, after: &HeldOut, floor: &[f64; COUNT]) -> bool {
    let errors = before.errors.iter().zip(&after.errors).zip(floor);
    let told = errors.filter(|((before, _), floor)| **before > ADEQUATE * **floor);
    let beyond = |error: f64, floor: f64| (error * error - floor * floor).max(0.0).sqrt();
    let ratios: Vec<f64> =
        told.map(|((before, after), floor)| beyond(*after, *floor) / beyond(*before, *floor)).collect();
    let told = after.ratios(before).len();
    ratios.len() >= told.min(2) && !ratios.is_empty() && ratios.iter().all(|ratio| *ratio <= LARGE)
}

/// Whether a candidate may be what is there, as far as only chance or the law's own terms speak against it. One that holds the target and that
/// the law nearly is, is the target.
pub(super) fn may_be(case: &Case, term: Term, doubt: Option<Doubt>) -> bool {
    match doubt {
        None | Some(Doubt::Chance) => true,
        Some(Doubt::Trap) => !case.record.accelerates(term),
        _ => false,
    }
}

/// The smallest effect that the best one contains and is not significantly better than.
fn smallest(case: &Case, standing: &Standing, entries: &[Entry], best: usize) -> usize {
    let name = |index: usize| effect_name(entries[index].contender.term, &case.record.expressions);
    let may_stand = |index: usize| {
        let smaller = &entries[index];
        let borne = matches!(smaller.doubt, None | Some(Doubt::Chance)) && smaller.contender.score < 0.0;
        if !borne {
            return false;
        }
        let [smaller, larger] = [index, best].map(|index| &entries[index].contender.held);
        let gains = standing.blocks.gains(&case.record, smaller, larger);
        let chance = standing.blocks.p_values(&[gains]);
        let difference = larger.score(smaller);
        difference > -TIE * COUNT as f64
            || chance.is_none_or(|p| p[0] >= LEVEL) && difference > COUNT as f64 * LARGE.ln()
    };
    let (mut found, mut larger) = (best, name(best));
    while let Some(index) =
        (0..entries.len()).find(|index| Catalogue::is_contained(&name(*index), &larger) && may_stand(*index))
    {
        (found, larger) = (index, name(index));
    }
    found
}

/// Those that are at least as good as the winner, it first. Once something is missing a tied one need not prove it again; one that the law's
/// own terms nearly are cannot win alone, but may be what is there.
fn ties(case: &Case, entries: &[Entry], winner: usize) -> Vec<Vec<String>> {
    let best = entries[winner].contender.score;
    let near = |entry: &&Entry| entry.may_be(case) && entry.contender.score <= best + TIE * COUNT as f64;
    let others = entries.iter().enumerate().filter(|(index, entry)| *index != winner && near(entry));
    let first = std::iter::once(effect_name(entries[winner].contender.term, &case.record.expressions));
    let group: Vec<String> =
        first.chain(others.map(|(_, entry)| effect_name(entry.contender.term, &case.record.expressions))).collect();
    if group.len() > 1 { vec![group.into_iter().take(TIED).collect()] } else { Vec::new() }
}

fn conclude(
    case: &Case,
    standing: Standing,
    improved: Option<Standing>,
    entries: &[Entry],
    (ties, tried): (Vec<Vec<String>>, usize),
) -> Diagnosis {
    let improved = improved.map(|improved| case.settled(improved));
    let standing = if improved.is_none() { case.settled(standing) } else { standing };
    let adequate = are_adequate(&case.errors_of(&standing));
    let finding = match &improved {
        Some(_) => Finding::Missing,
        None if adequate => Finding::Adequate,
        None => Finding::Unexplained,
    };
    let candidates: Vec<Candidate> = entries.iter().map(|entry| entry.describe(case, &standing)).collect();
    let before = entries.first().filter(|_| improved.is_some()).map_or(&standing.held, |entry| &entry.contender.before);
    let last = improved.as_ref().unwrap_or(&standing);
    let errors = errors(&case.record, before, &last.held, &last.floor);
    let best =
        candidates.iter().find(|candidate| !matches!(candidate.doubt, Some(Doubt::Sign | Doubt::Trap | Doubt::Worse)));
    let principal = if improved.is_some() { Some(errors[PRINCIPAL]) } else { best.map(Candidate::error) };
    Diagnosis {
        finding,
        effect: candidates.first().filter(|_| improved.is_some()).map(|candidate| candidate.effect.clone()),
        indistinguishable: ties,
        explained: principal.map_or(0.0, share_explained),
        left: remainder::sentence(case, last),
        errors,
        period: case.record.period,
        duration: case.record.duration,
        base: case.law(&standing),
        improved: improved.as_ref().map(|improved| case.law(improved)),
        tried,
        is_testable: standing.blocks.count.is_some(),
        candidates,
    }
}

/// 1 − (after² − floor²) ÷ (before² − floor²), between 0 and 1.
fn share_explained(error: WindowError) -> f64 {
    let beyond = |value: f64| (value * value - error.floor * error.floor).max(0.0);
    let before = beyond(error.before);
    if before > 0.0 { (1.0 - beyond(error.after) / before).clamp(0.0, 1.0) } else { 0.0 }
}

impl Diagnosis {
    /// Whether what is left, with the effect that is missing, is what the sensors alone would leave.
    pub fn is_down_to_sensors(&self) -> bool {
        are_adequate(&self.errors)
    }
}
