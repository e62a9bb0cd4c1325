//! Where a filter run begins, and where it goes on after an outage.

use super::filter::{Channel, Filter, Noise};

/// A motion that turns by more than this while samples are missing, rad, cannot be followed: the excitation is not
/// known.
pub(super) const LOST: f64 = 4.0;

/// How many times its own square the variance of what an outage leaves unknown is.
const UNKNOWN: f64 = 10.0;

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

/// The state after an outage over which the motion cannot be followed: what is measured next, and nothing that was
/// known of it before, `mean` (q, q̇), says anything of it.
pub fn state_after_outage(mean: [f64; 2], measured: [Option<f64>; 2], noise: &Noise) -> Filter {
    let (mut means, mut variances) = (mean, [0.0; 2]);
    for channel in Channel::ALL {
        let (place, noise) = (channel as usize, noise.sensor[channel as usize]);
        (means[place], variances[place]) = match measured[place] {
            Some(value) => (value, noise),
            None => (mean[place], UNKNOWN * (mean[place] * mean[place] + noise)),
        };
    }
    Filter::begin(means, variances)
}
