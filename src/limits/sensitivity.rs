//! The variational equations: how a small change of the state or of a coefficient grows along a motion.
//!
//! A column c = (δq, δq̇) obeys ċ = (δq̇, ∂q̈/∂q δq + ∂q̈/∂q̇ δq̇ + ∂q̈/∂θ), the last for the column of a coefficient
//! alone. Columns are integrated with the motion by the classical Runge–Kutta method (order 4).
//!
//! Where dry friction changes sign the acceleration jumps from a⁻ to a⁺, and δq̇ with it, by the factor a⁺/a⁻ (the
//! saltation matrix, Aizerman and Gantmakher 1958; Leine and Nijmeijer 2004, 7.3). Where both sides push back the mass
//! sticks: δq̇ = 0.

use super::course::{Course, parts};
use crate::law::{Drive, Motion, State};

/// δq, δq̇.
pub type Column = [f64; 2];

/// Columns first those of the state, then one per coefficient that is sought.
const OF_STATE: usize = 2;

/// q̈ and its derivatives at one point.
#[derive(Clone, Debug, Default)]
struct Point {
    /// ∂q̈/∂q, ∂q̈/∂q̇.
    by_state: [f64; 2],
    /// ∂q̈/∂θ of the sought coefficients.
    by_coefficient: Vec<f64>,
}

/// Carries columns along a course.
pub struct Variation<'a> {
    motion: Motion<'a>,
    sought: &'a [usize],
    points: [Point; 4],
}

impl<'a> Variation<'a> {
    /// Of a law and its sought coefficients, as positions among its terms.
    pub fn new(motion: Motion<'a>, sought: &'a [usize]) -> Variation<'a> {
        let point = || Point { by_state: [0.0; 2], by_coefficient: vec![0.0; sought.len()] };
        Variation { motion, sought, points: std::array::from_fn(|_| point()) }
    }

    /// Carries columns from sample k to k + 1 of a course: two of the state, then one per sought coefficient.
    pub fn carry(&mut self, course: &Course, k: usize, columns: &mut [Column]) {
        let (from, to) = (course.states[k], course.states[k + 1]);
        let (dt, drive) = (course.dt(k), &course.drives[k]);
        let turns = from.qd * to.qd < 0.0;
        let share = if turns { from.qd / (from.qd - to.qd) } else { 0.0 };
        let at_rest = State { q: from.q + 0.5 * share * dt * from.qd, qd: 0.0 };
        let [above, below] = self.sides(at_rest, drive.at(share));
        let sticks = above < 0.0 && below > 0.0;
        if sticks && (turns || from.qd.abs() <= dt * above.abs().max(below.abs())) {
            columns.iter_mut().for_each(|column| column[1] = 0.0);
        } else if turns {
            let (before, after) = if from.qd > 0.0 { (above, below) } else { (below, above) };
            self.smooth(from, drive, [0.0, share], dt, columns);
            let jump = jump(from.qd, before, after);
            columns.iter_mut().for_each(|column| column[1] *= jump);
            let away = State { qd: f64::MIN_POSITIVE.copysign(to.qd), ..at_rest };
            self.smooth(away, drive, [share, 1.0], dt, columns);
        } else {
            self.smooth(from, drive, [0.0, 1.0], dt, columns);
        }
    }

    /// q̈ on both sides of q̇ = 0: just above, just below.
    fn sides(&self, at_rest: State, excitation: f64) -> [f64; 2] {
        [1.0, -1.0]
            .map(|side| self.motion.acceleration(State { qd: f64::MIN_POSITIVE.copysign(side), ..at_rest }, excitation))
    }

    /// A part of the interval in which the acceleration does not jump, from and to these shares of it.
    fn smooth(&mut self, state: State, drive: &Drive, [from, to]: [f64; 2], dt: f64, columns: &mut [Column]) {
        let count = parts(&self.motion, state, drive.at(0.5 * (from + to)), dt * (to - from));
        let share = (to - from) / count as f64;
        (0..count).fold(state, |state, part| {
            let begin = from + share * part as f64;
            let excitation = [0.0, 0.5, 1.0].map(|point| drive.at(begin + share * point));
            self.step(state, share * dt, excitation, columns)
        });
    }

    fn step(&mut self, state: State, dt: f64, [begin, middle, end]: [f64; 3], columns: &mut [Column]) -> State {
        let half = 0.5 * dt;
        let first = self.look(0, state, begin);
        let second_at = State { q: state.q + half * state.qd, qd: state.qd + half * first };
        let second = self.look(1, second_at, middle);
        let third_at = State { q: state.q + half * second_at.qd, qd: state.qd + half * second };
        let third = self.look(2, third_at, middle);
        let fourth_at = State { q: state.q + dt * third_at.qd, qd: state.qd + dt * third };
        let fourth = self.look(3, fourth_at, end);
        columns.iter_mut().enumerate().for_each(|(index, column)| *column = self.moved(*column, index, dt));
        let velocities = state.qd + 2.0 * (second_at.qd + third_at.qd) + fourth_at.qd;
        let accelerations = first + 2.0 * (second + third) + fourth;
        State { q: state.q + dt / 6.0 * velocities, qd: state.qd + dt / 6.0 * accelerations }
    }

    /// q̈ at a stage of the step, its derivatives kept.
    fn look(&mut self, stage: usize, state: State, excitation: f64) -> f64 {
        let mass = self.motion.mass(state.q);
        let acceleration = self.motion.acceleration(state, excitation);
        let point = &mut self.points[stage];
        point.by_state = self.motion.acceleration_gradient(state, excitation);
        for (slope, index) in point.by_coefficient.iter_mut().zip(self.sought) {
            let term = self.motion.terms[*index];
            *slope = -(term.force(state.q, state.qd, excitation) + term.mass(state.q) * acceleration) / mass;
        }
        acceleration
    }

    fn moved(&self, column: Column, index: usize, dt: f64) -> Column {
        let slope = |stage: usize, [q, qd]: Column| {
            let Point { by_state: [by_q, by_qd], by_coefficient } = &self.points[stage];
            let own = if index < OF_STATE { 0.0 } else { by_coefficient[index - OF_STATE] };
            [qd, by_q * q + by_qd * qd + own]
        };
        let after = |[q, qd]: Column, share: f64| [column[0] + share * dt * q, column[1] + share * dt * qd];
        let first = slope(0, column);
        let second = slope(1, after(first, 0.5));
        let third = slope(2, after(second, 0.5));
        let fourth = slope(3, after(third, 1.0));
        let mean = |row: usize| (first[row] + 2.0 * (second[row] + third[row]) + fourth[row]) / 6.0;
        after([mean(0), mean(1)], 1.0)
    }
}

/// What a jump of the acceleration from `before` to `after` makes of δq̇ where q̇ comes through 0 from `velocity`; 1
/// where a motion that is known only nearly does not come through.
fn jump(velocity: f64, before: f64, after: f64) -> f64 {
    let through = velocity * before < 0.0 && before * after > 0.0;
    if through { after / before } else { 1.0 }
}
