//! The motion of a piece, smoothed from its readings; wild ones are doubted.

use super::spline::{Sensors, Spline, States};
use crate::diagnose::piece::Piece;
use crate::estimation::OUTLYING;

/// Factor on the variance of a reading that is not to be taken.
pub(super) const UNREAD: f64 = 1e12;

/// The motion of one piece.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Track {
    /// Which of q and q̇ are read.
    pub(in crate::diagnose) read: [bool; 2],
    /// Factor on the variance of every reading by channel; empty where none is wild.
    pub(in crate::diagnose) doubt: [Vec<f64>; 2],
    /// Position, velocity, acceleration and jerk at every sample.
    pub(in crate::diagnose) states: States,
}

/// The readings of a piece that are taken.
pub(in crate::diagnose) fn readings(piece: &Piece, read: [bool; 2]) -> [Option<&[f64]>; 2] {
    let measured = piece.measured();
    [measured[0].filter(|_| read[0]), measured[1].filter(|_| read[1])]
}

impl Track {
    /// The same readings smoothed another way.
    pub(in crate::diagnose) fn resmoothed(&self, piece: &Piece, sensors: Sensors) -> Track {
        track(piece, sensors, self.read, self.doubt.clone())
    }
}

/// The motions of all pieces; a reading that is wild is doubted in a second run.
pub(in crate::diagnose) fn follow(pieces: &[Piece], sensors: Sensors, read: [bool; 2]) -> Vec<Track> {
    let track = |piece: &Piece| {
        let first = track(piece, sensors, read, [Vec::new(), Vec::new()]);
        let doubt = [0, 1].map(|channel| doubt(piece, &first, sensors, channel));
        if doubt.iter().all(Vec::is_empty) { first } else { self::track(piece, sensors, read, doubt) }
    };
    pieces.iter().map(track).collect()
}

pub(in crate::diagnose) fn track(piece: &Piece, sensors: Sensors, read: [bool; 2], doubt: [Vec<f64>; 2]) -> Track {
    let spline = Spline::new(&piece.t, sensors, read, [&doubt[0], &doubt[1]]);
    let states = spline.smooth(readings(piece, read));
    Track { read, doubt, states }
}

/// By what factor the variance of each reading is larger than usual; empty where no reading is wild.
fn doubt(piece: &Piece, track: &Track, sensors: Sensors, channel: usize) -> Vec<f64> {
    let Some(values) = readings(piece, track.read)[channel] else { return Vec::new() };
    let distance =
        |(value, state): (&f64, &[f64; 4])| (value / sensors.unit(channel) - sensors.reading(channel, state)).abs();
    let distances: Vec<f64> = values.iter().zip(&track.states).map(distance).collect();
    let mut sorted = distances.clone();
    let middle = sorted.len() / 2;
    let usual = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1 / 0.6745;
    let usual = usual.max(sensors.noise[channel] / sensors.unit(channel).abs());
    if distances.iter().all(|distance| *distance <= OUTLYING * usual) {
        return Vec::new();
    }
    let factor = |distance: &f64| if *distance > OUTLYING * usual { (distance / usual).powi(2) } else { 1.0 };
    distances.iter().map(factor).collect()
}
