//! What a plant is: its terms, its stages, its excitation, its sensors.

use super::excitation::Excitation;
use super::hidden::Hidden;
use super::term_names;
use crate::law::{State, Term};
use serde::{Deserialize, Serialize};

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

/// Std of the Gaussian noise that the sensors add.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorNoise {
    /// On the displacement, m.
    pub q: f64,
    /// On the velocity, m/s.
    pub qd: f64,
    /// On the excitation, or on the force where that is what the law gives, N.
    #[serde(rename = "F")]
    pub force: f64,
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
    /// The excitation; of a law without inertia the motion that a machine imposes, q(t) less its initial value.
    #[serde(default)]
    pub excitation: Excitation,
    /// The sensors.
    #[serde(default)]
    pub noise: SensorNoise,
    /// The state at t = 0.
    #[serde(default)]
    pub initial: State,
    /// Effects that the law has in every stage besides its terms.
    #[serde(default)]
    pub hidden: Hidden,
    /// The stages, in the order of time; the first begins at 0.
    #[serde(rename = "stage")]
    pub stages: Vec<Stage>,
}

fn default_inner_step() -> f64 {
    Scenario::INNER_STEP
}

impl Scenario {
    /// Longest step of the inner integration where none is given, s. RK4 then errs by less than 1e-13 per second for
    /// oscillations up to 1 Hz, by less than 1e-8 up to 10 Hz.
    pub const INNER_STEP: f64 = 5e-4;

    /// Share of a grid interval by which a time may miss a grid point and still mean it: hosts jitter in the last bits,
    /// and no grid is finer than a millionth of the communication step.
    pub(super) const TIME_JITTER: f64 = 1e-3;

    /// Share of a grid interval that rounding of a quotient of two decimal times may leave.
    pub(super) const ROUNDING: f64 = 1e-9;

    /// A scenario of `duration` s with the default grid, no sensor noise, starting at rest.
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
            hidden: Hidden::default(),
            stages,
        }
    }

    /// The same scenario with sensor noise of this std on q and on q̇.
    pub fn with_noise(self, std: f64) -> Scenario {
        Scenario { noise: SensorNoise { q: std, qd: std, ..self.noise }, ..self }
    }

    /// The same scenario with another seed of its excitation and sensor noise.
    pub fn with_seed(self, seed: u64) -> Scenario {
        Scenario { seed, ..self }
    }

    /// Whether the law has no inertia: a machine imposes q, which the excitation gives, and F is the output.
    pub fn is_force_law(&self) -> bool {
        self.terms.iter().chain(&self.hidden.terms().collect::<Vec<_>>()).all(|term| !term.is_inertial())
    }

    /// Number of inner steps in one interval of the excitation's grid.
    pub fn substeps(&self) -> u64 {
        (self.excitation.sample_time / self.inner_step - Scenario::ROUNDING).ceil().max(1.0) as u64
    }

    /// Index of the stage at time t, s; a switch belongs to the new stage.
    pub fn stage_at(&self, t: f64) -> usize {
        self.stages.partition_point(|stage| stage.start <= t).saturating_sub(1)
    }

    /// The instants at which the law switches, s.
    pub fn switch_times(&self) -> Vec<f64> {
        self.stages.iter().skip(1).map(|stage| stage.start).collect()
    }
}
