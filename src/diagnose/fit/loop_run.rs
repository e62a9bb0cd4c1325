//! One run of the filter over a piece under a law with a hysteresis, whose internal state is a third beside q and q̇.
//!
//! The hysteresis is a series along the smoothed motion q̂ of the pass before; the filter's motion leaves it: z is
//! ẑ + w. Over an interval w⁺ = μ w + κ (δq⁺ − δq) with δq = q − q̂, κ = dz/dq of the loop and μ what a path leaves of
//! a difference in z. The filter carries (q, q̇, w) with its 3 × 3 covariance, the unknowns' sensitivities alike: the
//! iterated extended Kalman smoother (Bell, SIAM Journal on Optimization 4 (1994), 626), whose fixed point is the
//! motion of largest likelihood under the law with its memory.

use super::outcome::{self, Law, Outcome, Tangent};
use crate::diagnose::piece::Piece;
use crate::estimation::{
    Channel, Filter, Innovation, Matrix, Noise, Observation, Pass, Rivals, Smoothable, Track, smooth, times,
    white_acceleration,
};
use crate::law::{Line, Motion, State, Term};

/// Over an interval with a white acceleration of that intensity, whose displacement the loop follows with that slope.
fn noise(intensity: f64, slope: f64, dt: f64) -> Matrix<3> {
    let [[qq, qv], [_, vv]] = white_acceleration(intensity, dt);
    [[qq, qv, slope * qq], [qv, vv, slope * qv], [slope * qq, slope * qv, slope * slope * qq]]
}

/// The filter of (q, q̇), with w known to be 0.
fn with_loop(filter: Filter) -> Filter<3> {
    let ([q, qd], [[qq, qv], [_, vv]]) = (filter.mean, filter.covariance);
    Filter { mean: [q, qd, 0.0], covariance: [[qq, qv, 0.0], [qv, vv, 0.0], [0.0; 3]] }
}

/// ∂(q, q̇, w)⁺/∂(q, q̇, w) of the interval that the pass has carried the state over; `pull` is the hysteresis'
/// coefficient ÷ mass.
fn transition(pass: &Pass, tangent: &Tangent, pull: f64) -> Matrix<3> {
    let ([[a, b], [c, d]], [to_q, to_qd]) = (pass.map.transition, pass.map.push);
    let held = pull * tangent.slope;
    let q = [a + to_q * held, b, -to_q * pull];
    let loop_row = [tangent.slope * (q[0] - 1.0), tangent.slope * q[1], tangent.slope * q[2] + tangent.kept];
    [q, [c + to_qd * held, d, -to_qd * pull], loop_row]
}

/// What a run gathers.
struct Run<'a> {
    law: &'a Law<'a>,
    filter: Filter<3>,
    track: Track,
    rivals: Rivals<3>,
    /// ∂(q, q̇, w)/∂ unknowns.
    sensitivities: Vec<[f64; 3]>,
    rows: Vec<f64>,
    steps: Vec<Smoothable<3>>,
}

/// A run over a piece of a law whose tangents say how its hysteresis follows the motion.
pub(super) fn run(law: &Law, piece: &Piece, pass: &mut Pass, series: &[Vec<Line>]) -> Outcome {
    let free: Vec<Term> = law.free.iter().map(|index| law.terms[*index]).collect();
    let unknowns = free.len() + law.series.len();
    let first = outcome::first_state(piece, &law.noise);
    let mut outcome = Outcome::none(first, unknowns, 0);
    let mut own = Run::begin(law, with_loop(first), pass.rivals.ratios, unknowns);
    let (terms, mut coefficients) = law.bent();
    pass.begin(first);
    for (k, observation) in piece.observations.iter().enumerate() {
        let tangent = &law.tangents[k];
        coefficients[terms.len() - 1] = own.pull() * tangent.slope;
        let motion = Motion::new(&terms, &coefficients);
        pass.filter.set_state(own.filter.state());
        pass.step(&motion, &free, &law.noise, &own.relieved(observation, &series[k], tangent));
        let inverse_mass = motion.mass(pass.filter.mean[0]).recip();
        let means = series[k].iter().map(|[from, to]| 0.5 * (from + to));
        own.carry(pass, tangent, inverse_mass, observation.dt);
        own.carry_sensitivities(pass, tangent, means, inverse_mass);
        let mut innovations = [None; 2];
        for channel in Channel::ALL {
            let Some(innovation) = own.measure(channel, observation, &law.noise) else { continue };
            outcome.information.add(&own.rows, innovation.residual, innovation.variance);
            innovations[channel as usize] = Some(innovation);
        }
        own.end(innovations);
        outcome.finite &= own.filter.state().is_finite();
    }
    own.close(&with_loop(first), outcome)
}

