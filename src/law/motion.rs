//! Integration in time of a law whose coefficients are known.
//!
//! `Σ θ_j f_j = F` solved for the acceleration, `q̈ = (F − Σ θ_j force_j(q, q̇, F)) ÷ Σ θ_j mass_j(q)`, and one step of
//! the classical Runge–Kutta method (order 4) under an excitation that is held or runs on a straight line over the
//! step.

use super::expression::Expression;
use super::term::Term;
use serde::{Deserialize, Serialize};

/// Displacement and velocity of the coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Displacement, m (or charge, A s).
    pub q: f64,
    /// Velocity, m/s (or current, A).
    pub qd: f64,
}

impl State {
    /// Whether both values are finite numbers.
    pub fn is_finite(self) -> bool {
        self.q.is_finite() && self.qd.is_finite()
    }

    fn moved(self, slope: State, dt: f64) -> State {
        State { q: self.q + dt * slope.q, qd: self.qd + dt * slope.qd }
    }
}

/// A law with numbers: terms and their coefficients, of equal length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<'a> {
    /// What stands on the left-hand side.
    pub terms: &'a [Term],
    /// What multiplies each term: as many as terms, SI units.
    pub coefficients: &'a [f64],
    /// The user's own effects that terms name.
    pub own: &'a [Expression],
}

impl<'a> Motion<'a> {
    /// A law of these terms and coefficients, of equal length, none of them a user's own effect.
    pub const fn new(terms: &'a [Term], coefficients: &'a [f64]) -> Motion<'a> {
        Motion { terms, coefficients, own: &[] }
    }

    /// The same law, whose [`Term::Expression`]s count these.
    pub const fn with(self, own: &'a [Expression]) -> Motion<'a> {
        Motion { own, ..self }
    }

    /// Σ θ_j mass_j(q), what multiplies q̈, kg.
    pub fn mass(&self, q: f64) -> f64 {
        self.pairs().map(|(term, coefficient)| coefficient * term.mass(q)).sum()
    }

    /// q̈, m/s², at (q, q̇) under excitation F, N; not finite where the mass is 0.
    pub fn acceleration(&self, state: State, excitation: f64) -> f64 {
        let force: f64 =
            self.pairs().map(|(term, coefficient)| coefficient * term.force_of(self.own, state, excitation)).sum();
        (excitation - force) / self.mass(state.q)
    }

    /// (∂q̈/∂q, ∂q̈/∂q̇), 1/s² and 1/s, at (q, q̇) under excitation F, N.
    pub fn acceleration_gradient(&self, state: State, excitation: f64) -> [f64; 2] {
        let acceleration = self.acceleration(state, excitation);
        let mut sums = [0.0; 2];
        for (term, coefficient) in self.pairs() {
            let (by_q, by_qd) = term.gradient_of(self.own, state, excitation);
            sums[0] += coefficient * (by_q + term.mass_gradient(state.q) * acceleration);
            sums[1] += coefficient * by_qd;
        }
        let mass = self.mass(state.q);
        sums.map(|sum| -sum / mass)
    }

    /// The state `dt` s later under an excitation that stays at `excitation`, N.
    pub fn step_held(&self, state: State, dt: f64, excitation: f64) -> State {
        self.step_linear(state, dt, excitation, excitation)
    }

    /// The state `dt` s later under an excitation that runs straight from `from` to `to`, N.
    pub fn step_linear(&self, state: State, dt: f64, from: f64, to: f64) -> State {
        let middle = 0.5 * (from + to);
        let first = self.slope(state, from);
        let second = self.slope(state.moved(first, 0.5 * dt), middle);
        let third = self.slope(state.moved(second, 0.5 * dt), middle);
        let fourth = self.slope(state.moved(third, dt), to);
        let mean = |a: f64, b: f64, c: f64, d: f64| (a + 2.0 * b + 2.0 * c + d) / 6.0;
        let slope =
            State { q: mean(first.q, second.q, third.q, fourth.q), qd: mean(first.qd, second.qd, third.qd, fourth.qd) };
        state.moved(slope, dt)
    }

    fn slope(&self, state: State, excitation: f64) -> State {
        State { q: state.qd, qd: self.acceleration(state, excitation) }
    }

    fn pairs(&self) -> impl Iterator<Item = (&Term, f64)> {
        self.terms.iter().zip(self.coefficients.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::effect::Effect;

    const TERMS: [Term; 5] =
        [Term::Inertia, Term::power(0, 1), Term::power(1, 0), Term::power(2, 0), Term::power(3, 0)];
    const COEFFICIENTS: [f64; 5] = [1.3, 0.3, 4.0, 0.7, 2.0];

    fn integrate(steps: usize) -> State {
        let motion = Motion::new(&TERMS, &COEFFICIENTS);
        let dt = 2.0 / steps as f64;
        let excitation = |step: usize| 0.4 + 1.5 * step as f64 * dt;
        (0..steps).fold(State { q: 0.8, qd: -0.3 }, |state, step| {
            motion.step_linear(state, dt, excitation(step), excitation(step + 1))
        })
    }

    #[test]
    fn converges_with_order_four() {
        let exact = integrate(8192);
        let error = |steps| {
            let state = integrate(steps);
            (state.q - exact.q).abs() + (state.qd - exact.qd).abs()
        };
        for steps in [64, 128, 256] {
            let order = (error(steps) / error(2 * steps)).log2();
            assert!((3.8..4.3).contains(&order), "order {order} from {steps} steps");
        }
    }

    #[test]
    fn a_damped_oscillator_under_a_constant_force_follows_its_closed_form() {
        let motion = Motion::new(&TERMS[..3], &[2.0, 0.4, 8.0]);
        let (decay, frequency) = (0.1_f64, (4.0_f64 - 0.01).sqrt());
        let state = (0..3000).fold(State::default(), |state, _| motion.step_held(state, 1e-3, 4.0));
        let phase = frequency * 3.0;
        let expected = 0.5 * (1.0 - (-decay * 3.0).exp() * (phase.cos() + decay / frequency * phase.sin()));
        assert!((state.q - expected).abs() < 1e-12, "{} against {expected}", state.q);
    }

    #[test]
    fn the_gradient_of_the_acceleration_is_that_of_its_differences() {
        let terms =
            [Term::Inertia, Term::Effect(Effect::PositionDependentInertia), Term::power(1, 0), Term::power(2, 1)];
        let motion = Motion::new(&terms, &[1.0, 0.5, 4.0, 0.7]);
        let at = |q: f64, qd: f64| motion.acceleration(State { q: 0.8 + q, qd: -0.3 + qd }, 1.2);
        let eps = 1e-6;
        let differences = [at(eps, 0.0) - at(-eps, 0.0), at(0.0, eps) - at(0.0, -eps)];
        let gradient = motion.acceleration_gradient(State { q: 0.8, qd: -0.3 }, 1.2);
        for (slope, difference) in gradient.into_iter().zip(differences) {
            assert!((slope - difference / (2.0 * eps)).abs() < 1e-8, "{slope}");
        }
    }

    #[test]
    fn position_dependent_inertia_enters_the_mass() {
        let terms = [Term::Inertia, Term::Effect(Effect::PositionDependentInertia)];
        let motion = Motion::new(&terms, &[1.0, 0.5]);
        let state = State { q: 2.0, qd: 3.0 };
        assert_eq!(motion.mass(2.0), 3.0);
        assert_eq!(motion.acceleration(state, 12.0), (12.0 - 0.5 * 18.0) / 3.0);
    }
}
