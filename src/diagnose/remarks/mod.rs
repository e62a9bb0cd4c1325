//! What is to be said of a recording before it is believed: its clock, its sensors one by one, and whether they fit
//! together.
//!
//! No law is needed for it, and nothing is changed: a remark says what was seen, how much of it, and what it does to a
//! law.

mod readings;
mod remark;
mod sampling;
mod velocity;

pub use remark::Remark;

use super::motion::{Motion, period};
use crate::identify::Recording;
use crate::law::Hold;
use std::ops::Range;
use velocity::Beside;

/// Samples from which the motion is estimated: some thousand natural periods of a well sampled one, a second's work.
const LOOKED_AT: usize = 20_000;

/// Everything that is to be said of a recording; nothing where all is as it should be.
pub fn remarks(recording: &Recording) -> Vec<Remark> {
    let part = looked_at(recording).and_then(|part| tamed(&part));
    let motion = part.as_ref().and_then(|part| Motion::of(part, Hold::Linear));
    let period = motion.as_ref().map(|motion| period(std::slice::from_ref(motion)));
    let mut said = sampling::remarks(recording, period);
    said.extend(readings::remarks(recording));
    if let (Some(part), Some(motion), Some(period)) = (part, motion, period) {
        let (sample_time, t) = (recording.sample_time(), part.t());
        let beside = Beside { sample_time, duration: t[t.len() - 1] - t[0], period };
        // Of a motion that is sampled too seldom no slope is known.
        if period > sampling::FEW * sample_time {
            said.extend(velocity::remarks(&motion, beside));
        }
    }
    said
}

/// The middle of the longest stretch without gaps in which neither q nor q̇ is stuck.
fn looked_at(recording: &Recording) -> Option<Recording> {
    let longest =
        recording.pieces().into_iter().flat_map(|piece| free(recording, piece)).max_by_key(|range| range.len())?;
    let length = longest.len().min(LOOKED_AT);
    let start = longest.start + (longest.len() - length) / 2;
    recording.section(start..start + length).ok()
}

/// The recording with the wild readings of its motion on the line between their neighbours: they have a remark of their
/// own.
fn tamed(part: &Recording) -> Option<Recording> {
    let t = part.t();
    let calm = |channel: &str| {
        let mut values = part.signal(channel)?.to_vec();
        for at in readings::wild(t, &values.clone(), true) {
            values[at] = 0.5 * (values[at - 1] + values[at + 1]);
        }
        Some(values)
    };
    let excitation = part.signal("F").map(<[f64]>::to_vec);
    Recording::new(part.source(), t.to_vec(), calm("q"), calm("qd"), excitation).ok()
}

/// What a stuck sensor leaves of a stretch.
fn free(recording: &Recording, piece: Range<usize>) -> Vec<Range<usize>> {
    let signals = ["q", "qd"].map(|channel| recording.signal(channel).map(|values| &values[piece.clone()]));
    let stuck = match signals {
        [Some(q), Some(qd)] => readings::stuck(q, &[qd]).or_else(|| readings::stuck(qd, &[q])),
        _ => None,
    };
    let Some(run) = stuck else { return vec![piece] };
    vec![piece.start..piece.start + run.start, piece.start + run.end..piece.end]
}
