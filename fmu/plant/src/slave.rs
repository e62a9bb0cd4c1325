//! The plant behind the slave's trait.

use crate::places::Places;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use switchid::simulate::{ParametricLaw, ParametricLawError, Plant};
use switchid_fmu_slave::{Category, Description, Log, Slave, SlaveError, Value, Values};
use thiserror::Error;

/// The law's file in the resources.
const LAW_FILE: &str = "plant.toml";

/// Why the resources are refused.
#[derive(Debug, Error)]
pub enum ResourceError {
    /// The law is not there.
    #[error("{path}: {source}: package the FMU anew")]
    Missing {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The law is refused.
    #[error("{path}: {source}")]
    Law {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ParametricLawError,
    },
}

/// The plant with the places of its variables.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlantSlave {
    law: ParametricLaw,
    places: Places,
    start_time: f64,
    plant: Option<Plant>,
}

impl Slave for PlantSlave {
    fn instantiate(resources: &Path, description: &Description) -> Result<PlantSlave, SlaveError> {
        let law = read_law(&resources.join(LAW_FILE))?;
        let places = Places::find(description, &law)?;
        Ok(PlantSlave { law, places, start_time: 0.0, plant: None })
    }

    fn start(&mut self, time: f64, values: &mut Values, _log: &mut Log) -> Result<(), SlaveError> {
        let plant = Plant::new(self.places.scenario(&self.law, values)?)?;
        show(&self.places, &plant, values);
        self.start_time = time;
        self.plant = Some(plant);
        Ok(())
    }

    fn step(&mut self, time: f64, step: f64, values: &mut Values, log: &mut Log) -> Result<(), SlaveError> {
        let Some(plant) = self.plant.as_mut() else { return Ok(()) };
        let before = plant.truth().stage;
        plant.advance_to(time + step - self.start_time)?;
        show(&self.places, plant, values);
        let stage = plant.truth().stage;
        if stage != before {
            log.say(Category::Event, &format!("stage {} began before t = {} s", stage + 1, time + step));
        }
        Ok(())
    }
}

fn show(places: &Places, plant: &Plant, values: &mut Values) {
    let (reading, truth) = (plant.reading(), plant.truth());
    let motion = [reading.q, reading.qd, reading.excitation, truth.state.q, truth.state.qd];
    for (reference, value) in places.motion.iter().zip(motion) {
        values.put(*reference, Value::Real(value));
    }
    for (reference, value) in places.coefficients.iter().zip(truth.coefficients) {
        values.put(*reference, Value::Real(*value));
    }
    values.put(places.stage, Value::Integer(truth.stage as i32 + 1));
}

fn read_law(path: &Path) -> Result<ParametricLaw, ResourceError> {
    let text =
        std::fs::read_to_string(path).map_err(|source| ResourceError::Missing { path: path.to_path_buf(), source })?;
    ParametricLaw::from_toml(&text).map_err(|source| ResourceError::Law { path: path.to_path_buf(), source })
}
