//! A stretch of a recording without gaps, made ready for the filter.

use crate::estimation::Observation;
use crate::identify::Recording;
use crate::law::{BandLimited, Drive, Hold, NODES, REACH, State};
use crate::limits::Course;
use std::ops::Range;

/// Parts that are taken of a long record.
const PARTS: usize = 8;

/// Samples without a gap, SI units; every signal is as long as `t`.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Times, s.
    pub t: Vec<f64>,
    /// Measured displacement.
    pub q: Option<Vec<f64>>,
    /// Measured velocity.
    pub qd: Option<Vec<f64>>,
    /// Excitation; zeros where the motion is free.
    pub excitation: Vec<f64>,
    /// What the excitation did between samples.
    pub hold: Hold,
    /// Sample k + 1 and the excitation since sample k.
    pub observations: Vec<Observation>,
}

/// Median distance of two samples of several stretches, s; 0 where there are no two.
pub fn usual_step<'a>(times: impl Iterator<Item = &'a [f64]>) -> f64 {
    let mut steps: Vec<f64> = times.flat_map(|t| t.windows(2).map(|pair| pair[1] - pair[0])).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() { 0.0 } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

impl Piece {
    /// The pieces of a recording, in the order of time.
    pub fn all(recording: &Recording, hold: Hold) -> Vec<Piece> {
        recording
            .pieces()
            .into_iter()
            .filter(|range| range.len() > 2)
            .map(|range| Piece::of(recording, range, hold))
            .collect()
    }

    fn of(recording: &Recording, range: Range<usize>, hold: Hold) -> Piece {
        let channels = recording.channels();
        let samples: Vec<_> = range.clone().map(|index| recording.sample(index)).collect();
        let t = samples.iter().map(|sample| sample.t).collect();
        let q = channels.q.then(|| samples.iter().map(|sample| sample.q).collect());
        let qd = channels.qd.then(|| samples.iter().map(|sample| sample.qd).collect());
        let excitation = samples.iter().map(|sample| sample.excitation).collect();
        let mut piece = Piece { t, q, qd, excitation, hold, observations: Vec::new() };
        piece.observations = piece.observe();
        piece
    }

    /// The samples of a range, at least three.
    pub fn part(&self, range: Range<usize>) -> Piece {
        let cut = |values: &Vec<f64>| values[range.clone()].to_vec();
        Piece {
            t: cut(&self.t),
            q: self.q.as_ref().map(cut),
            qd: self.qd.as_ref().map(cut),
            excitation: cut(&self.excitation),
            hold: self.hold,
            observations: self.observations[range.start..range.end - 1].to_vec(),
        }
    }

    /// What a law runs through that moved so, one state per sample.
    pub fn course(&self, states: &[State]) -> Course {
        let drives = self.observations.iter().map(|observation| observation.drive).collect();
        Course { t: self.t.clone(), drives, states: states.to_vec() }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// The measured signals by channel: displacement, velocity.
    pub fn measured(&self) -> [Option<&[f64]>; 2] {
        [self.q.as_deref(), self.qd.as_deref()]
    }

    /// Forms the observations anew, after the signals have changed.
    pub(super) fn observe_again(&mut self) {
        self.observations = self.observe();
    }

    fn observe(&self) -> Vec<Observation> {
        let band_limited = BandLimited::new();
        let drive = |k: usize| match self.hold {
            Hold::Zero => Drive::Held(self.excitation[k]),
            Hold::Linear => Drive::Line(self.excitation[k], self.excitation[k + 1]),
            Hold::BandLimited => band_limited.interpolate(&self.taps(k)),
        };
        let observation = |k: usize| Observation {
            unseen: 0.0,
            dt: self.t[k + 1] - self.t[k],
            drive: drive(k),
            measured: self.measured().map(|signal| signal.map(|values| values[k + 1])),
        };
        (0..self.len() - 1).map(observation).collect()
    }

    /// The band-limited excitation at equidistant nodes of every interval.
    pub(super) fn band_limited(&self) -> Vec<[f64; NODES + 1]> {
        let interpolation = BandLimited::new();
        let nodes = |k: usize| match interpolation.interpolate(&self.taps(k)) {
            Drive::Nodes(nodes) => nodes,
            Drive::Held(value) | Drive::Line(value, _) => [value; NODES + 1],
        };
        (0..self.len() - 1).map(nodes).collect()
    }

    /// Samples around interval k; beyond the ends the last value stays.
    fn taps(&self, k: usize) -> [f64; 2 * REACH] {
        let last = self.len() as i64 - 1;
        let first = k as i64 - (REACH as i64 - 1);
        std::array::from_fn(|tap| self.excitation[(first + tap as i64).clamp(0, last) as usize])
    }
}

/// At most `limit` samples of the pieces, in [`PARTS`] parts spread evenly over them; all of them where there are no
/// more.
pub fn thinned(pieces: &[Piece], limit: usize) -> Vec<Piece> {
    let samples: usize = pieces.iter().map(Piece::len).sum();
    if samples <= limit {
        return pieces.to_vec();
    }
    let share = limit as f64 / samples as f64;
    let parts = |piece: &Piece| {
        let count = (PARTS as f64 * piece.len() as f64 / samples as f64).ceil() as usize;
        let length = piece.len() / count;
        let kept = ((length as f64 * share) as usize).max(3);
        let part = |part: usize| piece.part(part * length..part * length + kept);
        (0..count).filter(|_| length > 3).map(part).collect::<Vec<_>>()
    };
    pieces.iter().flat_map(parts).collect()
}
