//! The Kalman filter of one coordinate's state together with the coefficients of its law, which may wander.
//!
//! With κ_j = θ_j ÷ m and b = 1 ÷ m the acceleration is linear in what is sought, q̈ = b F − Σ κ_j f_j: the extended
//! filter (Ljung, IEEE TAC 24, 1979) of (q, q̇, θ) follows a product of two unknowns and is biased, that of (q, q̇, κ,
//! b) is linear in the unknowns but for the state that they share. The covariance is (2 + n) × (2 + n).

use super::covariance::{carry, correct};
use super::filter::{Channel, Filter, Noise, times, white_acceleration};
use super::initial_state::state_after_outage;
use super::pass::{IntervalMap, Observation};
use crate::law::{Compiled, Expression, Motion, State, Term};
use serde::{Deserialize, Serialize};

/// What a filter follows: the law's terms and which of their coefficients are free.
#[derive(Clone, Copy, Debug)]
pub struct Unknowns<'a> {
    /// All terms.
    pub terms: &'a [Term],
    /// The user's own effects that they name.
    pub own: &'a [Expression],
    /// Places of the free ones among them, n.
    pub free: &'a [usize],
    /// The free ones, n.
    pub free_terms: &'a [Term],
    /// Place of the inertia among all terms.
    pub inertia: usize,
    /// Place of the inertia among the free ones, where it is one.
    pub free_inertia: Option<usize>,
}

/// What a filter begins with.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// All coefficients θ of the law.
    pub all: &'a [f64],
    /// What θ is measured by, n.
    pub reach: &'a [f64],
    /// Std of θ relative to it.
    pub width: f64,
    /// (q, q̇).
    pub first: Filter,
}

/// Mean and covariance of state and coefficients.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AugmentedFilter {
    /// Σ −½ (ε² ÷ s + ln s).
    pub log_likelihood: f64,
    state: State,
    /// κ by free coefficient; b in the inertia's place.
    scaled: Vec<f64>,
    all: Vec<f64>,
    covariance: Vec<f64>,
    moved: Vec<[f64; 2]>,
    column: Vec<f64>,
    gain: Vec<f64>,
    slopes: Vec<f64>,
    scaled_slopes: Vec<f64>,
    map: IntervalMap,
    compiled: Compiled,
}

impl AugmentedFilter {
    /// A filter that has not begun, of `n` coefficients among `terms`.
    pub fn new(terms: usize, n: usize) -> AugmentedFilter {
        let size = n + 2;
        AugmentedFilter {
            log_likelihood: 0.0,
            state: State::default(),
            scaled: vec![0.0; n],
            all: vec![0.0; terms],
            covariance: vec![0.0; size * size],
            moved: vec![[0.0; 2]; size],
            column: vec![0.0; size],
            gain: vec![0.0; size],
            slopes: vec![0.0; n],
            scaled_slopes: vec![0.0; n],
            map: IntervalMap { transition: [[0.0; 2]; 2], input: vec![[0.0; 2]; n], push: [0.0; 2] },
            compiled: Compiled::default(),
        }
    }

    /// Begins at a state and a law.
    pub fn begin(&mut self, unknowns: &Unknowns, start: &Start) {
        self.compiled.seek(unknowns.free_terms);
        self.all.copy_from_slice(start.all);
        let inverse = start.all[unknowns.inertia].recip();
        for (free, (scaled, place)) in self.scaled.iter_mut().zip(unknowns.free).enumerate() {
            *scaled = if unknowns.free_inertia == Some(free) { inverse } else { start.all[*place] * inverse };
        }
        (self.state, self.log_likelihood) = (start.first.state(), 0.0);
        self.covariance.fill(0.0);
        for (row, first) in self.covariance.chunks_exact_mut(self.scaled.len() + 2).zip(start.first.covariance) {
            row[..2].copy_from_slice(&first);
        }
        self.wander(unknowns, start.reach, [start.width; 2]);
    }

    /// Becomes what `other` is, of the same law.
    pub fn copy_from(&mut self, other: &AugmentedFilter) {
        (self.log_likelihood, self.state) = (other.log_likelihood, other.state);
        self.scaled.copy_from_slice(&other.scaled);
        self.all.copy_from_slice(&other.all);
        self.covariance.copy_from_slice(&other.covariance);
        self.compiled.clone_from(&other.compiled);
    }

    fn size(&self) -> usize {
        self.scaled.len() + 2
    }

    /// Each coefficient θ, and the inertia, wanders by a std that is given relative to its `reach`; the inertia takes
    /// all of κ and b with it.
    pub fn wander(&mut self, unknowns: &Unknowns, reach: &[f64], [width, of_inertia]: [f64; 2]) {
        let (size, mass) = (self.size(), self.mass(unknowns));
        let AugmentedFilter { covariance, scaled, .. } = self;
        for (index, reach) in reach.iter().enumerate().filter(|(index, _)| unknowns.free_inertia != Some(*index)) {
            covariance[(index + 2) * (size + 1)] += (width * reach / mass).powi(2);
        }
        let Some(index) = unknowns.free_inertia else { return };
        let share = (of_inertia * reach[index] / mass).powi(2);
        for (row, first) in covariance[2 * size..].chunks_exact_mut(size).zip(scaled.iter()) {
            row[2..].iter_mut().zip(scaled.iter()).for_each(|(entry, second)| *entry += share * first * second);
        }
    }

