//! One run of the filter over a record: likelihood, score and information of the coefficients.

use super::filter::{Channel, Filter, Innovation, Noise};
use super::information::Information;
use super::innovation_gate::InnovationGate;
use super::symmetric::{Lane, LogSum, WIDTH};
use crate::law::{Compiled, Drive, Linearized, Motion, State, Term};
use serde::{Deserialize, Serialize};

/// Ratios by which the process noise of the two rival filters differs from the one in use, unless told otherwise.
pub const RIVALS: [f64; 2] = [1.0 / 30.0, 6.0];

/// Most parts into which an interval between two samples is cut.
const MAX_PARTS: usize = 8;

/// Largest rate per part, squared radians: below it a step of order 4 errs by less than 1e-7 of the motion.
const MAX_RATE: f64 = 0.0025;

/// A motion that turns by more than this in an outage, rad, cannot be followed over it: the excitation is not known.
const LOST: f64 = 4.0;

/// How many times its own square the variance of what an outage leaves unknown is.
const UNKNOWN: f64 = 10.0;

/// A sample and the excitation since the one before it.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// Time since the last sample, s.
    pub dt: f64,
    /// The excitation over that time.
    pub drive: Drive,
    /// What was measured at its end, by [`Channel`]; `None` where a channel is not measured.
    pub measured: [Option<f64>; 2],
    /// Intensity of the white force that the excitation may have had unseen over that time, N² s.
    pub unseen: f64,
}

/// Sums that make up a likelihood.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// Number of innovations by channel.
    pub count: [f64; 2],
    /// Σ ε²/s by channel.
    pub squares: [f64; 2],
    /// Σ ln s by channel.
    log_variance: [LogSum; 2],
}

impl Track {
    /// Adds an innovation of the channel.
    #[inline]
    pub fn add(&mut self, channel: Channel, innovation: &Innovation) {
        self.count[channel as usize] += 1.0;
        self.squares[channel as usize] += innovation.residual * innovation.residual * innovation.precision;
        self.log_variance[channel as usize].add(innovation.variance);
    }

    /// Mean of ε²/s in the channel: by how much its stated variance is too small; 1 where nothing was measured.
    pub fn scale(&self, channel: Channel) -> f64 {
        let count = self.count[channel as usize];
        if count > 0.0 { self.squares[channel as usize] / count } else { 1.0 }
    }

    /// Log-likelihood with each channel's scale at its own maximum, up to a constant.
    pub fn log_likelihood(&self) -> f64 {
        let profile = Channel::ALL.map(|channel| self.count[channel as usize] * self.scale(channel).max(1e-300).ln());
        let [q, qd] = &self.log_variance;
        -0.5 * (q.total() + qd.total() + profile[0] + profile[1])
    }

    /// Log-likelihood with the variances as they were stated, up to the same constant.
    pub fn stated_log_likelihood(&self) -> f64 {
        let [q, qd] = &self.log_variance;
        -0.5 * (q.total() + qd.total() + self.squares[0] + self.squares[1])
    }

    /// Geometric mean of s in the channel; 0 where nothing was measured.
    pub fn variance(&self, channel: Channel) -> f64 {
        let count = self.count[channel as usize];
        if count > 0.0 { (self.log_variance[channel as usize].total() / count).exp() } else { 0.0 }
    }

    /// Number of scalar measurements.
    pub fn total(&self) -> f64 {
        self.count[0] + self.count[1]
    }
}

/// δx⁺ = A δx + B δθ over an interval between two samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IntervalMap {
    /// A.
    pub transition: [[f64; 2]; 2],
    /// B, one column of (q, q̇) for each free coefficient.
    pub input: Vec<[f64; 2]>,
    /// What an acceleration of 1 over the whole interval does to (q, q̇).
    pub push: [f64; 2],
}

impl IntervalMap {
    /// Becomes the map of one step.
    #[inline]
    pub(super) fn set(&mut self, step: &Linearized, slopes: &[f64]) {
        let [to_q, to_qd] = step.input;
        self.transition = step.transition;
        self.push = step.input;
        for (input, slope) in self.input.iter_mut().zip(slopes) {
            *input = [to_q * slope, to_qd * slope];
        }
    }

