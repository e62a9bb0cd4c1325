//! A plant that somebody else integrates: q̇ and q̈ for a state and a time, and the times at which they jump.
//!
//! The law switches at the start of a stage and the excitation is held on its grid, as in [`Plant`], so that both show
//! the same motion as far as the integration is exact.

use super::error::ScenarioError;
use super::excitation::ExcitationKind;
use super::plant::{Plant, Truth, interval, noise_of};
use super::reading::Reading;
use super::scenario::Scenario;
use crate::law::State;
use serde::{Deserialize, Serialize};

/// A plant's equations, and where their integration is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContinuousPlant {
    /// Law and excitation; it stays at its start.
    plant: Plant,
    /// Whether the excitation comes from outside, at any time.
    driven: bool,
    t: f64,
    state: State,
    /// As they are from the last event on: stage, interval of the excitation's grid, excitation.
    stage: usize,
    interval: u64,
    excitation: f64,
}

impl ContinuousPlant {
    /// A plant at t = 0; where it is driven, of the scenario's excitation only `sample_time` counts.
    ///
    /// # Errors
    /// What [`Plant::new`] refuses, and a term with memory, a delay or dry friction.
    pub fn new(scenario: Scenario, driven: bool) -> Result<ContinuousPlant, ScenarioError> {
        let plant = Plant::new(scenario)?;
        if let Some(term) = plant.law.rough() {
            return Err(ScenarioError::NotSmooth { term });
        }
        let state = plant.truth().state;
        let mut begun = ContinuousPlant { plant, driven, t: 0.0, state, stage: 0, interval: 0, excitation: 0.0 };
        begun.settle(0.0);
        Ok(begun)
    }

    /// Moves on to time t, s, with the law and the held excitation as they were.
    pub fn set_time(&mut self, t: f64) {
        self.t = t;
    }

    /// Displacement and velocity.
    pub fn state(&self) -> State {
        self.state
    }

    /// Takes displacement and velocity.
    pub fn set_state(&mut self, state: State) {
        self.state = state;
    }

    /// q̈, m/s²; under that excitation, where it is driven and this is a finite number, else under the one of the last
    /// event.
    pub fn acceleration(&self, excitation: f64) -> f64 {
        let from_outside = self.driven && excitation.is_finite();
        let excitation = if from_outside { excitation } else { self.excitation };
        self.plant.law.motion(&self.plant.scenario, self.stage).acceleration(self.state, excitation)
    }

    /// An event: law, excitation and noise of the present time, and when the next one is, s. `excitation` is the one
    /// from outside.
    pub fn settle(&mut self, excitation: f64) -> Option<f64> {
        let scenario = &self.plant.scenario;
        self.interval = interval(scenario, self.t);
        self.stage = scenario.stage_at(self.t + self.plant.resolution(self.t));
        self.excitation = match self.driven {
            true if excitation.is_finite() => excitation,
            true => self.excitation,
            false => self.plant.held(self.interval),
        };
        let switch = scenario.stages.get(self.stage + 1).map(|stage| stage.start);
        let grid = self.is_on_a_grid().then_some((self.interval + 1) as f64 * scenario.excitation.sample_time);
        [switch, grid].into_iter().flatten().reduce(f64::min)
    }

    fn is_on_a_grid(&self) -> bool {
        let Scenario { noise, excitation, .. } = &self.plant.scenario;
        let is_held = !self.driven && excitation.kind != ExcitationKind::None;
        is_held || noise.q > 0.0 || noise.qd > 0.0
    }

    /// What is measured now; noise and excitation are those of the last event.
    pub fn reading(&self) -> Reading {
        let noise = noise_of(&self.plant.scenario, self.interval);
        let State { q, qd } = self.state;
        Reading { t: self.t, q: q + noise.q, qd: qd + noise.qd, excitation: self.excitation + noise.force }
    }

    /// What is the case now.
    pub fn truth(&self) -> Truth<'_> {
        let coefficients = &self.plant.scenario.stages[self.stage].coefficients;
        Truth { stage: self.stage, coefficients, state: self.state }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Effect, Term};
    use crate::simulate::Builtin;

    /// Classical Runge–Kutta from event to event.
    fn integrate(plant: &mut ContinuousPlant, end: f64, excitation: impl Fn(f64) -> f64) {
        while plant.t < end {
            let next = plant.settle(excitation(plant.t)).unwrap_or(end).min(end);
            let parts = ((next - plant.t) / 1e-3).ceil().max(1.0);
            let (from, dt) = (plant.t, (next - plant.t) / parts);
            for part in 0..parts as u64 {
                runge_kutta(plant, from + part as f64 * dt, dt, &excitation);
            }
            plant.set_time(next);
        }
    }

    fn runge_kutta(plant: &mut ContinuousPlant, t: f64, dt: f64, excitation: impl Fn(f64) -> f64) {
        let State { q, qd } = plant.state();
        let mut slopes = [[0.0; 2]; 4];
        for (index, share) in [0.0, 0.5, 0.5, 1.0].into_iter().enumerate() {
            let [dq, dqd] = if index == 0 { [0.0; 2] } else { slopes[index - 1] };
            plant.set_time(t + share * dt);
            plant.set_state(State { q: q + share * dt * dq, qd: qd + share * dt * dqd });
            slopes[index] = [plant.state().qd, plant.acceleration(excitation(t + share * dt))];
        }
        let mean = |of: usize| (slopes[0][of] + 2.0 * slopes[1][of] + 2.0 * slopes[2][of] + slopes[3][of]) / 6.0;
        plant.set_state(State { q: q + dt * mean(0), qd: qd + dt * mean(1) });
    }

    #[test]
    fn integrated_from_outside_it_moves_as_the_plant_does() {
        for builtin in [Builtin::DuffingSine, Builtin::VanDerPolWhite] {
            let scenario = builtin.scenario().with_noise(0.02).with_seed(3);
            let end = scenario.switch_times()[0] + 1.0;
            let (mut plant, mut continuous) =
                (Plant::new(scenario.clone()).unwrap(), ContinuousPlant::new(scenario, false).unwrap());
            plant.advance_to(end).unwrap();
            integrate(&mut continuous, end, |_| f64::NAN);
            continuous.settle(f64::NAN);
            let (one, other) = (plant.reading(), continuous.reading());
            assert!((one.q - other.q).abs() < 1e-8 && (one.qd - other.qd).abs() < 1e-8, "{one:?} {other:?}");
            assert_eq!((one.excitation, plant.truth().stage), (other.excitation, continuous.truth().stage));
            assert!((plant.acceleration() - continuous.acceleration(0.0)).abs() < 1e-6);
        }
    }

    #[test]
    fn driven_it_has_no_events_but_the_switches() {
        let scenario = Builtin::DuffingSine.scenario();
        let switch = scenario.switch_times()[0];
        let mut plant = ContinuousPlant::new(scenario, true).unwrap();
        assert_eq!(plant.settle(1.0), Some(switch));
        assert_eq!(
            plant.acceleration(3.0) - plant.acceleration(f64::NAN),
            plant.acceleration(2.0) - plant.acceleration(0.0)
        );
    }

    #[test]
    fn a_law_with_kinks_is_refused() {
        let mut scenario = Builtin::DuffingSine.scenario();
        scenario.hidden.push(Term::Effect(Effect::CoulombFriction), 0.1);
        let refused = ContinuousPlant::new(scenario, false).unwrap_err();
        assert!(refused.to_string().contains("co-simulation"), "{refused}");
    }
}
