//! The law in weak form over windows of one length.
//!
//! Over a window the residual of the law is `∫ (Σ θ_j f_j − F) φ dt`; q̈ and what is linear in q̇ are integrated by parts, as
//! [`crate::weak`] says. Every term is therefore a set of series, one value per sample, against φ, φ' or φ''. Sensor noise of std
//! (σ_q, σ_q̇) gives the residual the variance Σ_k (∂/∂q_k)² σ_q² + (∂/∂q̇_k)² σ_q̇².

use super::piece::Piece;
use super::trajectory::Trajectory;
use crate::law::{self, Expression, Hold, Monomial, Term, term_series};
use crate::weak::Variation;

/// The variation: 4 s (1 − s) to the power 4.
const VARIATION: Variation = Variation::Polynomial { power: 4 };

/// Gauss–Legendre points on 0 ≤ x ≤ 1, exact for polynomials of degree 5.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Share of a sample's distance by which a window's times may differ from another's and still share its weights.
const SAME_TIMES: f64 = 1e-4;

/// Points at which the mean about a reversal of the velocity is taken.
const PARTS: usize = 16;

/// One series of a term: what stands against a derivative of φ, and its slopes by the readings of q and q̇.
#[derive(Clone, Debug)]
struct Series {
    order: usize,
    values: Vec<f64>,
    slopes: [Option<Vec<f64>>; 2],
}

/// A piece with the series of a set of terms.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The piece.
    pub piece: Piece,
    /// Its motion.
    pub motion: Trajectory,
    terms: Vec<Vec<Series>>,
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
        let terms = terms.iter().map(|term| series(*term, expressions, &piece, &motion)).collect();
        Prepared { piece, motion, terms }
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
            variances.push((0..2).filter(|channel| measured[*channel].is_some()).map(of).sum());
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

/// The force of a term at every sample, without what multiplies q̈: the one place that knows how a term follows from a motion.
pub(super) fn force_series(term: Term, q: &[f64], qd: &[f64], excitation: &[f64]) -> Vec<f64> {
    q.iter().zip(qd).zip(excitation).map(|((q, qd), excitation)| term.force(*q, *qd, *excitation)).collect()
}

/// A term as series against φ and its derivatives. Products of powers take the readings themselves, whose noise is known; effects, which
/// may jump, the smoothed motion.
fn series(term: Term, expressions: &[Expression], piece: &Piece, motion: &Trajectory) -> Vec<Series> {
    let q = piece.q.as_ref().unwrap_or(&motion.q);
    let qd = piece.qd.as_ref().unwrap_or(&motion.qd);
    let one = |order, values, slopes| vec![Series { order, values, slopes }];
    match term {
        Term::Inertia if piece.qd.is_some() => {
            one(1, qd.iter().map(|qd| -qd).collect(), [None, Some(vec![-1.0; qd.len()])])
        }
        Term::Inertia => one(2, q.clone(), [Some(vec![1.0; q.len()]), None]),
        Term::Monomial(Monomial { q: power, qd: 1, excitation: 0 }) => {
            let next = i32::from(power) + 1;
            let values = q.iter().map(|q| -q.powi(next) / f64::from(next)).collect();
            one(1, values, [Some(q.iter().map(|q| -q.powi(next - 1)).collect()), None])
        }
        Term::Monomial(_) => {
            let gradient = |k: usize| term.gradient(q[k], qd[k], piece.excitation[k]);
            let by_q = (0..q.len()).map(|k| gradient(k).0).collect();
            let by_qd = (0..q.len()).map(|k| gradient(k).1).collect();
            one(0, force_series(term, q, qd, &piece.excitation), [Some(by_q), Some(by_qd)])
        }
        Term::Effect(_) if term.mass(1.0) != term.mass(0.0) => varying_mass(term, piece, motion),
        Term::Effect(effect) if effect.is_pointwise() => one(0, reversed_series(term, piece, motion), [None, None]),
        Term::Effect(_) | Term::Expression(_) => {
            let Piece { t, excitation, hold, .. } = piece;
            let along = law::Trajectory { t, q: &motion.q, qd: &motion.qd, excitation, hold: *hold };
            one(0, term_series(term, expressions, &along), [None, None])
        }
    }
}

/// The force of an effect at every sample; where the velocity reverses next to a sample, so that a force may jump there, its mean between the
/// middles of the intervals on both sides.
fn reversed_series(term: Term, piece: &Piece, motion: &Trajectory) -> Vec<f64> {
    let (q, qd, excitation) = (&motion.q, &motion.qd, &piece.excitation);
    let mut series = force_series(term, q, qd, excitation);
    for k in 1..qd.len().saturating_sub(1) {
        if qd[k - 1] * qd[k] > 0.0 && qd[k] * qd[k + 1] > 0.0 {
            continue;
        }
        let force = |part: usize| {
            let x = (part as f64 + 0.5) / PARTS as f64 - 0.5;
            let other = if x < 0.0 { k - 1 } else { k + 1 };
            let at = |values: &[f64]| values[k] + x.abs() * (values[other] - values[k]);
            term.force(at(q), at(qd), excitation[k])
        };
        series[k] = (0..PARTS).map(force).sum::<f64>() / PARTS as f64;
    }
    series
}

/// μ(q) q̈ + f, its first part integrated by parts: (μ q̇)' − μ' q̇² + f.
fn varying_mass(term: Term, piece: &Piece, motion: &Trajectory) -> Vec<Series> {
    let (q, qd) = (&motion.q, &motion.qd);
    let momentum = q.iter().zip(qd).map(|(q, qd)| -term.mass(*q) * qd).collect();
    let own = force_series(term, q, qd, &piece.excitation);
    let rest = own.iter().zip(q.iter().zip(qd)).map(|(force, (q, qd))| force - 2.0 * q * qd * qd).collect();
    vec![
        Series { order: 1, values: momentum, slopes: [None, None] },
        Series { order: 0, values: rest, slopes: [None, None] },
    ]
}

fn dot(weights: &[f64], values: &[f64]) -> f64 {
    weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
}
