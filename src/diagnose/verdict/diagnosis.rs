//! Which physical effect a law lacks, as the judge sees it.
//!
//! Every candidate is fitted beside the law with what time and sensors may explain; the one that lowers the held-out
//! errors most is named where that is no chance (a sign-flip test over blocks, all candidates counted) and worth the
//! word, or is large in every window. Nothing that a record cannot tell is claimed: a candidate that the law's own
//! terms nearly are, one whose sign physics forbids, one that its own std swallows.

use super::case::{Case, Standing};
use super::contained::smallest;
use super::doubt::{Doubt, SURE, doubt_of_gain, may_be};
use super::entry::{Candidate, Entry};
use super::errors::{WindowError, are_adequate, errors};
use super::law::Law;
use super::remainder;
use super::untold::is_of_untold_damper;
use crate::diagnose::candidates::{Contender, contest};
use crate::diagnose::judge::{COUNT, HeldOut, PRINCIPAL, delay_of};
use crate::law::{Catalogue, Effect, Inner, Term};

/// Most candidates in a tie.
const TIED: usize = 3;

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
    /// Share of the error's energy beyond the sensors' that the answer takes away; the best candidate's where none is
    /// named.
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

/// Diagnoses a law of these terms. None where the record is too short for them.
pub(in crate::diagnose) fn diagnose(case: &Case, terms: &[Term]) -> Option<Diagnosis> {
    let standing = case.stand(terms)?;
    let (mut entries, tried) = entries(case, &standing, terms);
    let named = entries.iter().position(|entry| entry.doubt.is_none());
    let winner = named.map(|best| smallest(case, &standing, &entries, best));
    let told = winner.zip(named);
    let ties = told.map_or_else(Vec::new, |(winner, best)| ties(case, &standing, &entries, [winner, best]));
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
    let (found, tried) = contest(&case.record, &case.folds, &standing.equation, (&standing.held, standing.floor));
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
        if entry.doubt.is_none() && is_of_untold_damper(case, standing, entry.contender.term) {
            entry.doubt = Some(Doubt::Trap);
        }
    }
    // near the law's own terms two candidates are near each other: one that is none of them stands for both
    if entries.iter().all(|entry| entry.doubt.is_some()) {
        for entry in entries.iter_mut().filter(|entry| entry.doubt == Some(Doubt::Trap)) {
            if entry.leaves_no_error(case, standing) {
                entry.doubt = None;
            }
        }
    }
}

/// An excitation that acts later than recorded, at once or gradually, as effects among the others: where the law stands
/// better so than with any of them. Only where it acts late at all a lag is tried, for to first order the two are one.
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

/// What the record cannot tell from the winner, it first: the best that could be named, which contains the winner where
/// it is another; then those that this one does not outdo and that take more than half of what it takes, last those
/// that contain the winner, for of them it is a limit. Once something is missing a tied one need not prove it again;
/// one that the law's own terms nearly are cannot win alone and comes after those that can, but may be what is there.
fn ties(case: &Case, standing: &Standing, entries: &[Entry], [winner, best]: [usize; 2]) -> Vec<Vec<String>> {
    let most = &entries[best].contender;
    let first = entries[winner].name();
    let is_near = |index: &usize| {
        let Entry { contender, doubt, .. } = &entries[*index];
        let takes_as_much = 2.0 * contender.score < most.score;
        may_be(*doubt) && takes_as_much && !is_outdone(case, standing, &contender.held, &most.held)
    };
    let place = |index: &usize| {
        let contains = Catalogue::is_contained(&first, &entries[*index].name());
        (*index != winner, *index != best, contains, entries[*index].doubt == Some(Doubt::Trap))
    };
    let mut group: Vec<usize> =
        (0..entries.len()).filter(|index| [winner, best].contains(index) || is_near(index)).collect();
    group.sort_by_key(place);
    let names: Vec<String> = group.into_iter().take(TIED).map(|index| entries[index].name()).collect();
    if names.len() > 1 { vec![names] } else { Vec::new() }
}

/// Whether one effect beats another by what an effect must beat its absence by: a gain worth the word that is no
/// chance, or a large one in every window.
fn is_outdone(case: &Case, standing: &Standing, other: &HeldOut, best: &HeldOut) -> bool {
    let chance = standing.blocks.p_values(&[standing.blocks.gains(&case.record, other, best)]).map(|values| values[0]);
    doubt_of_gain(other, best, chance, &standing.floor).is_none()
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
