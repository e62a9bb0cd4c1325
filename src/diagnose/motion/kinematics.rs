//! What the readings of q̇ are of the motion that q shows: how late, how large, and whether a measurement of their own.
//!
//! q̇ read at t is s ẋ(t − τ) + b: its regression on the smoothed ẋ(t − τ), ẍ(t − τ) and 1 gives s, τ and b. What
//! smoothing takes of the motion it must take of q̇ too, else s comes out too large: the integral of q̇ goes through
//! the same smoother as q. A q̇ that is computed from q, by differences and whatever filter, has the noise of q in it:
//! what is left of q̇ beside the same filter of the motion's velocity is then a linear function of what is left of q.
//! Some of that it is of any q̇, for both are set against the motion that the noisy q shows; how much, the smoothed
//! motion tells when it is read and smoothed again.

use super::spline::{Sensors, Spline};
use super::track::Track;
use crate::diagnose::piece::{Piece, usual_step};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Samples before an instant whose noise of q a derivative may hold: a second-order low-pass at a fifth of half the
/// sampling frequency has then forgotten all but a two-hundredth.
const BEFORE: usize = 12;
/// … and after it.
const AFTER: usize = 2;

/// … both, and the instant itself.
const AROUND: usize = BEFORE + AFTER + 1;

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
        let filter = Regression::of(&filtered(pieces, tracks), &right)?;
        let left_of_both = Left::of(pieces, tracks, filter.residuals(&filtered(pieces, tracks), &right))?;
        let of_its_own = Left::of_its_own(tracks, pieces, sensors, &filter);
        Some(Kinematics {
            lag: lag + found.solution[1] / scale,
            lag_std: std[1] / scale.abs(),
            scale,
            scale_std: std[0],
            offset: found.solution[2],
            offset_std: std[2],
            explained: 1.0 - left / spread,
            is_derivative: left_of_both.shared(&of_its_own)? > SHARED,
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

/// ẋ at and about every sample, and 1: what a filter of the velocity may be made of.
fn filtered(pieces: &[Piece], tracks: &[Track]) -> Vec<[f64; AROUND + 1]> {
    let usual = usual_step(pieces.iter().map(|piece| piece.t.as_slice()));
    let of = |(piece, track): (&Piece, &Track)| {
        let row = |k: usize| {
            let about = |place: usize| match place {
                AROUND => 1.0,
                _ => velocity(&piece.t, track, (k, piece.t[k] + usual * (place as f64 - BEFORE as f64))),
            };
            std::array::from_fn(about)
        };
        (0..piece.len()).map(row).collect::<Vec<_>>()
    };
    pieces.iter().zip(tracks).flat_map(of).collect()
}

/// ẋ at an instant not far from sample k, by the nearest sample's derivatives.
fn velocity(times: &[f64], track: &Track, (mut k, t): (usize, f64)) -> f64 {
    let distance = |k: usize| (times[k] - t).abs();
    while k > 0 && distance(k - 1) < distance(k) {
        k -= 1;
    }
    while k + 1 < times.len() && distance(k + 1) < distance(k) {
        k += 1;
    }
    let ([_, v, a, j], after) = (track.states[k], t - times[k]);
    v + after * (a + 0.5 * after * j)
}

/// The readings of q̇ through the smoother through which q went.
fn smoothed(piece: &Piece, track: &Track, sensors: Sensors) -> Option<Vec<f64>> {
    let velocity = piece.measured()[1]?;
    let slope = slopes(&piece.t, velocity);
    let mut integral = vec![0.0];
    for k in 0..piece.len() - 1 {
        let h = piece.t[k + 1] - piece.t[k];
        let area = 0.5 * h * (velocity[k] + velocity[k + 1] + h / 6.0 * (slope[k] - slope[k + 1]));
        integral.push(integral[k] + area);
    }
    let spline = Spline::new(&piece.t, sensors, [true, false], [&track.doubt[0], &[]]);
    Some(spline.smooth([Some(&integral), None]).iter().map(|state| state[1]).collect())
}

/// Slopes of values at instants, of the parabola through a reading and those beside it.
fn slopes(t: &[f64], values: &[f64]) -> Vec<f64> {
    let chord = |k: usize| (values[k + 1] - values[k]) / (t[k + 1] - t[k]);
    let last = values.len() - 1;
    let at = |k: usize| match k {
        0 => chord(0),
        k if k == last => chord(last - 1),
        k => {
            let [before, after] = [t[k] - t[k - 1], t[k + 1] - t[k]];
            (after * chord(k - 1) + before * chord(k)) / (before + after)
        }
    };
    (0..values.len()).map(at).collect()
}

/// What smoothing leaves of the readings: of q piece by piece, of q̇ end to end.
struct Left {
    q: Vec<Vec<f64>>,
    /// By piece, whether no reading is lost from each on as far as a filter of it reaches.
    whole: Vec<Vec<bool>>,
    qd: Vec<f64>,
}

impl Left {
    fn of(pieces: &[Piece], tracks: &[Track], qd: Vec<f64>) -> Option<Left> {
        let own = |(piece, track): (&Piece, &Track)| {
            let q = piece.measured()[0]?;
            Some(q.iter().zip(&track.states).map(|(q, state)| q - state[0]).collect())
        };
        Some(Left { q: pieces.iter().zip(tracks).map(own).collect::<Option<_>>()?, whole: whole(pieces), qd })
    }

    /// What it would be of a q̇ of its own, `filter` being what it reads: the smoothed motion, read and smoothed again.
    fn of_its_own(tracks: &[Track], pieces: &[Piece], sensors: Sensors, filter: &Regression) -> Left {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut read = |state: &[f64; 4]| {
            let draw: f64 = StandardNormal.sample(&mut random);
            state[0] + sensors.noise[0] * draw
        };
        let (mut left, mut again) = (Vec::new(), Vec::new());
        for (piece, track) in pieces.iter().zip(tracks) {
            let q: Vec<f64> = track.states.iter().map(&mut read).collect();
            let spline = Spline::new(&piece.t, sensors, [true, false], [&track.doubt[0], &[]]);
            let states = spline.smooth([Some(&q), None]);
            left.push(q.iter().zip(&states).map(|(q, state)| q - state[0]).collect());
            again.push(Track { states, ..track.clone() });
        }
        let qd = filter.expected(&filtered(pieces, tracks));
        Left { q: left, whole: whole(pieces), qd: filter.residuals(&filtered(pieces, &again), &qd) }
    }

    /// What is left of q about an instant, for what is left of q̇ then.
    fn rows(&self) -> (Vec<[f64; AROUND]>, Vec<f64>) {
        let (mut rows, mut right, mut first) = (Vec::new(), Vec::new(), 0);
        for (noise, whole) in self.q.iter().zip(&self.whole) {
            let windows = noise.windows(AROUND).zip(&self.qd[first + BEFORE..]).zip(whole).filter(|(_, whole)| **whole);
            let own = windows.filter_map(|((window, left), _)| Some((<[f64; AROUND]>::try_from(window).ok()?, *left)));
            own.for_each(|(window, left)| {
                rows.push(window);
                right.push(left);
            });
            first += noise.len();
        }
        (rows, right)
    }

    /// Share of what is left of q̇ that what is left of q explains, beyond what it does because both are set against
    /// the motion that the noisy q shows.
    fn shared(&self, of_its_own: &Left) -> Option<f64> {
        let (rows, right) = of_its_own.rows();
        let expected = Regression::of(&rows, &right)?;
        let (rows, right) = self.rows();
        let own = expected.residuals(&rows, &right);
        let total: f64 = own.iter().map(|value| value * value).sum();
        Some(1.0 - Regression::of(&rows, &own)?.left / total.max(f64::MIN_POSITIVE))
    }
}

/// By piece and sample, whether no reading is lost from there on as far as a filter reaches.
fn whole(pieces: &[Piece]) -> Vec<Vec<bool>> {
    let most = (AROUND as f64 - 0.5) * usual_step(pieces.iter().map(|piece| piece.t.as_slice()));
    let own = |piece: &Piece| piece.t.windows(AROUND).map(|t| t[AROUND - 1] - t[0] < most).collect();
    pieces.iter().map(own).collect()
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

    fn expected<const P: usize>(&self, rows: &[[f64; P]]) -> Vec<f64> {
        let expected = |row: &[f64; P]| row.iter().zip(self.solution.iter()).map(|(a, b)| a * b).sum::<f64>();
        rows.iter().map(expected).collect()
    }

    fn residuals<const P: usize>(&self, rows: &[[f64; P]], right: &[f64]) -> Vec<f64> {
        self.expected(rows).iter().zip(right).map(|(expected, value)| value - expected).collect()
    }
}
