//! A record of fixed length, captured sample by sample: what the published procedure identifies from.

use crate::identify::problem::Problem;
use crate::identify::sample::Sample;
use crate::identify::section::SectionBuffer;
use crate::identify::settings::Channels;
use crate::weak::Section;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Fewest samples of a record; one that is slow takes longer than its length for them.
const FEWEST: usize = 64;

/// q, q̇ and F over a given time; a channel that is not measured is completed from the other one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Capture {
    /// Its length, s.
    length: f64,
    count: usize,
    record: SectionBuffer,
}

impl Capture {
    /// Room for `length` s of samples at least half a `sample_time` apart.
    pub fn new(length: f64, sample_time: f64) -> Capture {
        let capacity = FEWEST.max((2.0 * length / sample_time).ceil() as usize + 2);
        Capture { length, count: 0, record: SectionBuffer::new(capacity) }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Number of samples.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether it is as long as it should be, to half a sample.
    pub fn is_complete(&self) -> bool {
        let t = &self.record.t;
        match self.count {
            count if count == t.len() => true,
            count if count < FEWEST => false,
            count => {
                let (last, before) = (t[count - 1], t[count - 2]);
                last - t[0] >= self.length - 0.5 * (last - before)
            }
        }
    }

    /// Takes a sample, completed; a full record takes none.
    pub fn push(&mut self, sample: Sample, channels: Channels) {
        let (at, record) = (self.count, &mut self.record);
        if at == record.t.len() {
            return;
        }
        record.put(at, &sample);
        if !channels.qd && at >= 2 {
            // now that there is a sample on both sides
            record.qd[at - 1] = (record.q[at] - record.q[at - 2]) / (record.t[at] - record.t[at - 2]);
        }
        self.count += 1;
    }

    /// Samples in this range, as weak rows want them.
    pub fn section(&self, problem: &Problem, range: RangeInclusive<usize>) -> Section<'_> {
        self.record.part(problem, range)
    }
}

/// The sample, with 0 in the channels that are not measured, completed: q̇ as the last difference of q, q as the
/// trapezoidal sum of q̇ on top of the completed sample before.
pub fn complete(sample: Sample, before: Option<&Sample>, channels: Channels) -> Sample {
    let Some(before) = before else { return sample };
    let dt = sample.t - before.t;
    let qd = if channels.qd { sample.qd } else { (sample.q - before.q) / dt };
    let q = if channels.q { sample.q } else { before.q + 0.5 * dt * (before.qd + sample.qd) };
    Sample { q, qd, ..sample }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POSITION_ONLY: Channels = Channels { qd: false, ..Channels::ALL };
    const VELOCITY_ONLY: Channels = Channels { q: false, ..Channels::ALL };

    fn motion(t: f64) -> Sample {
        Sample { t, q: (2.0 * t).sin(), qd: 2.0 * (2.0 * t).cos(), excitation: 1.0 }
    }

    fn captured(channels: Channels, sample_time: f64) -> Capture {
        let mut capture = Capture::new(1.0, sample_time);
        let mut before: Option<Sample> = None;
        let mut number = 0;
        while !capture.is_complete() {
            let whole = motion(f64::from(number) * sample_time);
            let hidden = Sample {
                q: if channels.q { whole.q } else { 0.0 },
                qd: if channels.qd { whole.qd } else { 0.0 },
                ..whole
            };
            let sample = complete(hidden, before.as_ref(), channels);
            capture.push(sample, channels);
            before = Some(sample);
            number += 1;
        }
        capture
    }

    #[test]
    fn a_record_is_complete_after_its_length_and_not_before() {
        assert_eq!(captured(Channels::ALL, 1e-3).count(), 1001);
        assert_eq!(captured(Channels::ALL, 0.25).count(), FEWEST);
    }

    #[test]
    fn a_missing_velocity_is_completed_with_order_two() {
        let error = |sample_time| {
            let capture = captured(POSITION_ONLY, sample_time);
            let inner = 1..capture.count() - 1;
            inner.map(|k| (capture.record.qd[k] - motion(capture.record.t[k]).qd).abs()).fold(0.0, f64::max)
        };
        let order = (error(4e-3) / error(2e-3)).log2();
        assert!((1.9..2.1).contains(&order), "order {order}");
    }

    #[test]
    fn a_missing_displacement_is_completed_up_to_its_start() {
        let SectionBuffer { t, q, .. } = captured(VELOCITY_ONLY, 1e-3).record;
        assert!(q.iter().zip(&t).all(|(q, t)| (q - motion(*t).q).abs() < 1e-6));
    }
}
