//! Inner parameters as unknowns of a fit: what their logarithms do to the force, and how they move.

use super::fit::Form;
use super::means;
use super::piece::Piece;
use crate::law::{Effect, InnerRange, State, Term};

/// Relative change of an inner parameter from which its slope is taken.
const DIFFERENCE: f64 = 0.01;

/// Largest step, in the logarithm of an inner parameter.
const LARGEST_STEP: f64 = 0.3;

/// An inner parameter that is sought: the position of its term in the form, and its own in the effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sought {
    pub(super) term: usize,
    pub(super) parameter: usize,
}

/// The inner parameters of a form that are open and take any value, not a few.
pub(super) fn sought(form: &Form) -> Vec<Sought> {
    let of = |(term, open): (usize, &Vec<bool>)| {
        let continuous =
            |parameter: usize| effect_at(form, term).is_some_and(|effect| is_continuous(effect, parameter));
        let parameters = (0..open.len()).filter(|index| open[*index] && continuous(*index)).collect::<Vec<_>>();
        parameters.into_iter().map(move |parameter| Sought { term, parameter })
    };
    form.open.iter().enumerate().flat_map(of).collect()
}

/// Whether the inner parameter of that position takes any value, not a few.
fn is_continuous(effect: Effect, parameter: usize) -> bool {
    !matches!(effect.inner()[parameter].range, InnerRange::Either(..))
}

fn effect_at(form: &Form, index: usize) -> Option<Effect> {
    form.terms[index].effect()
}

/// Change of the law's mean force over every interval with the logarithm of each, along a smoothed motion.
pub(super) fn slopes(
    form: &Form,
    coefficients: &[f64],
    sought: &[Sought],
    piece: &Piece,
    states: &[State],
) -> Vec<Vec<f64>> {
    let slope = |one: &Sought| -> Option<Vec<f64>> {
        let present = form.terms[one.term].effect()?;
        let side = |factor: f64| moved(present, one.parameter, factor).unwrap_or(present);
        let (above, below) = (side(DIFFERENCE.exp()), side((-DIFFERENCE).exp()));
        let value = |effect: Effect| effect.inner_values()[one.parameter];
        let apart = (value(above) / value(below)).ln();
        let [above, below] = [above, below].map(|effect| means::means(Term::Effect(effect), &[], piece, states));
        let factor = coefficients[one.term] / apart;
        Some(above.iter().zip(&below).map(|(above, below)| factor * (above - below)).collect())
    };
    let flat = || vec![0.0; piece.len() - 1];
    let finite = |slope: Vec<f64>| if slope.iter().all(|value| value.is_finite()) { slope } else { flat() };
    sought.iter().map(|one| slope(one).map_or_else(flat, finite)).collect()
}

/// Moves each by a step of its logarithm, within its range.
pub(super) fn take(form: &mut Form, sought: &[Sought], steps: &[f64]) {
    for (one, step) in sought.iter().zip(steps) {
        let factor = step.clamp(-LARGEST_STEP, LARGEST_STEP).exp();
        let moved = effect_at(form, one.term).and_then(|effect| moved(effect, one.parameter, factor));
        if let Some(effect) = moved {
            form.terms[one.term] = Term::Effect(effect);
        }
    }
}

fn moved(effect: Effect, parameter: usize, factor: f64) -> Option<Effect> {
    let mut values = effect.inner_values();
    values[parameter] *= factor;
    if let InnerRange::AtLeast(least) = effect.inner()[parameter].range {
        values[parameter] = values[parameter].max(least);
    }
    effect.with_inner(&values).ok()
}
