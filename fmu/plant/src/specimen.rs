//! Where a specimen's variables stand, and its force for what the inputs impose.

use crate::places::{
    PlaceError, StagePlaces, find_hidden_of, find_own_of, find_time_and_parameters, hidden_effects, position, push_own,
    schedule,
};
use serde::{Deserialize, Serialize};
use switchid::law::{Catalogue, Entry, State};
use switchid::simulate::{ParametricLaw, Scenario, ScenarioError, SensorNoise, Specimen};
use switchid_fmu_slave::{Description, Value, ValueError, Values};

/// Longest time of a scenario, which has no end here, s.
const NEVER: f64 = 1e29;

/// Value references of all variables.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SpecimenPlaces {
    imposed: [usize; 2],
    noise: usize,
    seed: usize,
    stages: Vec<StagePlaces>,
    hidden: Vec<(usize, Vec<usize>)>,
    own: Vec<(usize, Vec<usize>)>,
    /// `F`, `true.F`.
    force: [usize; 2],
    stage: usize,
    coefficients: Vec<usize>,
}

impl SpecimenPlaces {
    /// Finds every variable of the interface.
    ///
    /// # Errors
    /// [`ValueError::NoSuchName`] when one is missing.
    pub fn find(description: &Description, law: &ParametricLaw) -> Result<SpecimenPlaces, ValueError> {
        let find = |name: &str| position(description, name);
        let coefficients = law.terms().into_iter().map(|term| find(&format!("true.coef.{}", term.fmu_name())));
        let count = (1..).take_while(|number| description.position(&format!("stage[{number}].time")).is_some()).count();
        let stages = (1..=count).map(|number| find_time_and_parameters(description, law, number));
        Ok(SpecimenPlaces {
            imposed: [find("q")?, find("qd")?],
            noise: find("noise.F")?,
            seed: find("seed")?,
            stages: stages.collect::<Result<_, _>>()?,
            hidden: find_hidden_of(description, entries())?,
            own: find_own_of(description, law)?,
            force: [find("F")?, find("true.F")?],
            stage: find("true.stage")?,
            coefficients: coefficients.collect::<Result<_, _>>()?,
        })
    }

    /// The specimen that the parameters describe.
    ///
    /// # Errors
    /// A gap in the schedule, an impossible inner parameter, what [`Specimen::new`] refuses.
    pub fn specimen(&self, law: &ParametricLaw, values: &Values) -> Result<Specimen, SpecimenError> {
        let stages = schedule(&self.stages, law, values)?;
        let mut scenario = Scenario::new(&law.name, law.terms(), stages, NEVER);
        scenario.seed = values.integer(self.seed).max(0) as u64;
        scenario.noise = SensorNoise { force: values.real(self.noise), ..SensorNoise::default() };
        scenario.hidden = hidden_effects(entries(), &self.hidden, values).map_err(PlaceError::from)?;
        push_own(&mut scenario.hidden, law, &self.own, values);
        Ok(Specimen::new(scenario)?)
    }

    /// Index of the stage that was shown last.
    pub fn stage(&self, values: &Values) -> usize {
        values.integer(self.stage).max(1) as usize - 1
    }

    /// Shows the force at time t, s, for the inputs as they are; `index` numbers the readings.
    pub fn show(&self, specimen: &Specimen, t: f64, index: u64, values: &mut Values) {
        let [q, qd] = self.imposed.map(|reference| values.real(reference));
        let force = specimen.force(t, State { q, qd });
        values.put(self.force[0], Value::Real(force + specimen.noise(index)));
        values.put(self.force[1], Value::Real(force));
        for (reference, value) in self.coefficients.iter().zip(specimen.coefficients(t)) {
            values.put(*reference, Value::Real(*value));
        }
        values.put(self.stage, Value::Integer(specimen.stage(t) as i32 + 1));
    }
}

/// Why parameters describe no specimen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpecimenError {
    /// Stages or hidden effects.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// The scenario that they make.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
}

/// The effects that a specimen can hide.
fn entries() -> impl Iterator<Item = &'static Entry> {
    let fits = |entry: &&Entry| entry.term.is_pointwise() && !entry.term.is_inertial() && !entry.term.uses_excitation();
    Catalogue::ENTRIES.iter().filter(fits)
}
