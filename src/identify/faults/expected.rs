//! What readings are held against: a law or the motion itself, and by how much either may be wrong.

use crate::estimation::{Filter, Matrix, Noise, times, white_acceleration};
use crate::law::{Drive, Hold, Motion, State};
use crate::limits::SETTLED_ERROR;

/// What the readings are held against.
#[derive(Clone, Copy, Debug)]
pub struct Expected<'a> {
    /// The law in use.
    pub motion: Motion<'a>,
    /// The sensors' noise, and what the law leaves unexplained.
    pub noise: Noise,
    /// How many times the evidence is asked of a reading that a law known for sure would need.
    pub caution: f64,
    /// Std of what a switch adds to q̈, and of the part of F ÷ m that it does.
    pub switch: [f64; 2],
    /// Radians of the motion in a second.
    pub rate: f64,
    /// RMS of q and q̇: what an offset or a kick may be.
    pub size: [f64; 2],
    /// RMS of F ÷ m.
    pub drive: f64,
    /// Time since the end of an outage in which the law may have changed, s; 0 where that would have been noticed.
    pub unnoticed: f64,
    /// F, where it may be stuck.
    pub stuck: Option<Standing>,
    /// Parts of an interval between two samples.
    pub parts: usize,
    /// Samples that F acts later than it comes, as is assumed.
    pub lag: f64,
    /// Where no law is known: `motion` is a free mass of 1 kg then, whose acceleration the unknowns are.
    pub alone: Option<Roughness>,
}

/// How rough a motion is of which no law is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Variance that q̈ gains in a second, (m/s²)²/s.
    pub acceleration: f64,
    /// Variance of what q gains in a second beside the integral of q̇, m²/s.
    pub slip: f64,
    /// What F moves, kg, where that is known.
    pub inertia: Option<f64>,
}

/// An F that stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// For how long, s.
    pub since: f64,
    /// Time in which F, when it moves, goes as far as it is from 0, s.
    pub pace: f64,
}

impl Standing {
    /// What is left of a force, as its correlation, after so long, s.
    pub fn kept(&self, time: f64) -> f64 {
        (-time / self.pace).exp()
    }
}

