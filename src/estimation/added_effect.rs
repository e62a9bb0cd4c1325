//! An effect that is added to a law: its coefficient is sought beside the law's own, run by run.
//!
//! The law's own coefficients are told with that of the effect left open: with M and g their information and score, c,
//! i and s those of the effect beside them, it is M − ccᵀ ÷ i and g − cs ÷ i that tell them (the Schur complement).

use super::filter::Innovation;
use super::information::{Information, Solution};
use super::one_more_coefficient::{OwnTerms, Sums};
use super::pass::{Observation, Pass, gains};
use crate::law::{Motion, State, Term};
use serde::{Deserialize, Serialize};

/// What is known of an effect before a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KnownEffect {
    /// The effect, with inner parameters.
    pub term: Term,
    /// Its coefficient.
    pub coefficient: f64,
    /// 1 ÷ the variance of that.
    pub precision: f64,
}

/// The effect beside a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AddedEffect {
    pub(super) sums: Sums,
    before: State,
    /// What a coefficient of 1 has done to (q, q̇) over the last interval.
    pub input: [f64; 2],
    /// Coefficient and 1 ÷ its variance before the record.
    known: [f64; 2],
}

impl AddedEffect {
    /// None beside `n` free terms.
    pub fn new(n: usize) -> AddedEffect {
        AddedEffect { sums: Sums::new(n), before: State::default(), input: [0.0; 2], known: [0.0; 2] }
    }

    /// This is known of its coefficient before the record.
    pub fn suppose(&mut self, known: &KnownEffect) {
        self.known = [known.coefficient, known.precision];
    }

    /// ∂(q, q̇)/∂ its coefficient of the filtered state.
    pub fn sensitivity(&self) -> [f64; 2] {
        self.sums.sensitivity
    }

    /// Gives what went with a run for another one's room; both know the same beforehand from now on.
    pub fn hand_over(&mut self, live: &mut AddedEffect) {
        live.known = self.known;
        std::mem::swap(self, live);
    }

    /// Begins beside a run.
    pub fn begin(&mut self, state: State) {
        self.sums.clear();
        self.before = state;
    }

    /// Copies the other's sums into this room, without what was known before.
    pub fn copy_from(&mut self, other: &AddedEffect) {
        self.sums.copy_from(&other.sums);
        (self.before, self.known) = (other.before, [0.0; 2]);
    }

    /// The law's own coefficients have become those plus `steps`, that of the effect that plus `step`; so the law's own
    /// terms, which follow their own steps already, are told `own`.
    pub fn shift(&mut self, steps: &[f64], step: f64, own: &mut Information) {
        self.sums.shift(steps);
        self.sums.score -= self.sums.information * step;
        self.sums.take_out(-step, own);
    }

    /// Takes the sample that the run has just taken, under the law `motion` with the effect; returns what its
    /// coefficient makes of the innovations.
    pub fn step(
        &mut self,
        effect: Term,
        motion: &Motion,
        pass: &Pass,
        observation: &Observation,
        innovations: &[Option<Innovation>; 2],
    ) -> [f64; 2] {
        let pushed = push(effect, motion, self.before, pass, observation);
        self.before = pass.filter.state();
        self.input = pass.map.push.map(|push| push * pushed);
        self.sums.take(pass, pushed, &gains(innovations), innovations, [0.0; 2])
    }

    /// What the law's own terms are told with the coefficient, which is `value`, left open.
    pub fn leave_open(&self, value: f64, own: &mut Information) {
        self.add_share(-1.0, value, own);
    }

    /// What they are told with it held, of what they are with it left open.
    pub fn hold(&self, value: f64, own: &mut Information) {
        self.add_share(1.0, value, own);
    }

    /// What the law's own terms are told with it held, in that room for one more unknown: itself, the last.
    pub fn widen(&self, value: f64, own: &Information, whole: &mut Information) {
        own.widen(whole);
        let (information, score) = self.told(value);
        whole.tell_last(&self.sums.cross, information, score);
    }

    /// Adds so many times ccᵀ ÷ i and cs ÷ i.
    fn add_share(&self, times: f64, value: f64, own: &mut Information) {
        let (information, score) = self.told(value);
        let n = own.n;
        for row in 0..n {
            let share = times * self.sums.cross[row] / information;
            own.score[row] += share * score;
            for (entry, cross) in own.matrix[row * n + row..(row + 1) * n].iter_mut().zip(&self.sums.cross[row..n]) {
                *entry += share * cross;
            }
        }
    }

    /// The coefficient's own step from `value`, after the law's own terms have taken theirs; the state's with it.
    pub fn step_from(&self, value: f64, steps: &[f64]) -> (f64, [f64; 2]) {
        let (information, score) = self.told(value);
        let moved: f64 = self.sums.cross.iter().zip(steps).map(|(cross, step)| cross * step).sum();
        let step = (score - moved) / information;
        (step, self.sums.sensitivity.map(|sensitivity| step * sensitivity))
    }

