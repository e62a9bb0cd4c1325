//! A law whose output is F: a machine imposes q(t), and what the specimen answers is measured.
//!
//! q(t) = initial q + x(t), x the scenario's excitation as a function of time, not held, and q̇ = ẋ. The sine is that
//! of the stage at t, so that a stage with another amplitude or frequency begins with a jump of q. F = Σ θ_j f_j;
//! internal states begin with nothing stored and are integrated along the motion.

use super::error::ScenarioError;
use super::excitation::ExcitationKind;
use super::noise::{Stream, standard_normal};
use super::reading::Reading;
use super::scenario::Scenario;
use crate::law::{Hold, State, Term, Trajectory, term_series};
use serde::{Deserialize, Serialize};

/// The readings of a whole scenario, one per `excitation.sample_time`, from 0 to its duration.
///
/// # Errors
/// What [`Scenario::check`] refuses.
pub fn record(scenario: &Scenario) -> Result<Vec<Reading>, ScenarioError> {
    scenario.check()?;
    let sample_time = scenario.excitation.sample_time;
    let last = (scenario.duration / sample_time + Scenario::TIME_JITTER).floor() as u64;
    let t: Vec<f64> = (0..=last).map(|index| index as f64 * sample_time).collect();
    let phases = scenario.excitation.phases(scenario.seed);
    let states: Vec<State> = t.iter().map(|t| imposed(scenario, &phases, *t)).collect();
    let forces = forces(scenario, &t, &states);
    let noise = |std: f64, stream, index: usize| match std {
        0.0 => 0.0,
        std => std * standard_normal(scenario.seed, stream, index as u64),
    };
    let reading = |(index, (state, force)): (usize, (&State, &f64))| Reading {
        t: t[index],
        q: state.q + noise(scenario.noise.q, Stream::Displacement, index),
        qd: state.qd + noise(scenario.noise.qd, Stream::Velocity, index),
        excitation: force + noise(scenario.noise.force, Stream::Force, index),
    };
    Ok(states.iter().zip(&forces).enumerate().map(reading).collect())
}

/// The motion at t, s.
fn imposed(scenario: &Scenario, phases: &[f64], t: f64) -> State {
    let excitation = &scenario.excitation;
    let [q, qd] = match excitation.kind {
        ExcitationKind::None | ExcitationKind::WhiteNoise => [0.0; 2],
        ExcitationKind::Sine => {
            let stage = &scenario.stages[stage_at(scenario, t)];
            let (sin, cos) = (stage.omega * t).sin_cos();
            [stage.amplitude * sin, stage.amplitude * stage.omega * cos]
        }
        ExcitationKind::Multisine => excitation.multisine_with_slope(phases, t),
        ExcitationKind::Sweep => excitation.sweep_with_slope(t),
    };
    State { q: scenario.initial.q + q, qd }
}

/// The stage of a sample; one that begins at the sample, but for rounding, is its.
fn stage_at(scenario: &Scenario, t: f64) -> usize {
    scenario.stage_at(t + Scenario::TIME_JITTER * scenario.excitation.sample_time)
}

/// Σ θ_j f_j at every sample, the coefficients those of its stage.
fn forces(scenario: &Scenario, t: &[f64], states: &[State]) -> Vec<f64> {
    let (q, qd): (Vec<f64>, Vec<f64>) = states.iter().map(|state| (state.q, state.qd)).unzip();
    let none = vec![0.0; t.len()];
    let trajectory = Trajectory { t, q: &q, qd: &qd, excitation: &none, hold: Hold::Linear };
    let series = |term: Term| term_series(term, scenario.hidden.expressions(), &trajectory);
    let mut forces = none.clone();
    for (place, term) in scenario.terms.iter().enumerate() {
        for ((force, feature), t) in forces.iter_mut().zip(series(*term)).zip(t) {
            *force += scenario.stages[stage_at(scenario, *t)].coefficients[place] * feature;
        }
    }
    for (term, coefficient) in scenario.hidden.terms().zip(scenario.hidden.coefficients()) {
        forces.iter_mut().zip(series(term)).for_each(|(force, feature)| *force += coefficient * feature);
    }
    forces
}

/// A specimen that somebody else moves: its force for a displacement and a velocity at one instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Specimen {
    scenario: Scenario,
}

impl Specimen {
    /// The specimen of a scenario, whose excitation does not matter.
    ///
    /// # Errors
    /// What [`Scenario::check`] refuses, [`ScenarioError::Inertia`] for a law that moves of itself,
    /// [`ScenarioError::Memory`] for a term whose
    /// force needs the past.
    pub fn new(scenario: Scenario) -> Result<Specimen, ScenarioError> {
        scenario.check()?;
        if !scenario.is_force_law() {
            return Err(ScenarioError::Inertia);
        }
        let needs_the_past = |term: &Term| !term.is_pointwise() && !matches!(term, Term::Expression(_));
        let memory = scenario.terms.iter().copied().chain(scenario.hidden.terms()).find(needs_the_past);
        match memory {
            Some(term) => Err(ScenarioError::Memory { term }),
            None => Ok(Specimen { scenario }),
        }
    }

    /// The force at time t, s, without noise.
    pub fn force(&self, t: f64, State { q, qd }: State) -> f64 {
        let scenario = &self.scenario;
        let own = scenario.terms.iter().copied().zip(self.coefficients(t).iter().copied());
        let hidden = scenario.hidden.terms().zip(scenario.hidden.coefficients());
        let force = |term: Term| match term {
            Term::Expression(own) => scenario.hidden.expressions()[own.place()].value_of(&own, q, qd, 0.0, t),
            _ => term.force(q, qd, 0.0),
        };
        own.chain(hidden).map(|(term, value)| value * force(term)).sum()
    }

    /// Error of the force's sensor at sample `index`.
    pub fn noise(&self, index: u64) -> f64 {
        match self.scenario.noise.force {
            0.0 => 0.0,
            std => std * standard_normal(self.scenario.seed, Stream::Force, index),
        }
    }

    /// Index of the stage at time t, s.
    pub fn stage(&self, t: f64) -> usize {
        stage_at(&self.scenario, t)
    }

    /// The coefficients at time t, s, in the order of the scenario's terms.
    pub fn coefficients(&self, t: f64) -> &[f64] {
        &self.scenario.stages[self.stage(t)].coefficients
    }
}
