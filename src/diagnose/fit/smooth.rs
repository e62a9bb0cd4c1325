//! The motion as all samples together tell it: the Bryson–Frazier smoother over a run of the filter.
//!
//! Bierman, International Journal of Control 18 (1973), 65: the smoothed state at k is x − P λ with the filtered x and P, and λ goes backward
//! through the measurements, λ ← (I − K H)ᵀ λ − Hᵀ ε ÷ s, and through the intervals, λ ← Aᵀ λ. Nothing is inverted: where a law
//! explains its record the covariance is all but singular, and a smoother that divides by it goes back along the law without the
//! measurements, which a damped motion does not bear.

use super::outcome::Step;
use crate::estimation::{Channel, Filter, Innovation};
use crate::law::State;

/// States at every sample of a piece that begins with `first`, one step for each sample after.
pub fn smooth(first: &Filter, steps: &[Step]) -> Vec<State> {
    let mut states = vec![first.state; steps.len() + 1];
    let mut adjoint = [0.0; 2];
    for (k, step) in steps.iter().enumerate().rev() {
        states[k + 1] = moved(&step.filtered, adjoint);
        for channel in [Channel::Qd, Channel::Q] {
            if let Some(innovation) = &step.innovations[channel as usize] {
                adjoint = before_measurement(channel, innovation, adjoint);
            }
        }
        let [[a, b], [c, d]] = step.transition;
        adjoint = [a * adjoint[0] + c * adjoint[1], b * adjoint[0] + d * adjoint[1]];
    }
    states[0] = moved(first, adjoint);
    states
}

/// x − P λ.
fn moved(filter: &Filter, [q, qd]: [f64; 2]) -> State {
    let [qq, qv, vv] = filter.covariance;
    State { q: filter.state.q - qq * q - qv * qd, qd: filter.state.qd - qv * q - vv * qd }
}

fn before_measurement(channel: Channel, innovation: &Innovation, adjoint: [f64; 2]) -> [f64; 2] {
    let [gain_q, gain_qd] = innovation.gain;
    let taken = gain_q * adjoint[0] + gain_qd * adjoint[1] + innovation.residual * innovation.precision;
    let mut before = adjoint;
    before[channel as usize] -= taken;
    before
}
