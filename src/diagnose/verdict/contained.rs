//! The smaller of two effects of which one contains the other: it stands unless the larger is significantly better on
//! what neither has seen.

use super::case::{Case, Standing};
use super::doubt::{Doubt, LARGE, LEVEL};
use super::entry::Entry;
use super::errors::TIE;
use crate::diagnose::candidates::contender;
use crate::diagnose::judge::{COUNT, Equation, HeldOut};
use crate::law::{Catalogue, Term};

/// The smallest effect that the best one contains, link by link, and than which none that contains it is significantly
/// better.
pub(super) fn smallest(case: &Case, standing: &Standing, entries: &[Entry], best: usize) -> usize {
    let stands = |smaller: usize, larger: usize| {
        let [smaller, larger] = [smaller, larger].map(|index| &entries[index].contender);
        is_no_worse(case, standing, &smaller.held, &larger.held)
            || is_no_worse_punctually(case, standing, smaller.term, larger.term)
    };
    let mut links = vec![best];
    loop {
        let found = links[links.len() - 1];
        let name = entries[found].name();
        let may_be = |index: &usize| {
            let smaller = &entries[*index];
            let borne = matches!(smaller.doubt, None | Some(Doubt::Chance)) && smaller.contender.score < 0.0;
            borne && Catalogue::is_contained(&smaller.name(), &name)
        };
        let smaller =
            (0..entries.len()).filter(may_be).find(|index| links.iter().all(|larger| stands(*index, *larger)));
        match smaller {
            Some(index) => links.push(index),
            None => return found,
        }
    }
}

/// Whether a smaller law ties with a larger one, or is worse by no more than chance makes it and not by a third of the
/// energy.
fn is_no_worse(case: &Case, standing: &Standing, smaller: &HeldOut, larger: &HeldOut) -> bool {
    let chance = standing.blocks.p_values(&[standing.blocks.gains(&case.record, smaller, larger)]);
    let difference = larger.score(smaller);
    difference > -TIE * COUNT as f64 || chance.is_none_or(|p| p[0] >= LEVEL) && difference > COUNT as f64 * LARGE.ln()
}

/// The same on the record taken as punctual, where F is the output: a delay of its sensor and play both let the force
/// come late after a reversal, and what needs the one for the other is told from neither.
fn is_no_worse_punctually(case: &Case, standing: &Standing, smaller: Term, larger: Term) -> bool {
    if !case.record.is_output {
        return false;
    }
    let Equation { terms, target, timing, .. } = &standing.equation;
    let punctual = Equation::new(&case.record, terms, *target, *timing, false);
    let base = case.folds.judge(&punctual);
    let held = |term: Term| Some(contender(&case.record, &case.folds, &punctual, (&base, standing.floor), term)?.held);
    held(smaller).zip(held(larger)).is_some_and(|(smaller, larger)| is_no_worse(case, standing, &smaller, &larger))
}
