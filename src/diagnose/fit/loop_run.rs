//! One run of the filter over a piece under a law with a hysteresis, whose internal state is a third beside q and q̇.
//!
//! The hysteresis is a series along the smoothed motion q̂ of the pass before, and the filter's motion leaves it: z = ẑ + w. Over an interval
//! w⁺ = μ w + κ (δq⁺ − δq) with δq = q − q̂, κ = dz/dq of the loop and μ what a path leaves of a difference in z. The filter carries
//! (q, q̇, w) with its 3 × 3 covariance, the unknowns' sensitivities alike: the iterated extended Kalman smoother (Bell, SIAM Journal on
//! Optimization 4 (1994), 626), whose fixed point is the motion of largest likelihood under the law with its memory.

use super::outcome::{self, Law, Outcome, Place, Tangent};
use crate::diagnose::piece::Piece;
use crate::estimation::{Channel, Filter, Innovation, Noise, Observation, Pass, Track};
use crate::law::{Line, Motion, State, Term};

type Vector = [f64; 3];
type Matrix = [Vector; 3];

/// Mean and covariance of (q, q̇, w).
#[derive(Clone, Copy, Debug)]
struct Joint {
    mean: Vector,
    covariance: Matrix,
}

/// A measurement as the smoother needs it: gain, and residual ÷ variance.
#[derive(Clone, Copy, Debug)]
struct Seen {
    gain: Vector,
    pull: f64,
}

/// A sample as the smoother needs it.
struct Step {
    transition: Matrix,
    seen: [Option<Seen>; 2],
    filtered: Joint,
}

impl Joint {
    fn begin(filter: Filter) -> Joint {
        let [qq, qv, vv] = filter.covariance;
        Joint { mean: [filter.state.q, filter.state.qd, 0.0], covariance: [[qq, qv, 0.0], [qv, vv, 0.0], [0.0; 3]] }
    }

    fn state(&self) -> State {
        State { q: self.mean[0], qd: self.mean[1] }
    }

    /// Carries the covariance over an interval with a white acceleration of that intensity.
    fn predict(&mut self, transition: &Matrix, slope: f64, dt: f64, process: f64) {
        let mut carried = times(transition, &times(transition, &self.covariance, false), true);
        let [qq, qv, vv] = [dt * dt * dt / 3.0, dt * dt / 2.0, dt].map(|part| process * part);
        let noise = [[qq, qv, slope * qq], [qv, vv, slope * qv], [slope * qq, slope * qv, slope * slope * qq]];
        carried.iter_mut().flatten().zip(noise.as_flattened()).for_each(|(entry, noise)| *entry += noise);
        self.covariance = carried;
    }

    /// Takes one measurement with this noise variance.
    fn update(&mut self, channel: Channel, measured: f64, variance: f64) -> (Innovation, Vector) {
        let column = self.covariance[channel as usize];
        let total = column[channel as usize] + variance;
        let (residual, precision) = (measured - self.mean[channel as usize], total.recip());
        let gain = column.map(|entry| entry * precision);
        for ((mean, row), gain) in self.mean.iter_mut().zip(&mut self.covariance).zip(gain) {
            *mean += gain * residual;
            row.iter_mut().zip(column).for_each(|(entry, other)| *entry -= gain * other);
        }
        (Innovation { residual, variance: total, precision, gain: [gain[0], gain[1]] }, gain)
    }
}

/// A B, or B Aᵀ where `transposed`.
fn times(a: &Matrix, b: &Matrix, transposed: bool) -> Matrix {
    let entry = |row: usize, column: usize| match transposed {
        false => (0..3).map(|k| a[row][k] * b[k][column]).sum::<f64>(),
        true => (0..3).map(|k| b[row][k] * a[column][k]).sum::<f64>(),
    };
    std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)))
}

fn apply(a: &Matrix, x: Vector) -> Vector {
    std::array::from_fn(|row| (0..3).map(|k| a[row][k] * x[k]).sum())
}

