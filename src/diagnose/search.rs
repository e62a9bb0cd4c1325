//! From the whole catalogue to a few candidates in the law, alone and together.
//!
//! A long record is searched by parts of it; candidates that are clearly worse there need not be tried on all of it.

use super::diagnosis::{is_doubtful, is_evident};
use super::fit::{Fit, refit};
use super::judge::{Trial, merit};
use super::piece::{Piece, thinned};
use super::proposal::{Proposal, Proposals, proposals, propose};
use super::variants::Variant;
use crate::law::{Catalogue, Term};

/// Sets of one, two and three candidates that get into the law.
const FINALISTS: [usize; 3] = [5, 3, 2];

/// Candidates that get into a law of which the record shows no error.
const DOUBTED: usize = 3;

/// Samples by which a long record is searched first.
const PREVIEW: usize = 8000;

/// Part of the best gain on the preview that brings a candidate before the whole record in any case.
const NEARLY: f64 = 0.9;

/// Part of what a set promises that explains the parts of a record below which others are not tried there.
const FAR: f64 = 0.8;

/// The same of a set that does not explain them.
const FAR_BEHIND: f64 = 0.5;

/// Sets that are fitted on a gentler way.
const COOLED: usize = 2;

/// Gain, nats, inner parameters paid for, that brings a candidate before a law that leaves no evident error.
const PROMISING: f64 = 3.0;

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

    /// Candidates for a law that leaves no evident error, on a long record: the best of them by the score test on all of it, and those that may be
    /// worth their inner parameters.
    fn doubted(&self, few: &[Proposal]) -> Vec<Trial> {
        let variants: Vec<Variant> = few.iter().flat_map(|proposal| &proposal.variants).copied().collect();
        let promised = proposals(self.base, self.pieces, &variants).single;
        let worth = |proposal: &Proposal| merit(proposal.gain, proposal.inner_count(), self.base.measurements);
        let best = promised.iter().map(worth).fold(f64::NEG_INFINITY, f64::max);
        let kept = promised.iter().filter(|proposal| worth(proposal) >= best.min(PROMISING));
        tried(self.base, self.pieces, &kept.cloned().collect::<Vec<_>>())
    }

    /// Whether an effect of the law contains the candidate: its inner parameters stand in for it, and hide what it would gain.
    fn is_part_of_the_law(&self, proposal: &Proposal) -> bool {
        let name = |term: Term| self.base.form.effect_name(term);
        let own = self.base.form.terms.iter().filter(|term| term.effect().is_some());
        proposal
            .variants
            .iter()
            .any(|one| own.clone().any(|term| Catalogue::is_contained(&name(one.term), &name(*term))))
    }

    fn trials(&self, size: usize, explains: &dyn Fn(&Fit, &Fit) -> bool) -> Vec<Trial> {
        let finalists = if is_doubtful(self.base) { FINALISTS[size.clamp(1, 3) - 1] } else { DOUBTED };
        let all = self.proposals.of(size);
        let rest = all.iter().skip(finalists).filter(|proposal| size == 1 && self.is_part_of_the_law(proposal));
        let few: Vec<Proposal> = all.iter().take(finalists).chain(rest).cloned().collect();
        let Some((fit, pieces)) = &self.short else { return tried(self.base, self.pieces, &few) };
        if size == 1 && !is_evident(self.base) {
            return self.doubted(&few);
        }
        let trials = previewed(fit, pieces, &few);
        let Some(best) = trials.first() else { return trials };
        let near = |trial: &&Trial| !best.is_clearly_better_than(trial) || trial.gain > NEARLY * best.gain;
        let other = |trial: &&Trial| !trials.iter().any(|simpler| trial.is_at_the_end_of(simpler));
        let left = trials.iter().filter(near).filter(other).filter(|trial| explains(fit, &trial.fit));
        let mut whole: Vec<Trial> = left.filter_map(|trial| trial.on(self.base, self.pieces)).collect();
        rank(&mut whole);
        whole
    }
}

/// The sets in the law on parts of a record, best first; none that promises far less than one before.
fn previewed(base: &Fit, pieces: &[Piece], proposals: &[Proposal]) -> Vec<Trial> {
    let mut trials: Vec<Trial> = Vec::new();
    let mut least = 0.0_f64;
    for proposal in proposals {
        if proposal.gain < least {
            break;
        }
        let Some(trial) = Trial::of(base, pieces, proposal) else { continue };
        if trial.is_physical() {
            let part = if is_evident(&trial.fit) { FAR_BEHIND } else { FAR };
            least = least.max(part * proposal.gain);
        }
        trials.push(trial);
    }
    cool(&mut trials, base, pieces);
    rank(&mut trials);
    trials
}

fn total(pieces: &[Piece]) -> usize {
    pieces.iter().map(Piece::len).sum()
}

/// The sets in the law, best first.
fn tried(base: &Fit, pieces: &[Piece], proposals: &[Proposal]) -> Vec<Trial> {
    let mut trials: Vec<Trial> = proposals.iter().filter_map(|proposal| Trial::of(base, pieces, proposal)).collect();
    cool(&mut trials, base, pieces);
    rank(&mut trials);
    trials
}

/// Where all leave error, the best of them are fitted on a gentler way.
fn cool(trials: &mut [Trial], base: &Fit, pieces: &[Piece]) {
    if trials.iter().all(|trial| is_evident(&trial.fit)) {
        rank(trials);
        trials.iter_mut().take(COOLED).for_each(|trial| *trial = trial.clone().cooled(base, pieces));
    }
}

fn rank(trials: &mut [Trial]) {
    trials.sort_by(|a, b| b.merit().total_cmp(&a.merit()));
}
