//! Samples laid out for weak rows; of a stretch of the window, with estimates in place of what is not measured.

use super::problem::Problem;
use super::sample::Sample;
use super::window::Window;
use crate::law::Hold;
use crate::weak::{Section, differentiate, integrate};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};
use std::ops::RangeInclusive;

/// Samples in the longest variation of weak rows, where the window has room for it: half a period of a motion of 4096
/// samples a period.
pub const LONGEST_VARIATION: usize = 2048;

/// Room for one section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SectionBuffer {
    pub t: Vec<f64>,
    pub q: Vec<f64>,
    pub qd: Vec<f64>,
    excitation: Vec<f64>,
}

/// Writes the room alone of a buffer that is loaded anew before every use; for `#[serde(serialize_with)]`.
///
/// # Errors
/// What the serializer says.
pub fn serialize_room<S: Serializer>(buffer: &SectionBuffer, serializer: S) -> Result<S::Ok, S::Error> {
    buffer.t.len().serialize(serializer)
}

/// Room as [`serialize_room`] wrote it.
///
/// # Errors
/// More of it than a section needs, and what the deserializer says.
pub fn deserialize_room<'de, D: Deserializer<'de>>(deserializer: D) -> Result<SectionBuffer, D::Error> {
    let length = usize::deserialize(deserializer)?;
    match length <= LONGEST_VARIATION + 1 {
        true => Ok(SectionBuffer::new(length)),
        false => Err(D::Error::custom("a section is longer than the longest variation")),
    }
}

impl SectionBuffer {
    /// Room for `length` samples.
    pub fn new(length: usize) -> SectionBuffer {
        let [t, q, qd, excitation] = std::array::from_fn(|_| vec![0.0; length]);
        SectionBuffer { t, q, qd, excitation }
    }

    /// Writes one sample.
    pub fn put(&mut self, slot: usize, sample: &Sample) {
        self.t[slot] = sample.t;
        self.q[slot] = sample.q;
        self.qd[slot] = sample.qd;
        self.excitation[slot] = sample.excitation;
    }

    /// Copies the samples `first` to `last`; a displacement or velocity that is not measured is estimated from the
    /// other.
    pub fn load(&mut self, problem: &Problem, window: &Window, first: u64, last: u64) {
        for (slot, number) in (first..=last).enumerate() {
            self.put(slot, window.sample(number));
        }
        let length = (last - first) as usize + 1;
        if !problem.channels.qd {
            differentiate(&self.t[..length], &self.q[..length], &mut self.qd[..length]);
        }
        if !problem.channels.q {
            integrate(&self.t[..length], &self.qd[..length], &mut self.q[..length]);
        }
    }

    /// The first `length` samples.
    pub fn view(&self, problem: &Problem, length: usize) -> Section<'_> {
        self.part(problem, 0..=length - 1)
    }

    /// The samples in this range, as weak rows want them.
    pub fn part(&self, problem: &Problem, range: RangeInclusive<usize>) -> Section<'_> {
        Section {
            t: &self.t[range.clone()],
            q: &self.q[range.clone()],
            qd: &self.qd[range.clone()],
            qd_measured: problem.channels.qd,
            excitation: &self.excitation[range],
            hold: if problem.channels.excitation { problem.timing.hold } else { Hold::Zero },
        }
    }
}