    /// Puts one more step behind.
    #[inline]
    pub(super) fn append(&mut self, step: &Linearized, slopes: &[f64]) {
        let [[a, b], [c, d]] = step.transition;
        let [to_q, to_qd] = step.input;
        for (input, slope) in self.input.iter_mut().zip(slopes) {
            let [q, qd] = *input;
            *input = [a * q + b * qd + to_q * slope, c * q + d * qd + to_qd * slope];
        }
        let [q, qd] = self.push;
        self.push = [a * q + b * qd + to_q, c * q + d * qd + to_qd];
        let [[e, f], [g, h]] = self.transition;
        self.transition = [[a * e + b * g, a * f + b * h], [c * e + d * g, c * f + d * h]];
    }
}

/// A run of the filter over a record, sample by sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// The filter in use.
    pub filter: Filter,
    /// Its likelihood.
    pub track: Track,
    /// Likelihoods under the process noise times `ratios`.
    pub rivals: [Track; 2],
    /// Ratios of the rivals' process noise to the one in use; [`RIVALS`] at first.
    pub ratios: [f64; 2],
    /// What the record says on the free coefficients.
    pub information: Information,
    /// ∂(q, q̇)/∂θ of the filtered state.
    pub sensitivity: Vec<[f64; 2]>,
    /// What the last interval between samples did to small changes.
    pub map: IntervalMap,
    /// What readings that do not count say of another law, by channel.
    pub set_aside: [Option<Innovation>; 2],
    /// Parts into which an interval is cut: what the fastest motion asks for, of the run before at first, then of this
    /// one too.
    pub parts: usize,
    rival_filters: [Filter; 2],
    fastest: f64,
    /// `fastest` ÷ the square of the interval: how fast the motion turns, rad²/s².
    quickest: f64,
    /// Keeps outliers out, where wanted.
    guard: Option<InnovationGate>,
    compiled: Compiled,
    /// Whether the free terms of this run are known.
    seeking: bool,
    slopes: Vec<f64>,
    /// Sensitivity of the expected measurement by channel, each n long and filled up with zeros.
    rows: [Vec<Lane>; 2],
}

/// Parts of an interval whose motion turns by `fastest` squared radians in it.
fn parts_for(fastest: f64) -> usize {
    ((fastest / MAX_RATE).sqrt().ceil() as usize).clamp(1, MAX_PARTS)
}

impl Pass {
    /// A run that has not begun, on `n` free coefficients.
    pub fn new(n: usize) -> Pass {
        let lanes = || vec![[0.0; WIDTH]; n.div_ceil(WIDTH)];
        let filter = Filter { state: State::default(), covariance: [0.0; 3] };
        Pass {
            filter,
            track: Track::default(),
            rivals: [Track::default(); 2],
            ratios: RIVALS,
            information: Information::none(n),
            sensitivity: vec![[0.0; 2]; n],
            map: IntervalMap { transition: [[0.0; 2]; 2], input: vec![[0.0; 2]; n], push: [0.0; 2] },
            set_aside: [None; 2],
            parts: 1,
            rival_filters: [filter; 2],
            fastest: 0.0,
            quickest: 0.0,
            guard: None,
            compiled: Compiled::default(),
            seeking: false,
            slopes: vec![0.0; n],
            rows: [lanes(), lanes()],
        }
    }

    /// The same run, which leaves outliers out.
    pub fn guarded(self) -> Pass {
        Pass { guard: Some(InnovationGate::default()), ..self }
    }

    /// Begins at a state that does not depend on the coefficients.
    pub fn begin(&mut self, filter: Filter) {
        self.filter = filter;
        self.rival_filters = [filter; 2];
        self.track = Track::default();
        self.rivals = [Track::default(); 2];
        self.guard = self.guard.map(|_| InnovationGate::default());
        self.information.clear();
        self.sensitivity.fill([0.0; 2]);
        self.parts = parts_for(self.fastest);
        (self.fastest, self.quickest) = (0.0, 0.0);
        self.seeking = false;
    }

