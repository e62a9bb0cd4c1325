//! Families of variations δq.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A variation on 0 ≤ s ≤ 1, s = (t − T₁) ÷ (T₂ − T₁).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Variation {
    /// (4 s (1 − s))ᵖ: the first p − 1 derivatives vanish at both ends.
    Polynomial {
        /// p ≥ 2.
        power: u8,
    },
    /// sin²(π s) sin(k π s) for k > 1, sin²(π s) for k = 1: like the publication's sines, but with a slope that
    /// vanishes at both ends.
    Sine {
        /// k ≥ 1.
        mode: u8,
    },
    /// (4 s (1 − s))⁶ sin(k π s): sines as smooth at both ends as the polynomials.
    SmoothSine {
        /// k ≥ 1.
        mode: u8,
    },
}

impl Variation {
    /// [φ, dφ/ds, d²φ/ds²] at 0 ≤ s ≤ 1, all without unit.
    pub fn at(self, s: f64) -> [f64; 3] {
        match self {
            Variation::Polynomial { power } => polynomial(s, i32::from(power)),
            Variation::Sine { mode: 1 } => {
                let angle = PI * s;
                [angle.sin().powi(2), PI * (2.0 * angle).sin(), 2.0 * PI * PI * (2.0 * angle).cos()]
            }
            Variation::Sine { mode } => product(Variation::Sine { mode: 1 }.at(s), sine(s, f64::from(mode))),
            Variation::SmoothSine { mode } => product(polynomial(s, 6), sine(s, f64::from(mode))),
        }
    }
}

/// xᵖ⁻²; the powers that are in use without a loop.
#[inline]
fn low_power(x: f64, p: i32) -> f64 {
    match p {
        4 => x * x,
        6 => (x * x) * (x * x),
        _ => x.powi(p - 2),
    }
}

#[inline]
fn polynomial(s: f64, p: i32) -> [f64; 3] {
    let (base, slope) = (4.0 * s * (1.0 - s), 4.0 * (1.0 - 2.0 * s));
    let order = f64::from(p);
    let low = low_power(base, p);
    [low * base * base, order * low * base * slope, order * low * ((order - 1.0) * slope * slope - 8.0 * base)]
}

fn sine(s: f64, mode: f64) -> [f64; 3] {
    let rate = mode * PI;
    let (sin, cos) = (rate * s).sin_cos();
    [sin, rate * cos, -rate * rate * sin]
}

/// Leibniz's rule.
fn product(f: [f64; 3], g: [f64; 3]) -> [f64; 3] {
    [f[0] * g[0], f[1] * g[0] + f[0] * g[1], f[2] * g[0] + 2.0 * f[1] * g[1] + f[0] * g[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAMILIES: [Variation; 8] = [
        Variation::Polynomial { power: 2 },
        Variation::Polynomial { power: 4 },
        Variation::Polynomial { power: 6 },
        Variation::Polynomial { power: 5 },
        Variation::Sine { mode: 1 },
        Variation::Sine { mode: 2 },
        Variation::Sine { mode: 5 },
        Variation::SmoothSine { mode: 3 },
    ];

    #[test]
    fn a_variation_and_its_slope_vanish_at_both_ends() {
        for variation in FAMILIES {
            for s in [0.0, 1.0] {
                let [value, slope, _] = variation.at(s);
                assert!(value.abs() < 1e-12 && slope.abs() < 1e-12, "{variation:?} at {s}: {value}, {slope}");
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        let h = 1e-5;
        for variation in FAMILIES {
            for s in [0.13, 0.5, 0.71] {
                let [below, at, above] = [s - h, s, s + h].map(|s| variation.at(s));
                let scale = at[2].abs().max(1.0);
                assert!(((above[0] - below[0]) / (2.0 * h) - at[1]).abs() < 1e-7 * scale, "{variation:?} at {s}");
                assert!(
                    ((above[1] - below[1]) / (2.0 * h) - at[2]).abs() < 1e-6 * scale.max(100.0),
                    "{variation:?} at {s}"
                );
            }
        }
    }
}
