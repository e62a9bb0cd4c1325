//! From the whole catalogue to a few candidates in the law.

use super::fit::{Fit, refit};
use super::judge::Trial;
use super::piece::{Piece, thinned};
use super::screen::{Gain, screen};
use super::variants::{Scale, Variant, same_effect, variants};
use crate::law::Term;

/// Rounds in which the grid of inner parameters is narrowed.
const ROUNDS: usize = 3;

/// Effects whose inner parameters are honed.
const HONED: usize = 8;

/// Effects that get into the law.
const FINALISTS: usize = 5;

/// Inner parameters are fitted where the gain is this part of the largest: theirs will not make up for more.
const WITHIN_REACH: f64 = 0.6;

/// Samples by which a long record is searched first.
const PREVIEW: usize = 8000;

/// Part of the best gain on the preview that brings a candidate before the whole record in any case.
const NEARLY: f64 = 0.9;

/// What a search came to.
#[derive(Clone, Debug)]
pub struct Search {
    /// The best candidates in the law, best first.
    pub trials: Vec<Trial>,
    /// What the others would gain by the score test, best first.
    pub others: Vec<(Variant, Gain)>,
    /// Candidates looked at, inner parameters counted apart.
    pub tried: usize,
}

/// Looks for what the fitted law lacks among the candidates.
///
/// A long record is searched by parts of it; candidates that are clearly worse there need not be tried on all of it.
pub fn search(base: &Fit, pieces: &[Piece], candidates: &[Term]) -> Search {
    let few = thinned(pieces, PREVIEW);
    let short =
        if total(&few) < total(pieces) { refit(&base.form, &few, &base.coefficients, base.noise) } else { None };
    let Some(short) = short else { return search_whole(base, pieces, candidates) };
    let mut found = search_whole(&short, &few, candidates);
    let Some(best) = found.trials.first().cloned() else { return found };
    let variants: Vec<(Variant, Gain)> = found
        .trials
        .iter()
        .filter(|trial| !best.is_clearly_better_than(trial) || trial.gain > NEARLY * best.gain)
        .map(|trial| (Variant { term: trial.term, spacing: 1.0 }, trial.as_gain()))
        .collect();
    found.trials = tried(base, pieces, &variants);
    found
}

fn total(pieces: &[Piece]) -> usize {
    pieces.iter().map(Piece::len).sum()
}

fn search_whole(base: &Fit, pieces: &[Piece], candidates: &[Term]) -> Search {
    let scale = Scale::of(pieces, &base.states);
    let all = variants(candidates, &base.form.terms, &scale);
    let count = all.len();
    let mut best = leaders(base, pieces, &all);
    for _ in 0..ROUNDS {
        let (head, tail) = best.split_at(best.len().min(HONED));
        let narrowed: Vec<Variant> = head.iter().flat_map(|(variant, _)| variant.neighbours()).collect();
        let tail = tail.to_vec();
        best = leaders(base, pieces, &narrowed);
        best.extend(tail);
    }
    let others = best.split_off(best.len().min(FINALISTS));
    Search { trials: tried(base, pieces, &best), others, tried: count }
}

/// The variants in the law, best first.
fn tried(base: &Fit, pieces: &[Piece], variants: &[(Variant, Gain)]) -> Vec<Trial> {
    let mut trials: Vec<Trial> =
        variants.iter().filter_map(|(variant, gain)| Trial::of(base, pieces, *variant, gain)).collect();
    let leader = trials.iter().map(|trial| trial.gain).fold(0.0, f64::max);
    trials.iter_mut().filter(|trial| trial.gain >= WITHIN_REACH * leader).for_each(|trial| trial.polish(pieces));
    trials.sort_by(|a, b| b.merit().total_cmp(&a.merit()));
    trials
}

/// The best variant of each effect, best first.
fn leaders(base: &Fit, pieces: &[Piece], all: &[Variant]) -> Vec<(Variant, Gain)> {
    let terms: Vec<Term> = all.iter().map(|variant| variant.term).collect();
    let gains = screen(base, pieces, &terms);
    let mut ranked: Vec<(Variant, Gain)> = all.iter().copied().zip(gains).collect();
    ranked.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
    let mut leaders: Vec<(Variant, Gain)> = Vec::new();
    for entry in ranked {
        if !leaders.iter().any(|(leader, _)| same_effect(leader.term, entry.0.term)) {
            leaders.push(entry);
        }
    }
    leaders
}
