//! What is to be said of a recording before it is believed: its clock, its sensors one by one, and whether they fit
//! together.
//!
//! No law is needed for it, and nothing is changed: a remark says what was seen, how much of it, and what it does to a
//! law.

mod readings;
mod remark;
mod sampling;
mod velocity;
mod wild;

pub use remark::Remark;

use super::motion::{Motion, period};
use crate::identify::Recording;
use crate::law::Hold;
use std::ops::Range;
use velocity::Beside;

/// Samples from which the motion is estimated: some thousand natural periods of a well sampled one, a second's work.
const LOOKED_AT: usize = 20_000;

/// Samples at either end of a stretch in which a burst may begin or end without readings beside it; and how long a
/// stretch is from which they can be spared.
const END: usize = wild::LONGEST + 2;
const SHORT: usize = 20 * END;

/// Everything that is to be said of a recording; nothing where all is as it should be. What its channels are like
/// together is told by readings that count: not by wild ones, stuck ones, or those that only repeat what was read.
pub fn remarks(recording: &Recording) -> Vec<Remark> {
    let tamed = tamed(recording);
    let calm = tamed.as_ref().unwrap_or(recording);
    let part = looked_at(calm).and_then(|part| fresh(&part).or(Some(part)));
    let motion = part.as_ref().and_then(|part| Motion::of(part, Hold::Linear));
    let period = motion.as_ref().map(|motion| period(std::slice::from_ref(motion)));
    let mut said = sampling::remarks(recording, period);
    said.extend(readings::remarks(recording, calm));
    if let (Some(part), Some(motion), Some(period)) = (part, motion, period) {
        let (sample_time, t) = (recording.sample_time(), part.t());
        let beside = Beside { sample_time, duration: t[t.len() - 1] - t[0], period };
        // Of a motion that is sampled too seldom no slope is known.
        if period > sampling::FEW * part.sample_time() {
            said.extend(velocity::remarks(&motion, beside));
        }
    }
    said
}

/// The middle of the longest stretch without gaps in which neither q nor q̇ is stuck.
fn looked_at(recording: &Recording) -> Option<Recording> {
    let longest =
        recording.pieces().into_iter().flat_map(|piece| free(recording, piece)).max_by_key(|range| range.len())?;
    let longest = if begins_or_ends_wild(recording, &longest) { inner(&longest) } else { longest };
    let length = longest.len().min(LOOKED_AT);
    let start = longest.start + (longest.len() - length) / 2;
    recording.section(start..start + length).ok()
}

/// What is left of a stretch without its ends, where a burst has no readings on both sides that tell it.
fn inner(stretch: &Range<usize>) -> Range<usize> {
    stretch.start + END..stretch.end.saturating_sub(END)
}

/// Whether q or q̇ is further off at an end of a stretch than it ever is within, by more than its range there.
fn begins_or_ends_wild(recording: &Recording, stretch: &Range<usize>) -> bool {
    if stretch.len() < SHORT {
        return false;
    }
    let inner = inner(stretch);
    let is_wild = |values: &[f64]| {
        let [low, high] = readings::ends(&values[inner.clone()]);
        let ends = values[stretch.start..inner.start].iter().chain(&values[inner.end..stretch.end]);
        ends.into_iter().any(|value| *value > high + (high - low) || *value < low - (high - low))
    };
    ["q", "qd"].into_iter().filter_map(|channel| recording.signal(channel)).any(is_wild)
}

/// The recording with the wild readings of its motion on the line between those before and after: they have a remark of
/// their own. None where there is none.
fn tamed(recording: &Recording) -> Option<Recording> {
    let t = recording.t();
    let found = ["q", "qd"].map(|channel| recording.signal(channel).map(|values| wild::wild(t, values, true)));
    if found.iter().flatten().all(Vec::is_empty) {
        return None;
    }
    let [q, qd] = [("q", &found[0]), ("qd", &found[1])]
        .map(|(channel, found)| Some(wild::without(t, recording.signal(channel)?, found.as_deref()?)));
    let excitation = recording.signal("F").map(<[f64]>::to_vec);
    Recording::new(recording.source(), t.to_vec(), q, qd, excitation).ok()
}

/// The samples in which every channel of the motion was read anew, where one is read less often than the others.
fn fresh(part: &Recording) -> Option<Recording> {
    let signals = ["q", "qd", "F"].map(|channel| part.signal(channel));
    let others =
        |own: usize| (0..3).filter(|other| *other != own).filter_map(|other| signals[other]).collect::<Vec<_>>();
    let held = [0, 1].map(|own| signals[own].filter(|values| readings::is_held(values, &others(own))));
    if held == [None; 2] {
        return None;
    }
    let is_fresh = |at: &usize| held.iter().flatten().all(|values| values[*at] != values[at - 1]);
    let kept: Vec<usize> = (1..part.count()).filter(is_fresh).collect();
    let of = |values: &[f64]| kept.iter().map(|at| values[*at]).collect::<Vec<f64>>();
    let [q, qd, excitation] = signals.map(|values| values.map(of));
    Recording::new(part.source(), of(part.t()), q, qd, excitation).ok()
}

/// What a stuck sensor leaves of a stretch.
fn free(recording: &Recording, piece: Range<usize>) -> Vec<Range<usize>> {
    let run = ["q", "qd"].into_iter().find_map(|channel| readings::stuck_in(recording, channel, piece.clone()));
    let Some(run) = run else { return vec![piece] };
    vec![piece.start..piece.start + run.start, piece.start + run.end..piece.end]
}
