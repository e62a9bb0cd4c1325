//! A step under dry friction, cut where the velocity reverses.
//!
//! Between two cuts the motion slides in one direction, or sticks. Where it reverses, small changes of the state jump
//! by the saltation matrix I + (f⁺ − f⁻) hᵀ ÷ (h · f⁻) of the surface q̇ = 0 (Leine and Nijmeijer 2004, sec. 7.3): with
//! f = (q̇, q̈) that is diag(1, q̈⁺ ÷ q̈⁻), and diag(1, 0) where it comes to stick.

use super::compiled::Compiled;
use super::compiled::Table;
use super::linearized::Linearized;
use super::motion::State;
use super::reversal::{MOST_CUTS, NEGLIGIBLE, REFINEMENTS, direction_from_rest, release, rest_within};

/// Largest factor by which a reversal may change δq̇. Friction makes it smaller, so that 10 bounds only what no
/// friction does: a force that pushes could make it anything.
const LARGEST_RATIO: f64 = 10.0;

impl Compiled {
    /// The step `dt` long under an excitation with these values at its start, middle and end, cut where dry friction
    /// reverses. `take` gets every smooth piece, its duration, s, and ∂q̈/∂θ of the free terms, which are as many as
    /// `slopes`.
    #[inline]
    pub fn steps(
        &self,
        state: State,
        dt: f64,
        excitation: [f64; 3],
        slopes: &mut [f64],
        mut take: impl FnMut(&Linearized, f64, &[f64]),
    ) {
        if !self.is_dry() {
            let step = self.linearized_step(state, dt, excitation, slopes);
            return take(&step, dt, slopes);
        }
        let mut sliding = Sliding::new(self, state, dt, excitation);
        while let Some((step, duration)) = sliding.next(self, slopes) {
            take(&step, duration, slopes);
        }
    }
}

/// Where a step under dry friction stands. Its pieces are smooth steps, and jumps of no duration between them.
#[derive(Clone, Copy, Debug)]
struct Sliding {
    state: State,
    dt: f64,
    excitation: [f64; 3],
    /// Share of the step that is done.
    done: f64,
    /// +1, −1; 0 where it sticks.
    direction: f64,
    jump: Option<f64>,
    cuts: usize,
}

impl Sliding {
    /// A step `dt` long under an excitation with these values at its start, middle and end.
    fn new(law: &Compiled, state: State, dt: f64, excitation: [f64; 3]) -> Sliding {
        let start = Sliding { state, dt, excitation, done: 0.0, direction: state.qd.signum(), jump: None, cuts: 0 };
        match state.qd {
            0.0 => Sliding { direction: start.direction_at(law, 0.0), ..start },
            _ => start,
        }
    }

    /// The next piece and its duration, s; none at the end of the step. Writes ∂q̈/∂θ of the free terms into `slopes`.
    fn next(&mut self, law: &Compiled, slopes: &mut [f64]) -> Option<(Linearized, f64)> {
        if let Some(ratio) = self.jump.take() {
            return Some((self.standing([1.0, ratio]), 0.0));
        }
        if self.done >= 1.0 {
            return None;
        }
        self.cuts += 1;
        if self.direction == 0.0 { Some(self.stick(law)) } else { Some(self.slide(law, slopes)) }
    }

    /// Rest until the other forces exceed friction.
    fn stick(&mut self, law: &Compiled) -> (Linearized, f64) {
        let released =
            if self.cuts < MOST_CUTS { release(self.done, |share| self.accelerations(law, share)) } else { None };
        let (until, direction) = released.unwrap_or((1.0, 0.0));
        let duration = (until - self.done) * self.dt;
        (self.done, self.direction) = (until, direction);
        (self.standing([1.0, 0.0]), duration)
    }

    /// To the end of the step, or to the instant of rest.
    fn slide(&mut self, law: &Compiled, slopes: &mut [f64]) -> (Linearized, f64) {
        let whole = (1.0 - self.done) * self.dt;
        let step = self.slide_for(law, 1.0, slopes);
        let rates = step.acceleration.map(|acceleration| acceleration * whole);
        let rest = rest_within(self.direction, [self.state.qd, step.state.qd], rates);
        match rest.filter(|_| self.cuts < MOST_CUTS) {
            Some(share) => self.come_to_rest(law, share, slopes),
            None => {
                (self.state, self.done) = (step.state, 1.0);
                (step, whole)
            }
        }
    }

