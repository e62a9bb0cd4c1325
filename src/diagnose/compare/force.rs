//! The force that a law leaves over, along the motion.
//!
//! Over a short window the weak residual ÷ ∫ φ dt is the mean of `Σ θ_j f_j − F` about the window's middle. The window
//! is the shortest whose share of noise is small, so that a place can be told from its neighbour.

use super::record::Record;
use super::rows::{Prepared, Windows};

/// Lengths tried, as parts of the longest.
const PARTS: [usize; 5] = [8, 6, 4, 3, 2];

/// Fewest samples in a window.
const FEWEST: usize = 8;

/// Share of noise in the residual's energy that a window may have.
const NOISE_SHARE: f64 = 0.2;

/// What is left over at one instant, and where the motion then is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Time, s.
    pub t: f64,
    /// Displacement.
    pub q: f64,
    /// Velocity.
    pub qd: f64,
    /// What the law leaves over of the force, in units of F.
    pub residual: f64,
    /// Its variance from the sensors' noise.
    pub noise: f64,
    /// The excitation, of free motion the inertia force.
    pub force: f64,
}

/// What is left over along one piece of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Left {
    /// Position of the recording.
    pub recording: usize,
    /// Time from one place to the next, s.
    pub interval: f64,
    /// Places, in the order of time.
    pub places: Vec<Place>,
}

/// What the law leaves over along every piece; windows are at most `window` s long. `inertia` is its position among the
/// coefficients, where the law has one.
pub fn left_over(records: &[Record], coefficients: &[f64], inertia: Option<usize>, window: f64) -> Vec<Left> {
    let of = |(index, record): (usize, &Record)| {
        let windows = choose(record, coefficients, window);
        let piece = |prepared: &Prepared| Left {
            recording: index,
            interval: windows.stride as f64 * record.sample_time,
            places: places(record, prepared, windows, coefficients, inertia),
        };
        record.pieces.iter().map(piece).collect::<Vec<_>>()
    };
    records.iter().enumerate().flat_map(of).filter(|left| !left.places.is_empty()).collect()
}

/// The shortest window in which noise is a small share.
fn choose(record: &Record, coefficients: &[f64], window: f64) -> Windows {
    let longest = record.windows(window);
    let shorter = PARTS.into_iter().map(|part| (longest.samples / part).max(FEWEST).min(longest.samples));
    let clear = |windows: &Windows| {
        let (mut residual, mut noise) = (0.0, 0.0);
        for prepared in &record.pieces {
            residual += prepared.rows(*windows).residuals(coefficients).iter().map(|r| r * r).sum::<f64>();
            noise += prepared.noise(*windows, coefficients, record.noise).iter().sum::<f64>();
        }
        noise < NOISE_SHARE * residual
    };
    let windows = shorter.map(|samples| Windows { samples, stride: (samples / 4).max(1) });
    // noise is looked at in every tenth window only: it is a mean
    let sparse = |windows: &Windows| clear(&Windows { stride: 10 * windows.stride, ..*windows });
    windows.into_iter().find(sparse).unwrap_or(longest)
}

fn places(
    record: &Record,
    prepared: &Prepared,
    windows: Windows,
    coefficients: &[f64],
    inertia: Option<usize>,
) -> Vec<Place> {
    let rows = prepared.rows(windows);
    let residuals = rows.residuals(coefficients);
    let noise = prepared.noise(windows, coefficients, record.noise);
    let place = |index: usize| {
        let centre = rows.centre[index];
        let force = match inertia {
            Some(inertia) if !record.forced => rows.row(index)[inertia] * coefficients[inertia],
            _ => rows.right[index],
        };
        Place {
            t: prepared.piece.t[centre],
            q: prepared.motion.q[centre],
            qd: prepared.motion.qd[centre],
            residual: residuals[index] / rows.area,
            noise: noise[index] / (rows.area * rows.area),
            force: force / rows.area,
        }
    };
    (0..rows.len()).map(place).collect()
}
