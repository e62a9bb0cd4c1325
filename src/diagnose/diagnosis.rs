//! Which physical effect a model lacks.
//!
//! The model's form is fitted, every candidate of the catalogue is put to the score test, the best of them join the law. What decides: the
//! likelihood gained, its chance among all that were tried, whether physics allows the sign, whether the other coefficients stay
//! plausible, and how much of what the law leaves unexplained goes away. Where that is too little, a second and a third effect are
//! sought before the answer is that the catalogue does not have it.

use super::errors::{Left, Windows};
use super::fit::{Fit, Form, fit, refit};
use super::judge::Trial;
use super::piece::Piece;
use super::search::{Search, search};
use crate::identify::Recording;
use crate::law::{Catalogue, Effect, Expression, Given, Hold, Model, Term};

/// Chance, shared among all candidates tried, below which a gain is none.
pub const LEVEL: f64 = 0.01;

/// Share of what is unexplained that effects of the catalogue must explain for them to be the answer.
const ENOUGH: f64 = 0.75;

/// Factor by which a coefficient must not grow when a candidate joins: both would be large and of opposite sign.
const CANCELLING: f64 = 4.0;

/// Share that a first effect must explain for a second to be sought.
const PROMISING: f64 = 0.05;

/// Part by which error energy may exceed the sensors' noise in a law that is adequate.
const TOLERATED: f64 = 0.02;

/// Log-likelihood, nats, that an error of the law must gain to be one.
const EVIDENT: f64 = 6.0;

/// Effects that may be missing together.
const DEPTH: usize = 3;

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
    /// Where it removes error, one sentence.
    pub place: Option<String>,
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
    /// The law with the effect that is missing.
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

/// Diagnoses a fitted law.
pub fn diagnose(base: &Fit, evidence: &Evidence) -> Diagnosis {
    let candidates = candidates(&base.form.expressions);
    let found = search(base, &evidence.pieces, &candidates);
    let ranked = ranked(base, &found);
    let windows = windows(base, &ranked, evidence);
    let (before, left) = windows.error(base, &evidence.pieces);
    let describe = |trial: &Trial| {
        let (after, remaining) = windows.error(&trial.fit, &evidence.pieces);
        describe(base, trial, found.tried, [before, after], place(&left, &remaining))
    };
    let listed: Vec<Candidate> = ranked.iter().map(describe).collect();
    let mut diagnosis = Diagnosis {
        finding: Finding::Adequate,
        effect: None,
        indistinguishable: Vec::new(),
        beside: Vec::new(),
        base: base.clone(),
        improved: None,
        tried: found.tried,
        explained: 0.0,
        window: windows.length,
        candidates: listed,
    };
    let first = diagnosis.candidates.first().is_some_and(Candidate::is_missing);
    match ranked.into_iter().next().filter(|_| first) {
        Some(best) => conclude(&mut diagnosis, best, &found, evidence, &candidates),
        None if is_evident(base) => diagnosis.finding = Finding::Unexplained,
        None => {}
    }
    diagnosis
}

impl Candidate {
    /// Whether it is significant, and physics allows it.
    pub fn is_missing(&self) -> bool {
        self.p_value < LEVEL && self.physical && self.plausible
    }
}

/// Whether the record speaks for an error of the law that is worth the word.
pub fn is_evident(fit: &Fit) -> bool {
    fit.lack() > EVIDENT && excess(fit) > TOLERATED
}

/// Part by which the law's error exceeds the sensors' noise, as energy of its innovations.
pub fn excess(fit: &Fit) -> f64 {
    (2.0 * fit.lack() / fit.measurements.max(1.0)).exp() - 1.0
}

/// Trials with the physical and plausible ones first; among those that the record cannot tell apart the simplest.
fn ranked(base: &Fit, found: &Search) -> Vec<Trial> {
    let (mut sound, unsound): (Vec<Trial>, Vec<Trial>) =
        found.trials.iter().cloned().partition(|trial| is_physical(trial) && is_plausible(base, trial));
    if let Some(best) = sound.first().cloned() {
        let tied = (0..sound.len()).filter(|index| !best.is_clearly_better_than(&sound[*index]));
        let simplest = tied.min_by_key(|index| (sound[*index].inner_count(), *index)).unwrap_or(0);
        let contained = |index: usize| Catalogue::is_contained(&name(&sound[index]), &name(&best));
        if sound[simplest].inner_count() < best.inner_count() || contained(simplest) {
            let simplest = sound.remove(simplest);
            sound.insert(0, simplest);
        }
    }
    sound.extend(unsound);
    sound
}

fn name(trial: &Trial) -> String {
    trial.fit.form.effect_name(trial.term)
}

/// The effect id of a term, or its canonical name.
pub fn effect_name(term: Term) -> String {
    Catalogue::of(term).map_or_else(|| term.name(), |entry| entry.id.into())
}

fn is_physical(trial: &Trial) -> bool {
    Catalogue::of(trial.term).is_none_or(|entry| entry.sign.allows(trial.coefficient()))
}

/// Whether no other coefficient turned to a sign that physics does not allow it, by more than its std, or grew so much that it and the
/// candidate must cancel.
fn is_plausible(base: &Fit, trial: &Trial) -> bool {
    let spoilt = |index: usize| {
        let allowed = |value: f64| Catalogue::of(base.form.terms[index]).is_none_or(|entry| entry.sign.allows(value));
        let (old, new, std) = (base.coefficients[index], trial.fit.coefficients[index], trial.fit.std(index));
        let turned = allowed(old) && !allowed(new) && new.abs() > 2.0 * std;
        turned || (old.abs() > 3.0 * base.std(index) && new.abs() > CANCELLING * old.abs())
    };
    !(0..base.form.terms.len()).any(spoilt)
}

