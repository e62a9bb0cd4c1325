//! The identifier behind the slave's trait.

use crate::parameters::{Parameters, position};
use crate::stream::Watch;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use switchid::identify::{Identifier, OutputValue, Outputs, Sample, SavedLaws, SavedLawsError, SensorState, Skipped};
use switchid::law::{Hold, Model, ModelError, Term};
use switchid_fmu_slave::{Category, Description, Log, Slave, SlaveError, Value, Values, memory, seconds};
use thiserror::Error;

/// The model's file in the resources.
const MODEL_FILE: &str = "model.toml";

/// The known laws' file in the resources, where there is one.
const LAWS_FILE: &str = "laws.toml";

/// How much more memory an identifier's record takes than its samples alone, with as much again for the host; a test
/// measures it.
const RECORD: f64 = 3.0;

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
    /// There is not enough memory.
    #[error(
        "max_window and sample_time ask for {megabytes:.0} MB, which this process does not get: a shorter max_window takes less"
    )]
    Memory {
        /// How much is needed, MB.
        megabytes: f64,
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
    /// Value reference of `stream`.
    stream: usize,
    running: Option<Running>,
}

/// What exists once the parameters are taken.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Running {
    identifier: Identifier,
    outputs: Outputs,
    watch: Watch,
}

impl Slave for IdentifierSlave {
    const ROOM: usize = 10 << 20;

    fn instantiate(resources: &Path, description: &Description) -> Result<IdentifierSlave, SlaveError> {
        let library = read_model(&resources.join(MODEL_FILE))?;
        let find = |name: &str| position(description, name);
        let outputs = Outputs::describe(&terms(&library));
        let output_references = outputs.iter().map(|output| find(&output.name)).collect::<Result<_, _>>()?;
        Ok(IdentifierSlave {
            inputs: [find("q")?, find("qd")?, find("F")?],
            parameters: Parameters::find(description)?,
            output_references,
            stream: find("stream")?,
            library,
            known: read_laws(&resources.join(LAWS_FILE))?,
            running: None,
        })
    }

    fn start(&mut self, _time: f64, values: &mut Values, _log: &mut Log) -> Result<(), SlaveError> {
        let model = self.parameters.model(&self.library, values)?;
        let settings = self.parameters.settings(values);
        settings.check()?;
        probe((settings.max_window + settings.deviation_interval) / settings.sample_time)?;
        let identifier = Identifier::new(&model, settings)?.with_known_laws(&self.known)?;
        let outputs = Outputs::new(&terms(&self.library), &identifier);
        let running = Running { identifier, outputs, watch: Watch::default() };
        running.publish(&self.output_references, values);
        self.running = Some(running);
        Ok(())
    }

    fn step(&mut self, time: f64, _step: f64, values: &mut Values, log: &mut Log) -> Result<(), SlaveError> {
        let Some(running) = self.running.as_mut() else { return Ok(()) };
        let [q, qd, excitation] = self.inputs.map(|reference| values.real(reference));
        let before = running.identifier.output().switch_count;
        let (sensors, hold) = (running.identifier.output().sensors, running.identifier.output().hold);
        let sample = Sample { t: time, q, qd, excitation };
        let outcome = running.identifier.step(sample);
        running.publish(&self.output_references, values);
        if let Err(skipped) = outcome {
            say_skipped(skipped, log);
        }
        running.watch.take(&sample, &outcome, running.identifier.waiting(), log);
        values.put(self.stream, Value::Integer(running.watch.shown()));
        running.say_switch(before, log);
        running.say_sensors(time, sensors, log);
        running.say_hold(time, hold, log);
        Ok(())
    }
}

/// What each sensor measures, and the key of its warnings.
const SENSORS: [(&str, &str); 3] = [("q", "sensor of q"), ("qd", "sensor of qd"), ("F", "sensor of F")];

impl Running {
    fn publish(&self, references: &[usize], values: &mut Values) {
        for (reference, value) in references.iter().zip(self.outputs.values(&self.identifier)) {
            values.put(*reference, to_fmi(value));
        }
    }

    /// A sensor's fault is said once when it begins and once when it ends.
    fn say_sensors(&self, time: f64, before: [SensorState; 3], log: &mut Log) {
        let now = self.identifier.output().sensors;
        for (channel, (before, now)) in SENSORS.into_iter().zip(before.into_iter().zip(now)) {
            if before != now {
                let t = seconds(time);
                log.warn_of_onset(channel.1, || match now {
                    SensorState::Ok => format!("sensor of {}: {} until t = {t} s, ok again", channel.0, before.id()),
                    SensorState::Late => format!(
                        "sensor of {}: late from t = {t} s on, by a sample; it is taken for the one before",
                        channel.0
                    ),
                    fault => {
                        format!("sensor of {}: {} from t = {t} s on, its readings do not count", channel.0, fault.id())
                    }
                });
            }
        }
    }

    /// A hold that the motion contradicts is left, and that is said.
    fn say_hold(&self, time: f64, before: Hold, log: &mut Log) {
        let now = self.identifier.output().hold;
        if before != now {
            let t = seconds(time);
            log.warn_of_onset("hold", || {
                format!("hold: the motion until t = {t} s tells that F is {now} between samples, not {before}; so it is taken from here on")
            });
        }
    }

    fn say_switch(&self, before: u32, log: &Log) {
        let output = self.identifier.output();
        if output.switch_count > before {
            let (at, near) = (seconds(output.detection_time.unwrap_or_default()), seconds(output.switch_time));
            log.say(Category::Event, &format!("switch detected at t = {at} s, it happened near {near} s"));
        }
    }
}

/// A sample that the identifier did not take; what comes too soon or after a hole is for the [`Watch`] to say.
fn say_skipped(skipped: Skipped, log: &mut Log) {
    match skipped {
        Skipped::TooSoon { .. } | Skipped::Repeated { .. } | Skipped::Interpolated { .. } => {}
        Skipped::NotFinite { t, channel } => {
            log.warn_rarely(channel, || Skipped::NotFinite { t: seconds(t), channel }.to_string());
        }
        Skipped::NotLater { t, previous } => {
            log.warn_rarely("time", || Skipped::NotLater { t: seconds(t), previous: seconds(previous) }.to_string())
        }
        Skipped::Ahead { t, previous } => {
            log.warn_rarely("time", || Skipped::Ahead { t: seconds(t), previous: seconds(previous) }.to_string())
        }
    }
}

/// Where the record would not fit, says so: an allocation that fails on the way would end the host.
fn probe(samples: f64) -> Result<(), ResourceError> {
    let bytes = samples * size_of::<Sample>() as f64 * RECORD + IdentifierSlave::ROOM as f64;
    memory::ask(bytes as usize).map_err(|_| ResourceError::Memory { megabytes: bytes * 1e-6 })
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

#[cfg(test)]
mod tests {
    use super::probe;

    #[test]
    fn memory_that_does_not_exist_is_an_error() {
        assert!(probe(3e4).is_ok());
        assert!(probe(1e18).unwrap_err().to_string().contains("max_window"));
    }
}
