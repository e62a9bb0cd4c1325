//! Inner parameters as unknowns of a fit: what their logarithms do to the force, and how they move.

use super::course::Course;
use super::form::Form;
use super::means;
use crate::diagnose::piece::Piece;
use crate::diagnose::scale::Scale;
use crate::law::{Effect, InnerRange, Line, State, Term, interval_forces};

/// Relative change of an inner parameter from which its slope is taken: the error of a difference, of the order of
/// a hundredth, is corrected by the next pass.
const DIFFERENCE: f64 = 0.01;

/// Largest step, in the logarithm of an inner parameter.
const LARGEST_STEP: f64 = 0.3;

/// No limit.
const EVERYWHERE: [f64; 2] = [0.0, f64::INFINITY];

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

/// Whether the inner parameter of that position has a logarithm, and takes any value, not a few.
fn is_continuous(effect: Effect, parameter: usize) -> bool {
    !matches!(effect.inner()[parameter].range, InnerRange::Either(..) | InnerRange::Any)
}

fn effect_at(form: &Form, index: usize) -> Option<Effect> {
    form.terms[index].effect()
}

/// A smoothed motion of a piece, how its acceleration changes over every interval, and where a memory begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along<'a> {
    pub(super) piece: &'a Piece,
    pub(super) states: &'a [State],
    pub(super) bends: &'a [f64],
    pub(super) begin: &'a [f64],
}

/// Change of the law's force over every interval with the logarithm of an inner parameter, along a smoothed motion, its
/// memory beginning there.
pub(super) fn slope(
    (form, coefficients): (&Form, &[f64]),
    one: Sought,
    Along { piece, states, bends, begin }: Along,
) -> Vec<Line> {
    let flat = || vec![[0.0; 2]; piece.len() - 1];
    let Some(present) = form.terms[one.term].effect() else { return flat() };
    let side = |factor: f64| moved(present, one.parameter, factor).unwrap_or(present);
    let (above, below) = (side(DIFFERENCE.exp()), side((-DIFFERENCE).exp()));
    let value = |effect: Effect| effect.inner_values()[one.parameter];
    let factor = coefficients[one.term] / (value(above) / value(below)).ln();
    let course = Course::of(piece, states);
    let forces = |effect: Effect| -> Vec<Line> {
        let term = Term::Effect(effect);
        match effect.is_pointwise() {
            true => means::means(term, &[], piece, states).into_iter().map(|mean| [mean; 2]).collect(),
            false => interval_forces(term, &[], &course.trajectory(), bends, begin),
        }
    };
    let pairs = forces(above).into_iter().zip(forces(below));
    let slope: Vec<Line> = pairs.map(|(above, below)| [0, 1].map(|end| factor * (above[end] - below[end]))).collect();
    if slope.iter().flatten().all(|value| value.is_finite()) { slope } else { flat() }
}

/// The part of a step that moves none too far.
pub(super) fn bounded(steps: &[f64]) -> f64 {
    let largest = steps.iter().map(|step| step.abs()).fold(0.0, f64::max);
    if largest > LARGEST_STEP { LARGEST_STEP / largest } else { 1.0 }
}

/// Between which values of each a motion of that scale can tell.
pub(super) fn limits(form: &Form, sought: &[Sought], scale: &Scale) -> Vec<[f64; 2]> {
    let of = |one: &Sought| effect_at(form, one.term).map_or(EVERYWHERE, |effect| scale.limits(effect, one.parameter));
    sought.iter().map(of).collect()
}

/// Positions of those that stand at their limit, and would be carried beyond it.
pub(super) fn outward(form: &Form, sought: &[Sought], limits: &[[f64; 2]], steps: &[f64]) -> Vec<usize> {
    let is_held = |((one, [low, high]), step): ((&Sought, &[f64; 2]), &f64)| {
        let value = effect_at(form, one.term).map_or(f64::NAN, |effect| effect.inner_values()[one.parameter]);
        (value <= *low && *step < 0.0) || (value >= *high && *step > 0.0)
    };
    let held = sought.iter().zip(limits).zip(steps).map(is_held);
    held.enumerate().filter_map(|(position, is_held)| is_held.then_some(position)).collect()
}

/// Moves each by a fraction of a step of its logarithm, to its limit at most.
pub(super) fn take(form: &mut Form, sought: &[Sought], limits: &[[f64; 2]], steps: &[f64], fraction: f64) {
    for (position, (one, step)) in sought.iter().zip(steps).enumerate() {
        let limits = limits.get(position).copied().unwrap_or(EVERYWHERE);
        let Some(effect) = effect_at(form, one.term) else { continue };
        let present = effect.inner_values()[one.parameter];
        // one that began beyond its limit may come back at its own pace
        let [low, high] = [limits[0].min(present), limits[1].max(present)];
        let factor = ((fraction * step).exp() * present).clamp(low, high) / present;
        if let Some(effect) = moved(effect, one.parameter, factor) {
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