    /// Carries everything over the interval up to the observation, cut into `parts`.
    pub fn advance(&mut self, unknowns: &Unknowns, process: f64, parts: usize, observation: &Observation) {
        let mass = self.scatter(unknowns);
        let parts = observation.drive.parts(parts);
        let dt = observation.dt / parts as f64;
        let AugmentedFilter { compiled, slopes, scaled_slopes, map, state, all, .. } = self;
        compiled.compile(&Motion::new(unknowns.terms, all).with(unknowns.own));
        let mut first = true;
        for part in 0..parts {
            let excitation = observation.drive.part(part, parts);
            compiled.steps(*state, dt, excitation, slopes, |step, _, slopes| {
                scale(unknowns, all, mass, slopes, scaled_slopes);
                match first {
                    true => map.set(step, scaled_slopes),
                    false => map.append(step, scaled_slopes),
                }
                first = false;
                *state = step.state;
            });
        }
        let noise = white_acceleration(process + observation.unseen / (mass * mass), observation.dt);
        let AugmentedFilter { covariance, moved, map, .. } = self;
        carry(covariance, moved, |change| times(&map.transition, change), &map.input, &noise);
    }

    /// Goes on after an outage over which the motion cannot be followed: of the state only what is measured next is
    /// known, of the coefficients what was.
    pub fn resume(&mut self, noise: &Noise, observation: &Observation) {
        let size = self.size();
        let filter = state_after_outage([self.state.q, self.state.qd], observation.measured, noise);
        self.state = filter.state();
        for (row, entries) in self.covariance.chunks_exact_mut(size).enumerate() {
            entries[..2].fill(0.0);
            if let Some(own) = filter.covariance.get(row) {
                entries.fill(0.0);
                entries[..2].copy_from_slice(own);
            }
        }
    }

    /// Writes κ and b as coefficients of the law; returns the inertia.
    fn scatter(&mut self, unknowns: &Unknowns) -> f64 {
        let mass = self.mass(unknowns);
        for (free, (scaled, place)) in self.scaled.iter().zip(unknowns.free).enumerate() {
            self.all[*place] = if unknowns.free_inertia == Some(free) { mass } else { scaled * mass };
        }
        mass
    }

    fn mass(&self, unknowns: &Unknowns) -> f64 {
        unknowns.free_inertia.map_or(self.all[unknowns.inertia], |index| self.scaled[index].recip())
    }

    /// What the measurement would leave, and the variance of that.
    pub fn residual(&self, channel: Channel, measured: f64, variance: f64) -> (f64, f64) {
        let expected = [self.state.q, self.state.qd][channel as usize];
        (measured - expected, self.covariance[channel as usize * (self.size() + 1)] + variance)
    }

    /// Takes one measurement with this noise variance.
    pub fn update(&mut self, channel: Channel, measured: f64, variance: f64) {
        let (residual, total) = self.residual(channel, measured, variance);
        let (size, place) = (self.size(), channel as usize);
        self.log_likelihood -= 0.5 * (residual * residual / total + total.ln());
        let AugmentedFilter { column, gain, covariance, state, scaled, .. } = self;
        column.copy_from_slice(&covariance[place * size..(place + 1) * size]);
        let precision = total.recip();
        gain.iter_mut().zip(column.iter()).for_each(|(gain, entry)| *gain = entry * precision);
        state.q += gain[0] * residual;
        state.qd += gain[1] * residual;
        scaled.iter_mut().zip(&gain[2..]).for_each(|(value, gain)| *value += gain * residual);
        correct(covariance, column, gain, place, variance);
    }

    /// Whether all is finite and the inertia has kept its sign.
    pub fn is_sound(&self, unknowns: &Unknowns) -> bool {
        let kept = unknowns.free_inertia.is_none_or(|index| self.scaled[index] * self.all[unknowns.inertia] > 0.0);
        kept && self.log_likelihood.is_finite() && self.state.is_finite()
    }

    /// The free coefficient θ and its variance, to first order.
    pub fn coefficient(&self, unknowns: &Unknowns, free: usize) -> (f64, f64) {
        let (mass, size) = (self.mass(unknowns), self.size());
        let entry = |row: usize, column: usize| self.covariance[(row + 2) * size + column + 2];
        let value = self.scaled[free] * mass;
        match unknowns.free_inertia {
            None => (value, mass * mass * entry(free, free)),
            Some(index) if index == free => (mass, mass.powi(4) * entry(index, index)),
            Some(index) => {
                let slope = -value * mass;
                let cross = 2.0 * mass * slope * entry(free, index);
                (value, mass * mass * entry(free, free) + cross + slope * slope * entry(index, index))
            }
        }
    }
}

