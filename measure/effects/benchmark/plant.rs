//! A plant: its law, what drives it, its motion without noise.

use super::drive::{Drive, rms};
use std::f64::consts::TAU;
use switchid::law::{Dynamics, Hold, Motion, State, Term, Trajectory, term_series};

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
    /// The sample from which on the linear stiffness is that many times as large. Only a plant that runs straight has
    /// it.
    pub switch: Option<(usize, f64)>,
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
}

impl Law {
    /// Its motion; none where a coefficient stands in its way.
    pub fn dynamics(&self) -> Option<Dynamics<'_>> {
        Dynamics::new(Motion::new(&self.terms, &self.coefficients)).ok()
    }

    /// The law with that many times its linear stiffness.
    pub fn stiffened(&self, factor: f64) -> Law {
        let mut law = self.clone();
        let own = law.terms.iter().zip(&mut law.coefficients).filter(|(term, _)| **term == Term::power(1, 0));
        own.for_each(|(_, coefficient)| *coefficient *= factor);
        law
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
