//! The answer: one effect, several together, nothing, or nothing that the catalogue has.
//!
//! The smallest set of candidates that leaves no evident error is the answer. On real records no set may: then the best single effect is
//! one if it explains most of what is missing, then the best set if it explains nearly all.

use super::diagnosis::{Evidence, Finding, LEVEL, is_evident, share};
use super::fit::{Fit, refit};
use super::judge::{Trial, p_value};
use super::search::Search;
use super::sound::Sound;
use super::variants::same_effect;
use crate::law::Term;

/// Share of what is unexplained that one effect must explain to be the answer though error is left.
const ENOUGH: f64 = 0.75;

/// The same of several effects together, which have more freedom.
const ENOUGH_TOGETHER: f64 = 0.95;

/// Effects that may be missing together.
const DEPTH: usize = 3;

/// An effect of the answer.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub(super) term: Term,
    /// The law with the answer's other effects alone.
    pub(super) without: Fit,
}

/// What a diagnosis comes to.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    pub(super) finding: Finding,
    /// The law with all effects of the answer.
    pub(super) best: Option<Trial>,
    /// The effects of the answer, the weightiest first.
    pub(super) members: Vec<Member>,
    /// Effects that this record cannot tell apart.
    pub(super) ties: Vec<Vec<String>>,
    /// Share of what is unexplained that the best explains.
    pub(super) explained: f64,
}

/// Concludes from the candidates alone, ranked, and where they leave error from sets of them.
pub(super) fn conclude(base: &Fit, evidence: &Evidence, found: &Search, singles: &[Trial], sound: &Sound) -> Answer {
    let significant = |trial: &&Trial| trial.p_value(found.tried) < LEVEL && sound.is(trial);
    let first = singles.first().filter(significant);
    if !is_evident(base) && first.is_none() {
        return nothing(Finding::Adequate, 0.0);
    }
    if let Some(first) = first.filter(|first| !is_evident(&first.fit)) {
        return alone(base, first, singles, sound);
    }
    let explained = |trial: &Trial| share(base, &trial.fit);
    let enough = first.filter(|first| explained(first) >= ENOUGH);
    // beside one effect that is enough, only a set that leaves nothing could be the answer
    let explains: &Explains = if enough.is_some() { &leaves_nothing } else { &explains };
    let mut reached: Vec<(Trial, Vec<Member>)> = Vec::new();
    for size in 2..=DEPTH {
        let (trials, best) = together(base, evidence, found, sound, (size, explains));
        if enough.is_some() && trials.is_empty() {
            break;
        }
        let Some((trial, members)) = best else { continue };
        if !is_evident(&trial.fit) {
            return several(base, trial, members, &trials, sound);
        }
        reached.push((trial, members));
    }
    if let Some(first) = enough {
        return alone(base, first, singles, sound);
    }
    let most = reached.into_iter().max_by(|a, b| a.0.merit().total_cmp(&b.0.merit()));
    match most {
        Some((trial, members)) => several(base, trial, members, &[], sound),
        None => nothing(Finding::Unexplained, first.map_or(0.0, explained)),
    }
}

/// Whether a law with several candidates leaves no evident error, or next to none.
fn explains(base: &Fit, fit: &Fit) -> bool {
    leaves_nothing(base, fit) || share(base, fit) >= ENOUGH_TOGETHER
}

fn leaves_nothing(_: &Fit, fit: &Fit) -> bool {
    !is_evident(fit)
}

fn nothing(finding: Finding, explained: f64) -> Answer {
    Answer { finding, best: None, members: Vec::new(), ties: Vec::new(), explained }
}

