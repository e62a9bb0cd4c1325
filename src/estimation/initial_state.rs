//! Where a filter run begins.

use super::filter::{Filter, Noise};

/// Variance of a displacement that nobody measures, m²: with a law of motion nothing tells where it began, and any
/// number serves that is no zero.
const UNMEASURED: f64 = 1.0;

/// How many times its own square, and that of what noise alone makes of it, the variance of a slope between two samples
/// is: three stds, so that the start binds nothing.
const SLOPE: f64 = 10.0;

/// The state at the first sample from that sample and the next alone: `measured` holds both by channel, `None` where a
/// channel is not measured, `dt` (s) lies between them. One that is not measured at all is taken for 0.
pub fn initial_state(measured: [Option<[f64; 2]>; 2], dt: f64, noise: &Noise) -> Filter {
    let [q, qd] = noise.sensor;
    match measured {
        [Some([displacement, _]), Some([velocity, _])] => Filter::begin([displacement, velocity], [q, qd]),
        [Some([first, second]), None] => {
            let dt = dt.max(f64::MIN_POSITIVE);
            let slope = (second - first) / dt;
            let spread = SLOPE * (slope * slope + q / (dt * dt));
            Filter::begin([first, slope], [q, spread])
        }
        [None, velocity] => {
            let first = velocity.map_or(0.0, |[first, _]| first);
            Filter::begin([0.0, first], [UNMEASURED, qd])
        }
    }
}
