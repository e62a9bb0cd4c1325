//! A record with its truth, from which limits are computed and readings are handed out.

use super::Failure;
use std::ops::Range;
use switchid::law::{Drive, Given, Model, State};
use switchid::limits::{Course, Law, Sensors};
use switchid::simulate::{Builtin, Plant, Reading, Scenario};

/// What an identifier is told of the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Library {
    /// The plant's own terms, all "fit".
    Given,
    /// The full cubic library, all "fit".
    Fit,
    /// The full cubic library, all "maybe" but the inertia.
    Maybe,
}

impl Library {
    /// Its name in a table.
    pub fn id(self) -> &'static str {
        match self {
            Library::Given => "given",
            Library::Fit => "full, fit",
            Library::Maybe => "full, maybe",
        }
    }

    /// The model.
    pub fn model(self, builtin: Builtin) -> Model {
        let fit = |terms: Vec<_>| Model::of(builtin.id(), terms.into_iter().map(|term| (term, Given::Fit)));
        match self {
            Library::Given => fit(builtin.terms()),
            Library::Fit => fit(Model::cubic_library().terms.iter().map(|entry| entry.term).collect()),
            Library::Maybe => Model::cubic_library(),
        }
    }
}

/// Readings and the motion behind them, sample by sample.
pub struct Recorded {
    /// What an identifier sees.
    pub readings: Vec<Reading>,
    /// What it does not.
    states: Vec<State>,
}

impl Recorded {
    /// Simulates the scenario on its excitation's grid.
    pub fn of(scenario: &Scenario) -> Result<Recorded, Failure> {
        let mut plant = Plant::new(scenario.clone())?;
        let sample_time = scenario.excitation.sample_time;
        let last = (scenario.duration / sample_time + 1e-3).floor() as u64;
        let mut recorded = Recorded { readings: Vec::new(), states: Vec::new() };
        for index in 0..=last {
            plant.advance_to(index as f64 * sample_time)?;
            recorded.readings.push(plant.reading());
            recorded.states.push(plant.truth().state);
        }
        Ok(recorded)
    }

    /// The samples of a stage.
    pub fn stage(&self, scenario: &Scenario, stage: usize) -> Range<usize> {
        let from = |stage: usize| match scenario.stages.get(stage) {
            Some(stage) => self.readings.partition_point(|reading| reading.t < stage.start - 1e-9),
            None => self.readings.len(),
        };
        from(stage)..from(stage + 1)
    }

    /// The true motion over these samples.
    pub fn course(&self, samples: Range<usize>) -> Course {
        let readings = &self.readings[samples.clone()];
        Course {
            t: readings.iter().map(|reading| reading.t).collect(),
            drives: readings[..readings.len() - 1].iter().map(|reading| Drive::Held(reading.excitation)).collect(),
            states: self.states[samples].to_vec(),
        }
    }
}

/// The true law of a stage over the model's terms, all sought.
pub fn law(model: &Model, scenario: &Scenario, stage: usize) -> Result<Law, Failure> {
    let truth = &scenario.stages[stage].coefficients;
    let value = |term| scenario.terms.iter().position(|own| *own == term).map_or(0.0, |index| truth[index]);
    let pairs: Vec<_> = model.terms.iter().map(|entry| (entry.term, value(entry.term))).collect();
    Ok(Law::new(&pairs, &(0..pairs.len()).collect::<Vec<_>>())?)
}

/// The scenario's sensors.
pub fn sensors(scenario: &Scenario) -> Sensors {
    Sensors([Some(scenario.noise.q), Some(scenario.noise.qd)])
}
