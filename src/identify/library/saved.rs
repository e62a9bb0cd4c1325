//! Known laws as a text to keep: TOML in SI units, terms by name.
//!
//! ```toml
//! [[law]]
//! number = 1                                  # as the identifier counts it
//! samples = 12000                             # that it is known from
//! terms = ["qdd", "q"]                        # that the law has, of those that were sought
//! coefficients = [1.0, 4.0]                   # theirs
//! covariance = [[1e-6, 0.0], [0.0, 4e-6]]     # of the coefficients
//! sought = ["qdd", "qd", "q"]                 # every term that was sought
//! change = [0.3, 0.5, 1.2]                    # how far a switch moves the coefficient of each, std
//! [law.noise]                  # std of the sensors; intensity of the acceleration not explained, (m/s²)² s
//! q = 0.01
//! qd = 0.01
//! process = 1e-9
//! ```

use super::known_law::KnownLaw;
use crate::estimation::{Noise, Solution};
use crate::identify::problem::Problem;
use crate::law::Term;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Laws that an identifier has validated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedLaws {
    /// The laws, at most 16, each number once.
    #[serde(rename = "law", default)]
    pub laws: Vec<SavedLaw>,
}

/// One of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedLaw {
    /// Its number, from 1 on.
    pub number: u32,
    /// Samples that it is known from.
    pub samples: u64,
    /// The terms that the law has, of those that were sought, by name.
    pub terms: Vec<String>,
    /// Their coefficients.
    pub coefficients: Vec<f64>,
    /// Covariance of the coefficients, row by row.
    pub covariance: Vec<Vec<f64>>,
    /// Every term that was sought, by name.
    pub sought: Vec<String>,
    /// How far a switch moves the coefficient of each of those, std.
    pub change: Vec<f64>,
    /// Its noise.
    pub noise: SavedNoise,
}

/// Noise levels under a law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedNoise {
    /// Std of the displacement's sensor.
    pub q: f64,
    /// Std of the velocity's sensor.
    pub qd: f64,
    /// Intensity of the white acceleration that the law does not explain, (m/s²)² s.
    pub process: f64,
}

/// Why saved laws are refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SavedLawsError {
    /// No such TOML.
    #[error("these are no saved laws: {message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A law has a term that the model does not seek.
    #[error(
        "law {law} has the term {term}, which this model does not seek: laws go with the model that they were saved under"
    )]
    ForeignTerm {
        /// Number of the law.
        law: u32,
        /// Its term.
        term: String,
    },
    /// A law lacks a term that the model fits.
    #[error(
        "law {law} lacks the term {term}, which this model seeks: laws go with the model that they were saved under"
    )]
    MissingTerm {
        /// Number of the law.
        law: u32,
        /// The model's term.
        term: String,
    },
    /// A number is out of range.
    #[error("law {law}: {what} must be {range}")]
    Value {
        /// Number of the law.
        law: u32,
        /// What is wrong.
        what: String,
        /// What it may be.
        range: &'static str,
    },
    /// Two laws of one number, or too many.
    #[error("law {law}: there can be {room} laws at most, each number once: take this one out")]
    TooMany {
        /// Number of the law.
        law: u32,
        /// How many there is room for.
        room: usize,
    },
}

impl SavedLaws {
    /// Reads what [`SavedLaws::to_toml`] writes.
    ///
    /// # Errors
    /// [`SavedLawsError::Syntax`].
    pub fn from_toml(text: &str) -> Result<SavedLaws, SavedLawsError> {
        toml::from_str(text).map_err(|error| SavedLawsError::Syntax { message: error.to_string() })
    }

    /// The laws as a text.
    ///
    /// # Errors
    /// [`SavedLawsError::Syntax`] where TOML cannot hold a number.
    pub fn to_toml(&self) -> Result<String, SavedLawsError> {
        toml::to_string(self).map_err(|error| SavedLawsError::Syntax { message: error.to_string() })
    }
}

impl SavedLaw {
    /// What is kept of a law.
    pub(in crate::identify) fn of(law: &KnownLaw, problem: &Problem) -> SavedLaw {
        let active: Vec<usize> = (0..problem.n()).filter(|free| law.active[*free]).collect();
        let n = problem.n();
        let keys = problem.free_terms.iter().map(|term| key(*term));
        let row = |row: &usize| active.iter().map(|column| law.covariance[row * n + column]).collect();
        SavedLaw {
            number: law.number,
            samples: law.samples,
            terms: active.iter().map(|free| key(problem.free_terms[*free])).collect(),
            coefficients: active.iter().map(|free| law.coefficients[*free]).collect(),
            covariance: active.iter().map(row).collect(),
            sought: keys.collect(),
            change: law.spread.clone(),
            noise: SavedNoise {
                q: law.noise.sensor[0].sqrt(),
                qd: law.noise.sensor[1].sqrt(),
                process: law.noise.process,
            },
        }
    }

