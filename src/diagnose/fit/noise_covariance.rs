//! Noise levels that follow a run: the sensors' their innovations, the process noise the likelihood of two rivals.

use super::outcome::Outcome;
use super::start;
use crate::estimation::{Noise, RIVALS};

/// Gain in log-likelihood, nats, that another level of process noise must promise: far below any that decides.
pub(super) const GAIN: f64 = 0.1;

/// Ratios of the rivals' process noise to the one in use once it is nearly right.
const NEAR: [f64; 2] = [1.0 / 1.5, 1.5];

/// How far a vertex beyond the rivals is followed, in their distances.
const BEYOND: f64 = 2.5;

/// Relative change of a variance below which it stays.
const STEADY: f64 = 0.02;

/// What the signals are like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Signals {
    /// The largest value measured by channel.
    pub(super) largest: [f64; 2],
    /// Time between samples, s.
    pub(super) sample_time: f64,
}

/// The noise with the scale that the innovations have: the likelihood is that of the best scale, whatever the noise
/// was.
pub(super) fn calibrated(noise: &Noise, outcomes: &[Outcome]) -> Noise {
    let [squares, count] = totals(outcomes);
    let scale = scale(outcomes);
    let mean = (squares[0] + squares[1]) / (count[0] + count[1]).max(1.0);
    Noise { sensor: [0, 1].map(|channel| noise.sensor[channel] * scale[channel]), process: noise.process * mean }
}

/// By how much the variances of a run are too small, by channel; 1 where nothing was measured.
pub(super) fn scale(outcomes: &[Outcome]) -> [f64; 2] {
    let [squares, count] = totals(outcomes);
    [0, 1].map(|channel| if count[channel] > 0.0 { squares[channel] / count[channel] } else { 1.0 })
}

/// Σ ε²/s and number of innovations, by channel.
fn totals(outcomes: &[Outcome]) -> [[f64; 2]; 2] {
    let sum = |value: &dyn Fn(&Outcome) -> f64| outcomes.iter().map(value).sum::<f64>();
    [
        [0, 1].map(|channel| sum(&|outcome| outcome.squares[channel])),
        [0, 1].map(|channel| sum(&|outcome| outcome.count[channel])),
    ]
}

/// Sensor noise follows the innovations, process noise the likelihood of rivals at these ratios to it; returns whether
/// both stayed.
///
/// Where a sensor's noise would fall below its floor, all noise is lifted with it: the likelihood depends on the ratios
/// alone.
pub(super) fn follow(noise: &mut Noise, ratios: &mut [f64; 2], outcomes: &[Outcome], signals: Signals) -> bool {
    let old = *noise;
    *noise = calibrated(&old, outcomes);
    noise.process *= towards(outcomes, ratios);
    let measured = [0, 1].map(|channel| outcomes.iter().any(|outcome| outcome.count[channel] > 0.0));
    let floor = |channel: usize| Noise::floor(signals.largest[channel]);
    let lift = (0..2)
        .filter(|channel| measured[*channel])
        .map(|channel| floor(channel) / noise.sensor[channel])
        .fold(1.0, f64::max);
    for channel in (0..2).filter(|channel| measured[*channel]) {
        noise.sensor[channel] *= lift;
    }
    // once there is less than the motion itself could show, it is none
    noise.process *= lift;
    let dt = signals.sample_time;
    let [to_q, to_qd] = [noise.process * dt.powi(3) / 3.0, noise.process * dt];
    let seen = if measured[1] { to_qd >= floor(1) } else { to_q >= floor(0) };
    if !seen {
        noise.process = 0.0;
    }
    noise.process = noise.process.max(start::negligible(noise));
    let near = |new: f64, old: f64| (new / old - 1.0).abs() < STEADY;
    let none = noise.process <= start::negligible(noise);
    let settled = |channel: usize| !measured[channel] || near(noise.sensor[channel], old.sensor[channel]);
    settled(0) && settled(1) && (none || near(noise.process, old.process))
}

/// Factor by which the process noise moves: to the vertex of the parabola through the three levels, or to none. The
/// rivals come near once the level in use is better than theirs; beyond their reach the vertex is trusted a little.
fn towards(outcomes: &[Outcome], ratios: &mut [f64; 2]) -> f64 {
    let sum = |value: fn(&Outcome) -> f64| outcomes.iter().map(value).sum::<f64>();
    let present = sum(|outcome| outcome.log_likelihood);
    let [less, more] = [sum(|outcome| outcome.rivals[0]) - present, sum(|outcome| outcome.rivals[1]) - present];
    let wide = *ratios == RIVALS;
    let flat = less.abs() < GAIN && more < GAIN;
    if flat && wide && less >= more {
        // where a part of it does as well, it is none: a law that explains its record is not to be approached step by
        // step
        return 0.0;
    }
    let ends = ratios.map(f64::ln);
    let reach = if wide { ends } else { ends.map(|end| BEYOND * end) };
    let vertex = vertex(ends, [less, more]);
    let best = less < GAIN && more < GAIN;
    let near = if wide { best } else { !flat && (reach[0]..=reach[1]).contains(&vertex) };
    *ratios = if near { NEAR } else { RIVALS };
    if wide && best { 1.0 } else { vertex.clamp(reach[0], reach[1]).exp() }
}

/// Where the parabola through 0 at 0 and these values at the ends, on either side of it, is largest; 0 where that is no
/// gain, and beyond the better end where it opens upward.
fn vertex([from, to]: [f64; 2], [less, more]: [f64; 2]) -> f64 {
    let determinant = from * to * (from - to);
    let curvature = (less * to - more * from) / determinant;
    let slope = (from * from * more - to * to * less) / determinant;
    match curvature < 0.0 {
        true if -0.25 * slope * slope / curvature < GAIN => 0.0,
        true => -0.5 * slope / curvature,
        false if less.max(more) < GAIN => 0.0,
        false => {
            if less > more {
                BEYOND * from
            } else {
                BEYOND * to
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::vertex;

    #[test]
    fn the_vertex_is_that_of_the_parabola() {
        for top in [-0.7, 0.2, 2.5] {
            let value = |x: f64| 5.0 * (top * top - (x - top).powi(2));
            let found = vertex([-1.5, 0.8], [value(-1.5), value(0.8)]);
            assert!((found - top).abs() < 1e-12, "{found} for {top}");
        }
        assert!(vertex([-1.0, 1.0], [5.0, 1.0]) < -1.0);
        assert!(vertex([-1.0, 1.0], [1.0, 5.0]) > 1.0);
        assert_eq!(vertex([-1.0, 1.0], [-1.0, -1.1]), 0.0, "a gain too small to be one");
    }
}
