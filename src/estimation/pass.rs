//! One run of the filter over a record: likelihood, score and information of the coefficients.

use super::covariance::Matrix;
use super::filter::{Channel, Filter, Innovation, Noise, times, white_acceleration};
use super::information::Information;
use super::initial_state::{LOST, state_after_outage};
use super::innovation_gate::InnovationGate;
use super::rivals::{RIVALS, Rivals};
use super::symmetric::{Lane, WIDTH};
use super::track::Track;
use crate::law::{Compiled, Drive, Linearized, Motion, Term};
use serde::{Deserialize, Serialize};

/// Most parts into which an interval between two samples is cut.
const MAX_PARTS: usize = 8;

/// Largest rate per part, squared radians: below it a step of order 4 errs by less than 1e-7 of the motion.
const MAX_RATE: f64 = 0.0025;

/// A sample and the excitation since the one before it.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// Time since the last sample, s.
    pub dt: f64,
    /// The excitation over that time.
    pub drive: Drive,
    /// What was measured at its end, q and q̇; `None` where a channel is not measured.
    pub measured: [Option<f64>; 2],
    /// Intensity of the white force that the excitation may have had unseen over that time, N² s; infinite over an
    /// outage, of which nothing is known.
    pub unseen: f64,
}

impl Observation {
    /// Whether the motion cannot be followed to it where it turns by so much, rad.
    pub fn is_lost(&self, turned: f64) -> bool {
        self.unseen.is_infinite() || self.unseen > 0.0 && turned > LOST
    }
}

/// δx⁺ = A δx + B δθ over an interval between two samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IntervalMap {
    /// A.
    pub transition: Matrix<2>,
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
    /// Its rivals of less and of more process noise.
    pub rivals: Rivals,
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
    fastest: f64,
    /// `fastest` ÷ the square of the interval: how fast the motion turns, rad²/s².
    quickest: f64,
    /// Keeps outliers out, where wanted.
    gate: Option<InnovationGate>,
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
        Pass {
            filter: Filter::default(),
            track: Track::default(),
            rivals: Rivals::new(RIVALS),
            information: Information::none(n),
            sensitivity: vec![[0.0; 2]; n],
            map: IntervalMap { transition: [[0.0; 2]; 2], input: vec![[0.0; 2]; n], push: [0.0; 2] },
            set_aside: [None; 2],
            parts: 1,
            fastest: 0.0,
            quickest: 0.0,
            gate: None,
            compiled: Compiled::default(),
            seeking: false,
            slopes: vec![0.0; n],
            rows: [lanes(), lanes()],
        }
    }

    /// The same run, which leaves outliers out.
    pub fn gated(self) -> Pass {
        Pass { gate: Some(InnovationGate::default()), ..self }
    }

    /// Begins at a state that does not depend on the coefficients.
    pub fn begin(&mut self, filter: Filter) {
        self.filter = filter;
        self.rivals.begin(filter);
        self.track = Track::default();
        self.gate = self.gate.map(|_| InnovationGate::default());
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
        if observation.is_lost(self.quickest.sqrt() * observation.dt) {
            return self.resume(noise, observation);
        }
        let unseen = match observation.unseen > 0.0 {
            true => observation.unseen / motion.mass(self.filter.mean[0]).powi(2),
            false => 0.0,
        };
        self.advance(noise.process, unseen, observation);
        // one after the other, each with its channel known to the compiler
        let displacement = self.correct(Channel::Q, noise, observation);
        let innovations = [displacement, self.correct(Channel::Qd, noise, observation)];
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
    pub fn carry(&self, state: [f64; 2], acceleration: f64, gains: &[[f64; 2]; 2]) -> ([f64; 2], [f64; 2]) {
        let moved = sum(times(&self.map.transition, state), self.map.push.map(|push| push * acceleration));
        measured(moved, gains)
    }

    /// With process noise of intensity `process`, and `unseen` besides.
    fn advance(&mut self, process: f64, unseen: f64, observation: &Observation) {
        let parts = observation.drive.parts(self.parts);
        let dt = observation.dt / parts as f64;
        let mut first = true;
        for part in 0..parts {
            let excitation = observation.drive.part(part, parts);
            let Pass { compiled, slopes, map, rivals, filter, fastest, .. } = self;
            compiled.steps(filter.state(), dt, excitation, slopes, |step, dt, slopes| {
                match first {
                    true => map.set(step, slopes),
                    false => map.append(step, slopes),
                }
                first = false;
                *fastest = fastest.max(step.rate * (parts * parts) as f64);
                let noise = |ratio: f64| white_acceleration(process * ratio + unseen, dt);
                rivals.predict(filter.mean, [step.state.q, step.state.qd], &step.transition, noise);
                filter.set_state(step.state);
                filter.predict(|change| times(&step.transition, change), &noise(1.0));
            });
        }
        self.parts = self.parts.max(parts_for(self.fastest));
        self.quickest = self.quickest.max(self.fastest / (observation.dt * observation.dt));
    }

    /// Goes on after an outage in which the motion has turned too far to be followed.
    fn resume(&mut self, noise: &Noise, observation: &Observation) -> [Option<Innovation>; 2] {
        let filter = state_after_outage(self.filter.mean, observation.measured, noise);
        self.filter = filter;
        self.rivals.resume(filter);
        self.sensitivity.fill([0.0; 2]);
        self.map.transition = [[0.0; 2]; 2];
        self.map.push = [0.0; 2];
        self.map.input.fill([0.0; 2]);
        self.rows.iter_mut().for_each(|row| row.fill([0.0; WIDTH]));
        self.set_aside = [None; 2];
        [None; 2]
    }

    #[inline(always)]
    fn correct(&mut self, channel: Channel, noise: &Noise, observation: &Observation) -> Option<Innovation> {
        self.set_aside[channel as usize] = None;
        let measured = observation.measured[channel as usize]?;
        let variance = noise.sensor[channel as usize];
        if let Some(gate) = &mut self.gate {
            let (residual, total) = self.filter.residual(channel, measured, variance);
            if !gate.admits(channel, residual, total) {
                let precision = gate.precision(channel, residual);
                let innovation = Innovation { residual, variance: precision.recip(), precision, gain: [0.0; 2] };
                self.set_aside[channel as usize] = Some(innovation);
                return None;
            }
        }
        // how far an unseen force scatters the motion is a guess, and tells nothing of the law's error or the sensors'
        let counts = observation.unseen == 0.0;
        self.rivals.update(channel, measured, variance, counts);
        let innovation = self.filter.update(channel, measured, variance);
        if counts {
            self.track.add(channel, &innovation);
        }
        Some(innovation)
    }

    /// Carries the sensitivity over the interval and through its measurements, and adds what they say.
    #[inline]
    fn inform(&mut self, innovations: &[Option<Innovation>; 2]) {
        let gains = gains(innovations);
        let [q_row, qd_row] = &mut self.rows;
        let rows = q_row.as_flattened_mut().iter_mut().zip(qd_row.as_flattened_mut());
        for ((state, input), (q_row, qd_row)) in self.sensitivity.iter_mut().zip(&self.map.input).zip(rows) {
            let moved = sum(times(&self.map.transition, *state), *input);
            ([*q_row, *qd_row], *state) = measured(moved, &gains);
        }
        let residuals = innovations.map(|innovation| innovation.map_or(0.0, |innovation| innovation.residual));
        let weights = innovations.map(|innovation| innovation.map_or(0.0, |innovation| innovation.precision));
        self.information.add_pair([&self.rows[0], &self.rows[1]], residuals, weights);
    }
}

