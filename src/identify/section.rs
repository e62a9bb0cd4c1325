//! A stretch of the window laid out for weak rows, with estimates in place of the channel that is not measured.

use super::packed;
use super::problem::Problem;
use super::sample::Sample;
use super::window::Window;
use crate::law::Hold;
use crate::weak::{Section, differentiate, integrate};
use serde::{Deserialize, Serialize};

/// Samples in the longest variation of weak rows, where the window has room for it: half a period of a motion of 4096
/// samples a period.
pub const LONGEST_VARIATION: usize = 2048;

/// Room for one section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "PackedSection", into = "PackedSection")]
pub struct SectionBuffer {
    t: Vec<f64>,
    q: Vec<f64>,
    qd: Vec<f64>,
    excitation: Vec<f64>,
}

/// A section in a saved state.
#[derive(Serialize, Deserialize)]
struct PackedSection(#[serde(with = "packed")] Vec<Sample>);

impl From<SectionBuffer> for PackedSection {
    fn from(SectionBuffer { t, q, qd, excitation }: SectionBuffer) -> PackedSection {
        let sample = |slot: usize| Sample { t: t[slot], q: q[slot], qd: qd[slot], excitation: excitation[slot] };
        PackedSection((0..t.len()).map(sample).collect())
    }
}

impl From<PackedSection> for SectionBuffer {
    fn from(PackedSection(samples): PackedSection) -> SectionBuffer {
        let column = |value: fn(&Sample) -> f64| samples.iter().map(value).collect();
        let (t, q) = (column(|sample| sample.t), column(|sample| sample.q));
        SectionBuffer { t, q, qd: column(|sample| sample.qd), excitation: column(|sample| sample.excitation) }
    }
}

impl SectionBuffer {
    /// Room for `length` samples.
    pub fn new(length: usize) -> SectionBuffer {
        let empty = || vec![0.0; length];
        SectionBuffer { t: empty(), q: empty(), qd: empty(), excitation: empty() }
    }

    /// Copies the samples `first` to `last`; a displacement or velocity that is not measured is estimated from the
    /// other.
    pub fn load(&mut self, problem: &Problem, window: &Window, first: u64, last: u64) {
        for (slot, number) in (first..=last).enumerate() {
            let sample = window.sample(number);
            self.t[slot] = sample.t;
            self.q[slot] = sample.q;
            self.qd[slot] = sample.qd;
            self.excitation[slot] = if problem.channels.excitation { sample.excitation } else { 0.0 };
        }
        let length = (last - first) as usize + 1;
        if !problem.channels.qd {
            differentiate(&self.t[..length], &self.q[..length], &mut self.qd[..length]);
        }
        if !problem.channels.q {
            integrate(&self.t[..length], &self.qd[..length], &mut self.q[..length]);
        }
    }

    /// The first `length` samples that were loaded.
    pub fn view(&self, problem: &Problem, length: usize) -> Section<'_> {
        Section {
            t: &self.t[..length],
            q: &self.q[..length],
            qd: &self.qd[..length],
            qd_measured: problem.channels.qd,
            excitation: &self.excitation[..length],
            hold: if problem.channels.excitation { problem.timing.hold } else { Hold::Zero },
        }
    }
}
