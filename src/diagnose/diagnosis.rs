//! Which physical effect a model lacks.
//!
//! The model's form is fitted, every candidate of the catalogue is put to the score test, the best of them join the law. What decides: the
//! likelihood gained, its chance among all that were tried, whether physics allows the sign, whether the other coefficients stay
//! plausible, and how much of what the law leaves unexplained goes away. Where that is too little, a second and a third effect are
//! sought before the answer is that the catalogue does not have it.

use super::conclude::{Answer, conclude};
use super::errors::{Left, Windows};
use super::fit::{Fit, Form, fit, refit};
use super::judge::{Trial, p_value};
use super::massless::massless;
use super::piece::Piece;
use super::place::{Removal, place};
use super::search::search;
use super::sound::{Sound, is_physical};
use super::variants::same_effect;
use crate::identify::Recording;
use crate::law::{Catalogue, Expression, Given, Hold, Model, Term};

/// Chance, shared among all candidates tried, below which a gain is none.
pub const LEVEL: f64 = 0.01;

/// Part by which error energy may exceed the sensors' noise in a law that is adequate.
const TOLERATED: f64 = 0.02;

/// Log-likelihood, nats, that an error of the law must gain to be one.
const EVIDENT: f64 = 6.0;

/// What a diagnosis comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// An effect is missing.
    Missing,
    /// The law explains its record.
    Adequate,
    /// Something is missing that the catalogue does not have.
    Unexplained,
}

/// A candidate that was tried in the law.
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
    /// Std of it.
    pub std: f64,
    /// Held-out error without it …
    pub error_before: f64,
    /// … and with it.
    pub error_after: f64,
    /// Probability of a gain this large by chance, all candidates counted.
    pub p_value: f64,
    /// Log-likelihood gained, nats.
    pub gain: f64,
    /// Share of the unexplained acceleration's energy that it takes away.
    pub share: f64,
    /// Whether physics allows the sign of its coefficient.
    pub physical: bool,
    /// Whether the other coefficients keep the signs that physics allows them.
    pub plausible: bool,
    /// Where it removes error.
    pub place: Option<Removal>,
}

/// A diagnosis of one law on a set of recordings.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// What it comes to.
    pub finding: Finding,
    /// The effect that is missing.
    pub effect: Option<String>,
    /// The candidates that were tried in the law, best first.
    pub candidates: Vec<Candidate>,
    /// Candidates that this record cannot tell apart, the best first.
    pub indistinguishable: Vec<Vec<String>>,
    /// Effects that are missing beside the first.
    pub beside: Vec<String>,
    /// The law as it is, fitted.
    pub base: Fit,
    /// The law with all effects that are missing.
    pub improved: Option<Trial>,
    /// Candidates tried, inner parameters counted apart.
    pub tried: usize,
    /// Share of what is unexplained that the effects found explain together.
    pub explained: f64,
    /// Length of the windows of the errors, s.
    pub window: f64,
}

/// A problem to be diagnosed: recordings, and the pieces of them that have no gap.
pub struct Evidence<'a> {
    /// The recordings, each with what its excitation did between samples.
    pub recordings: Vec<(&'a Recording, Hold)>,
    /// Their pieces.
    pub pieces: Vec<Piece>,
}