/// One effect, and those that could stand in its place.
fn alone(base: &Fit, first: &Trial, singles: &[Trial], sound: &Sound) -> Answer {
    let name = |trial: &Trial| trial.fit.form.effect_name(trial.term());
    let tied = singles.iter().filter(|trial| {
        let other = !same_effect(trial.term(), first.term()) && !trial.is_at_the_end_of(first);
        other && sound.is(trial) && !first.is_clearly_better_than(trial)
    });
    let group: Vec<String> = std::iter::once(first).chain(tied).map(name).collect();
    Answer {
        finding: Finding::Missing,
        best: Some(first.clone()),
        members: vec![Member { term: first.term(), without: base.clone() }],
        ties: if group.len() > 1 { vec![group] } else { Vec::new() },
        explained: share(base, &first.fit),
    }
}

/// Several effects, and what could stand in the place of one of them.
fn several(base: &Fit, best: Trial, members: Vec<Member>, others: &[Trial], sound: &Sound) -> Answer {
    let explained = share(base, &best.fit);
    let tied = others.iter().filter(|other| sound.is(other) && !best.is_clearly_better_than(other));
    let mut ties: Vec<Vec<String>> = Vec::new();
    for (own, other) in tied.filter_map(|other| replaced(&best, other)) {
        match ties.iter_mut().find(|group| group[0] == own) {
            Some(group) => group.push(other),
            None => ties.push(vec![own, other]),
        }
    }
    Answer { finding: Finding::Missing, best: Some(best), members, ties, explained }
}

/// The one effect in which two sets differ, in this and in the other; none where they differ in several, or in none.
fn replaced(one: &Trial, other: &Trial) -> Option<(String, String)> {
    let name = |trial: &Trial, term: Term| trial.fit.form.effect_name(term);
    let absent = |trial: &Trial, from: &Trial| -> Vec<String> {
        let has = |term: &Term| from.terms().iter().any(|other| same_effect(*term, *other));
        trial.terms().iter().filter(|term| !has(term)).map(|term| name(trial, *term)).collect()
    };
    match (absent(one, other).as_slice(), absent(other, one).as_slice()) {
        ([own], [other]) => Some((own.clone(), other.clone())),
        _ => None,
    }
}

/// Whether a law with several candidates explains what the one without them does not.
type Explains<'a> = dyn Fn(&Fit, &Fit) -> bool + 'a;

/// Sets of candidates in the law, and the best of them with its members.
type Sets = (Vec<Trial>, Option<(Trial, Vec<Member>)>);

/// All sets of that size in the law, and the best sound one of which each member is significant.
fn together(
    base: &Fit,
    evidence: &Evidence,
    found: &Search,
    sound: &Sound,
    (size, explains): (usize, &Explains),
) -> Sets {
    let trials = found.sets(size, explains);
    let needed = |trial: &Trial| {
        if !explains(base, &trial.fit) {
            return None;
        }
        let members = members(base, trial, evidence)?;
        let counts = |(member, gain): &(Member, f64)| {
            let inner = member.term.effect().map_or(0, |effect| effect.inner().len());
            p_value(*gain, inner, trial.fit.measurements, found.tried) < LEVEL
        };
        members.iter().all(counts).then(|| members.into_iter().map(|(member, _)| member).collect())
    };
    let mut sets = trials.iter().filter(|trial| sound.is(trial));
    let best = sets.find_map(|trial| Some((trial.clone(), needed(trial)?)));
    (trials, best)
}

/// The members of a set and what is lost without each, the weightiest first.
fn members(base: &Fit, trial: &Trial, evidence: &Evidence) -> Option<Vec<(Member, f64)>> {
    let first = trial.fit.form.terms.len() - trial.count;
    let without = |index: usize| {
        let mut coefficients = trial.fit.coefficients.clone();
        coefficients.remove(index);
        let fit = refit(&trial.fit.form.without(index), &evidence.pieces, &coefficients, base.noise)?;
        let lost = trial.fit.log_likelihood - fit.log_likelihood;
        Some((Member { term: trial.fit.form.terms[index], without: fit }, lost))
    };
    let mut members = (first..first + trial.count).map(without).collect::<Option<Vec<_>>>()?;
    members.sort_by(|a, b| b.1.total_cmp(&a.1));
    Some(members)
}
