//! The plant behind the slave's trait.

use crate::equations::Equations;
use crate::moving::Moving;
use crate::places::Places;
use crate::specimen::SpecimenPlaces;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use switchid::simulate::{ParametricLaw, ParametricLawError, Specimen};
use switchid_fmu_slave::{Category, Continuous, Description, Log, Slave, SlaveError, Values, seconds};
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

/// A law with the places of its variables.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlantSlave {
    law: ParametricLaw,
    start_time: f64,
    kind: Kind,
}

/// Which way round the law is.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Kind {
    /// With inertia: F moves the plant.
    Plant { places: Box<Places>, plant: Option<Box<Moving>> },
    /// The same while the host integrates it.
    Equations(Box<Equations>),
    /// Without: q and qd are imposed, F answers; the readings so far.
    Specimen { places: SpecimenPlaces, specimen: Option<Box<Specimen>>, readings: u64 },
}

impl Slave for PlantSlave {
    const ROOM: usize = 512 << 10;

    fn instantiate(resources: &Path, description: &Description) -> Result<PlantSlave, SlaveError> {
        let law = read_law(&resources.join(LAW_FILE))?;
        // the plant of a law without inertia can have none besides, which its description says
        let kind = match description.position("true.F") {
            Some(_) => {
                let places = SpecimenPlaces::find(description, &law)?;
                Kind::Specimen { places, specimen: None, readings: 0 }
            }
            None => Kind::Plant { places: Box::new(Places::find(description, &law)?), plant: None },
        };
        Ok(PlantSlave { law, start_time: 0.0, kind })
    }

    fn start(&mut self, time: f64, values: &mut Values, _log: &mut Log) -> Result<(), SlaveError> {
        self.start_time = time;
        match &mut self.kind {
            Kind::Plant { places, plant } => {
                let begun = Moving::new(places.scenario(&self.law, values)?, places.input(values).is_some())?;
                begun.show(places, values);
                *plant = Some(Box::new(begun));
            }
            Kind::Specimen { places, specimen, readings } => {
                let begun = places.specimen(&self.law, values)?;
                places.show(&begun, 0.0, 0, values);
                (*specimen, *readings) = (Some(Box::new(begun)), 0);
            }
            Kind::Equations(_) => {}
        }
        Ok(())
    }

    fn start_continuous(&mut self, time: f64, values: &mut Values, _log: &mut Log) -> Result<(), SlaveError> {
        if let Kind::Plant { places, .. } = &self.kind {
            let begun = Equations::new(places, places.scenario(&self.law, values)?, values, time)?;
            begun.show(values);
            self.kind = Kind::Equations(Box::new(begun));
        }
        Ok(())
    }

    fn continuous(&mut self) -> Option<&mut dyn Continuous> {
        match &mut self.kind {
            Kind::Equations(equations) => Some(equations.as_mut()),
            _ => None,
        }
    }

    fn step(&mut self, time: f64, step: f64, values: &mut Values, log: &mut Log) -> Result<(), SlaveError> {
        let [from, to] = [time, time + step].map(|t| t - self.start_time);
        let [before, after] = match &mut self.kind {
            Kind::Plant { places, plant: Some(plant) } => {
                let before = plant.truth().stage;
                let input = places.input(values);
                if input.is_some_and(|value| !value.is_finite()) {
                    let text =
                        || format!("excitation.F is no finite number at t = {} s: the last one acts on", seconds(time));
                    log.warn_rarely("excitation.F", text);
                }
                plant.advance_to(to, input)?;
                plant.show(places, values);
                [before, plant.truth().stage]
            }
            Kind::Specimen { places, specimen: Some(specimen), readings } => {
                let before = places.stage(values);
                places.show(specimen, from, *readings, values);
                *readings += 1;
                [before, specimen.stage(from)]
            }
            _ => return Ok(()),
        };
        if after != before {
            log.say(Category::Event, &format!("stage {} began before t = {} s", after + 1, seconds(time + step)));
        }
        Ok(())
    }
}

fn read_law(path: &Path) -> Result<ParametricLaw, ResourceError> {
    let text =
        std::fs::read_to_string(path).map_err(|source| ResourceError::Missing { path: path.to_path_buf(), source })?;
    ParametricLaw::from_toml(&text).map_err(|source| ResourceError::Law { path: path.to_path_buf(), source })
}
