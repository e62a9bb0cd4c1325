//! What is to be said of a recording before it is believed: its clock, its sensors one by one, and whether they fit together.
//!
//! No law is needed for it, and nothing is changed: a remark says what was seen, how much of it, and what it does to a law.

mod readings;
mod remark;
mod sampling;
mod velocity;

pub use remark::Remark;

use super::motion::{Motion, period};
use crate::identify::Recording;
use crate::law::Hold;

/// Samples from which the motion is estimated: some thousand natural periods of a well sampled one, a second's work.
const LOOKED_AT: usize = 20_000;

/// Everything that is to be said of a recording; nothing where all is as it should be.
pub fn remarks(recording: &Recording) -> Vec<Remark> {
    let motion = looked_at(recording).and_then(|part| Motion::of(&part, Hold::Linear));
    let mut said = sampling::remarks(recording, motion.as_ref().map(|motion| period(std::slice::from_ref(motion))));
    said.extend(readings::remarks(recording));
    said.extend(motion.iter().flat_map(|motion| velocity::remarks(motion, recording.sample_time())));
    said
}

/// The middle of the longest stretch without gaps.
fn looked_at(recording: &Recording) -> Option<Recording> {
    let longest = recording.pieces().into_iter().max_by_key(|range| range.len())?;
    let length = longest.len().min(LOOKED_AT);
    let start = longest.start + (longest.len() - length) / 2;
    recording.section(start..start + length).ok()
}
