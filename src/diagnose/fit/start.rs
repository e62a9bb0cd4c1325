//! First guesses of coefficients and noise, from weak rows of a whole record.

use super::form::{Form, Parts};
use crate::diagnose::motion::sensor_noise;
use crate::diagnose::piece::Piece;
use crate::estimation::{Noise, RowsOfLength, VARIATION};
use crate::law::{Motion, Term};
use crate::weak::{self, Row, Section};

/// Lengths of the weak rows that are tried, samples.
const LENGTHS: [usize; 7] = [16, 32, 64, 128, 256, 512, 1024];

/// Coefficients and noise from which a descent begins.
pub(super) struct Start {
    pub(super) coefficients: Vec<f64>,
    pub(super) noise: Noise,
}

/// What the rows of one length say.
struct Guess {
    relative_error: f64,
    coefficients: Vec<f64>,
    /// Of the force that they leave unexplained, N² s.
    intensity: f64,
}

/// Guesses from rows of every length, the best first: those of positive inertia, then by the predicted error of the
/// law's force. None without rows enough.
pub(super) fn starts(form: &Form, pieces: &[Piece]) -> Vec<Start> {
    let sensor = sensor_noise(pieces).map(|std| std * std + f64::MIN_POSITIVE);
    let motions: Vec<[Vec<f64>; 2]> = pieces.iter().map(|piece| [displacement(piece), velocity(piece)]).collect();
    let inertia = |guess: &Guess| form.inertia().map_or(1.0, |index| guess.coefficients[index]);
    let mut guesses: Vec<Guess> = LENGTHS.iter().filter_map(|length| guess(form, pieces, &motions, *length)).collect();
    guesses.sort_by(|a, b| {
        (inertia(a) <= 0.0).cmp(&(inertia(b) <= 0.0)).then(a.relative_error.total_cmp(&b.relative_error))
    });
    let begin = |guess: Guess| {
        let process = guess.intensity / inertia(&guess).powi(2) + f64::MIN_POSITIVE;
        (process.is_finite() && inertia(&guess) != 0.0)
            .then_some(Start { coefficients: guess.coefficients, noise: Noise { sensor, process } })
    };
    guesses.into_iter().filter_map(begin).collect()
}

fn guess(form: &Form, pieces: &[Piece], motions: &[[Vec<f64>; 2]], length: usize) -> Option<Guess> {
    let parts = Parts::of(form);
    let terms: Vec<Term> = parts.of_state.iter().map(|index| form.terms[*index]).collect();
    let held: Vec<f64> = parts.of_state.iter().map(|index| form.held[*index].unwrap_or(0.0)).collect();
    let mut rows = RowsOfLength::new(length, parts.free.len());
    let mut row = Row::new(terms.len());
    let mut left = vec![0.0; parts.free.len()];
    for (piece, [displacement, velocity]) in pieces.iter().zip(motions) {
        for first in (0..piece.len().saturating_sub(length)).step_by(rows.stride()) {
            let range = first..first + length + 1;
            let section = Section {
                t: &piece.t[range.clone()],
                q: &displacement[range.clone()],
                qd: &velocity[range.clone()],
                qd_measured: piece.qd.is_some(),
                excitation: &piece.excitation[range],
                hold: piece.hold,
            };
            row.integrate(&section, VARIATION, &Motion::new(&terms, &[]));
            left.iter_mut().zip(&parts.free).for_each(|(entry, index)| *entry = row.terms[*index]);
            let known: f64 = held.iter().zip(&row.terms).map(|(held, term)| held * term).sum();
            rows.add(&row, &parts.free, &mut left, row.excitation - known);
        }
    }
    let mut fit = weak::Fit::new(parts.free.len());
    let relative_error = rows.solve(&mut fit)?;
    let mut coefficients: Vec<f64> = form.held.iter().map(|held| held.unwrap_or(0.0)).collect();
    form.free().iter().zip(&fit.coefficients).for_each(|(index, value)| coefficients[*index] = *value);
    let finite = relative_error.is_finite() && coefficients.iter().all(|value| value.is_finite());
    finite.then_some(Guess { relative_error, coefficients, intensity: fit.residual.powi(2) })
}

/// The largest value measured by channel.
pub(super) fn largest(pieces: &[Piece]) -> [f64; 2] {
    [0, 1].map(|channel| {
        let values = pieces.iter().filter_map(|piece| piece.measured()[channel]).flatten();
        values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
    })
}

/// A process noise too small to be seen beside the sensors' noise, whatever the motion.
pub(super) fn negligible(noise: &Noise) -> f64 {
    let measured = noise.sensor.iter().filter(|variance| **variance > f64::MIN_POSITIVE);
    1e-9 * measured.fold(f64::INFINITY, |least: f64, variance| least.min(*variance)).min(1e300)
}

/// The measured velocity, or the displacement's slopes.
fn velocity(piece: &Piece) -> Vec<f64> {
    let slopes = || {
        let mut slopes = vec![0.0; piece.len()];
        piece.q.iter().for_each(|q| weak::differentiate(&piece.t, q, &mut slopes));
        slopes
    };
    piece.qd.clone().unwrap_or_else(slopes)
}

/// The measured displacement, or the velocity's integral less its mean: its constant is unknown.
fn displacement(piece: &Piece) -> Vec<f64> {
    let integral = || {
        let mut q = vec![0.0; piece.len()];
        piece.qd.iter().for_each(|qd| weak::integrate(&piece.t, qd, &mut q));
        let mean = q.iter().sum::<f64>() / q.len() as f64;
        q.iter().map(|value| value - mean).collect()
    };
    piece.q.clone().unwrap_or_else(integral)
}