impl<'a> Run<'a> {
    fn begin(law: &'a Law<'a>, first: Filter<3>, ratios: [f64; 2], columns: usize) -> Run<'a> {
        let mut rivals = Rivals::new(ratios);
        rivals.begin(first);
        Run {
            law,
            filter: first,
            track: Track::default(),
            rivals,
            sensitivities: vec![[0.0; 3]; columns],
            rows: vec![0.0; columns],
            steps: Vec::new(),
        }
    }

    /// The hysteresis' coefficient.
    fn pull(&self) -> f64 {
        self.law.tangents.first().and_then(|tangent| self.law.series.get(tangent.series)).copied().unwrap_or(0.0)
    }

    /// The observation without its measurements, the series' forces and what w adds to them taken off its excitation.
    fn relieved(&self, observation: &Observation, forces: &[Line], tangent: &Tangent) -> Observation {
        let [q, _, w] = self.filter.mean;
        let from = w - tangent.slope * (q - tangent.ends[0]);
        let shifted = tangent.displacement.map(|displacement| from - tangent.slope * displacement);
        let blind = Observation { measured: [None; 2], ..*observation };
        outcome::relieved(&blind, self.law.series, forces, shifted.map(|shift| self.pull() * shift))
    }

    /// Means and covariances over the interval that the pass has carried the state over.
    fn carry(&mut self, pass: &Pass, tangent: &Tangent, inverse_mass: f64, dt: f64) {
        let transition = transition(pass, tangent, self.pull() * inverse_mass);
        let State { q, qd } = pass.filter.state();
        let [old, _, w] = self.filter.mean;
        let moved = (q - tangent.ends[1]) - (old - tangent.ends[0]);
        let mean = [q, qd, tangent.kept * w + tangent.slope * moved];
        let noise = |ratio: f64| noise(ratio * self.law.noise.process, tangent.slope, dt);
        self.rivals.predict(self.filter.mean, mean, &transition, noise);
        self.filter.mean = mean;
        self.filter.predict(|change| times(&transition, change), &noise(1.0));
        self.steps.push(Smoothable { transition, innovations: [None; 2], filtered: self.filter });
    }

    /// Sensitivities over the interval; `forces` are the means of the series.
    fn carry_sensitivities(
        &mut self,
        pass: &Pass,
        tangent: &Tangent,
        forces: impl Iterator<Item = f64>,
        inverse_mass: f64,
    ) {
        let Some(Smoothable { transition, .. }) = self.steps.last() else { return };
        let [to_q, to_qd] = pass.map.push;
        let pushed = forces.map(|force| [-force * inverse_mass * to_q, -force * inverse_mass * to_qd]);
        for (own, [q, qd]) in self.sensitivities.iter_mut().zip(pass.map.input.iter().copied().chain(pushed)) {
            let carried = times(transition, *own);
            *own = [carried[0] + q, carried[1] + qd, carried[2] + tangent.slope * q];
        }
    }

    /// Takes the measurement of a channel; leaves the sensitivities of what was expected in the rows.
    fn measure(&mut self, channel: Channel, observation: &Observation, noise: &Noise) -> Option<Innovation<3>> {
        let (measured, variance) = (observation.measured[channel as usize]?, noise.sensor[channel as usize]);
        self.rivals.update(channel, measured, variance, true);
        let innovation = self.filter.update(channel, measured, variance);
        self.track.add(channel, &innovation);
        for (own, row) in self.sensitivities.iter_mut().zip(&mut self.rows) {
            *row = own[channel as usize];
            own.iter_mut().zip(innovation.gain).for_each(|(entry, gain)| *entry -= gain * *row);
        }
        Some(innovation)
    }

    fn end(&mut self, innovations: [Option<Innovation<3>>; 2]) {
        if let Some(step) = self.steps.last_mut() {
            (step.innovations, step.filtered) = (innovations, self.filter);
        }
    }

    fn close(self, first: &Filter<3>, outcome: Outcome) -> Outcome {
        Outcome {
            log_likelihood: self.track.log_likelihood(),
            rivals: self.rivals.log_likelihoods(),
            squares: self.track.squares,
            count: self.track.count,
            smoothed: Some(outcome::states(&smooth(first, &self.steps))),
            ..outcome
        }
    }
}
