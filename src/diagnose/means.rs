//! Mean forces of terms over the intervals between samples, along a smoothed motion.

use super::piece::Piece;
use crate::law::{Effect, Expression, Hold, State, Term, Trajectory, term_series};

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
    match term {
        Term::Effect(Effect::ExcitationDelay { delay }) => delayed(piece, delay.value()),
        _ if is_series(term) => between(&along(term, expressions, piece, states)),
        _ => pointwise(term, piece, states),
    }
}

fn along(term: Term, expressions: &[Expression], piece: &Piece, states: &[State]) -> Vec<f64> {
    let q: Vec<f64> = states.iter().map(|state| state.q).collect();
    let qd: Vec<f64> = states.iter().map(|state| state.qd).collect();
    let Piece { t, excitation, hold, .. } = piece;
    term_series(term, expressions, &Trajectory { t, q: &q, qd: &qd, excitation, hold: *hold })
}

fn between(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
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

/// Mean of F(t) − F(t − τ) over every interval, exact for a held or linear excitation; before the record its first value stood.
fn delayed(piece: &Piece, delay: f64) -> Vec<f64> {
    let (t, force) = (&piece.t, &piece.excitation);
    let mut integral = vec![0.0; t.len()];
    for k in 1..t.len() {
        let mean = if piece.hold == Hold::Zero { force[k - 1] } else { 0.5 * (force[k - 1] + force[k]) };
        integral[k] = integral[k - 1] + mean * (t[k] - t[k - 1]);
    }
    let until = |time: f64| {
        let k = t.partition_point(|other| *other <= time);
        if k == 0 {
            return force[0] * (time - t[0]);
        }
        let (k, dt) = (k - 1, time - t[k - 1]);
        let slope = match (piece.hold, t.get(k + 1)) {
            (Hold::Zero, _) | (_, None) => 0.0,
            (_, Some(next)) => (force[k + 1] - force[k]) / (next - t[k]),
        };
        integral[k] + dt * (force[k] + 0.5 * slope * dt)
    };
    let mean = |k: usize| {
        let dt = t[k + 1] - t[k];
        (integral[k + 1] - integral[k] - until(t[k + 1] - delay) + until(t[k] - delay)) / dt
    };
    (0..t.len() - 1).map(mean).collect()
}

/// One row per interval from one column per term.
pub(super) fn rows(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = columns.first().map_or(0, Vec::len);
    (0..count).map(|k| columns.iter().map(|column| column[k]).collect()).collect()
}
