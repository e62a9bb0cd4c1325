//! What the readings of q̇ are of the motion that q shows: how late, how large, and whether a measurement of their own.
//!
//! q̇ read at t is s ẋ(t − τ) + b: its regression on the smoothed ẋ(t − τ), ẍ(t − τ) and 1 gives s, τ and b. What
//! smoothing takes of the motion it must take of q̇ too, else s comes out too large: the integral of q̇ goes through
//! the same smoother as q. A q̇ that is computed from q, by differences and whatever filter, has the noise of q in it:
//! what is left of q̇ is then a linear function of what is left of q.

use super::spline::{Sensors, Spline};
use super::track::Track;
use crate::diagnose::piece::Piece;
use nalgebra::{DMatrix, DVector};

/// Samples before and after an instant whose noise of q a derivative may hold.
const BEFORE: usize = 8;
/// … and after it.
const AFTER: usize = 2;

/// Share of what is left of q̇ that q's own noise must explain where q̇ is computed from q.
const SHARED: f64 = 0.5;

/// Share of q̇'s variance that the derivative of q must explain where it is a velocity at all.
const EXPLAINED: f64 = 0.5;

/// Blocks over which a std is taken: each is as long as the motion's slowest usual change, or longer.
const BLOCKS: usize = 32;

/// Times that the delay is corrected.
const STEPS: usize = 3;

/// What q̇ is of q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    /// How late q̇ is, s.
    pub lag: f64,
    /// Std of it, s.
    pub lag_std: f64,
    /// q̇ ÷ derivative of q.
    pub scale: f64,
    /// Std of it.
    pub scale_std: f64,
    /// What q̇ reads where nothing moves; less where q moves on without it.
    pub offset: f64,
    /// Std of it.
    pub offset_std: f64,
    /// Share of q̇'s variance that the derivative of q explains.
    pub explained: f64,
    /// Whether q̇ is computed from q, so that it is no second measurement.
    pub is_derivative: bool,
}

impl Kinematics {
    /// Of pieces that have both, and the motion that q alone, taken by these sensors, shows. None where nothing moves.
    pub(super) fn of(pieces: &[Piece], tracks: &[Track], sensors: Sensors) -> Option<Kinematics> {
        let (mut right, mut smooth) = (Vec::new(), Vec::new());
        for (piece, track) in pieces.iter().zip(tracks) {
            right.extend(piece.measured()[1]?);
            smooth.extend(smoothed(piece, track, sensors)?);
        }
        let (mut lag, mut rows) = (0.0, late(tracks, 0.0));
        let mut found = Regression::of(&rows, &smooth)?;
        for _ in 0..STEPS {
            lag += found.solution[1] / found.solution[0];
            rows = late(tracks, lag);
            found = Regression::of(&rows, &smooth)?;
        }
        let residuals = found.residuals(&rows, &right);
        let left: f64 = residuals.iter().map(|residual| residual * residual).sum();
        let count = right.len() as f64;
        let mean = right.iter().sum::<f64>() / count;
        let spread: f64 = right.iter().map(|value| (value - mean).powi(2)).sum();
        let std = found.std(&rows, &residuals);
        let scale = found.solution[0];
        Some(Kinematics {
            lag: lag + found.solution[1] / scale,
            lag_std: std[1] / scale.abs(),
            scale,
            scale_std: std[0],
            offset: found.solution[2],
            offset_std: std[2],
            explained: 1.0 - left / spread,
            is_derivative: shared(pieces, tracks, &residuals)? > SHARED,
        })
        .filter(|found| found.lag.is_finite() && found.scale.is_finite())
    }

    /// Whether q̇ is the derivative of q, up to a factor and a delay.
    pub fn is_velocity(&self) -> bool {
        self.explained > EXPLAINED
    }
}

/// ẋ so late, its slope by the delay, and 1, at every sample.
fn late(tracks: &[Track], lag: f64) -> Vec<[f64; 3]> {
    let row = |[_, v, a, j]: &[f64; 4]| [v - lag * a + 0.5 * lag * lag * j, lag * j - a, 1.0];
    tracks.iter().flat_map(|track| track.states.iter().map(row)).collect()
}

