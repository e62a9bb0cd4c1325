//! The law in weak form over windows of one length.
//!
//! Over a window the residual of the law is `∫ (Σ θ_j f_j − F) φ dt`; q̈ and what is linear in q̇ are integrated by
//! parts, as [`crate::weak`] says. Every term is therefore a set of series, one value per sample, against φ, φ' or φ''.
//! Sensor noise of std (σ_q, σ_q̇) gives the residual the variance Σ_k (∂/∂q_k)² σ_q² + (∂/∂q̇_k)² σ_q̇².

use super::series::{Series, doubt, jumped, series};
use super::trajectory::Trajectory;
use crate::diagnose::piece::Piece;
use crate::law::{Expression, GAUSS, Hold, Term};
use crate::weak::Variation;

/// The variation: 4 s (1 − s) to the power 4.
const VARIATION: Variation = Variation::Polynomial { power: 4 };

/// Share of a sample's distance by which a window's times may differ from another's and still share its weights.
const SAME_TIMES: f64 = 1e-4;

/// A piece with the series of a set of terms.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The piece.
    pub piece: Piece,
    /// Its motion.
    pub motion: Trajectory,
    terms: Vec<Vec<Series>>,
    /// By term, half the jump of its force where the velocity may have either sign; empty for a force that does not
    /// jump.
    doubt: Vec<Vec<f64>>,
}

/// The weak equations of a piece, one for each window.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    /// Number of terms.
    pub width: usize,
    /// ∫ f_j φ dt, one row of `width` for each window.
    pub left: Vec<f64>,
    /// ∫ F φ dt.
    pub right: Vec<f64>,
    /// Sample in the window's middle.
    pub centre: Vec<usize>,
    /// ∫ φ² dt, s.
    pub norm: f64,
    /// ∫ φ dt, s.
    pub area: f64,
}

/// φ and its derivatives at the samples of a window, with the weights of quadrature.
struct Weights {
    times: Vec<f64>,
    phi: [Vec<f64>; 3],
    excitation: Vec<f64>,
    norm: f64,
    area: f64,
}

/// Windows of `samples`, one every `stride`, over `count` samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Windows {
    /// Samples in a window.
    pub samples: usize,
    /// Samples from one window to the next.
    pub stride: usize,
}

impl Windows {
    fn starts(self, count: usize) -> impl Iterator<Item = usize> {
        let last = (count + 1).saturating_sub(self.samples);
        (0..last).step_by(self.stride.max(1))
    }
}

impl Prepared {
    /// The series of these terms along a piece's motion.
    pub fn new(piece: Piece, motion: Trajectory, terms: &[Term], expressions: &[Expression]) -> Prepared {
        let doubt = terms.iter().map(|term| doubt(*term, &motion)).collect();
        let terms = terms.iter().map(|term| series(*term, expressions, &piece, &motion)).collect();
        Prepared { piece, motion, terms, doubt }
    }

    /// The equation of every window.
    pub fn rows(&self, windows: Windows) -> Rows {
        let mut rows = Rows { width: self.terms.len(), ..Rows::default() };
        self.visit(windows, |first, weights| {
            for term in &self.terms {
                let integrals = term.iter().map(|part| dot(&weights.phi[part.order], &part.values[first..]));
                rows.left.push(integrals.sum());
            }
            rows.right.push(dot(&weights.excitation, &self.piece.excitation[first..]));
            rows.centre.push(first + windows.samples / 2);
            (rows.norm, rows.area) = (weights.norm, weights.area);
        });
        rows
    }

    /// The variance of every window's residual under the law with these coefficients and sensors of this noise (std).
    pub fn noise(&self, windows: Windows, coefficients: &[f64], noise: [f64; 2]) -> Vec<f64> {
        let slopes = [0, 1].map(|channel| self.slopes(channel, coefficients));
        let mut variances = Vec::new();
        self.visit(windows, |first, weights| {
            let of = |channel: usize| {
                let slope = |k: usize| -> f64 {
                    (0..3).map(|order| weights.phi[order][k] * slopes[channel][order][first + k]).sum()
                };
                (0..windows.samples).map(|k| slope(k).powi(2)).sum::<f64>() * noise[channel].powi(2)
            };
            let measured = self.piece.measured();
            let sensors: f64 = (0..2).filter(|channel| measured[*channel].is_some()).map(of).sum();
            let jumps = self.doubt.iter().zip(coefficients).filter(|(doubt, _)| !doubt.is_empty());
            let jumps = jumps.map(|(doubt, c)| c * c * jumped(&weights.phi[0], &doubt[first..]));
            variances.push(sensors + jumps.sum::<f64>());
        });
        variances
    }

