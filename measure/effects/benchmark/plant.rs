//! The plant in motion: directly, as a scenario, or as an FMU.

use super::drive::{Drive, rms};
use super::generator::Generator;
use super::outside::Agent;
use super::problem::PARTS;
use super::through_fmu;
use std::f64::consts::TAU;
use switchid::law::{Dynamics, Hold, Motion, Samples, State, Term, Trajectory, term_series};
use switchid::simulate::{Hidden, Scenario, Stage, record};

/// A motion without noise.
#[derive(Clone, Debug, Default)]
pub struct Track {
    pub t: Vec<f64>,
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    pub excitation: Vec<f64>,
    /// Force of an effect that the catalogue does not have.
    pub outside: Vec<f64>,
}

/// The whole law of a plant: what the model knows, then what it does not.
#[derive(Clone, Debug)]
pub struct Law {
    pub terms: Vec<Term>,
    pub coefficients: Vec<f64>,
    /// How many of them the model may know.
    pub known: usize,
}

/// What drives a plant, and how it is sampled.
#[derive(Clone, Debug)]
pub struct Rig {
    pub drive: Drive,
    /// Whether the plant is a scenario; its excitation is then held between samples, else it runs straight.
    pub scenario: bool,
    /// Whether the scenario is stepped through the FMI functions of its FMU in the end.
    pub fmu: bool,
    pub omega: f64,
    pub sample_time: f64,
    pub count: usize,
    /// RMS of the excitation, N.
    pub amplitude: f64,
    pub seed: u64,
    /// What the excitation does between samples where the plant runs straight.
    pub direct_hold: Hold,
    /// A force at samples that nothing measures, ÷ [`Rig::amplitude`]; empty where there is none. Only a plant that
    /// runs straight has it.
    pub disturbance: Vec<f64>,
}

impl Rig {
    /// What the excitation does between samples.
    pub fn hold(&self) -> Hold {
        if self.scenario { Hold::Zero } else { self.direct_hold }
    }

    /// The seed of a scenario, which FMI takes as a positive integer of 32 bits.
    pub fn fmi_seed(&self) -> u64 {
        self.seed & i32::MAX as u64
    }

    /// The motion from rest, a sample cut into `parts` steps; none where it has no bounds.
    pub fn run(&self, law: &Law, parts: usize, agent: Option<(Agent, f64)>) -> Option<Track> {
        let track = match self.scenario {
            true => self.run_scenario(law, parts)?,
            false => self.run_direct(law, parts, agent)?,
        };
        track.q.iter().all(|q| q.is_finite()).then_some(track)
    }

    fn run_scenario(&self, law: &Law, parts: usize) -> Option<Track> {
        let mut excitation = self.drive.of_scenario(self.omega, self.sample_time, self.count);
        excitation.rms = self.amplitude;
        excitation.intensity *= self.amplitude * self.amplitude;
        if self.fmu && parts == PARTS[1] {
            return through_fmu::run(self, law, &excitation).ok();
        }
        let (terms, coefficients) = (law.terms[..law.known].to_vec(), law.coefficients[..law.known].to_vec());
        let stage = Stage { start: 0.0, coefficients, amplitude: 0.0, omega: 0.0 };
        let duration = self.sample_time * (self.count as f64 - 0.5);
        let mut scenario = Scenario::new("hidden effect", terms, vec![stage], duration).with_seed(self.fmi_seed());
        scenario.excitation = excitation;
        scenario.inner_step = self.sample_time / parts as f64;
        let mut hidden = Hidden::default();
        let pairs = law.terms.iter().zip(&law.coefficients).skip(law.known);
        pairs.for_each(|(term, coefficient)| hidden.push(*term, *coefficient));
        scenario.hidden = hidden;
        let mut track = Track::default();
        for reading in record(&scenario).ok()? {
            track.push(reading.t, State { q: reading.q, qd: reading.qd }, reading.excitation, 0.0);
        }
        Some(track)
    }

    fn run_direct(&self, law: &Law, parts: usize, mut agent: Option<(Agent, f64)>) -> Option<Track> {
        let mut generator = Generator::new(self.seed);
        let values = self.drive.values(&mut generator, self.omega, self.sample_time, self.count);
        let excitation: Vec<f64> = values.iter().map(|value| value * self.amplitude).collect();
        let t: Vec<f64> = (0..self.count).map(|index| index as f64 * self.sample_time).collect();
        let samples = Samples { t: &t, excitation: &excitation, hold: self.direct_hold };
        let disturbance: Vec<f64> = self.disturbance.iter().map(|value| value * self.amplitude).collect();
        let disturbance = Samples { t: &t[..disturbance.len()], excitation: &disturbance, hold: Hold::Linear };
        let dynamics = Dynamics::new(Motion { terms: &law.terms, coefficients: &law.coefficients }, &[]).ok()?;
        let mut phase = dynamics.rest(State::default());
        let width = self.sample_time / parts as f64;
        let mut track = Track::default();
        for (k, now) in t.iter().enumerate() {
            // what is held stays until the sample's end, also at it
            let is_held = |t: f64| self.direct_hold == Hold::Zero && t > *now;
            let measured = |t: f64| if is_held(t) { excitation[k] } else { samples.at(t) };
            for part in 0..parts {
                let from = now + width * part as f64;
                let (force, strength) = match &mut agent {
                    Some((agent, strength)) => (agent.force(from, width, phase.state, measured(from)), *strength),
                    None => (0.0, 0.0),
                };
                if part == 0 {
                    track.push(*now, phase.state, excitation[k], force);
                }
                phase =
                    dynamics.step(&phase, from, width, &|t: f64| measured(t) + disturbance.at(t) - strength * force);
            }
        }
        Some(track)
    }
}

impl Track {
    pub fn push(&mut self, t: f64, state: State, excitation: f64, outside: f64) {
        self.t.push(t);
        self.q.push(state.q);
        self.qd.push(state.qd);
        self.excitation.push(excitation);
        self.outside.push(outside);
    }

    /// The samples from an index on.
    pub fn from(mut self, first: usize) -> Track {
        for signal in [&mut self.t, &mut self.q, &mut self.qd, &mut self.excitation, &mut self.outside] {
            signal.drain(..first);
        }
        self
    }

    /// T₀ = 2π rms q̇ ÷ rms q̈, s.
    pub fn period(&self) -> f64 {
        let pairs = self.qd.windows(2).zip(self.t.windows(2));
        let acceleration: Vec<f64> = pairs.map(|(qd, t)| (qd[1] - qd[0]) / (t[1] - t[0])).collect();
        TAU * rms(&self.qd) / rms(&acceleration)
    }

    /// The force of a term along the motion, per unit of its coefficient, with the part that multiplies q̈.
    pub fn force(&self, term: Term, hold: Hold) -> Vec<f64> {
        let Track { t, q, qd, excitation, .. } = self;
        let mut series = term_series(term, &[], &Trajectory { t, q, qd, excitation, hold });
        for k in 1..t.len() - 1 {
            series[k] += term.mass(q[k]) * (qd[k + 1] - qd[k - 1]) / (t[k + 1] - t[k - 1]);
        }
        series
    }
}