/// ∂(q, q̇, w)⁺/∂(q, q̇, w) of the interval that the pass has carried the state over; `pull` is the hysteresis' coefficient ÷ mass.
fn transition(pass: &Pass, tangent: &Tangent, pull: f64) -> Matrix {
    let ([[a, b], [c, d]], [to_q, to_qd]) = (pass.map.transition, pass.map.push);
    let held = pull * tangent.slope;
    let q = [a + to_q * held, b, -to_q * pull];
    let loop_row = [tangent.slope * (q[0] - 1.0), tangent.slope * q[1], tangent.slope * q[2] + tangent.kept];
    [q, [c + to_qd * held, d, -to_qd * pull], loop_row]
}

/// What a run gathers.
struct Run<'a> {
    law: &'a Law<'a>,
    filter: Joint,
    rivals: [Joint; 2],
    tracks: [Track; 3],
    /// ∂(q, q̇, w)/∂ unknowns.
    sensitivities: Vec<Vector>,
    rows: Vec<f64>,
    steps: Vec<Step>,
}

/// A run over a piece of a law whose tangents say how its hysteresis follows the motion.
pub(super) fn run(law: &Law, piece: &Piece, pass: &mut Pass, series: &[Vec<Line>], place: Place) -> Outcome {
    let free: Vec<Term> = law.free.iter().map(|index| law.terms[*index]).collect();
    let unknowns = free.len() + law.series.len();
    let first = outcome::first_state(piece, &law.noise);
    let mut outcome = Outcome::none(first, unknowns, 0);
    let mut own = Run::begin(law, first, unknowns);
    let (terms, mut coefficients) = law.bent();
    pass.begin(first);
    for (k, observation) in piece.observations.iter().enumerate() {
        let tangent = &law.tangents[k];
        coefficients[terms.len() - 1] = own.pull() * tangent.slope;
        let motion = Motion { terms: &terms, coefficients: &coefficients };
        pass.filter.state = own.filter.state();
        pass.step(&motion, &free, &law.noise, &own.relieved(observation, &series[k], tangent));
        let inverse_mass = motion.mass(pass.filter.state.q).recip();
        let means = series[k].iter().map(|[from, to]| 0.5 * (from + to));
        own.carry(pass, tangent, inverse_mass, observation.dt);
        own.carry_sensitivities(pass, tangent, means, inverse_mass);
        let mut seen = [None; 2];
        for channel in Channel::ALL {
            let Some((innovation, gain)) = own.measure(channel, observation, &law.noise) else { continue };
            outcome.sums[place.stretch(k)].add(&own.rows, channel, &innovation);
            seen[channel as usize] = Some(Seen { gain, pull: innovation.residual * innovation.precision });
        }
        own.end(seen);
        outcome.finite &= own.filter.state().is_finite();
    }
    own.close(first, outcome)
}

impl<'a> Run<'a> {
    fn begin(law: &'a Law<'a>, first: Filter, columns: usize) -> Run<'a> {
        let filter = Joint::begin(first);
        Run {
            law,
            filter,
            rivals: [filter; 2],
            tracks: [Track::default(); 3],
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
        outcome::beside(&blind, self.law.series, forces, shifted.map(|shift| self.pull() * shift))
    }

    /// Means and covariances over the interval that the pass has carried the state over.
    fn carry(&mut self, pass: &Pass, tangent: &Tangent, inverse_mass: f64, dt: f64) {
        let transition = transition(pass, tangent, self.pull() * inverse_mass);
        let State { q, qd } = pass.filter.state;
        let [old, _, w] = self.filter.mean;
        let moved = (q - tangent.ends[1]) - (old - tangent.ends[0]);
        let mean = [q, qd, tangent.kept * w + tangent.slope * moved];
        for (rival, ratio) in self.rivals.iter_mut().zip(pass.ratios) {
            let apart = std::array::from_fn(|row| rival.mean[row] - self.filter.mean[row]);
            let apart = apply(&transition, apart);
            rival.mean = std::array::from_fn(|row| mean[row] + apart[row]);
            rival.predict(&transition, tangent.slope, dt, ratio * self.law.noise.process);
        }
        self.filter.mean = mean;
        self.filter.predict(&transition, tangent.slope, dt, self.law.noise.process);
        self.steps.push(Step { transition, seen: [None; 2], filtered: self.filter });
    }