    /// The law's slope by the readings of a channel, against φ, φ' and φ''.
    fn slopes(&self, channel: usize, coefficients: &[f64]) -> [Vec<f64>; 3] {
        let mut sums = [0, 1, 2].map(|_| vec![0.0; self.piece.len()]);
        for (term, coefficient) in self.terms.iter().zip(coefficients) {
            for part in term {
                let Some(slopes) = &part.slopes[channel] else { continue };
                sums[part.order].iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += coefficient * slope);
            }
        }
        sums
    }

    fn visit(&self, windows: Windows, mut each: impl FnMut(usize, &Weights)) {
        let t = &self.piece.t;
        let mut kept: Option<Weights> = None;
        for first in windows.starts(t.len()) {
            let times = &t[first..first + windows.samples];
            let weights = match kept.take() {
                Some(weights) if weights.serve(times) => weights,
                _ => Weights::new(times, self.piece.hold),
            };
            each(first, &weights);
            kept = Some(weights);
        }
    }
}

impl Rows {
    /// Number of windows.
    pub fn len(&self) -> usize {
        self.right.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.right.is_empty()
    }

    /// The integrals of the terms in one window.
    pub fn row(&self, index: usize) -> &[f64] {
        &self.left[index * self.width..(index + 1) * self.width]
    }

    /// The largest integral of a term.
    pub fn largest(&self, term: usize) -> f64 {
        let integrals = self.left.iter().skip(term).step_by(self.width);
        integrals.fold(0.0, |largest: f64, value| largest.max(value.abs()))
    }

    /// ∫ (Σ θ_j f_j − F) φ dt of every window.
    pub fn residuals(&self, coefficients: &[f64]) -> Vec<f64> {
        (0..self.len()).map(|index| dot(coefficients, self.row(index)) - self.right[index]).collect()
    }
}

impl Weights {
    fn new(t: &[f64], hold: Hold) -> Weights {
        let last = t.len() - 1;
        let length = t[last] - t[0];
        let mut phi = [0, 1, 2].map(|_| Vec::with_capacity(t.len()));
        let (mut norm, mut area) = (0.0, 0.0);
        for k in 0..t.len() {
            let [value, slope, curvature] = VARIATION.at((t[k] - t[0]) / length);
            let width = 0.5 * (t[(k + 1).min(last)] - t[k.saturating_sub(1)]);
            phi[0].push(width * value);
            phi[1].push(width * slope / length);
            phi[2].push(width * curvature / (length * length));
            norm += width * value * value;
            area += width * value;
        }
        let excitation = if hold == Hold::BandLimited { phi[0].clone() } else { held(t, hold) };
        Weights { times: t.iter().map(|time| time - t[0]).collect(), phi, excitation, norm, area }
    }

    /// Whether a window of these times may use them.
    fn serve(&self, t: &[f64]) -> bool {
        let allowed = SAME_TIMES * self.times[1];
        self.times.iter().zip(t).all(|(kept, time)| (time - t[0] - kept).abs() <= allowed)
    }
}

/// What each sample of a held or linear excitation has of ∫ F φ dt.
fn held(t: &[f64], hold: Hold) -> Vec<f64> {
    let length = t[t.len() - 1] - t[0];
    let mut weights = vec![0.0; t.len()];
    for (k, pair) in t.windows(2).enumerate() {
        let dt = pair[1] - pair[0];
        for (x, weight) in GAUSS {
            let value = dt * weight * VARIATION.at((pair[0] + x * dt - t[0]) / length)[0];
            let share = if hold == Hold::Zero { 0.0 } else { x };
            weights[k] += (1.0 - share) * value;
            weights[k + 1] += share * value;
        }
    }
    weights
}

fn dot(weights: &[f64], values: &[f64]) -> f64 {
    weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
}