/// Share of the unexplained acceleration that goes away between two fits.
fn share(base: &Fit, fit: &Fit) -> f64 {
    let inertia = |fit: &Fit| {
        let position = fit.form.terms.iter().position(|term| *term == Term::Inertia);
        position.map_or(1.0, |index| fit.coefficients[index])
    };
    let unexplained = |fit: &Fit| if fit.lack() > EVIDENT { inertia(fit).powi(2) * fit.noise.process } else { 0.0 };
    let before = inertia(base).powi(2) * base.noise.process;
    if before > 0.0 && is_evident(base) { (1.0 - unexplained(fit) / before).clamp(0.0, 1.0) } else { 1.0 }
}

fn windows(base: &Fit, ranked: &[Trial], evidence: &Evidence) -> Windows {
    let own = base.form.terms.len();
    let terms = base.form.terms.iter().copied().chain(ranked.iter().map(|trial| trial.term)).collect();
    Windows::new(&evidence.recordings, terms, own, &base.form.expressions)
}

fn describe(base: &Fit, trial: &Trial, tried: usize, error: [f64; 2], place: Option<String>) -> Candidate {
    let inner = match trial.term {
        Term::Effect(effect) => {
            let names = effect.inner().iter().map(|parameter| parameter.name.to_string());
            names.zip(effect.inner_values()).collect()
        }
        _ => Vec::new(),
    };
    Candidate {
        effect: name(trial),
        term: trial.term,
        inner,
        coefficient: trial.coefficient(),
        std: trial.std(),
        error_before: error[0],
        error_after: error[1],
        p_value: trial.p_value(tried),
        gain: trial.gain,
        share: share(base, &trial.fit),
        physical: is_physical(trial),
        plausible: is_plausible(base, trial),
        place,
    }
}

/// The answer where a first effect is missing: it alone, it with others, or nothing that the catalogue has.
fn conclude(diagnosis: &mut Diagnosis, best: Trial, found: &Search, evidence: &Evidence, candidates: &[Term]) {
    let base = diagnosis.base.clone();
    let mut reached = best.fit.clone();
    for _ in 1..DEPTH {
        let explained = share(&base, &reached);
        if !is_evident(&reached) || !(PROMISING..ENOUGH).contains(&explained) {
            break;
        }
        let next = search(&reached, &evidence.pieces, candidates);
        let sound = ranked(&reached, &next).into_iter().next();
        let Some(next) = sound.filter(|trial| trial.p_value(next.tried) < LEVEL && is_physical(trial)) else { break };
        diagnosis.beside.push(name(&next));
        reached = next.fit;
    }
    diagnosis.explained = share(&base, &reached);
    if is_evident(&reached) && diagnosis.explained < ENOUGH {
        diagnosis.finding = Finding::Unexplained;
        diagnosis.beside.clear();
        return;
    }
    diagnosis.finding = Finding::Missing;
    diagnosis.effect = Some(name(&best));
    let others = found.trials.iter().filter(|trial| name(trial) != name(&best));
    let tied =
        others.filter(|trial| is_physical(trial) && is_plausible(&base, trial) && !best.is_clearly_better_than(trial));
    let group: Vec<String> = std::iter::once(name(&best)).chain(tied.map(name)).collect();
    if group.len() > 1 {
        diagnosis.indistinguishable.push(group);
    }
    diagnosis.improved = Some(best);
}

/// Where a candidate removes error: the third of the motion, by speed or by displacement, that holds most of what goes away.
fn place(before: &[Left], after: &[Left]) -> Option<String> {
    let removed: Vec<f64> = before.iter().zip(after).map(|(before, after)| before.squared - after.squared).collect();
    let total: f64 = removed.iter().sum();
    if total <= 0.0 || removed.len() < 12 {
        return None;
    }
    let mean = before.iter().map(|left| left.q).sum::<f64>() / before.len() as f64;
    let speeds: Vec<f64> = before.iter().map(|left| left.qd.abs()).collect();
    let excursions: Vec<f64> = before.iter().map(|left| (left.q - mean).abs()).collect();
    let thirds = [(&speeds, "|q̇|"), (&excursions, "|q − mean|")].into_iter().flat_map(|(values, symbol)| {
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let (low, high) = (sorted[sorted.len() / 3], sorted[2 * sorted.len() / 3]);
        let share = |inside: &dyn Fn(f64) -> bool| {
            let held = values.iter().zip(&removed).filter(|(value, _)| inside(**value));
            held.map(|(_, removed)| removed).sum::<f64>() / total
        };
        [
            (share(&|value| value < low), format!("where {symbol} < {low:.3}")),
            (share(&|value| value > high), format!("where {symbol} > {high:.3}")),
        ]
    });
    let best = thirds.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > 0.45).then(|| format!("{:.0} % of what it removes lies {}", 100.0 * best.0.min(1.0), best.1))
}

impl Trial {
    /// Number of inner parameters that were fitted.
    pub fn inner_count(&self) -> usize {
        self.term.effect().map_or(0, |effect: Effect| effect.inner().len())
    }
}
