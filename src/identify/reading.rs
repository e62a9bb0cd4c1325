//! A sample as it enters the record: which of its readings count.

use super::sample::Sample;
use serde::{Deserialize, Serialize};

/// A sample, and what of it is a sensor's fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// The sample; in the place of a reading that does not count stands what the law expects.
    pub sample: Sample,
    /// Which of q and q̇ are a sensor's fault.
    pub faulty: [bool; 2],
    /// Intensity of the white force that may have acted since the sample before besides the excitation, N² s.
    pub unseen: f64,
}

impl Reading {
    /// Whether one of the channels that are `measured` counts.
    pub fn counts(&self, measured: [bool; 2]) -> bool {
        self.faulty.into_iter().zip(measured).any(|(faulty, measured)| measured && !faulty)
    }
}

impl From<Sample> for Reading {
    fn from(sample: Sample) -> Reading {
        Reading { sample, faulty: [false; 2], unseen: 0.0 }
    }
}
