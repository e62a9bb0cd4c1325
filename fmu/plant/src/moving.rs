//! A plant that moves, under its own excitation or under one from outside.

use crate::places::Places;
use serde::{Deserialize, Serialize};
use switchid::simulate::{DrivenPlant, Plant, PlantError, Reading, Scenario, ScenarioError, Truth};
use switchid_fmu_slave::Values;

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

    fn acceleration(&self) -> f64 {
        match self {
            Moving::Scheduled(plant) => plant.acceleration(),
            Moving::Driven(plant) => plant.acceleration(),
        }
    }

    /// Writes every output.
    pub fn show(&self, places: &Places, values: &mut Values) {
        // q̈ costs as much as an inner step: only where a variable shows it
        let acceleration = if places.shows_derivatives() { self.acceleration() } else { 0.0 };
        places.show(&self.reading(), &self.truth(), acceleration, values);
    }
}
