//! Recordings for the likelihood, and a model's form with its best coefficients on them.

use super::form::{Fit, Form};
use super::refit::{fit, refit};
use crate::diagnose::piece::Piece;
use crate::estimation::price_of_a_term;
use crate::identify::Recording;
use crate::law::{Given, Hold, Model, Term};

/// Part by which error energy may exceed the sensors' noise in a law that explains its record.
const TOLERATED: f64 = 0.02;

/// Log-likelihood, nats, that an error of the law must gain to be one.
const EVIDENT: f64 = 6.0;

/// Recordings, and the pieces of them that have no gap.
pub struct Evidence {
    /// Whether any recording has an excitation.
    pub forced: bool,
    /// Their pieces.
    pub pieces: Vec<Piece>,
}

impl Evidence {
    /// Cuts recordings at their gaps, each with what its excitation did between samples.
    pub fn new(recordings: &[(&Recording, Hold)]) -> Evidence {
        let pieces = recordings.iter().flat_map(|(recording, hold)| Piece::all(recording, *hold)).collect();
        Evidence { forced: recordings.iter().any(|(recording, _)| recording.channels().excitation), pieces }
    }
}

/// The model's form with its best coefficients, its numbers held: "maybe" terms only where the record speaks for them.
///
/// None where the record determines no law: too short, no motion.
pub fn best_as_given(model: &Model, evidence: &Evidence) -> Option<Fit> {
    let held = |term: Term, given: Given| match (term, given) {
        (_, Given::Known(value)) => Some(value),
        (Term::Inertia, _) if !evidence.forced => Some(1.0),
        _ => None,
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

/// The fit without its least significant "maybe" term, where that is worth less than its price.
fn without_weakest(fitted: &Fit, maybe: &[Term], pieces: &[Piece]) -> Option<Fit> {
    let price = price_of_a_term(fitted.measurements).sqrt();
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

/// Whether the record speaks for an error of the law that is worth the word.
pub fn is_evident(fit: &Fit) -> bool {
    let lack = fit.lack();
    lack > EVIDENT && 2.0 * lack / fit.measurements.max(1.0) > TOLERATED
}
