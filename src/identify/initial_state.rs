//! Where a filter run begins.

use super::problem::Problem;
use super::window::Window;
use crate::estimation::{Filter, Noise};
use crate::law::State;

/// The state at the first sample, from that sample and the next alone.
pub fn first_state(problem: &Problem, window: &Window, start: u64, noise: &Noise) -> Filter {
    let [first, second] = [start, (start + 1).min(window.end() - 1)].map(|number| *window.sample(number));
    let [q, qd] = noise.sensor;
    let dt = (second.t - first.t).max(f64::MIN_POSITIVE);
    match (problem.channels.q, problem.channels.qd) {
        (true, true) => Filter { state: State { q: first.q, qd: first.qd }, covariance: [q, 0.0, qd] },
        (true, false) => {
            let slope = (second.q - first.q) / dt;
            Filter {
                state: State { q: first.q, qd: slope },
                covariance: [q, 0.0, 10.0 * (slope * slope + q / (dt * dt))],
            }
        }
        _ => Filter { state: State { q: 0.0, qd: first.qd }, covariance: [1.0, 0.0, qd] },
    }
}