    /// Takes one sample; `free` are the terms whose coefficients are sought, the same ones throughout a run, as are
    /// those of the motion. Returns the innovations by channel.
    pub fn step(
        &mut self,
        motion: &Motion,
        free: &[Term],
        noise: &Noise,
        observation: &Observation,
    ) -> [Option<Innovation>; 2] {
        if !self.seeking {
            self.compiled.seek(free);
            self.compiled.compile(motion);
            self.seeking = true;
        }
        self.compiled.follow(motion);
        if observation.unseen > 0.0 && self.quickest * observation.dt * observation.dt > LOST * LOST {
            return self.resume(noise, observation);
        }
        let unseen = match observation.unseen > 0.0 {
            true => observation.unseen / motion.mass(self.filter.state.q).powi(2),
            false => 0.0,
        };
        self.advance(noise.process, unseen, observation);
        let innovations = Channel::ALL.map(|channel| self.correct(channel, noise, observation));
        self.inform(&innovations);
        innovations
    }

    /// ∂/∂θ of what the last sample was expected to measure in the channel, n.
    pub fn expected(&self, channel: Channel) -> &[f64] {
        &self.rows[channel as usize].as_flattened()[..self.sensitivity.len()]
    }

    /// Carries the sensitivity of the state to an unknown beside the free terms, an acceleration over the last interval
    /// per unit of it, over that interval and through its measurements. Returns that of the expected measurements by
    /// channel, and the state's.
    #[inline]
    pub fn carry(&self, [q, qd]: [f64; 2], acceleration: f64, gains: [[f64; 2]; 2]) -> ([f64; 2], [f64; 2]) {
        let [[a, b], [c, d]] = self.map.transition;
        let [to_q, to_qd] = self.map.push;
        measured([a * q + b * qd + to_q * acceleration, c * q + d * qd + to_qd * acceleration], gains)
    }

    /// With process noise of intensity `process`, and `unseen` besides.
    fn advance(&mut self, process: f64, unseen: f64, observation: &Observation) {
        let parts = observation.drive.parts(self.parts);
        let dt = observation.dt / parts as f64;
        let mut first = true;
        for part in 0..parts {
            let excitation = observation.drive.part(part, parts);
            let Pass { compiled, slopes, map, rival_filters, ratios, filter, fastest, .. } = self;
            compiled.steps(filter.state, dt, excitation, slopes, |step, dt, slopes| {
                match first {
                    true => map.set(step, slopes),
                    false => map.append(step, slopes),
                }
                first = false;
                *fastest = fastest.max(step.rate * (parts * parts) as f64);
                for (rival, ratio) in rival_filters.iter_mut().zip(*ratios) {
                    rival.state = beside(step, filter.state, rival.state);
                    rival.predict(step, dt, process * ratio + unseen);
                }
                filter.state = step.state;
                filter.predict(step, dt, process + unseen);
            });
        }
        self.parts = self.parts.max(parts_for(self.fastest));
        self.quickest = self.quickest.max(self.fastest / (observation.dt * observation.dt));
    }

    /// After an outage in which the motion has turned too far to be followed its state is what is measured next, and
    /// nothing that was known of it before says anything of it.
    fn resume(&mut self, noise: &Noise, observation: &Observation) -> [Option<Innovation>; 2] {
        let Filter { state, .. } = self.filter;
        let [q, qd] = observation.measured;
        let [q_noise, qd_noise] = noise.sensor;
        let unknown = |value: f64, noise: f64| UNKNOWN * (value * value + noise);
        let covariance = [
            if q.is_some() { q_noise } else { unknown(state.q, q_noise) },
            0.0,
            if qd.is_some() { qd_noise } else { unknown(state.qd, qd_noise) },
        ];
        self.filter = Filter { state: State { q: q.unwrap_or(state.q), qd: qd.unwrap_or(state.qd) }, covariance };
        self.rival_filters = [self.filter; 2];
        self.sensitivity.fill([0.0; 2]);
        self.map.transition = [[0.0; 2]; 2];
        self.map.push = [0.0; 2];
        self.map.input.fill([0.0; 2]);
        self.rows.iter_mut().for_each(|row| row.fill([0.0; WIDTH]));
        self.set_aside = [None; 2];
        [None; 2]
    }

