//! A plant that the host integrates.

use crate::places::Places;
use serde::{Deserialize, Serialize};
use switchid::law::State;
use switchid::simulate::{ContinuousPlant, Scenario, ScenarioError};
use switchid_fmu_slave::{Category, Continuous, Log, Values, seconds};

/// The equations with the places of their variables; states are q and q̇.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Equations {
    places: Places,
    plant: ContinuousPlant,
    start_time: f64,
    time: f64,
}

impl Equations {
    /// A plant at its start, at that time, s.
    ///
    /// # Errors
    /// What the scenario does not allow, and effects that are not smooth.
    pub fn new(places: &Places, scenario: Scenario, values: &Values, time: f64) -> Result<Equations, ScenarioError> {
        let plant = ContinuousPlant::new(scenario, places.input(values).is_some())?;
        Ok(Equations { places: places.clone(), plant, start_time: time, time })
    }
}

impl Continuous for Equations {
    fn set_time(&mut self, time: f64) {
        self.time = time;
        self.plant.set_time(time - self.start_time);
    }

    fn states(&self) -> Vec<f64> {
        let State { q, qd } = self.plant.state();
        vec![q, qd]
    }

    fn set_states(&mut self, states: &[f64]) {
        if let [q, qd] = *states {
            self.plant.set_state(State { q, qd });
        }
    }

    fn derivatives(&self, values: &Values) -> Vec<f64> {
        vec![self.plant.state().qd, self.plant.acceleration(self.places.outside(values))]
    }

    fn settle(&mut self, values: &Values, log: &mut Log) -> Option<f64> {
        let before = self.plant.truth().stage;
        let next = self.plant.settle(self.places.outside(values));
        let stage = self.plant.truth().stage;
        if stage != before {
            log.say(Category::Event, &format!("stage {} begins at t = {} s", stage + 1, seconds(self.time)));
        }
        next.map(|t| t + self.start_time)
    }

    fn show(&self, values: &mut Values) {
        let acceleration = self.plant.acceleration(self.places.outside(values));
        self.places.show(&self.plant.reading(), &self.plant.truth(), acceleration, values);
    }
}
