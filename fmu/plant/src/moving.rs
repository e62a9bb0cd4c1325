//! A plant that moves, under its own excitation or under one from outside.

use crate::places::Places;
use serde::{Deserialize, Serialize};
use switchid::simulate::{DrivenPlant, Plant, PlantError, Reading, Scenario, ScenarioError, Truth};
use switchid_fmu_slave::{Value, Values};

/// Where its excitation comes from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Moving {
    /// From the scenario.
    Scheduled(Plant),
    /// From an input.
    Driven(DrivenPlant),
}

impl Moving {
    /// A plant at its start.
    ///
    /// # Errors
    /// What the scenario does not allow.
    pub fn new(scenario: Scenario, driven: bool) -> Result<Moving, ScenarioError> {
        match driven {
            true => DrivenPlant::new(scenario).map(Moving::Driven),
            false => Plant::new(scenario).map(Moving::Scheduled),
        }
    }

    /// Moves to time t, s; what comes from outside is held all the way, and where it is no number, what came before.
    ///
    /// # Errors
    /// [`PlantError`]; the plant then stays where it was.
    pub fn advance_to(&mut self, t: f64, input: Option<f64>) -> Result<(), PlantError> {
        match self {
            Moving::Scheduled(plant) => plant.advance_to(t),
            Moving::Driven(plant) => {
                let input = input.filter(|value| value.is_finite()).unwrap_or(plant.excitation());
                plant.advance_to(t, input)
            }
        }
    }

    /// What is the case now.
    pub fn truth(&self) -> Truth<'_> {
        match self {
            Moving::Scheduled(plant) => plant.truth(),
            Moving::Driven(plant) => plant.truth(),
        }
    }

    fn reading(&self) -> Reading {
        match self {
            Moving::Scheduled(plant) => plant.reading(),
            Moving::Driven(plant) => plant.reading(),
        }
    }

    /// Writes every output.
    pub fn show(&self, places: &Places, values: &mut Values) {
        let (reading, truth) = (self.reading(), self.truth());
        let motion = [reading.q, reading.qd, reading.excitation, truth.state.q, truth.state.qd];
        for (reference, value) in places.motion.iter().zip(motion) {
            values.put(*reference, Value::Real(value));
        }
        for (reference, value) in places.coefficients.iter().zip(truth.coefficients) {
            values.put(*reference, Value::Real(*value));
        }
        values.put(places.stage, Value::Integer(truth.stage as i32 + 1));
    }
}
