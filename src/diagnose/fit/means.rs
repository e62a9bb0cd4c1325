//! Mean forces of terms over the intervals between samples, along a smoothed motion.

use super::course::Course;
use crate::diagnose::piece::Piece;
use crate::law::{Expression, Hold, State, Term, interval_forces};

/// Whether the term's force cannot be computed from state and excitation at one instant.
pub(super) fn is_series(term: Term) -> bool {
    match term {
        Term::Effect(effect) => !effect.is_pointwise(),
        Term::Expression(_) => true,
        Term::Inertia | Term::Monomial(_) => false,
    }
}

/// The term's mean over every interval, as far as its ends tell; with what multiplies q̈ in it.
pub(super) fn means(term: Term, expressions: &[Expression], piece: &Piece, states: &[State]) -> Vec<f64> {
    if !is_series(term) {
        return pointwise(term, piece, states);
    }
    let course = Course::of(piece, states);
    let straight = vec![0.0; piece.len() - 1];
    let lines = interval_forces(term, expressions, &course.trajectory(), &straight, &[]);
    lines.into_iter().map(|[from, to]| 0.5 * (from + to)).collect()
}

fn pointwise(term: Term, piece: &Piece, states: &[State]) -> Vec<f64> {
    let value = |state: &State, excitation: f64| term.force(state.q, state.qd, excitation);
    let interval = |k: usize| {
        let (from, to) = (&states[k], &states[k + 1]);
        let last = if piece.hold == Hold::Zero { k } else { k + 1 };
        let acceleration = (to.qd - from.qd) / (piece.t[k + 1] - piece.t[k]);
        let mass = term.mass(0.5 * (from.q + to.q));
        0.5 * (value(from, piece.excitation[k]) + value(to, piece.excitation[last])) + mass * acceleration
    };
    (0..states.len() - 1).map(interval).collect()
}