    /// The law among the problem's free terms.
    ///
    /// # Errors
    /// [`SavedLawsError`] names law and term.
    pub(in crate::identify) fn known(&self, problem: &Problem) -> Result<KnownLaw, SavedLawsError> {
        let names: Vec<String> = problem.free_terms.iter().map(|term| key(*term)).collect();
        let mut law = KnownLaw::none(problem.n());
        (law.number, law.samples) = (self.number, self.samples);
        let sought = self.places(&self.sought, &names)?;
        self.take(&sought, "change", &self.change, |change| change > 0.0, &mut law.spread)?;
        let places = self.places(&self.terms, &names)?;
        self.take(&places, "coefficients", &self.coefficients, |_| true, &mut law.coefficients)?;
        places.iter().for_each(|place| law.active[*place] = true);
        let lacks = |free: &usize| !sought.contains(free) || !(problem.maybe[*free] || law.active[*free]);
        if let Some(free) = (0..names.len()).find(lacks) {
            return Err(SavedLawsError::MissingTerm { law: self.number, term: names[free].clone() });
        }
        self.take_covariance(&places, &mut law)?;
        law.noise = self.checked_noise()?;
        Ok(law)
    }

    /// The places of terms among those that the model seeks.
    fn places(&self, terms: &[String], names: &[String]) -> Result<Vec<usize>, SavedLawsError> {
        let foreign = |term: &String| SavedLawsError::ForeignTerm { law: self.number, term: term.clone() };
        let place = |term: &String| names.iter().position(|name| name == term).ok_or_else(|| foreign(term));
        terms.iter().map(place).collect()
    }

    fn take(
        &self,
        places: &[usize],
        what: &str,
        numbers: &[f64],
        sound: fn(f64) -> bool,
        into: &mut [f64],
    ) -> Result<(), SavedLawsError> {
        let fit = numbers.len() == places.len() && numbers.iter().all(|number| number.is_finite() && sound(*number));
        if !fit {
            return Err(self.refuse(what, "finite numbers, one for each term, changes positive"));
        }
        places.iter().zip(numbers).for_each(|(place, number)| into[*place] = *number);
        Ok(())
    }

    /// The covariance and its inverse.
    fn take_covariance(&self, places: &[usize], law: &mut KnownLaw) -> Result<(), SavedLawsError> {
        let n = law.coefficients.len();
        let square =
            self.covariance.len() == places.len() && self.covariance.iter().all(|row| row.len() == places.len());
        let range = "a symmetric positive definite matrix, a row for each coefficient";
        let refused = || self.refuse("covariance", range);
        if !square {
            return Err(refused());
        }
        for (row, entries) in places.iter().zip(&self.covariance) {
            for (column, entry) in places.iter().zip(entries) {
                law.covariance[row * n + column] = *entry;
            }
        }
        law.information.matrix[..n * n].copy_from_slice(&law.covariance);
        let mut inverse = Solution::none(n);
        inverse.solve(&law.information, &law.active);
        law.information.matrix[..n * n].copy_from_slice(&inverse.covariance);
        let definite = places.iter().all(|place| inverse.determined[*place] && inverse.variance(*place) > 0.0);
        let finite = law.information.matrix.iter().all(|entry| entry.is_finite());
        if definite && finite { Ok(()) } else { Err(refused()) }
    }

    fn checked_noise(&self) -> Result<Noise, SavedLawsError> {
        let SavedNoise { q, qd, process } = self.noise;
        let sound = [q, qd, process].iter().all(|level| level.is_finite() && *level > 0.0);
        match sound {
            true => Ok(Noise { sensor: [q * q, qd * qd], process }),
            false => Err(self.refuse("noise", "positive")),
        }
    }

    fn refuse(&self, what: &str, range: &'static str) -> SavedLawsError {
        SavedLawsError::Value { law: self.number, what: what.into(), range }
    }
}

/// The term's name, with the inner parameters that it is held at.
fn key(term: Term) -> String {
    let values: Vec<String> = term.inner_values().iter().map(f64::to_string).collect();
    if values.is_empty() { term.name() } else { format!("{}({})", term.name(), values.join(", ")) }
}