/// The readings of q̇ through the smoother through which q went.
fn smoothed(piece: &Piece, track: &Track, sensors: Sensors) -> Option<Vec<f64>> {
    let velocity = piece.measured()[1]?;
    let mut integral = vec![0.0];
    for (t, qd) in piece.t.windows(2).zip(velocity.windows(2)) {
        integral.push(integral[integral.len() - 1] + 0.5 * (t[1] - t[0]) * (qd[0] + qd[1]));
    }
    let spline = Spline::new(&piece.t, sensors, [true, false], [&track.doubt[0], &[]]);
    Some(spline.smooth([Some(&integral), None]).iter().map(|state| state[1]).collect())
}

/// Share of what is left of q̇ that what is left of q explains.
fn shared(pieces: &[Piece], tracks: &[Track], left: &[f64]) -> Option<f64> {
    let (mut rows, mut right, mut first) = (Vec::new(), Vec::new(), 0);
    for (piece, track) in pieces.iter().zip(tracks) {
        let q = piece.measured()[0]?;
        let noise: Vec<f64> = q.iter().zip(&track.states).map(|(q, state)| q - state[0]).collect();
        let windows = noise.windows(BEFORE + AFTER + 1).enumerate();
        for (k, window) in windows {
            rows.push(<[f64; BEFORE + AFTER + 1]>::try_from(window).ok()?);
            right.push(left[first + k + BEFORE]);
        }
        first += noise.len();
    }
    let total: f64 = right.iter().map(|value| value * value).sum();
    let found = Regression::of(&rows, &right)?;
    Some(1.0 - found.left / total.max(f64::MIN_POSITIVE))
}

/// Least squares, columns scaled.
struct Regression {
    solution: DVector<f64>,
    inverse: DMatrix<f64>,
    /// Σ residual².
    left: f64,
}

impl Regression {
    fn of<const P: usize>(rows: &[[f64; P]], right: &[f64]) -> Option<Regression> {
        let mut gram = DMatrix::<f64>::zeros(P, P);
        let mut moment = DVector::<f64>::zeros(P);
        for (row, value) in rows.iter().zip(right) {
            for a in 0..P {
                moment[a] += row[a] * value;
                (0..P).for_each(|b| gram[(a, b)] += row[a] * row[b]);
            }
        }
        let scale = |index: usize| if gram[(index, index)] > 0.0 { gram[(index, index)].sqrt().recip() } else { 0.0 };
        let scaled = DMatrix::from_fn(P, P, |a, b| gram[(a, b)] * scale(a) * scale(b));
        if !scaled.iter().all(|value| value.is_finite()) {
            return None;
        }
        let inverse = scaled.pseudo_inverse(1e-12).ok()?;
        let inverse = DMatrix::from_fn(P, P, |a, b| inverse[(a, b)] * scale(a) * scale(b));
        let solution = &inverse * &moment;
        let total: f64 = right.iter().map(|value| value * value).sum();
        Some(Regression { left: (total - solution.dot(&moment)).max(0.0), solution, inverse })
    }

    /// Std of the solution by the sandwich over contiguous blocks: what is left of smoothed readings is coloured.
    fn std<const P: usize>(&self, rows: &[[f64; P]], residuals: &[f64]) -> Vec<f64> {
        let length = rows.len().div_ceil(BLOCKS);
        let scores = rows.chunks(length).zip(residuals.chunks(length)).map(|(rows, residuals)| {
            let add =
                |sum: DVector<f64>, (row, residual): (&[f64; P], &f64)| sum + DVector::from_row_slice(row) * *residual;
            &self.inverse * rows.iter().zip(residuals).fold(DVector::zeros(P), add)
        });
        let squares = scores.fold(DVector::<f64>::zeros(P), |sum, step| sum + step.component_mul(&step));
        squares.iter().map(|square| square.sqrt()).collect()
    }

    fn residuals<const P: usize>(&self, rows: &[[f64; P]], right: &[f64]) -> Vec<f64> {
        let expected = |row: &[f64; P]| row.iter().zip(self.solution.iter()).map(|(a, b)| a * b).sum::<f64>();
        rows.iter().zip(right).map(|(row, value)| value - expected(row)).collect()
    }
}
