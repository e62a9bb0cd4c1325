//! The excitation between two samples.

use super::hold::Hold;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// How finely a band-limited excitation is known inside an interval: values at `NODES + 1` points, ends included.
pub const NODES: usize = 16;

/// Samples on each side that band-limited interpolation looks at.
pub const REACH: usize = 16;

/// The excitation from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Drive {
    /// Held at a value.
    Held(f64),
    /// A straight line between two values.
    Line(f64, f64),
    /// Values at `NODES + 1` equidistant points.
    Nodes([f64; NODES + 1]),
}

impl Drive {
    /// Values at the start, the middle and the end of part `index` of `parts` equal parts.
    ///
    /// A band-limited drive serves 1, 2, 4 or 8 parts.
    #[inline]
    pub fn part(&self, index: usize, parts: usize) -> [f64; 3] {
        match self {
            Drive::Held(value) => [*value; 3],
            Drive::Line(from, to) => {
                let at = |point: f64| from + (to - from) * point / parts as f64;
                [at(index as f64), at(index as f64 + 0.5), at(index as f64 + 1.0)]
            }
            Drive::Nodes(nodes) => {
                let width = NODES / parts;
                [nodes[index * width], nodes[index * width + width / 2], nodes[(index + 1) * width]]
            }
        }
    }

    /// The value at a share of the interval, 0 … 1; straight between nodes.
    pub fn at(&self, share: f64) -> f64 {
        match self {
            Drive::Held(value) => *value,
            Drive::Line(from, to) => from + (to - from) * share,
            Drive::Nodes(nodes) => {
                let position = (share * NODES as f64).clamp(0.0, NODES as f64);
                let index = (position as usize).min(NODES - 1);
                nodes[index] + (nodes[index + 1] - nodes[index]) * (position - index as f64)
            }
        }
    }

    /// How many parts a drive of this hold needs at least for `parts` to be wanted.
    #[inline]
    pub fn parts(&self, wanted: usize) -> usize {
        match self {
            Drive::Nodes(_) => wanted.next_power_of_two().clamp(4, NODES / 2),
            _ => wanted.max(1),
        }
    }
}

/// Interpolates equidistant samples of a band-limited excitation.
///
/// A sinc windowed by (1 − r²) exp(−6 r²), r = distance ÷ `REACH`, whose weights are normalised so that a constant
/// stays one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandLimited {
    /// `weights[node][tap]`: tap `REACH − 1` is the sample at the interval's start.
    weights: Vec<[f64; 2 * REACH]>,
}

impl BandLimited {
    /// The interpolator: its weights do not depend on the data.
    pub fn new() -> BandLimited {
        BandLimited { weights: (0..=NODES).map(|node| weights(node as f64 / NODES as f64)).collect() }
    }

    /// The excitation over the interval that starts at tap `REACH − 1` of `taps`.
    pub fn interpolate(&self, taps: &[f64; 2 * REACH]) -> Drive {
        let at = |node: usize| self.weights[node].iter().zip(taps).map(|(weight, tap)| weight * tap).sum();
        Drive::Nodes(std::array::from_fn(at))
    }
}

impl Default for BandLimited {
    fn default() -> BandLimited {
        BandLimited::new()
    }
}

fn weights(position: f64) -> [f64; 2 * REACH] {
    let raw: [f64; 2 * REACH] = std::array::from_fn(|tap| {
        let distance = position - (tap as f64 - (REACH as f64 - 1.0));
        let r2 = (distance / REACH as f64).powi(2);
        if r2 >= 1.0 { 0.0 } else { sinc(distance) * (1.0 - r2) * (-6.0 * r2).exp() }
    });
    let sum: f64 = raw.iter().sum();
    raw.map(|weight| weight / sum)
}

fn sinc(x: f64) -> f64 {
    if x == x.round() { if x == 0.0 { 1.0 } else { 0.0 } } else { (PI * x).sin() / (PI * x) }
}

/// Samples after an interval's start that must be known before its drive is.
pub fn look_ahead(hold: Hold) -> usize {
    match hold {
        Hold::Zero | Hold::Linear => 1,
        Hold::BandLimited => REACH,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn band_limited_interpolation_follows_a_sine_at_a_third_of_the_sampling_frequency() {
        let signal = |x: f64| (2.0 * PI * 0.33 * x + 0.7).sin();
        let taps = std::array::from_fn(|tap| signal(tap as f64 - (REACH as f64 - 1.0)));
        let Drive::Nodes(nodes) = BandLimited::new().interpolate(&taps) else { panic!("not nodes") };
        for (node, value) in nodes.iter().enumerate() {
            let exact = signal(node as f64 / NODES as f64);
            assert!((value - exact).abs() < 2e-3, "node {node}: {value} against {exact}");
        }
    }

    #[test]
    fn parts_of_a_line_join_and_cover_it() {
        let drive = Drive::Line(1.0, 3.0);
        assert_eq!(drive.part(0, 2), [1.0, 1.5, 2.0]);
        assert_eq!(drive.part(1, 2), [2.0, 2.5, 3.0]);
    }

    #[test]
    fn a_drive_at_a_share_meets_its_parts() {
        let nodes = Drive::Nodes(std::array::from_fn(|node| (node * node) as f64));
        for drive in [Drive::Held(0.7), Drive::Line(1.0, 3.0), nodes] {
            for (index, value) in drive.part(1, 4).into_iter().enumerate() {
                assert_eq!(drive.at(0.25 + 0.125 * index as f64), value, "{drive:?}");
            }
        }
    }
}