impl Expected<'_> {
    /// What F moves at q, kg; infinite where F is not known to move anything.
    fn mass(&self, q: f64) -> f64 {
        self.alone.map_or_else(|| self.motion.mass(q), |alone| alone.inertia.unwrap_or(f64::INFINITY))
    }

    /// Variance of what a valid law may leave out of q̈.
    pub fn misfit(&self) -> f64 {
        let [acceleration, _] = self.switch;
        SETTLED_ERROR * acceleration * acceleration
    }

    /// The filter of (q, q̇) after an interval of the law in use.
    pub fn carry(&self, filter: &Filter, dt: f64, drive: &Drive) -> Filter {
        let mut filter = *filter;
        let parts = drive.parts(self.parts);
        let dt = dt / parts as f64;
        let noise = white_acceleration(self.noise.process, dt);
        for part in 0..parts {
            let [from, middle, to] = drive.part(part, parts);
            let state = filter.state();
            let transition = transition(self.motion.acceleration_gradient(state, middle), dt);
            filter.set_state(self.motion.step_linear(state, dt, from, to));
            filter.predict(|change| times(&transition, change), &noise);
        }
        filter
    }

    /// (q, q̇) after an interval of the law in use.
    pub fn carry_state(&self, state: State, dt: f64, drive: &Drive) -> State {
        let parts = drive.parts(self.parts);
        (0..parts).fold(state, |state, part| {
            let [from, _, to] = drive.part(part, parts);
            self.motion.step_linear(state, dt / parts as f64, from, to)
        })
    }

    /// Goes over an interval in which q̈ is the law's, u₀ and u₁ F ÷ m as far as they act. `added`, by what multiplies
    /// them, is the intensity of a white acceleration and what u₀ gains in a second, as variances.
    pub fn advance(
        &self,
        filter: &mut Filter<4>,
        dt: f64,
        drive: &Drive,
        act: [bool; 2],
        added: impl Fn([f64; 2]) -> [f64; 2],
    ) {
        let parts = drive.parts(self.parts);
        let part_dt = dt / parts as f64;
        let half = 0.5 * part_dt * part_dt;
        let [rough, slip] = self.alone.map_or([0.0; 2], |alone| [alone.acceleration, alone.slip]);
        for part in 0..parts {
            let [from, middle, to] = drive.part(part, parts);
            let state = filter.state();
            let gradient = self.motion.acceleration_gradient(state, middle);
            let [first, second] = act.map(|acts| if acts { 1.0 } else { 0.0 });
            let inputs = [first, second * middle / self.motion.mass(state.q)];
            let moved = self.motion.step_linear(state, part_dt, from, to);
            let extra = inputs[0] * filter.mean[2] + inputs[1] * filter.mean[3];
            filter.set_state(State { q: moved.q + half * extra, qd: moved.qd + part_dt * extra });
            let [process, wander] = added(inputs);
            let [[qq, qv], [_, vv]] = white_acceleration(self.noise.process + process, part_dt);
            let noise = [
                [qq + slip * part_dt, qv, 0.0, 0.0],
                [qv, vv, 0.0, 0.0],
                [0.0, 0.0, (wander + rough) * part_dt, 0.0],
                [0.0; 4],
            ];
            let [by_q, by_qd] = transition(gradient, part_dt);
            let map = |[q, qd, acceleration, gain]: [f64; 4]| {
                let input = inputs[0] * acceleration + inputs[1] * gain;
                let [moved, faster] = times(&[by_q, by_qd], [q, qd]);
                [moved + half * input, faster + part_dt * input, acceleration, gain]
            };
            filter.predict(map, &noise);
        }
    }

    /// What is expected of (q, q̇) after an interval of a motion of which no law is known.
    pub fn foresee(&self, filter: &Filter<4>, dt: f64, drive: &Drive) -> Filter<4> {
        let mut filter = *filter;
        self.advance(&mut filter, dt, drive, [true; 2], |_| [0.0; 2]);
        filter
    }

    /// The noise, and a white force of intensity `unseen`, N² s, that acts on the mass at `q`.
    pub fn noise_with(&self, unseen: f64, q: f64) -> Noise {
        let mass = self.mass(q);
        Noise { process: self.noise.process + unseen / (mass * mass), ..self.noise }
    }
}

#[cfg(test)]
impl<'a> Expected<'a> {
    /// A law known for sure of 2 rad/s, in a motion of size 1 under sensors of that std, where nothing is open.
    pub fn of_oscillator(motion: Motion<'a>, noise: f64) -> Expected<'a> {
        Expected {
            motion,
            noise: Noise { sensor: [noise * noise; 2], process: 1e-9 },
            caution: 1.0,
            switch: [4.0, 0.5],
            rate: 2.0,
            size: [1.0, 2.0],
            drive: 1.0,
            unnoticed: 0.0,
            stuck: None,
            parts: 1,
            lag: 0.0,
            alone: None,
        }
    }
}

/// Samples by which q and q̇ come later than before where F, which acts so many samples later than it comes, does so by
/// `later` more: what is left of that is F's, which comes earlier or is held otherwise.
pub fn delay(lag: f64, later: f64) -> f64 {
    (lag + later.trunc()).max(0.0) - lag.max(0.0)
}

/// Whether F is held between samples where `hold` is assumed of what acts `lag` samples later than it comes: what is
/// held acts, to first order, half a sample later than what moves straight.
pub fn is_held(hold: Hold, lag: f64) -> bool {
    let late = if hold == Hold::Zero { lag + 0.5 } else { lag };
    late.fract().abs() == 0.5
}

/// What an interval makes of a small change of (q, q̇), where q̈ changes so by them.
fn transition([by_q, by_qd]: [f64; 2], dt: f64) -> Matrix<2> {
    let half = 0.5 * dt * dt;
    [[1.0 + half * by_q, dt + half * by_qd], [dt * by_q, 1.0 + dt * by_qd]]
}