    #[inline]
    fn correct(&mut self, channel: Channel, noise: &Noise, observation: &Observation) -> Option<Innovation> {
        let measured = observation.measured[channel as usize]?;
        let variance = noise.sensor[channel as usize];
        self.set_aside[channel as usize] = None;
        if let Some(guard) = &mut self.guard {
            let (residual, total) = self.filter.residual(channel, measured, variance);
            if !guard.admits(channel, residual, total) {
                let precision = guard.precision(channel, residual);
                let innovation = Innovation { residual, variance: precision.recip(), precision, gain: [0.0; 2] };
                self.set_aside[channel as usize] = Some(innovation);
                return None;
            }
        }
        for (rival, track) in self.rival_filters.iter_mut().zip(&mut self.rivals) {
            track.add(channel, &rival.update(channel, measured, variance));
        }
        let innovation = self.filter.update(channel, measured, variance);
        self.track.add(channel, &innovation);
        Some(innovation)
    }

    /// Carries the sensitivity over the interval and through its measurements, and adds what they say.
    #[inline]
    fn inform(&mut self, innovations: &[Option<Innovation>; 2]) {
        let gains = gains(innovations);
        let [[a, b], [c, d]] = self.map.transition;
        let [q_row, qd_row] = &mut self.rows;
        let rows = q_row.as_flattened_mut().iter_mut().zip(qd_row.as_flattened_mut());
        for ((state, input), (q_row, qd_row)) in self.sensitivity.iter_mut().zip(&self.map.input).zip(rows) {
            let [q, qd] = *state;
            let moved = [a * q + b * qd + input[0], c * q + d * qd + input[1]];
            ([*q_row, *qd_row], *state) = measured(moved, gains);
        }
        let residuals = innovations.map(|innovation| innovation.map_or(0.0, |innovation| innovation.residual));
        let weights = innovations.map(|innovation| innovation.map_or(0.0, |innovation| innovation.precision));
        self.information.add_pair([&self.rows[0], &self.rows[1]], residuals, weights);
    }
}

/// How much of each channel's residual goes into the state; nothing where it was not measured.
#[inline]
pub fn gains(innovations: &[Option<Innovation>; 2]) -> [[f64; 2]; 2] {
    innovations.map(|innovation| innovation.map_or([0.0; 2], |innovation| innovation.gain))
}

/// A sensitivity of the state through the measurements of both channels: what it is of the expected ones, and what is
/// left of it.
#[inline]
fn measured([q, qd]: [f64; 2], [first, second]: [[f64; 2]; 2]) -> ([f64; 2], [f64; 2]) {
    let row = q;
    let (q, qd) = (q - first[0] * q, qd - first[1] * q);
    ([row, qd], [q - second[0] * qd, qd - second[1] * qd])
}

/// Where a state near the one that was integrated ends: it is carried by the linearised step.
fn beside(step: &Linearized, from: State, state: State) -> State {
    let [[a, b], [c, d]] = step.transition;
    let (dq, dqd) = (state.q - from.q, state.qd - from.qd);
    State { q: step.state.q + a * dq + b * dqd, qd: step.state.qd + c * dq + d * dqd }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a radian from sample to sample: in one step of the integrator the motion would be lost.
    #[test]
    fn the_first_run_takes_steps_as_fine_as_the_second() {
        let (omega, dt) = (50.0_f64, 0.01);
        let terms = [Term::Inertia, Term::power(1, 0)];
        let motion = Motion { terms: &terms, coefficients: &[1.0, omega * omega] };
        let noise = Noise { sensor: [1e-8, 1e-8 * omega * omega], process: 1e-12 };
        let at = |t: f64| [(omega * t).cos(), -omega * (omega * t).sin()];
        let mut pass = Pass::new(1);
        let mut squares = || {
            pass.begin(Filter { state: State { q: 1.0, qd: 0.0 }, covariance: [1e-8, 0.0, 1e-8 * omega * omega] });
            for k in 1..400 {
                let measured = at(f64::from(k) * dt).map(Some);
                let observation = Observation { dt, drive: Drive::Held(0.0), measured, unseen: 0.0 };
                pass.step(&motion, &terms[1..], &noise, &observation);
            }
            pass.track.squares.iter().sum::<f64>()
        };
        let [first, second] = [squares(), squares()];
        assert!(second < 10.0 && first < second + 10.0, "{first}, then {second}");
    }
}
