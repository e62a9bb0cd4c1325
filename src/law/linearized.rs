//! One step of integration together with its linearisation in state and coefficients.
//!
//! With the state x = (q, q̇) and the coefficients θ, a step x⁺ = g(x, θ) has x⁺ + δx⁺ with δx⁺ = A δx + B δθ. The
//! state itself is integrated with order 4; A and B are taken at the middle of the step (order 2), which leaves a
//! Gauss–Newton fixed point where it is: only the path to it depends on them.

use super::compiled::Compiled;
use super::compiled::Table;
use super::motion::State;

/// A step and what it is linear about.
#[derive(Clone, Copy, Debug)]
pub struct Linearized {
    /// The state at the end of the step.
    pub state: State,
    /// A = ∂x⁺/∂x.
    pub transition: [[f64; 2]; 2],
    /// ∂x⁺/∂q̈ for an acceleration that acts over the whole step: B = input ⊗ ∂q̈/∂θ.
    pub input: [f64; 2],
    /// |∂q̈/∂q| dt² + |∂q̈/∂q̇| dt: how much happens within the step.
    pub rate: f64,
    /// q̈ at the start, and to order 3 at the end of the step.
    pub acceleration: [f64; 2],
}

impl Compiled {
    /// The step `dt` long under an excitation with these values at its start, middle and end. Writes ∂q̈/∂θ of the free
    /// terms at the middle of the step into `slopes`; a mass that varies with q counts as constant in the transition.
    #[inline]
    pub fn linearized_step(&self, state: State, dt: f64, excitation: [f64; 3], slopes: &mut [f64]) -> Linearized {
        self.step_with(state, dt, excitation, slopes, |_, _| {})
    }

    /// The same step of a motion that slides in `direction` all along, whichever sign its velocity takes.
    #[inline]
    pub(super) fn sliding_step(
        &self,
        state: State,
        dt: f64,
        excitation: [f64; 3],
        direction: f64,
        slopes: &mut [f64],
    ) -> Linearized {
        self.step_with(state, dt, excitation, slopes, |table, state| self.slide(table, state.qd, direction))
    }

    /// `amend` changes the factors at a point.
    #[inline]
    fn step_with(
        &self,
        state: State,
        dt: f64,
        excitation: [f64; 3],
        slopes: &mut [f64],
        amend: impl Fn(&mut Table, State),
    ) -> Linearized {
        let half = 0.5 * dt;
        let [from, middle, to] = excitation;
        let mut table = Table::EMPTY;
        let mut at = |state: State, excitation: f64| {
            self.fill(&mut table, state, excitation);
            amend(&mut table, state);
            self.acceleration(&table, excitation).0
        };
        let a1 = at(state, from);
        let s2 = State { q: state.q + half * state.qd, qd: state.qd + half * a1 };
        let a2 = at(s2, middle);
        let s3 = State { q: state.q + half * s2.qd, qd: state.qd + half * a2 };
        self.fill_all(&mut table, s3, middle);
        amend(&mut table, s3);
        let (a3, inverse_mass) = self.acceleration(&table, middle);
        self.slopes(&table, a3, inverse_mass, slopes);
        let [by_q, by_qd] = self.gradient(&table, s3, middle).map(|slope| -slope * inverse_mass);
        let s4 = State { q: state.q + dt * s3.qd, qd: state.qd + dt * a3 };
        self.fill(&mut table, s4, to);
        amend(&mut table, s4);
        let a4 = self.acceleration(&table, to).0;
        let half2 = half * dt;
        Linearized {
            state: State {
                q: state.q + dt / 6.0 * (state.qd + 2.0 * s2.qd + 2.0 * s3.qd + s4.qd),
                qd: state.qd + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4),
            },
            transition: [
                [1.0 + half2 * by_q, dt + half2 * by_qd],
                [dt * by_q + half2 * by_q * by_qd, 1.0 + dt * by_qd + half2 * (by_q + by_qd * by_qd)],
            ],
            input: [half2, dt + half2 * by_qd],
            rate: by_q.abs() * dt * dt + by_qd.abs() * dt,
            acceleration: [a1, a4],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::motion::Motion;
    use crate::law::term::Term;

    const TERMS: [Term; 4] = [Term::Inertia, Term::power(0, 1), Term::power(1, 0), Term::power(2, 1)];
    const COEFFICIENTS: [f64; 4] = [1.3, 0.3, 4.0, 0.7];

    fn drive(dt: f64) -> [f64; 3] {
        [0.4, 0.4 + 0.9 * dt, 0.4 + 1.8 * dt]
    }

    fn step(coefficients: &[f64], state: State, dt: f64) -> (Linearized, [f64; 4]) {
        let (mut compiled, mut slopes) = (Compiled::default(), [0.0; 4]);
        compiled.seek(&TERMS);
        compiled.compile(&Motion::new(&TERMS, coefficients));
        (compiled.linearized_step(state, dt, drive(dt), &mut slopes), slopes)
    }

    fn end(coefficients: &[f64], state: State, dt: f64) -> State {
        step(coefficients, state, dt).0.state
    }

    /// The largest error of A and B against differences of the step itself.
    fn error(dt: f64) -> f64 {
        let state = State { q: 0.8, qd: -0.3 };
        let (step, slopes) = step(&COEFFICIENTS, state, dt);
        let eps = 1e-5;
        let moved = |q: f64, qd: f64| end(&COEFFICIENTS, State { q: state.q + q, qd: state.qd + qd }, dt);
        let mut worst: f64 = 0.0;
        for (column, (dq, dqd)) in [(eps, 0.0), (0.0, eps)].into_iter().enumerate() {
            let (plus, minus) = (moved(dq, dqd), moved(-dq, -dqd));
            worst = worst.max(((plus.q - minus.q) / (2.0 * eps) - step.transition[0][column]).abs());
            worst = worst.max(((plus.qd - minus.qd) / (2.0 * eps) - step.transition[1][column]).abs());
        }
        for (index, slope) in slopes.into_iter().enumerate() {
            let nudged = |by: f64| {
                let mut coefficients = COEFFICIENTS;
                coefficients[index] += by;
                end(&coefficients, state, dt)
            };
            let (plus, minus) = (nudged(eps), nudged(-eps));
            worst = worst.max(((plus.q - minus.q) / (2.0 * eps) - step.input[0] * slope).abs());
            worst = worst.max(((plus.qd - minus.qd) / (2.0 * eps) - step.input[1] * slope).abs());
        }
        worst
    }

    #[test]
    fn one_step_of_the_linearisation_errs_with_order_three() {
        for dt in [0.08, 0.04, 0.02] {
            let order = (error(dt) / error(0.5 * dt)).log2();
            assert!((2.7..3.4).contains(&order), "order {order} at dt = {dt}");
        }
    }
}
