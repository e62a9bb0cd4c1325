//! What the excitation did between samples.

use serde::{Deserialize, Serialize};

/// How the excitation continues between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// The value at a sample stays until the next one, as co-simulation holds its inputs.
    #[default]
    Zero,
    /// A straight line from sample to sample.
    Linear,
    /// Smooth up to half the sampling frequency, as behind an anti-aliasing filter.
    BandLimited,
}

impl Hold {
    /// All holds, in the order in which they are tried on a record that names none.
    pub const ALL: [Hold; 3] = [Hold::Zero, Hold::Linear, Hold::BandLimited];

    /// The name used in model files and on the command line.
    pub fn id(self) -> &'static str {
        match self {
            Hold::Zero => "zero",
            Hold::Linear => "linear",
            Hold::BandLimited => "band_limited",
        }
    }

    /// The hold of that name.
    pub fn from_id(id: &str) -> Option<Hold> {
        Hold::ALL.into_iter().find(|hold| hold.id() == id)
    }
}

impl std::fmt::Display for Hold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.id())
    }
}
