//! The motion as all samples together tell it: the Rauch–Tung–Striebel smoother over a run of the filter.
//!
//! Rauch, Tung and Striebel, AIAA Journal 3 (1965), 1445: backward from the last sample, the smoothed state at k is the filtered one
//! plus G (smoothed − predicted at k + 1), G = P Aᵀ (P⁻)⁻¹.

use super::piece::Piece;
use super::run::Step;
use crate::law::State;

/// States at every sample of a piece, the first taken from the second back by the first interval.
pub fn smooth(piece: &Piece, steps: &[Step]) -> Vec<State> {
    let mut states: Vec<State> = steps.iter().map(|step| step.filtered.state).collect();
    for k in (0..steps.len().saturating_sub(1)).rev() {
        let next = &steps[k + 1];
        let correction = [states[k + 1].q - next.predicted.state.q, states[k + 1].qd - next.predicted.state.qd];
        let gain = backward_gain(&steps[k], next);
        let state = steps[k].filtered.state;
        states[k] = State {
            q: state.q + gain[0][0] * correction[0] + gain[0][1] * correction[1],
            qd: state.qd + gain[1][0] * correction[0] + gain[1][1] * correction[1],
        };
    }
    let first = before(piece, &states);
    states.insert(0, first);
    states
}

/// P Aᵀ (P⁻)⁻¹; the identity of a deterministic interval, A⁻¹, where P⁻ is singular.
fn backward_gain(now: &Step, next: &Step) -> [[f64; 2]; 2] {
    let [qq, qv, vv] = now.filtered.covariance;
    let [[a, b], [c, d]] = next.transition;
    let cross = [[qq * a + qv * b, qq * c + qv * d], [qv * a + vv * b, qv * c + vv * d]];
    let [pqq, pqv, pvv] = next.predicted.covariance;
    let determinant = pqq * pvv - pqv * pqv;
    if determinant <= 1e-14 * pqq * pvv {
        let inverse = (a * d - b * c).recip();
        return [[d * inverse, -b * inverse], [-c * inverse, a * inverse]];
    }
    cross.map(|[x, y]| [(x * pvv - y * pqv) / determinant, (y * pqq - x * pqv) / determinant])
}

fn before(piece: &Piece, states: &[State]) -> State {
    let dt = piece.t[1] - piece.t[0];
    let next = states[0];
    let slope = states.get(1).map_or(0.0, |after| (after.qd - next.qd) / (piece.t[2] - piece.t[1]));
    State { q: next.q - dt * next.qd + 0.5 * dt * dt * slope, qd: next.qd - dt * slope }
}