    /// Newton's steps from a first guess of the instant; then what happens there.
    fn come_to_rest(&mut self, law: &Compiled, guess: f64, slopes: &mut [f64]) -> (Linearized, f64) {
        let whole = (1.0 - self.done) * self.dt;
        let mut share = guess;
        let mut step = self.slide_for(law, share, slopes);
        for _ in 0..REFINEMENTS {
            let by = step.state.qd / (step.acceleration[1] * whole);
            if by.is_nan() || by.abs() < NEGLIGIBLE {
                break;
            }
            share = (share - by).clamp(NEGLIGIBLE, 1.0);
            step = self.slide_for(law, share, slopes);
        }
        step.state.qd = 0.0;
        let before = self.direction;
        (self.state, self.done) = (step.state, if share < 1.0 { self.done + share * (1.0 - self.done) } else { 1.0 });
        self.direction = self.direction_at(law, self.done);
        self.jump = Some(self.ratio(law, before));
        (step, share * whole)
    }

    /// q̈ after the reversal ÷ q̈ before it.
    fn ratio(&self, law: &Compiled, before: f64) -> f64 {
        let [forward, backward] = self.accelerations(law, self.done);
        let along = |direction: f64| if direction > 0.0 { forward } else { backward };
        match self.direction {
            0.0 => 0.0,
            after => (along(after) / along(before)).clamp(0.0, LARGEST_RATIO),
        }
    }

    fn slide_for(&self, law: &Compiled, share: f64, slopes: &mut [f64]) -> Linearized {
        let left = 1.0 - self.done;
        let at = |part: f64| self.excitation_at(self.done + part * share * left);
        law.sliding_step(self.state, share * left * self.dt, [at(0.0), at(0.5), at(1.0)], self.direction, slopes)
    }

    /// The parabola through the three values.
    fn excitation_at(&self, share: f64) -> f64 {
        let [from, middle, to] = self.excitation;
        let (slope, bend) = (to - from, from + to - 2.0 * middle);
        from + share * slope - 2.0 * share * (1.0 - share) * bend
    }

    fn direction_at(&self, law: &Compiled, share: f64) -> f64 {
        let [forward, backward] = self.accelerations(law, share);
        direction_from_rest(forward, backward)
    }

    /// q̈ at rest if it slid forward and if it slid backward.
    fn accelerations(&self, law: &Compiled, share: f64) -> [f64; 2] {
        let (mut table, excitation) = (Table::EMPTY, self.excitation_at(share));
        law.fill(&mut table, State { qd: 0.0, ..self.state }, excitation);
        [1.0, -1.0].map(|direction| {
            law.slide(&mut table, 0.0, direction);
            law.acceleration(&table, excitation).0
        })
    }