impl<'a> Evidence<'a> {
    /// Cuts recordings at their gaps.
    pub fn new(recordings: &[(&'a Recording, Hold)]) -> Evidence<'a> {
        let pieces = recordings.iter().flat_map(|(recording, hold)| Piece::all(recording, *hold)).collect();
        Evidence { recordings: recordings.to_vec(), pieces }
    }

    /// Whether any recording has an excitation.
    pub fn forced(&self) -> bool {
        self.recordings.iter().any(|(recording, _)| recording.channels().excitation)
    }
}

/// The model's form with its best coefficients: "maybe" terms only where the record speaks for them.
///
/// None where the record determines no law: too short, no motion.
pub fn best_of_form(model: &Model, evidence: &Evidence) -> Option<Fit> {
    best(model, evidence, |_| None)
}

/// The same with the model's numbers held.
pub fn best_as_given(model: &Model, evidence: &Evidence) -> Option<Fit> {
    best(model, evidence, |given| match given {
        Given::Known(value) => Some(value),
        _ => None,
    })
}

fn best(model: &Model, evidence: &Evidence, held: impl Fn(Given) -> Option<f64>) -> Option<Fit> {
    let forced = evidence.forced();
    let held = |term: Term, given: Given| match (term, given) {
        (Term::Inertia, Given::Known(value)) if !forced => Some(value),
        (Term::Inertia, _) if !forced => Some(1.0),
        _ => held(given),
    };
    let form = Form {
        terms: model.terms.iter().map(|entry| entry.term).collect(),
        held: model.terms.iter().map(|entry| held(entry.term, entry.given)).collect(),
        open: model.terms.iter().map(|entry| entry.open.clone()).collect(),
        expressions: model.expressions.clone(),
    };
    let mut fitted = fit(&form, &evidence.pieces)?;
    let maybe: Vec<Term> =
        model.terms.iter().filter(|entry| entry.given == Given::Maybe).map(|entry| entry.term).collect();
    while let Some(smaller) = without_weakest(&fitted, &maybe, &evidence.pieces) {
        fitted = smaller;
    }
    Some(fitted)
}

/// The fit without its least significant "maybe" term, where that is worth less than ln N.
fn without_weakest(fitted: &Fit, maybe: &[Term], pieces: &[Piece]) -> Option<Fit> {
    let price = (2.0 * fitted.measurements.max(2.0).ln()).sqrt();
    let worth = |index: usize| fitted.coefficients[index].abs() / fitted.std(index);
    let open = (0..fitted.form.terms.len()).filter(|index| maybe.contains(&fitted.form.terms[*index]));
    let weakest = open.map(|index| (index, worth(index))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    if weakest.1 > price {
        return None;
    }
    let form = fitted.form.without(weakest.0);
    let mut coefficients = fitted.coefficients.clone();
    coefficients.remove(weakest.0);
    refit(&form, pieces, &coefficients, fitted.noise)
}

/// Every candidate: the catalogue, and the user's own effects.
pub fn candidates(expressions: &[Expression]) -> Vec<Term> {
    let own = (0..expressions.len()).map(|index| Term::Expression(index as u8));
    Catalogue::ENTRIES.iter().map(|entry| entry.term).chain(own).collect()
}

/// Diagnoses a model: its form with its best coefficients.
///
/// None where the record determines no law of the model's form.
pub fn diagnose_model(model: &Model, evidence: &Evidence) -> Option<Diagnosis> {
    let base = best_of_form(model, evidence);
    base.map_or_else(|| massless(model, evidence), |base| Some(diagnose(&base, evidence)))
}

/// One candidate in the list of a law that nothing else was tried in, and the length of its windows, s.
pub(super) fn listed(base: &Fit, trial: &Trial, evidence: &Evidence) -> (Vec<Candidate>, f64) {
    let sound = Sound::new(base, &evidence.pieces);
    let listed = Listed { base, pairs: vec![(base, &trial.fit, trial.fit.form.terms.len() - 1)] };
    let described = listed.describe(evidence, &sound, 1);
    (described.candidates, described.window)
}

/// Diagnoses a fitted law.
pub fn diagnose(base: &Fit, evidence: &Evidence) -> Diagnosis {
    let candidates = candidates(&base.form.expressions);
    let found = search(base, &evidence.pieces, &candidates);
    let sound = Sound::new(base, &evidence.pieces);
    let singles = sound.ranked(found.singles());
    let doubtful = singles.first().filter(|first| !is_evident(base) && first.p_value(found.tried) < LEVEL);
    if let Some(better) = doubtful.and_then(|first| first.same_without(base, &evidence.pieces)) {
        return diagnose(&better, evidence);
    }
    let answer = conclude(base, evidence, &found, &singles, &sound);
    let listed = Listed::new(base, &answer, &singles, &sound);
    let described = listed.describe(evidence, &sound, found.tried);
    let name = |term: Term| base.form.effect_name(term);
    let missing = answer.finding == Finding::Missing;
    let named: Vec<String> = answer.members.iter().map(|member| name(member.term)).collect();
    Diagnosis {
        finding: answer.finding,
        effect: named.first().cloned(),
        beside: named.into_iter().skip(1).collect(),
        indistinguishable: answer.ties,
        explained: answer.explained,
        improved: answer.best.filter(|_| missing),
        base: base.clone(),
        tried: found.tried,
        window: described.window,
        candidates: described.candidates,
    }
}

/// What is to be listed: a law without the term of that position, and with it.
struct Listed<'a> {
    base: &'a Fit,
    pairs: Vec<(&'a Fit, &'a Fit, usize)>,
}

struct Described {
    candidates: Vec<Candidate>,
    window: f64,
}

impl<'a> Listed<'a> {
    /// The members of the answer, then the candidates alone; not those that neither physics nor the law bears: they are numbers run wild.
    fn new(base: &'a Fit, answer: &'a Answer, singles: &'a [Trial], sound: &Sound) -> Listed<'a> {
        let together = answer.best.iter().filter(|best| best.count > 1).flat_map(|best| {
            let position = |term: Term| best.fit.form.terms.iter().position(|other| *other == term);
            answer.members.iter().filter_map(move |member| Some((&member.without, &best.fit, position(member.term)?)))
        });
        let is_listed = |trial: &&Trial| match &answer.best {
            Some(best) if best.count > 1 => !best.terms().iter().any(|term| same_effect(*term, trial.term())),
            _ => true,
        };
        let is_wild = |trial: &&Trial| {
            !is_physical(&trial.fit, trial.fit.form.terms.len() - 1) && !sound.is_plausible(&trial.fit)
        };
        let tame = singles.iter().filter(|trial| !is_wild(trial));
        let alone = tame.filter(is_listed).map(|trial| (base, &trial.fit, trial.fit.form.terms.len() - 1));
        Listed { base, pairs: together.chain(alone).collect() }
    }

    fn describe(&self, evidence: &Evidence, sound: &Sound, tried: usize) -> Described {
        let windows = self.windows(evidence);
        let error = |fit: &Fit| windows.error(fit, &evidence.pieces);
        let mut last: Option<(&Fit, (f64, Vec<Left>))> = None;
        let candidates = self.pairs.iter().map(|(without, with, index)| {
            let known = last.take().filter(|(fit, _)| std::ptr::eq(*fit, *without));
            let (fit, (before, left)) = known.unwrap_or_else(|| (*without, error(without)));
            let (after, remaining) = error(with);
            let place = place(&left, &remaining);
            last = Some((fit, (before, left)));
            describe(without, with, *index, [before, after], place, sound, tried)
        });
        Described { candidates: candidates.collect(), window: windows.length }
    }

    /// Windows with every term of every law.
    fn windows(&self, evidence: &Evidence) -> Windows {
        let mut terms = self.base.form.terms.clone();
        for term in self.pairs.iter().flat_map(|(without, with, _)| without.form.terms.iter().chain(&with.form.terms)) {
            if !terms.contains(term) {
                terms.push(*term);
            }
        }
        Windows::new(&evidence.recordings, terms, self.base.form.terms.len(), &self.base.form.expressions)
    }
}

impl Candidate {
    /// Whether it is significant, and physics allows it.
    pub fn is_missing(&self) -> bool {
        self.p_value < LEVEL && self.physical && self.plausible
    }
}

/// Whether the record speaks for an error of the law, worth the word or not.
pub(super) fn is_doubtful(fit: &Fit) -> bool {
    fit.lack() > EVIDENT
}

/// Whether the record speaks for an error of the law that is worth the word.
pub fn is_evident(fit: &Fit) -> bool {
    is_error(fit.lack(), fit.measurements)
}

/// Whether so much log-likelihood, nats, in so many measurements is that of an error worth the word.
pub(super) fn is_error(lack: f64, measurements: f64) -> bool {
    lack > EVIDENT && relative(lack, measurements) > TOLERATED
}

/// Part by which the law's error exceeds the sensors' noise, as energy of its innovations.
pub fn excess(fit: &Fit) -> f64 {
    relative(fit.lack(), fit.measurements)
}

fn relative(lack: f64, measurements: f64) -> f64 {
    (2.0 * lack / measurements.max(1.0)).exp() - 1.0
}

/// Share of the unexplained acceleration that goes away between two fits.
pub(super) fn share(base: &Fit, fit: &Fit) -> f64 {
    let inertia = |fit: &Fit| {
        let position = fit.form.terms.iter().position(|term| *term == Term::Inertia);
        position.map_or(1.0, |index| fit.coefficients[index])
    };
    let unexplained = |fit: &Fit| if is_doubtful(fit) { inertia(fit).powi(2) * fit.noise.process } else { 0.0 };
    let before = inertia(base).powi(2) * base.noise.process;
    if before > 0.0 && is_evident(base) { (1.0 - unexplained(fit) / before).clamp(0.0, 1.0) } else { 1.0 }
}

/// The effect id of a term, or its canonical name.
pub fn effect_name(term: Term) -> String {
    Catalogue::of(term).map_or_else(|| term.name(), |entry| entry.id.into())
}

fn describe(
    without: &Fit,
    with: &Fit,
    index: usize,
    error: [f64; 2],
    place: Option<Removal>,
    sound: &Sound,
    tried: usize,
) -> Candidate {
    let term = with.form.terms[index];
    let inner = match term {
        Term::Effect(effect) => {
            let names = effect.inner().iter().map(|parameter| parameter.name.to_string());
            names.zip(effect.inner_values()).collect()
        }
        _ => Vec::new(),
    };
    let gain = with.log_likelihood - without.log_likelihood;
    Candidate {
        effect: with.form.effect_name(term),
        term,
        coefficient: with.coefficients[index],
        std: with.std(index),
        error_before: error[0],
        error_after: error[1],
        p_value: p_value(gain, inner.len(), with.measurements, tried),
        inner,
        gain,
        share: share(without, with),
        physical: is_physical(with, index),
        plausible: sound.is_plausible(with),
        place,
    }
}
