//! A smoothed motion by channel, along which terms are evaluated.

use crate::diagnose::piece::Piece;
use crate::law::{State, Trajectory};

/// A smoothed motion by channel.
pub(super) struct Course<'a> {
    piece: &'a Piece,
    q: Vec<f64>,
    qd: Vec<f64>,
}

impl Course<'_> {
    pub(super) fn of<'a>(piece: &'a Piece, states: &[State]) -> Course<'a> {
        let q = states.iter().map(|state| state.q).collect();
        Course { piece, q, qd: states.iter().map(|state| state.qd).collect() }
    }

    pub(super) fn trajectory(&self) -> Trajectory<'_> {
        let Piece { t, excitation, hold, .. } = self.piece;
        Trajectory { t, q: &self.q, qd: &self.qd, excitation, hold: *hold }
    }
}