    /// No motion; small changes are multiplied.
    fn standing(&self, [of_q, of_qd]: [f64; 2]) -> Linearized {
        Linearized {
            state: self.state,
            transition: [[of_q, 0.0], [0.0, of_qd]],
            input: [0.0; 2],
            rate: 0.0,
            acceleration: [0.0; 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::effect::Effect;
    use crate::law::motion::Motion;
    use crate::law::term::Term;

    fn terms() -> [Term; 5] {
        let stribeck = Effect::prototype("stribeck_friction").unwrap().with_inner(&[0.4]).unwrap();
        let coulomb = Term::Effect(Effect::CoulombFriction);
        [Term::Inertia, Term::power(0, 1), Term::power(1, 0), coulomb, Term::Effect(stribeck)]
    }

    const SLIPS: [f64; 5] = [1.3, 0.3, 4.0, 0.7, 0.4];
    const STICKS: [f64; 5] = [1.3, 0.3, 4.0, 2.2, 0.4];

    struct End {
        state: State,
        transition: [[f64; 2]; 2],
        input: [[f64; 2]; 5],
    }

    /// The end of a stretch of time in equal steps under a parabola, with what small changes became.
    fn end(coefficients: &[f64], start: State, duration: f64, steps: usize) -> End {
        let (terms, mut slopes) = (terms(), [0.0; 5]);
        let mut law = Compiled::default();
        law.seek(&terms);
        law.compile(&Motion::new(&terms, coefficients));
        assert!(law.is_dry());
        let excitation = |t: f64| 1.5 - 3.0 * t + 9.0 * t * t;
        let mut end = End { state: start, transition: [[1.0, 0.0], [0.0, 1.0]], input: [[0.0; 2]; 5] };
        let dt = duration / steps as f64;
        for step in 0..steps {
            let values = [0.0, 0.5, 1.0].map(|part| excitation((step as f64 + part) * dt));
            let mut sliding = Sliding::new(&law, end.state, dt, values);
            while let Some((piece, _)) = sliding.next(&law, &mut slopes) {
                let carry = |[q, qd]: [f64; 2]| piece.transition.map(|[a, b]| a * q + b * qd);
                let [first, second] = [0, 1].map(|column| carry(end.transition.map(|row| row[column])));
                end.transition = [[first[0], second[0]], [first[1], second[1]]];
                for (input, slope) in end.input.iter_mut().zip(slopes) {
                    let [q, qd] = carry(*input);
                    *input = [q + piece.input[0] * slope, qd + piece.input[1] * slope];
                }
                end.state = piece.state;
            }
        }
        end
    }

    fn distance(a: State, b: State) -> f64 {
        (a.q - b.q).abs().max((a.qd - b.qd).abs())
    }

    const START: State = State { q: 0.9, qd: 0.05 };

    #[test]
    fn a_step_across_a_reversal_is_exact_to_order_four() {
        for (coefficients, duration) in [(SLIPS, 0.08), (STICKS, 0.6)] {
            let exact = end(&coefficients, START, duration, 4096).state;
            assert!(exact.qd < 0.0 || coefficients == STICKS, "{exact:?}");
            let [coarse, fine] = [4, 8].map(|steps| distance(end(&coefficients, START, duration, steps).state, exact));
            assert!(coarse < 2e-7 && (fine < coarse / 10.0 || fine < 1e-9), "{coarse:e}, {fine:e}");
        }
        let exact = end(&SLIPS, START, 0.02, 4096).state;
        assert!(distance(end(&SLIPS, START, 0.02, 1).state, exact) < 1e-9);
    }

    #[test]
    fn small_changes_are_those_of_the_step_itself() {
        for (coefficients, duration) in [(SLIPS, 0.2), (STICKS, 0.9)] {
            let found = end(&coefficients, START, duration, 512);
            let eps = 1e-6;
            let difference =
                |plus: State, minus: State| [plus.q - minus.q, plus.qd - minus.qd].map(|d| d / (2.0 * eps));
            for (column, (q, qd)) in [(eps, 0.0), (0.0, eps)].into_iter().enumerate() {
                let moved = |sign: f64| State { q: START.q + sign * q, qd: START.qd + sign * qd };
                let [plus, minus] = [1.0, -1.0].map(|sign| end(&coefficients, moved(sign), duration, 512).state);
                for (row, expected) in difference(plus, minus).into_iter().enumerate() {
                    let value = found.transition[row][column];
                    assert!((value - expected).abs() < 2e-5, "{row}, {column}: {value} against {expected}");
                }
            }
            for index in 0..5 {
                let nudged = |by: f64| {
                    let mut moved = coefficients;
                    moved[index] += by;
                    end(&moved, START, duration, 512).state
                };
                for (row, expected) in difference(nudged(eps), nudged(-eps)).into_iter().enumerate() {
                    let value = found.input[index][row];
                    assert!((value - expected).abs() < 2e-5, "{index}, {row}: {value} against {expected}");
                }
            }
        }
    }

    #[test]
    fn the_least_motion_is_stopped_by_friction() {
        for qd in [1e-9, 1e-15, -1e-20] {
            let held = end(&[1.3, 0.3, 4.0, 9.0, 0.4], State { q: 0.5, qd }, 0.02, 1);
            assert_eq!(held.state.qd, 0.0, "{qd}");
            assert!((held.state.q - 0.5).abs() < 1e-9, "{qd}");
        }
    }

    #[test]
    fn what_friction_holds_stays_where_it_is() {
        let held = end(&[1.3, 0.3, 4.0, 9.0, 0.4], START, 0.3, 3);
        assert_eq!(held.state.qd, 0.0);
        assert!((held.state.q - START.q).abs() < 1e-3);
        assert_eq!(held.transition[1], [0.0, 0.0]);
        let longer = end(&[1.3, 0.3, 4.0, 9.0, 0.4], START, 0.4, 4);
        assert_eq!(longer.state, held.state);
    }
}
