//! What a plant is: its terms, its stages, its excitation, its sensors.

use crate::law::{State, Term, TermError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A time from which the law and the sine excitation have these numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Time at which the stage begins, s.
    pub start: f64,
    /// One coefficient per term of the scenario, in their order.
    pub coefficients: Vec<f64>,
    /// P of the sine excitation P sin ωt, N.
    #[serde(default)]
    pub amplitude: f64,
    /// ω of the sine excitation, rad/s.
    #[serde(default)]
    pub omega: f64,
}

/// Which excitation acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExcitationKind {
    /// None: free motion.
    None,
    /// P sin ωt with the amplitude and the angular frequency of the stage; the phase is that of the global time.
    #[default]
    Sine,
    /// Gaussian white noise of a given intensity.
    WhiteNoise,
}

/// The excitation and the grid on which it is evaluated and held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Excitation {
    /// Which one.
    pub kind: ExcitationKind,
    /// Intensity 2D of the white noise, N² s: its variance on the grid is 2D ÷ `sample_time`.
    pub intensity: f64,
    /// Time between two points of the grid, s.
    pub sample_time: f64,
}

impl Default for Excitation {
    fn default() -> Excitation {
        Excitation { kind: ExcitationKind::Sine, intensity: 3.0, sample_time: 1e-3 }
    }
}

/// Std of the Gaussian noise that the sensors add.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorNoise {
    /// On the displacement, m.
    pub q: f64,
    /// On the velocity, m/s.
    pub qd: f64,
}

/// A plant and what happens to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// A name for reports.
    #[serde(default)]
    pub name: String,
    /// What stands on the left-hand side of the law.
    #[serde(with = "term_names")]
    pub terms: Vec<Term>,
    /// How long a record of it is, s.
    pub duration: f64,
    /// Seed of the white excitation and of the sensor noise.
    #[serde(default)]
    pub seed: u64,
    /// Longest step of the inner integration, s.
    #[serde(default = "default_inner_step")]
    pub inner_step: f64,
    /// The excitation.
    #[serde(default)]
    pub excitation: Excitation,
    /// The sensors.
    #[serde(default)]
    pub noise: SensorNoise,
    /// The state at t = 0.
    #[serde(default)]
    pub initial: State,
    /// The stages, in the order of time; the first begins at 0.
    #[serde(rename = "stage")]
    pub stages: Vec<Stage>,
}

fn default_inner_step() -> f64 {
    Scenario::INNER_STEP
}

/// Why a scenario is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ScenarioError {
    /// The text is no TOML, or a key is missing, unknown or of the wrong type.
    #[error("{message}")]
    Syntax {
        /// What the TOML reader says, with line and column.
        message: String,
    },
    /// The same term twice.
    #[error("terms: \"{term}\" stands there twice: keep one")]
    Twice {
        /// The term.
        term: Term,
    },
    /// Nothing to integrate.
    #[error("terms: there is no inertia: add \"qdd\"")]
    NoInertia,
    /// No stage at all.
    #[error("there is no stage: write at least one [[stage]] with start = 0")]
    NoStages,
    /// The first stage does not begin at 0.
    #[error("stage 1 starts at {start} s: the first stage starts at 0")]
    FirstStart {
        /// Its start, s.
        start: f64,
    },
    /// Stages out of order.
    #[error("stage {stage} starts at {start} s, which is not after stage {} at {previous} s: order the stages by time", stage - 1)]
    Order {
        /// The stage, counted from 1.
        stage: usize,
        /// Its start, s.
        start: f64,
        /// The start of the stage before, s.
        previous: f64,
    },
    /// Not one coefficient per term.
    #[error("stage {stage} has {found} coefficients for {expected} terms: write one for each, in their order")]
    Count {
        /// The stage, counted from 1.
        stage: usize,
        /// How many terms there are.
        expected: usize,
        /// How many coefficients there are.
        found: usize,
    },
    /// A mass of 0 has no acceleration.
    #[error("stage {stage}: the coefficient of qdd is 0: give it a mass")]
    ZeroInertia {
        /// The stage, counted from 1.
        stage: usize,
    },
    /// A stage holds an infinite number or none.
    #[error("stage {stage}: {name} = {value} is no finite number")]
    StageNumber {
        /// The stage, counted from 1.
        stage: usize,
        /// What is at fault.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A number outside its range.
    #[error("{name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// The key.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed, in words.
        range: &'static str,
    },
}

impl Scenario {
    /// Longest step of the inner integration where none is given, s. RK4 then errs by less than 1e-13 per second for
    /// oscillations up to 1 Hz, by less than 1e-8 up to 10 Hz.
    pub const INNER_STEP: f64 = 5e-4;

    /// A scenario with the default grid, no sensor noise, starting at rest.
    pub fn new(name: &str, terms: Vec<Term>, stages: Vec<Stage>, duration: f64) -> Scenario {
        Scenario {
            name: name.into(),
            terms,
            duration,
            seed: 0,
            inner_step: Scenario::INNER_STEP,
            excitation: Excitation::default(),
            noise: SensorNoise::default(),
            initial: State::default(),
            stages,
        }
    }

    /// The same scenario with sensor noise of this std on q and on q̇.
    pub fn with_noise(self, std: f64) -> Scenario {
        Scenario { noise: SensorNoise { q: std, qd: std }, ..self }
    }