    /// Sensitivities over the interval; `forces` are the means of the series.
    fn carry_sensitivities(
        &mut self,
        pass: &Pass,
        tangent: &Tangent,
        forces: impl Iterator<Item = f64>,
        inverse_mass: f64,
    ) {
        let Some(Step { transition, .. }) = self.steps.last() else { return };
        let [to_q, to_qd] = pass.map.push;
        let pushed = forces.map(|force| [-force * inverse_mass * to_q, -force * inverse_mass * to_qd]);
        for (own, [q, qd]) in self.sensitivities.iter_mut().zip(pass.map.input.iter().copied().chain(pushed)) {
            let carried = apply(transition, *own);
            *own = [carried[0] + q, carried[1] + qd, carried[2] + tangent.slope * q];
        }
    }

    /// Takes the measurement of a channel; leaves the sensitivities of what was expected in the rows.
    fn measure(&mut self, channel: Channel, observation: &Observation, noise: &Noise) -> Option<(Innovation, Vector)> {
        let (measured, variance) = (observation.measured[channel as usize]?, noise.sensor[channel as usize]);
        let [track, rival_tracks @ ..] = &mut self.tracks;
        for (rival, track) in self.rivals.iter_mut().zip(rival_tracks) {
            track.add(channel, &rival.update(channel, measured, variance).0);
        }
        let (innovation, gain) = self.filter.update(channel, measured, variance);
        track.add(channel, &innovation);
        for (own, row) in self.sensitivities.iter_mut().zip(&mut self.rows) {
            *row = own[channel as usize];
            own.iter_mut().zip(gain).for_each(|(entry, gain)| *entry -= gain * *row);
        }
        Some((innovation, gain))
    }

    fn end(&mut self, seen: [Option<Seen>; 2]) {
        if let Some(step) = self.steps.last_mut() {
            (step.seen, step.filtered) = (seen, self.filter);
        }
    }

    fn close(self, first: Filter, outcome: Outcome) -> Outcome {
        let [track, less, more] = self.tracks;
        Outcome {
            log_likelihood: track.log_likelihood(),
            rivals: [less.log_likelihood(), more.log_likelihood()],
            squares: track.squares,
            count: track.count,
            smoothed: Some(smooth(first, &self.steps)),
            ..outcome
        }
    }
}

/// States at every sample, as all samples together tell them (Bryson and Frazier, as in [`super::smooth`]).
fn smooth(first: Filter, steps: &[Step]) -> Vec<State> {
    let mut states = vec![first.state; steps.len() + 1];
    let mut adjoint = [0.0; 3];
    for (k, step) in steps.iter().enumerate().rev() {
        states[k + 1] = moved(&step.filtered, adjoint);
        for channel in [Channel::Qd, Channel::Q] {
            if let Some(Seen { gain, pull }) = &step.seen[channel as usize] {
                adjoint[channel as usize] -= (0..3).map(|k| gain[k] * adjoint[k]).sum::<f64>() + pull;
            }
        }
        adjoint = std::array::from_fn(|column| (0..3).map(|row| step.transition[row][column] * adjoint[row]).sum());
    }
    states[0] = moved(&Joint::begin(first), adjoint);
    states
}

/// x − P λ.
fn moved(joint: &Joint, adjoint: Vector) -> State {
    let taken = apply(&joint.covariance, adjoint);
    State { q: joint.mean[0] - taken[0], qd: joint.mean[1] - taken[1] }
}
