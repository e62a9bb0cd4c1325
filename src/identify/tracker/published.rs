//! The law as last made known: what is not known any more keeps its value, and has no std.

use crate::estimation::Missing;
use crate::identify::problem::Problem;
use crate::identify::report::Coefficient;
use serde::{Deserialize, Serialize};

/// What was last made known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Published {
    /// In the order of the model's terms.
    pub(super) coefficients: Vec<Coefficient>,
    /// Std of the sensors' noise by channel.
    pub(super) noise: [Option<f64>; 2],
    /// Whether a law's residuals have told it.
    pub(super) noise_by_law: bool,
    /// The effect that the law lacks most.
    pub(super) missing: Option<Missing>,
    pub(super) switches: Switches,
    /// Since when the present law is valid, s.
    pub(super) identified: Option<f64>,
}

/// The switches so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Switches {
    pub(super) count: u32,
    /// Instant of the last one, s; of the first sample before.
    pub(super) time: f64,
    /// Its std, s.
    pub(super) time_std: Option<f64>,
    /// Time of its alarm, s.
    pub(super) detection_time: Option<f64>,
    /// Time at which it had its name, s.
    pub(super) named_time: Option<f64>,
}

impl Published {
    /// Nothing is known.
    pub(super) fn new(problem: &Problem) -> Published {
        Published {
            coefficients: problem.terms.iter().map(|term| Coefficient::unknown(*term)).collect(),
            noise: [None; 2],
            noise_by_law: false,
            missing: None,
            switches: Switches::default(),
            identified: None,
        }
    }

    /// Free coefficients are not known any more.
    pub(super) fn forget_stds(&mut self, problem: &Problem) {
        problem.free.iter().for_each(|index| self.coefficients[*index].std = None);
    }

    /// The variance that is stated for e of eq. (8), relative: Σ std² ÷ Σθ²; infinite where an std is not known.
    pub(super) fn stated_error(&self) -> f64 {
        let sum = |square: fn(&Coefficient) -> f64| self.coefficients.iter().map(square).sum::<f64>();
        sum(|known| known.std.map_or(f64::INFINITY, |std| std * std)) / sum(|known| known.value * known.value)
    }

    /// Makes known what was given, and each free coefficient's value and std as `free` says of it and its present
    /// value; where that says none the value stays.
    pub(super) fn set(&mut self, problem: &Problem, free: impl Fn(usize, f64) -> Option<(f64, f64)>) {
        for (index, coefficient) in self.coefficients.iter_mut().enumerate() {
            let told = match problem.free.iter().position(|place| *place == index) {
                None => Some((problem.known[index], 0.0)),
                Some(place) => free(place, coefficient.value),
            };
            coefficient.value = told.map_or(coefficient.value, |(value, _)| value);
            coefficient.std = told.map(|(_, std)| std);
        }
    }
}
