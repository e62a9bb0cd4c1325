//! Mean forces of terms over the intervals between samples, along a smoothed motion.

use super::piece::Piece;
use crate::law::{Effect, Hold, State, Term};

/// Whether the term's force cannot be computed from state and excitation at one instant.
pub(super) fn is_series(term: Term) -> bool {
    matches!(term, Term::Effect(effect) if !effect.is_pointwise())
}

/// The term's mean over every interval, as far as its ends tell; with what multiplies q̈ in it.
pub(super) fn means(term: Term, piece: &Piece, states: &[State]) -> Vec<f64> {
    match term {
        Term::Effect(Effect::ExcitationDelay { delay }) => delayed(piece, delay.value()),
        Term::Effect(Effect::Hysteresis { yield_displacement, share, exponent }) => {
            between(&hysteresis(piece, states, yield_displacement.value(), share.value(), exponent.value()))
        }
        Term::Effect(Effect::HiddenResonator { frequency, damping_ratio }) => {
            between(&resonator(piece, states, frequency.value(), damping_ratio.value()))
        }
        _ => pointwise(term, piece, states),
    }
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

fn hysteresis(piece: &Piece, states: &[State], yield_displacement: f64, share: f64, exponent: f64) -> Vec<f64> {
    let mut z = vec![0.0; states.len()];
    for k in 1..states.len() {
        let dq = states[k].q - states[k - 1].q;
        let parts = (4.0 * dq.abs() / yield_displacement).ceil().clamp(1.0, 50.0);
        let rate = |z: f64| {
            let relative = z / yield_displacement;
            let power = relative.abs().powf(exponent - 1.0) * relative;
            dq / parts * (1.0 - (1.0 - share) * relative.abs().powf(exponent)) - share * (dq / parts).abs() * power
        };
        z[k] = z[k - 1];
        for _ in 0..parts as usize {
            let first = rate(z[k]);
            z[k] += 0.5 * (first + rate(z[k] + first));
        }
    }
    let _ = piece;
    z
}

fn resonator(piece: &Piece, states: &[State], frequency: f64, damping_ratio: f64) -> Vec<f64> {
    let (stiffness, damping) = (frequency * frequency, 2.0 * damping_ratio * frequency);
    let (mut r, mut rd) = (0.0, 0.0);
    let mut out = vec![0.0; states.len()];
    // relative to the coordinate, r = y − q: r̈ = −Ω² r − 2ζΩ ṙ − q̈
    for k in 1..states.len() {
        let dt = piece.t[k] - piece.t[k - 1];
        let acceleration = (states[k].qd - states[k - 1].qd) / dt;
        let parts = (frequency * dt / 0.3).ceil().clamp(1.0, 64.0);
        let h = dt / parts;
        for _ in 0..parts as usize {
            let at = |r: f64, rd: f64| -stiffness * r - damping * rd - acceleration;
            let a1 = at(r, rd);
            let (r2, v2) = (r + 0.5 * h * rd, rd + 0.5 * h * a1);
            let a2 = at(r2, v2);
            let (r3, v3) = (r + 0.5 * h * v2, rd + 0.5 * h * a2);
            let a3 = at(r3, v3);
            let (r4, v4) = (r + h * v3, rd + h * a3);
            let a4 = at(r4, v4);
            r += h / 6.0 * (rd + 2.0 * v2 + 2.0 * v3 + v4);
            rd += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
        out[k] = -stiffness * r - damping * rd;
    }
    out
}

/// One row per interval from one column per term.
pub(super) fn rows(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = columns.first().map_or(0, Vec::len);
    (0..count).map(|k| columns.iter().map(|column| column[k]).collect()).collect()
}
