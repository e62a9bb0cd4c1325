//! Added effects seen anew beside each other: one effect may imitate two, and is then named before them.
//!
//! Adding the best effect, then the best beside it, never revises the first. Here each added effect is taken out in
//! turn and what the judge names in its place put there, as in stepwise selection with exchange (Miller, *Subset
//! Selection in Regression*, 2002, sect. 3.4); and the best pairs are sought as such, for neither of two may be the
//! best alone.

use super::case::{Case, Standing};
use super::diagnosis::{Finding, diagnose};
use super::doubt::{SURE, doubt_of_gain};
use super::errors::TIE;
use super::untold::drives;
use crate::diagnose::candidates::{Pairs, same_effect};
use crate::diagnose::judge::{COUNT, delay_of};
use crate::law::{Catalogue, Term};

/// Pairs that are fitted and judged in full: those that leave least on a grid of inner parameters
/// (docs/decisions/pairs.md).
const PAIRS: usize = 6;

/// A law with other effects in the place of some.
pub(super) struct Exchange {
    pub(super) terms: Vec<Term>,
    pub(super) standing: Standing,
    /// Effects that cannot be told from the last term.
    pub(super) ties: Vec<Vec<String>>,
}

/// Added effects, each seen anew beside the others.
pub(super) struct Seen {
    /// The law in which one of them is exchanged for what the judge names in its place, or has the inner parameters
    /// that suit it beside the others; none where all stand.
    pub(super) exchange: Option<Exchange>,
    /// What each cannot be told from, the others being there.
    pub(super) ties: Vec<(Term, Vec<Vec<String>>)>,
}

/// Every added effect of a law beside the others.
pub(super) fn seen(case: &Case, original: &[Term], terms: &[Term], standing: &Standing) -> Seen {
    let (mut exchanges, mut ties) = (Vec::new(), Vec::new());
    for place in added(original, terms) {
        let (rest, old) = ([&terms[..place], &terms[place + 1..]].concat(), terms[place]);
        let Some(exchange) = with_named(case, rest) else { continue };
        let new = exchange.terms[terms.len() - 1];
        if same_effect(new, old) {
            ties.push((old, exchange.ties.clone()));
        }
        if exchange.standing.held.score(&standing.held) < worth(old, new) {
            exchanges.push(exchange);
        }
    }
    Seen { exchange: exchanges.into_iter().min_by(|a, b| compare(a, b, standing)), ties }
}

/// Score below which one effect takes another's place: a smaller one need not be better than one that contains it, new
/// inner parameters alone are worth the word or none.
fn worth(old: Term, new: Term) -> f64 {
    let [contained, containing] = [new, old].map(Catalogue::name_of);
    match (same_effect(old, new), Catalogue::is_contained(&contained, &containing)) {
        (true, _) => -TIE,
        (_, true) => TIE * COUNT as f64,
        _ => 0.0,
    }
}

/// The best law with two effects in the place of none, one or two. None where the law has more, or no two are better:
/// beyond chance, all of them counted, than fewer; than two by their errors or, these being equal, with fewer inner
/// parameters.
pub(super) fn paired(case: &Case, original: &[Term], terms: &[Term], standing: &Standing) -> Option<Exchange> {
    let own = added(original, terms);
    if own.len() > 2 {
        return None;
    }
    let rest: Vec<Term> = (0..terms.len()).filter(|place| !own.contains(place)).map(|place| terms[place]).collect();
    let base = case.stand(&rest)?;
    let tried = Pairs::new(&case.record, &case.folds, &base.equation, (&base.held, base.floor));
    let pairs = tried.best().into_iter().take(PAIRS).filter_map(|pair| {
        let terms = [&rest[..], &tried.narrowed(pair)[..]].concat();
        Some(Exchange { standing: case.stand(&terms)?, terms, ties: Vec::new() })
    });
    let better = |pair: &Exchange| {
        if own.len() < 2 {
            let gains = standing.blocks.gains(&case.record, &standing.held, &pair.standing.held);
            let chance = standing.blocks.p_values(&[gains]).map(|values| PAIRS as f64 * values[0]);
            return doubt_of_gain(&standing.held, &pair.standing.held, chance, &standing.floor).is_none();
        }
        let simpler = parameters(&pair.terms) < parameters(terms);
        pair.standing.held.score(&standing.held) < if simpler { TIE * COUNT as f64 } else { -TIE }
    };
    let mut told: Vec<Exchange> = pairs.filter(|pair| better(pair) && is_told(case, original, pair)).collect();
    told.sort_by(|a, b| compare(a, b, standing));
    told.into_iter().find(|pair| is_named(case, &rest, pair))
}