    /// Variance of the coefficient where `solution` is of what [`AddedEffect::leave_open`] leaves.
    pub fn variance(&self, solution: &Solution, active: &[bool]) -> f64 {
        let (information, _) = self.told(0.0);
        (1.0 + self.overlap(solution, active) / information) / information
    }

    /// The same beside any one more of the law's terms, `own` being what they are told with the coefficient held;
    /// infinite where one leaves nothing of it. `room` is left with what that solves.
    pub fn variance_beside_another(&self, own: &Information, active: &[bool], room: &mut OwnTerms) -> f64 {
        let n = own.n;
        self.widen(0.0, own, &mut room.information);
        let mut beside = |one_more: Option<usize>| {
            room.active[..n].copy_from_slice(active);
            one_more.into_iter().chain([n]).for_each(|index| room.active[index] = true);
            room.solution.solve(&room.information, &room.active);
            if room.solution.determined[n] { room.solution.variance(n) } else { f64::INFINITY }
        };
        let own = beside(None);
        (0..n).filter(|index| !active[*index]).map(|index| beside(Some(index))).fold(own, f64::max)
    }

    /// What of the effect is like the law's own terms: by how much these are others for each unit of its coefficient,
    /// n; `solution` as in [`AddedEffect::variance`].
    pub fn likeness(&self, solution: &Solution, active: &[bool], likeness: &mut [f64]) {
        let (information, _) = self.told(0.0);
        let whole = 1.0 + self.overlap(solution, active) / information;
        for (row, slot) in likeness.iter_mut().enumerate() {
            let is_told = active[row] && solution.determined[row];
            *slot = if is_told { self.shared(row, solution, active) / whole } else { 0.0 };
        }
    }

    /// cᵀΣc, Σ being the covariance of the law's own terms.
    fn overlap(&self, solution: &Solution, active: &[bool]) -> f64 {
        let told = (0..active.len()).filter(|row| active[*row] && solution.determined[*row]);
        told.map(|row| self.sums.cross[row] * self.shared(row, solution, active)).sum()
    }

    /// A row of Σc.
    fn shared(&self, row: usize, solution: &Solution, active: &[bool]) -> f64 {
        let n = active.len();
        let told = (0..n).filter(|column| active[*column] && solution.determined[*column]);
        told.map(|column| solution.covariance[row * n + column] * self.sums.cross[column]).sum()
    }

    /// (information, score) about `value`, with what was known before.
    fn told(&self, value: f64) -> (f64, f64) {
        let [centre, precision] = self.known;
        (self.sums.information + precision + f64::MIN_POSITIVE, self.sums.score + precision * (centre - value))
    }
}

impl OwnTerms {
    /// As a run says it of those that are active, beside the effect that the law may have.
    pub fn solve(&mut self, own: &Information, active: &[bool], effect: Option<&AddedEffect>) {
        self.solve_beside(own, active, effect.map(|effect| &effect.sums));
    }
}

