//! From the whole catalogue to a few candidates in the law, alone and together.
//!
//! A long record is searched by parts of it; candidates that are clearly worse there need not be tried on all of it.

use super::diagnosis::is_evident;
use super::fit::{Fit, refit};
use super::judge::Trial;
use super::piece::{Piece, thinned};
use super::proposal::{Proposal, Proposals, propose};
use crate::law::Term;

/// Sets of one, two and three candidates that get into the law.
const FINALISTS: [usize; 3] = [5, 3, 2];

/// Candidates that get into a law that leaves no evident error.
const DOUBTED: usize = 3;

/// Samples by which a long record is searched first.
const PREVIEW: usize = 8000;

/// Part of the best gain on the preview that brings a candidate before the whole record in any case.
const NEARLY: f64 = 0.9;

/// A law, its record, and what the candidates promise.
#[derive(Clone, Debug)]
pub struct Search<'a> {
    base: &'a Fit,
    pieces: &'a [Piece],
    /// Parts of a long record, and the law fitted to them.
    short: Option<(Fit, Vec<Piece>)>,
    proposals: Proposals,
    /// Candidates looked at, inner parameters counted apart.
    pub tried: usize,
}

/// Looks for what the fitted law lacks among the candidates.
pub fn search<'a>(base: &'a Fit, pieces: &'a [Piece], candidates: &[Term]) -> Search<'a> {
    let few = thinned(pieces, PREVIEW);
    let shortened = total(&few) < total(pieces);
    let fitted = if shortened { refit(&base.form, &few, &base.coefficients, base.noise) } else { None };
    let short = fitted.map(|fit| (fit, few));
    let proposals = match &short {
        Some((fit, few)) => propose(fit, few, candidates),
        None => propose(base, pieces, candidates),
    };
    let tried = proposals.tried;
    Search { base, pieces, short, proposals, tried }
}

impl Search<'_> {
    /// The best candidates alone in the law, best first.
    pub fn singles(&self) -> Vec<Trial> {
        self.trials(1, &|_, _| true)
    }

    /// The best sets of so many candidates in the law, two or three, best first. On a long record a set gets there only if it `explains`
    /// the parts of it that are looked at first, told by the laws without and with it.
    pub fn sets(&self, size: usize, explains: &dyn Fn(&Fit, &Fit) -> bool) -> Vec<Trial> {
        self.trials(size, explains)
    }

    fn trials(&self, size: usize, explains: &dyn Fn(&Fit, &Fit) -> bool) -> Vec<Trial> {
        let finalists = if is_evident(self.base) { FINALISTS[size.clamp(1, 3) - 1] } else { DOUBTED };
        let few: Vec<Proposal> = self.proposals.of(size).iter().take(finalists).cloned().collect();
        let Some((fit, pieces)) = &self.short else { return tried(self.base, self.pieces, &few) };
        let trials = tried(fit, pieces, &few);
        let Some(best) = trials.first() else { return trials };
        let near = |trial: &&Trial| !best.is_clearly_better_than(trial) || trial.gain > NEARLY * best.gain;
        let other = |trial: &&Trial| !trials.iter().any(|simpler| trial.is_at_the_end_of(simpler));
        let left = trials.iter().filter(near).filter(other).filter(|trial| explains(fit, &trial.fit));
        let mut whole: Vec<Trial> = left.filter_map(|trial| trial.on(self.base, self.pieces)).collect();
        rank(&mut whole);
        whole
    }
}

fn total(pieces: &[Piece]) -> usize {
    pieces.iter().map(Piece::len).sum()
}

/// The sets in the law, best first.
fn tried(base: &Fit, pieces: &[Piece], proposals: &[Proposal]) -> Vec<Trial> {
    let mut trials: Vec<Trial> = proposals.iter().filter_map(|proposal| Trial::of(base, pieces, proposal)).collect();
    rank(&mut trials);
    trials
}

fn rank(trials: &mut [Trial]) {
    trials.sort_by(|a, b| b.merit().total_cmp(&a.merit()));
}