/// ∂q̈/∂κ and ∂q̈/∂b from ∂q̈/∂θ, by the chain rule of θ_j = κ_j ÷ b and m = 1 ÷ b.
fn scale(unknowns: &Unknowns, all: &[f64], mass: f64, slopes: &[f64], scaled: &mut [f64]) {
    scaled.iter_mut().zip(slopes).for_each(|(scaled, slope)| *scaled = mass * slope);
    if let Some(index) = unknowns.free_inertia {
        let all = unknowns.free.iter().map(|place| all[*place]);
        // the inertia's own θ is m: its share of the sum is the first term
        scaled[index] = -mass * all.zip(slopes).map(|(value, slope)| value * slope).sum::<f64>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Drive;

    const TERMS: [Term; 3] = [Term::Inertia, Term::power(0, 1), Term::power(1, 0)];
    const TRUTH: [f64; 3] = [2.0, 1.5, 80.0];
    const DT: f64 = 0.005;
    const VARIANCES: [f64; 2] = [1e-8, 1e-6];

    fn at_rest() -> Filter {
        Filter::begin([0.0; 2], VARIANCES)
    }

    fn unknowns() -> Unknowns<'static> {
        Unknowns { terms: &TERMS, own: &[], free: &[0, 1, 2], free_terms: &TERMS, inertia: 0, free_inertia: Some(0) }
    }

    /// A filter that begins with coefficients a tenth off and is told that they may be, after `seconds` of a driven
    /// motion seen without noise.
    fn followed(seconds: f64, wander: f64) -> AugmentedFilter {
        let mut joint = AugmentedFilter::new(3, 3);
        let all = TRUTH.map(|value| 1.1 * value);
        let start = Start { all: &all, reach: &TRUTH, width: 0.2, first: at_rest() };
        joint.begin(&unknowns(), &start);
        let (motion, mut state) = (Motion::new(&TERMS, &TRUTH), State::default());
        for k in 0..(seconds / DT) as usize {
            let force = 30.0 * (5.0 * k as f64 * DT).sin() + 10.0;
            state = motion.step_linear(state, DT, force, force);
            let observation = Observation {
                dt: DT,
                drive: Drive::Held(force),
                measured: [Some(state.q), Some(state.qd)],
                unseen: 0.0,
            };
            joint.wander(&unknowns(), &TRUTH, [wander; 2]);
            joint.advance(&unknowns(), 1e-10, 2, &observation);
            joint.update(Channel::Q, state.q, VARIANCES[0]);
            joint.update(Channel::Qd, state.qd, VARIANCES[1]);
        }
        joint
    }

    #[test]
    fn coefficients_are_found_within_their_std() {
        let joint = followed(3.0, 0.0);
        assert!(joint.is_sound(&unknowns()));
        for (free, truth) in TRUTH.iter().enumerate() {
            let (value, variance) = joint.coefficient(&unknowns(), free);
            assert!(
                (value - truth).abs() < 3.0 * variance.sqrt() && variance.sqrt() < 0.01 * truth,
                "{free}: {value} ± {}",
                variance.sqrt()
            );
        }
    }

    #[test]
    fn what_wanders_is_known_less() {
        let [still, wandering] = [0.0, 0.01].map(|wander| followed(3.0, wander).coefficient(&unknowns(), 2).1);
        assert!(wandering > 10.0 * still, "{still} and {wandering}");
    }

    /// θ = κ ÷ b: the variance to first order is that of the tangent, whatever moves κ and b together.
    #[test]
    fn an_inertia_that_wanders_takes_no_other_coefficient_with_it() {
        let mut joint = AugmentedFilter::new(3, 3);
        let start = Start { all: &TRUTH, reach: &TRUTH, width: 0.0, first: at_rest() };
        joint.begin(&unknowns(), &start);
        joint.wander(&unknowns(), &TRUTH, [0.0, 0.1]);
        let variances = [0, 1, 2].map(|free| joint.coefficient(&unknowns(), free).1);
        assert!((variances[0].sqrt() - 0.1 * TRUTH[0]).abs() < 1e-12, "{variances:?}");
        assert!(variances[1].abs() < 1e-15 && variances[2].abs() < 1e-12, "{variances:?}");
    }

    #[test]
    fn the_covariance_stays_symmetric() {
        let (joint, size) = (followed(1.0, 0.01), 5);
        for (row, column) in (0..size).flat_map(|row| (0..row).map(move |column| (row, column))) {
            let [here, there] = [row * size + column, column * size + row].map(|place| joint.covariance[place]);
            assert!((here - there).abs() <= 1e-9 * here.abs().max(1e-12), "{row}, {column}: {here} and {there}");
        }
    }
}
