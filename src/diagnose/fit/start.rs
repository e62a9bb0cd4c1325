//! A first guess of coefficients and noise, from weak rows.

use super::form::{Form, Parts};
use super::means::is_series;
use crate::diagnose::motion::sensor_noise;
use crate::diagnose::piece::Piece;
use crate::estimation::Noise;
use crate::law::{Motion, Term};
use crate::weak::{Fit, Regression, Row, Section, Variation};

/// Lengths of the weak rows that are tried, samples.
const LENGTHS: [usize; 7] = [16, 32, 64, 128, 256, 512, 1024];

/// Rows begin at every such fraction of their length.
const OVERLAP: usize = 4;

const VARIATION: Variation = Variation::Polynomial { power: 4 };

/// Coefficients and noise from which a descent begins.
pub(super) struct Start {
    pub(super) coefficients: Vec<f64>,
    pub(super) noise: Noise,
}

/// Guesses from rows of every length, the best first: those of positive inertia, then by the part of the force that their rows leave
/// unexplained. None without rows enough.
pub(super) fn starts(form: &Form, pieces: &[Piece]) -> Vec<Start> {
    let sensor = sensor_noise(pieces).map(|std| std * std + f64::MIN_POSITIVE);
    let position = form.terms.iter().position(|term| *term == Term::Inertia);
    let inertia = |coefficients: &[f64]| position.map_or(1.0, |index| coefficients[index]);
    let mut guesses: Vec<_> = LENGTHS.iter().filter_map(|length| guess(form, pieces, *length)).collect();
    guesses.sort_by(|a, b| (inertia(&a.1) <= 0.0).cmp(&(inertia(&b.1) <= 0.0)).then(a.0.total_cmp(&b.0)));
    let begin = |(_, coefficients, intensity): (f64, Vec<f64>, f64)| {
        let process = intensity / inertia(&coefficients).powi(2) + f64::MIN_POSITIVE;
        (process.is_finite() && inertia(&coefficients) != 0.0)
            .then_some(Start { coefficients, noise: Noise { sensor, process } })
    };
    guesses.into_iter().filter_map(begin).collect()
}

/// (relative residual, coefficients, intensity of the unexplained force) from rows of one length.
fn guess(form: &Form, pieces: &[Piece], length: usize) -> Option<(f64, Vec<f64>, f64)> {
    let free = form.free();
    let mut regression = Regression::new(free.len());
    let terms: Vec<Term> = form.terms.iter().copied().filter(|term| !is_series(*term)).collect();
    let held: Vec<f64> = form
        .terms
        .iter()
        .zip(&form.held)
        .filter(|(term, _)| !is_series(**term))
        .map(|(_, held)| held.unwrap_or(0.0))
        .collect();
    let positions: Vec<usize> = Parts::of(form).free;
    let mut row = Row::new(terms.len());
    let mut left = vec![0.0; free.len()];
    let (mut power, mut rows) = (0.0, 0);
    for piece in pieces {
        let velocity = piece.qd.clone().unwrap_or_else(|| slopes(piece));
        let displacement = piece.q.clone().unwrap_or_else(|| integral(piece));
        let mut first = 0;
        while first + length < piece.len() {
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
            let weight = row.norm.sqrt().recip();
            for (entry, index) in left.iter_mut().zip(&positions) {
                *entry = row.terms[*index] * weight;
            }
            let held: f64 = held.iter().zip(&row.terms).map(|(held, term)| held * term).sum();
            let right = (row.excitation - held) * weight;
            regression.add(&left, right);
            power += right * right;
            rows += 1;
            first += (length / OVERLAP).max(1);
        }
    }
    if rows < 2 * free.len() + 4 {
        return None;
    }
    let mut fit = Fit::new(free.len());
    regression.solve(&mut fit);
    let mut coefficients: Vec<f64> = form.held.iter().map(|held| held.unwrap_or(0.0)).collect();
    free.iter().zip(&fit.coefficients).for_each(|(index, value)| coefficients[*index] = *value);
    let relative = fit.residual / (power / rows as f64).sqrt();
    (relative.is_finite() && coefficients.iter().all(|value| value.is_finite())).then_some((
        relative,
        coefficients,
        fit.residual * fit.residual,
    ))
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

/// Velocity of a measured displacement by central differences.
pub(super) fn slopes(piece: &Piece) -> Vec<f64> {
    let Some(q) = &piece.q else { return vec![0.0; piece.len()] };
    let last = q.len() - 1;
    let slope = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        (q[after] - q[before]) / (piece.t[after] - piece.t[before])
    };
    (0..q.len()).map(slope).collect()
}

/// Displacement of a measured velocity by the trapezoidal rule, its mean taken off.
fn integral(piece: &Piece) -> Vec<f64> {
    let Some(qd) = &piece.qd else { return vec![0.0; piece.len()] };
    let mut q = vec![0.0; qd.len()];
    for k in 1..qd.len() {
        q[k] = q[k - 1] + 0.5 * (qd[k] + qd[k - 1]) * (piece.t[k] - piece.t[k - 1]);
    }
    let mean = q.iter().sum::<f64>() / q.len() as f64;
    q.iter().map(|value| value - mean).collect()
}