    /// The same scenario with another seed of its excitation and sensor noise.
    pub fn with_seed(self, seed: u64) -> Scenario {
        Scenario { seed, ..self }
    }

    /// Reads a scenario file.
    ///
    /// # Errors
    /// [`ScenarioError`] names the key or stage at fault.
    pub fn from_toml(text: &str) -> Result<Scenario, ScenarioError> {
        let scenario: Scenario =
            toml::from_str(text).map_err(|error| ScenarioError::Syntax { message: error.to_string() })?;
        scenario.check()?;
        Ok(scenario)
    }

    /// Writes a file that [`Scenario::from_toml`] reads back to the same scenario.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where TOML cannot hold a number (a seed above 2⁶³).
    pub fn to_toml(&self) -> Result<String, ScenarioError> {
        toml::to_string(self).map_err(|error| ScenarioError::Syntax { message: error.to_string() })
    }

    /// Number of inner steps in one interval of the excitation's grid.
    pub fn substeps(&self) -> u64 {
        (self.excitation.sample_time / self.inner_step - 1e-9).ceil().max(1.0) as u64
    }

    /// Index of the stage at time t, s; a switch belongs to the new stage.
    pub fn stage_at(&self, t: f64) -> usize {
        self.stages.partition_point(|stage| stage.start <= t).saturating_sub(1)
    }

    /// The instants at which the law switches, s.
    pub fn switch_times(&self) -> Vec<f64> {
        self.stages.iter().skip(1).map(|stage| stage.start).collect()
    }

    /// Checks everything that would make the plant fail later.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check(&self) -> Result<(), ScenarioError> {
        self.check_terms()?;
        self.check_numbers()?;
        self.check_stages()
    }

    fn check_terms(&self) -> Result<(), ScenarioError> {
        for (index, &term) in self.terms.iter().enumerate() {
            if self.terms[..index].contains(&term) {
                return Err(ScenarioError::Twice { term });
            }
        }
        if self.terms.contains(&Term::Inertia) { Ok(()) } else { Err(ScenarioError::NoInertia) }
    }

    fn check_numbers(&self) -> Result<(), ScenarioError> {
        let positive = [
            ("duration", self.duration),
            ("inner_step", self.inner_step),
            ("excitation.sample_time", self.excitation.sample_time),
        ];
        for (name, value) in positive {
            within(name, value, value > 0.0, "a positive number of seconds")?;
        }
        let not_negative = [
            ("excitation.intensity", self.excitation.intensity),
            ("noise.q", self.noise.q),
            ("noise.qd", self.noise.qd),
        ];
        for (name, value) in not_negative {
            within(name, value, value >= 0.0, "0 or a positive number")?;
        }
        for (name, value) in [("initial.q", self.initial.q), ("initial.qd", self.initial.qd)] {
            within(name, value, true, "a finite number")?;
        }
        let ratio = self.excitation.sample_time / self.inner_step;
        within("inner_step", self.inner_step, ratio <= 1e6, "at least a millionth of excitation.sample_time")
    }

    fn check_stages(&self) -> Result<(), ScenarioError> {
        let first = self.stages.first().ok_or(ScenarioError::NoStages)?;
        if first.start != 0.0 {
            return Err(ScenarioError::FirstStart { start: first.start });
        }
        for (index, stage) in self.stages.iter().enumerate() {
            self.check_stage(index + 1, stage)?;
        }
        for (index, pair) in self.stages.windows(2).enumerate() {
            let (previous, start) = (pair[0].start, pair[1].start);
            if start <= previous {
                return Err(ScenarioError::Order { stage: index + 2, start, previous });
            }
        }
        Ok(())
    }

    fn check_stage(&self, number: usize, stage: &Stage) -> Result<(), ScenarioError> {
        let (expected, found) = (self.terms.len(), stage.coefficients.len());
        if expected != found {
            return Err(ScenarioError::Count { stage: number, expected, found });
        }
        let named = [("start", stage.start), ("amplitude", stage.amplitude), ("omega", stage.omega)];
        let named = named.into_iter().map(|(name, value)| (name.to_string(), value));
        let coefficients = self.terms.iter().zip(&stage.coefficients).map(|(term, value)| (term.name(), *value));
        if let Some((name, value)) = named.chain(coefficients).find(|(_, value)| !value.is_finite()) {
            return Err(ScenarioError::StageNumber { stage: number, name, value });
        }
        let mut inertia = self.terms.iter().zip(&stage.coefficients).filter(|(term, _)| **term == Term::Inertia);
        if inertia.any(|(_, value)| *value == 0.0) {
            return Err(ScenarioError::ZeroInertia { stage: number });
        }
        Ok(())
    }
}

fn within(name: &'static str, value: f64, holds: bool, range: &'static str) -> Result<(), ScenarioError> {
    if holds && value.is_finite() { Ok(()) } else { Err(ScenarioError::OutOfRange { name, value, range }) }
}

/// Terms by their canonical names.
mod term_names {
    use super::{Term, TermError};
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub fn serialize<S: Serializer>(terms: &[Term], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(terms.iter().map(|term| term.name()))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Term>, D::Error> {
        let names = Vec::<String>::deserialize(deserializer)?;
        let terms: Result<Vec<Term>, TermError> = names.iter().map(|name| Term::parse(name)).collect();
        terms.map_err(D::Error::custom)
    }
}
