//! The law in weak form against variations that end at the newest sample: Poisson moment functionals.
//!
//! φ(τ) = a (aτ)⁴ e^(−aτ) ÷ 4!, τ back from now, vanishes with its first three derivatives at τ = 0 and fades behind. ∫
//! f φ dτ is f through five equal low-pass stages, so that every sample gives the integrals of all terms at a cost that
//! does not depend on how long the variation is, and derivatives go over to φ as in any weak form: the first two stages
//! take u, u̇ and ü alike. Every signal passes the same stages, trapezoidal in time, and therefore a law that holds at
//! the samples holds between the integrals. (Saha and Rao, *Identification of Continuous Dynamical Systems: the Poisson
//! Moment Functional Approach*, 1983; Garnier, Mensler and Richard, Int. J. Control 76, 2003.)

use crate::law::{Expression, Monomial, State, Term, raised};
use serde::{Deserialize, Serialize};

/// Stages behind the two that differentiate.
const STAGES: usize = 3;

/// An interval of samples as one stage takes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pole {
    decay: f64,
    gain: f64,
    slope: f64,
}

impl Pole {
    /// A stage a ÷ (s + a), a = `rate` in 1/s, over an interval `dt`, s.
    pub fn new(rate: f64, dt: f64) -> Pole {
        let advance = rate * dt;
        let scale = (2.0 + advance).recip();
        Pole { decay: (2.0 - advance) * scale, gain: advance * scale, slope: 2.0 * rate * scale }
    }
}

/// The running integral of one signal u₀ + u̇₁ + ü₂ against φ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Functional {
    last: Option<[f64; 3]>,
    differentiated: f64,
    first: f64,
    stages: [f64; STAGES + 1],
}

impl Functional {
    /// Samples, as multiples of 1 ÷ a, after which the beginning has faded to 0.4 % of an integral.
    pub const FADED: f64 = 13.0;

    /// Takes [u₀, u₁, u₂] at the end of an interval; returns the integral.
    #[inline]
    pub fn step(&mut self, pole: &Pole, signal: [f64; 3]) -> f64 {
        let last = self.last.replace(signal).unwrap_or(signal);
        let (differentiated, first) = (self.differentiated, self.first);
        self.differentiated = pole.decay * differentiated + pole.slope * (signal[2] - last[2]);
        self.first = pole.decay * first + pole.gain * (signal[0] + last[0]) + pole.slope * (signal[1] - last[1]);
        let mut before = self.stages[0];
        self.stages[0] = pole.decay * before
            + pole.gain * (self.first + first)
            + pole.slope * (self.differentiated - differentiated);
        for index in 1..=STAGES {
            let own = self.stages[index];
            self.stages[index] = pole.decay * own + pole.gain * (self.stages[index - 1] + before);
            before = own;
        }
        self.stages[STAGES]
    }

    /// What white noise of variance 1 in the samples of u₀, u₁ or u₂ (`order` 0, 1, 2) adds to the integral's variance,
    /// for a = 1 and samples `dt` apart; for another a times a^(2 order).
    pub fn noise_gain(order: usize, dt: f64) -> f64 {
        let pole = Pole::new(1.0, dt);
        let mut functional = Functional::default();
        let lasting = (3.0 * Functional::FADED / dt) as usize;
        let at = |sample: usize| {
            let mut signal = [0.0; 3];
            signal[order] = if sample == 1 { 1.0 } else { 0.0 };
            signal
        };
        (0..lasting).map(|sample| functional.step(&pole, at(sample)).powi(2)).sum()
    }
}

/// A term as [u₀, u₁, u₂] with f = u₀ + u̇₁ + ü₂: as many derivatives as can be are φ's. Without a measured
/// displacement (`by_parts` false) q̇ itself is the signal.
pub fn signal(term: Term, own: &[Expression], state: State, excitation: f64, by_parts: bool) -> [f64; 3] {
    let State { q, qd } = state;
    match term {
        Term::Inertia if by_parts => [0.0, 0.0, q],
        Term::Inertia => [0.0, qd, 0.0],
        Term::Monomial(Monomial { q: power, qd: 1, excitation: 0 }) if by_parts => {
            let next = power + 1;
            [0.0, raised(q, next) / f64::from(next), 0.0]
        }
        // q² q̈ + q q̇² = (q² q̇)' − q q̇²
        Term::Effect(_) if term.mass(1.0) != 0.0 => {
            [term.force(q, qd, excitation) - 2.0 * q * qd * qd, term.mass(q) * qd, 0.0]
        }
        _ => [term.force_of(own, state, excitation), 0.0, 0.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 3.0;

    /// The largest difference between the integrals of f and of u̇₁ or ü₂ that are f, once the beginning has faded.
    fn violation(dt: f64) -> f64 {
        let pole = Pole::new(RATE, dt);
        let mut functionals = [Functional::default(); 3];
        let mut worst = 0.0f64;
        for k in 0..(20.0 / dt) as usize {
            let t = dt * k as f64;
            let (value, slope, curvature) =
                ((1.7 * t + 0.3).sin(), 1.7 * (1.7 * t + 0.3).cos(), -2.89 * (1.7 * t + 0.3).sin());
            let signals = [[curvature, 0.0, 0.0], [0.0, slope, 0.0], [0.0, 0.0, value]];
            let mut integrals = [0.0; 3];
            for ((integral, functional), signal) in integrals.iter_mut().zip(&mut functionals).zip(signals) {
                *integral = functional.step(&pole, signal);
            }
            if RATE * t > 2.0 * Functional::FADED {
                worst = worst.max((integrals[0] - integrals[1]).abs()).max((integrals[0] - integrals[2]).abs());
            }
        }
        worst
    }

    #[test]
    fn derivatives_go_over_to_the_variation_with_order_two() {
        for dt in [0.1, 0.05, 0.02] {
            let order = (violation(dt) / violation(0.5 * dt)).log2();
            assert!(order > 1.9, "order {order} at {dt} s");
        }
    }

    #[test]
    fn a_constant_is_its_own_integral_once_the_beginning_has_faded() {
        let pole = Pole::new(RATE, 0.1);
        let mut functional = Functional::default();
        let samples = (Functional::FADED / (RATE * 0.1)) as usize;
        let integral = (0..samples).fold(0.0, |_, _| functional.step(&pole, [2.0, 5.0, 7.0]));
        assert!((integral - 2.0).abs() < 0.004 * 2.0, "{integral}");
    }
}