/// How much of each channel's residual goes into the states; nothing where it was not measured.
#[inline]
pub fn gains<const N: usize>(innovations: &[Option<Innovation<N>>; 2]) -> [[f64; N]; 2] {
    innovations.map(|innovation| innovation.map_or([0.0; N], |innovation| innovation.gain))
}

/// A sensitivity of the states through the measurements of both channels: what it is of the expected ones, and what is
/// left of it.
#[inline]
fn measured<const N: usize>(mut state: [f64; N], gains: &[[f64; N]; 2]) -> ([f64; 2], [f64; N]) {
    let mut rows = [0.0; 2];
    for (channel, gain) in gains.iter().enumerate() {
        rows[channel] = state[channel];
        state.iter_mut().zip(gain).for_each(|(entry, gain)| *entry -= gain * rows[channel]);
    }
    (rows, state)
}

#[inline]
fn sum(first: [f64; 2], second: [f64; 2]) -> [f64; 2] {
    [first[0] + second[0], first[1] + second[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a radian from sample to sample: in one step of the integrator the motion would be lost.
    #[test]
    fn the_first_run_takes_steps_as_fine_as_the_second() {
        let (omega, dt) = (50.0_f64, 0.01);
        let terms = [Term::Inertia, Term::power(1, 0)];
        let coefficients = [1.0, omega * omega];
        let motion = Motion::new(&terms, &coefficients);
        let noise = Noise { sensor: [1e-8, 1e-8 * omega * omega], process: 1e-12 };
        let at = |t: f64| [(omega * t).cos(), -omega * (omega * t).sin()];
        let mut pass = Pass::new(1);
        let mut squares = || {
            pass.begin(Filter::begin([1.0, 0.0], [1e-8, 1e-8 * omega * omega]));
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

    /// What a reading said that did not count is said once, also where the channel is not measured after it.
    #[test]
    fn a_reading_set_aside_speaks_once() {
        let motion = Motion::new(&[Term::Inertia], &[1.0]);
        let noise = Noise { sensor: [1e-4; 2], process: 1e-6 };
        let mut pass = Pass::new(0).gated();
        pass.begin(Filter::begin([0.0; 2], [1e-6; 2]));
        let aside = [Some(0.2), None].map(|qd| {
            let observation = Observation { dt: 1e-3, drive: Drive::Held(0.0), measured: [Some(0.0), qd], unseen: 0.0 };
            pass.step(&motion, &[], &noise, &observation);
            pass.set_aside[1].is_some()
        });
        assert_eq!(aside, [true, false]);
    }
}
