//! The identifier behind the slave's trait.

use crate::parameters::{Parameters, position};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use switchid::identify::{Identifier, OutputValue, Outputs, Sample, SavedLaws, SavedLawsError, SensorState, Skipped};
use switchid::law::{Model, ModelError, Term};
use switchid_fmu_slave::{Category, Description, Log, Slave, SlaveError, Value, Values};
use thiserror::Error;

/// The model's file in the resources.
const MODEL_FILE: &str = "model.toml";

/// The known laws' file in the resources, where there is one.
const LAWS_FILE: &str = "laws.toml";

/// Why the resources are refused.
#[derive(Debug, Error)]
pub enum ResourceError {
    /// The model is not there.
    #[error("{path}: {source}: package the FMU anew")]
    Missing {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The model is refused.
    #[error("{path}: {source}")]
    Model {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ModelError,
    },
    /// The known laws are refused.
    #[error("{path}: {source}")]
    Laws {
        /// The file.
        path: PathBuf,
        /// Why.
        source: SavedLawsError,
    },
}

/// The identifier with the places of its variables.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct IdentifierSlave {
    library: Model,
    known: SavedLaws,
    inputs: [usize; 3],
    parameters: Parameters,
    /// Value references in the order of [`Outputs::describe`].
    output_references: Vec<usize>,
    running: Option<Running>,
}

/// What exists once the parameters are taken.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Running {
    identifier: Identifier,
    outputs: Outputs,
    thinning_said: bool,
}

impl Slave for IdentifierSlave {
    fn instantiate(resources: &Path, description: &Description) -> Result<IdentifierSlave, SlaveError> {
        let library = read_model(&resources.join(MODEL_FILE))?;
        let find = |name: &str| position(description, name);
        let outputs = Outputs::describe(&terms(&library));
        let output_references = outputs.iter().map(|output| find(&output.name)).collect::<Result<_, _>>()?;
        Ok(IdentifierSlave {
            inputs: [find("q")?, find("qd")?, find("F")?],
            parameters: Parameters::find(description)?,
            output_references,
            library,
            known: read_laws(&resources.join(LAWS_FILE))?,
            running: None,
        })
    }

    fn start(&mut self, _time: f64, values: &mut Values, _log: &mut Log) -> Result<(), SlaveError> {
        let model = self.parameters.model(&self.library, values)?;
        let identifier = Identifier::new(&model, self.parameters.settings(values))?.with_known_laws(&self.known)?;
        let outputs = Outputs::new(&terms(&self.library), &identifier);
        let running = Running { identifier, outputs, thinning_said: false };
        running.publish(&self.output_references, values);
        self.running = Some(running);
        Ok(())
    }

    fn step(&mut self, time: f64, _step: f64, values: &mut Values, log: &mut Log) -> Result<(), SlaveError> {
        let Some(running) = self.running.as_mut() else { return Ok(()) };
        let [q, qd, excitation] = self.inputs.map(|reference| values.real(reference));
        let before = running.identifier.output().switch_count;
        let sensors = running.identifier.output().sensors;
        match running.identifier.step(Sample { t: time, q, qd, excitation }) {
            Ok(()) => running.publish(&self.output_references, values),
            Err(skipped) => running.say_skipped(skipped, log),
        }
        running.say_switch(before, log);
        running.say_sensors(time, sensors, log);
        Ok(())
    }
}

impl Running {
    fn publish(&self, references: &[usize], values: &mut Values) {
        for (reference, value) in references.iter().zip(self.outputs.values(&self.identifier)) {
            values.put(*reference, to_fmi(value));
        }
    }

    fn say_skipped(&mut self, skipped: Skipped, log: &mut Log) {
        match skipped {
            Skipped::TooSoon { .. } if self.thinning_said => {}
            Skipped::TooSoon { .. } => {
                self.thinning_said = true;
                let text =
                    format!("{skipped}; said once. Set sample_time to the step of the simulation to use all samples");
                log.say(Category::Warning, &text);
            }
            Skipped::NotFinite { channel, .. } => log.warn_rarely(channel, || skipped.to_string()),
            Skipped::NotLater { .. } | Skipped::Ahead { .. } => log.warn_rarely("time", || skipped.to_string()),
        }
    }

    /// A sensor's fault is said once when it begins and once when it ends.
    fn say_sensors(&self, time: f64, before: [SensorState; 3], log: &Log) {
        let now = self.identifier.output().sensors;
        for (channel, (before, now)) in ["q", "qd", "F"].into_iter().zip(before.into_iter().zip(now)) {
            if before != now {
                let text = match now {
                    SensorState::Ok => format!("sensor of {channel}: {} until t = {time} s, ok again", before.id()),
                    fault => {
                        format!("sensor of {channel}: {} from t = {time} s on, its readings do not count", fault.id())
                    }
                };
                log.say(Category::Warning, &text);
            }
        }
    }

    fn say_switch(&self, before: u32, log: &Log) {
        let output = self.identifier.output();
        if output.switch_count > before {
            let at = output.detection_time.unwrap_or_default();
            log.say(
                Category::Event,
                &format!("switch detected at t = {at} s, it happened near {} s", output.switch_time),
            );
        }
    }
}

fn to_fmi(value: OutputValue) -> Value {
    match value {
        OutputValue::Real(value) => Value::Real(value),
        OutputValue::Count(count) => Value::Integer(i32::try_from(count).unwrap_or(i32::MAX)),
        OutputValue::Flag(flag) => Value::Boolean(flag),
        OutputValue::Status(status) => Value::Integer(status as i32),
        OutputValue::Sensor(sensor) => Value::Integer(sensor as i32),
        OutputValue::Effect(effect) => Value::Integer(i32::from(effect)),
    }
}

fn terms(model: &Model) -> Vec<Term> {
    model.terms.iter().map(|entry| entry.term).collect()
}

fn read_model(path: &Path) -> Result<Model, ResourceError> {
    let text =
        std::fs::read_to_string(path).map_err(|source| ResourceError::Missing { path: path.to_path_buf(), source })?;
    Model::from_toml(&text).map_err(|source| ResourceError::Model { path: path.to_path_buf(), source })
}

fn read_laws(path: &Path) -> Result<SavedLaws, ResourceError> {
    if !path.exists() {
        return Ok(SavedLaws::default());
    }
    let text =
        std::fs::read_to_string(path).map_err(|source| ResourceError::Missing { path: path.to_path_buf(), source })?;
    SavedLaws::from_toml(&text).map_err(|source| ResourceError::Laws { path: path.to_path_buf(), source })
}