/// Whether a diagnosis beside one of a pair names the other, with all that it asks of one effect.
fn is_named(case: &Case, rest: &[Term], pair: &Exchange) -> bool {
    let new = &pair.terms[rest.len()..];
    (0..new.len()).rev().any(|other| {
        let beside =
            (0..new.len()).filter(|place| *place != other).fold(rest.to_vec(), |law, place| joined(&law, new[place]));
        let found = diagnose(case, &beside).filter(|found| found.finding == Finding::Missing);
        let name = Catalogue::name_of(new[other]);
        found.is_some_and(|found| {
            found.effect.as_ref() == Some(&name) || found.indistinguishable.iter().flatten().any(|tied| *tied == name)
        })
    })
}

/// Terms with the inner parameters of those added to a law, two and more, that suit them beside each other; `base` is
/// the law without them.
pub(super) fn tuned(case: &Case, original: &[Term], terms: &[Term], base: &Standing) -> Vec<Term> {
    let mut own: Vec<Term> = added(original, terms).into_iter().map(|place| terms[place]).collect();
    for one in 0..own.len() {
        for other in one + 1..own.len() {
            let rest = own.iter().enumerate().filter(|(place, _)| ![one, other].contains(place));
            let beside = rest.fold(base.equation.clone(), |equation, (_, term)| equation.with(&case.record, *term));
            let held = case.folds.judge(&beside);
            let pairs = Pairs::new(&case.record, &case.folds, &beside, (&held, base.floor));
            [own[one], own[other]] = pairs.narrowed([own[one], own[other]]);
        }
    }
    let found = |term: &Term| own.iter().find(|own| same_effect(**own, *term)).copied();
    terms.iter().map(|term| found(term).unwrap_or(*term)).collect()
}

/// Whether every effect that was added is one that physics allows, with a coefficient that is none by chance, and is
/// worth the word beside the others.
fn is_told(case: &Case, original: &[Term], exchange: &Exchange) -> bool {
    let Exchange { terms, standing, .. } = exchange;
    let (values, stds) = (&standing.estimate.coefficients, &standing.estimate.std);
    added(original, terms).into_iter().all(|place| {
        let allowed = Catalogue::of(terms[place]).is_none_or(|entry| entry.sign.allows(values[place]));
        let without = || case.of(standing.equation.without(place));
        let helps = |without: Standing| {
            without.held.score(&standing.held) >= TIE * COUNT as f64
                && !drives(case, &without, terms[place], [values[place], stds[place]])
        };
        allowed && values[place].abs() > SURE * stds[place] && without().is_some_and(helps)
    })
}

/// Inner parameters of a law.
fn parameters(terms: &[Term]) -> usize {
    terms.iter().filter_map(|term| term.effect()).map(|effect| effect.inner().len()).sum()
}

/// A law with what its diagnosis names as its last term.
fn with_named(case: &Case, terms: Vec<Term>) -> Option<Exchange> {
    let found = diagnose(case, &terms)?;
    let named = found.candidates.first().filter(|_| found.finding == Finding::Missing)?.term;
    let terms = joined(&terms, named);
    let standing = case.stand(&terms)?;
    Some(Exchange { terms, standing, ties: found.indistinguishable })
}

fn compare(a: &Exchange, b: &Exchange, standing: &Standing) -> std::cmp::Ordering {
    let score = |exchange: &Exchange| exchange.standing.held.score(&standing.held);
    score(a).total_cmp(&score(b))
}

/// Places of the effects that were added; a delay is no effect among others.
pub(super) fn added(original: &[Term], terms: &[Term]) -> Vec<usize> {
    let own = |term: Term| original.iter().any(|own| same_effect(*own, term));
    (0..terms.len()).filter(|place| !own(terms[*place]) && delay_of(terms[*place]).is_none()).collect()
}

/// Terms with one more.
pub(super) fn joined(terms: &[Term], new: Term) -> Vec<Term> {
    terms.iter().copied().chain([new]).collect()
}