/// The acceleration over the run's last interval, from the state `before` it, that a coefficient of 1 of the term is.
fn push(term: Term, motion: &Motion, before: State, pass: &Pass, observation: &Observation) -> f64 {
    let state = pass.filter.state();
    let acceleration = (state.qd - before.qd) / observation.dt;
    let [from, _, to] = observation.drive.part(0, 1);
    let force = 0.5 * (term.force(before.q, before.qd, from) + term.force(state.q, state.qd, to));
    -(force + term.mass(state.q) * acceleration) / motion.mass(state.q)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What forty readings of x + 0.3 y + 0.5 z say of the first two coefficients, and of the third beside them: x and
    /// y from 0, z from 0.2, each with the std 0.1.
    fn readings() -> (Information, AddedEffect) {
        let (mut own, mut effect) = (Information::none(2), AddedEffect::new(2));
        for k in 0..40 {
            let phase = 0.37 * f64::from(k);
            let features = [phase.sin(), phase.cos(), 0.6 * phase.sin() + (2.0 * phase).cos()];
            let residual = features[0] + 0.3 * features[1] + (0.5 - 0.2) * features[2];
            own.add(&features[..2], residual, 0.01);
            effect.sums.information += features[2] * features[2] / 0.01;
            effect.sums.score += features[2] * residual / 0.01;
            effect.sums.cross.iter_mut().zip(&features).for_each(|(sum, own)| *sum += own * features[2] / 0.01);
        }
        (own, effect)
    }

    /// The own coefficients' solution with that of the effect left open.
    fn solved(own: &mut Information, effect: &AddedEffect) -> Solution {
        effect.leave_open(0.2, own);
        let mut solution = Solution::none(2);
        solution.solve(own, &[true; 2]);
        solution
    }

    #[test]
    fn both_together_are_found() {
        let (mut own, effect) = readings();
        let solution = solved(&mut own, &effect);
        let (step, _) = effect.step_from(0.2, &solution.step);
        assert!((solution.step[0] - 1.0).abs() < 1e-9 && (solution.step[1] - 0.3).abs() < 1e-9, "{:?}", solution.step);
        assert!((step - 0.3).abs() < 1e-9, "{step}");
    }

    /// A step of both, and the coefficient held again after it was left open: what was told about the old coefficients
    /// is told about the new ones.
    #[test]
    fn what_was_left_open_is_held_again_about_other_coefficients() {
        let (mut own, mut effect) = readings();
        let (mut told, steps, step) = (own.clone(), [0.7, -0.2], 0.4);
        effect.suppose(&KnownEffect { term: Term::power(2, 0), coefficient: 0.3, precision: 50.0 });
        effect.leave_open(0.2, &mut told);
        told.shift(&steps);
        own.shift(&steps);
        effect.shift(&steps, step, &mut own);
        effect.hold(0.2 + step, &mut told);
        let near = |(one, other): (&f64, &f64)| (one - other).abs() < 1e-9 * (1.0 + other.abs());
        assert!(told.score.iter().zip(&own.score).all(near), "{:?} against {:?}", told.score, own.score);
        assert!([0, 1, 3].iter().all(|entry| near((&told.matrix[*entry], &own.matrix[*entry]))));
    }

    #[test]
    fn the_variance_is_that_of_the_larger_system() {
        let (mut own, effect) = readings();
        let mut whole = Solution::none(2);
        whole.solve(&own, &[true; 2]);
        let shared: Vec<f64> = (0..2).map(|row| effect.shared(row, &whole, &[true; 2])).collect();
        let left = effect.sums.information - shared[0] * effect.sums.cross[0] - shared[1] * effect.sums.cross[1];
        let solution = solved(&mut own, &effect);
        let found = effect.variance(&solution, &[true; 2]);
        assert!((found * left - 1.0).abs() < 1e-9, "{found} against {}", left.recip());
        let mut likeness = [0.0; 2];
        effect.likeness(&solution, &[true; 2], &mut likeness);
        assert!(likeness.iter().zip(&shared).all(|(a, b)| (a - b).abs() < 1e-9), "{likeness:?} against {shared:?}");
    }

    /// Forty readings of 0.5 w about a law of x, y and z, z the effect with 0.2 too much: what is asked for w is the
    /// gain with z left open, and z itself gains nothing more.
    #[test]
    fn another_effect_is_asked_for_with_this_one_left_open() {
        let (mut own, mut effect) = (Information::none(2), AddedEffect::new(2));
        let (mut other, mut same, mut whole) = (Sums::new(2), Sums::new(2), Information::none(4));
        for k in 0..40 {
            let phase = 0.37 * f64::from(k);
            let z = 0.6 * phase.sin() + (2.0 * phase).cos();
            let row = [phase.sin(), phase.cos(), z, 0.8 * z + (3.0 * phase).sin()];
            let residual = 0.5 * row[3] - 0.2 * z;
            own.add(&row[..2], residual, 0.01);
            whole.add(&row, residual, 0.01);
            for (sums, feature) in [(&mut effect.sums, z), (&mut same, z), (&mut other, row[3])] {
                sums.information += feature * feature / 0.01;
                sums.score += feature * residual / 0.01;
                sums.cross.iter_mut().zip(&row[..3]).for_each(|(sum, own)| *sum += own * feature / 0.01);
            }
        }
        let mut terms = OwnTerms::none(2);
        terms.solve(&own, &[true; 2], Some(&effect));
        let mut all = Solution::none(4);
        all.solve(&whole, &[true; 4]);
        let (coefficient, gain, information) = other.gain(&terms);
        assert!((coefficient - all.step[3]).abs() < 1e-9, "{coefficient} against {}", all.step[3]);
        assert!((information * all.covariance[15] - 1.0).abs() < 1e-9 && gain > 100.0, "{information}, {gain}");
        assert_eq!(same.gain(&terms), (0.0, 0.0, 0.0));
    }

    #[test]
    fn what_was_known_before_counts() {
        let (mut own, mut effect) = readings();
        let term = Term::power(2, 0);
        effect.suppose(&KnownEffect { term, coefficient: 0.2, precision: 1e12 });
        let solution = solved(&mut own, &effect);
        let (step, _) = effect.step_from(0.2, &solution.step);
        assert!(step.abs() < 1e-6 && (effect.variance(&solution, &[true; 2]) * 1e12 - 1.0).abs() < 1e-6, "{step}");
    }
}
