//! From the whole catalogue to a few candidates in the law.

use super::fit::Fit;
use super::judge::Trial;
use super::piece::Piece;
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
pub fn search(base: &Fit, pieces: &[Piece], candidates: &[Term]) -> Search {
    let scale = Scale::of(pieces, &base.states);
    let all = variants(candidates, &base.form.terms, &scale);
    let tried = all.len();
    let mut best = leaders(base, pieces, &all);
    for _ in 0..ROUNDS {
        let (head, tail) = best.split_at(best.len().min(HONED));
        let narrowed: Vec<Variant> = head.iter().flat_map(|(variant, _)| variant.neighbours()).collect();
        let tail = tail.to_vec();
        best = leaders(base, pieces, &narrowed);
        best.extend(tail);
    }
    let others = best.split_off(best.len().min(FINALISTS));
    let mut trials: Vec<Trial> =
        best.iter().filter_map(|(variant, gain)| Trial::of(base, pieces, *variant, gain)).collect();
    let leader = trials.iter().map(|trial| trial.gain).fold(0.0, f64::max);
    trials.iter_mut().filter(|trial| trial.gain >= WITHIN_REACH * leader).for_each(|trial| trial.polish(pieces));
    trials.sort_by(|a, b| b.merit().total_cmp(&a.merit()));
    Search { trials, others, tried }
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
