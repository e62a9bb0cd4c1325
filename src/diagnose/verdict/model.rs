//! A law written as a model.

use super::law::Law;
use crate::law::{Catalogue, Given, Model, ModelTerm, Term};

/// The model with a law's numbers: its own terms under the names that the user wrote, then what was added; with the
/// hold under which the law stands, where there is an excitation.
pub fn improved_model(model: &Model, law: &Law) -> Model {
    let key = |index: usize, term: Term| {
        let own = model.terms.iter().find(|entry| same(entry.term, term)).map(|entry| entry.key.clone());
        own.unwrap_or_else(|| Catalogue::name_of(law.terms[index]))
    };
    let pairs = law.terms.iter().zip(&law.coefficients).enumerate();
    let terms = pairs.map(|(index, (term, value))| {
        let open = vec![false; model.inner_names(*term).len()];
        ModelTerm { key: key(index, *term), open, ..ModelTerm::new(*term, Given::Known(*value)) }
    });
    let hold = model.hold.or(law.delay.map(|_| law.timing.hold));
    Model { terms: terms.collect(), expressions: law.expressions.clone(), hold, ..model.clone() }
}

/// The same with its coefficients to be fitted anew, as the streaming identifier wants them; numbers that the model
/// held are kept.
pub fn refitted_model(model: &Model, law: &Law) -> Model {
    let improved = improved_model(model, law).freed();
    let held = |term: Term| {
        let own = model.terms.iter().find(|entry| same(entry.term, term));
        own.map(|entry| entry.given).filter(|given| matches!(given, Given::Known(_)))
    };
    let terms = improved.terms.iter();
    let terms = terms.map(|entry| ModelTerm { given: held(entry.term).unwrap_or(Given::Fit), ..entry.clone() });
    Model { terms: terms.collect(), ..improved }
}

/// Whether both are one term, whatever its inner parameters.
fn same(one: Term, other: Term) -> bool {
    crate::diagnose::candidates::same_effect(one, other)
}
