//! Mean forces of terms over the intervals between samples, along a smoothed motion.

use super::piece::Piece;
use crate::law::{Hold, State, Term};

/// Whether the term's force cannot be computed from state and excitation at one instant.
pub(super) fn is_series(term: Term) -> bool {
    let _ = term;
    false
}

/// The term's mean over every interval, as far as its ends tell; with what multiplies q̈ in it.
pub(super) fn means(term: Term, piece: &Piece, states: &[State]) -> Vec<f64> {
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

/// One row per interval from one column per term.
pub(super) fn rows(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = columns.first().map_or(0, Vec::len);
    (0..count).map(|k| columns.iter().map(|column| column[k]).collect()).collect()
}
