//! A stretch of a recording without gaps, made ready for the filter.

use crate::evidence::Observation;
use crate::identify::Recording;
use crate::law::{BandLimited, Drive, Hold, REACH};
use std::ops::Range;

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

    fn observe(&self) -> Vec<Observation> {
        let band_limited = BandLimited::new();
        let drive = |k: usize| match self.hold {
            Hold::Zero => Drive::Held(self.excitation[k]),
            Hold::Linear => Drive::Line(self.excitation[k], self.excitation[k + 1]),
            Hold::BandLimited => band_limited.interpolate(&self.taps(k)),
        };
        let observation = |k: usize| Observation {
            dt: self.t[k + 1] - self.t[k],
            drive: drive(k),
            measured: self.measured().map(|signal| signal.map(|values| values[k + 1])),
        };
        (0..self.len() - 1).map(observation).collect()
    }

    /// Samples around interval k; beyond the ends the last value stays.
    fn taps(&self, k: usize) -> [f64; 2 * REACH] {
        let last = self.len() as i64 - 1;
        let first = k as i64 - (REACH as i64 - 1);
        std::array::from_fn(|tap| self.excitation[(first + tap as i64).clamp(0, last) as usize])
    }
}
