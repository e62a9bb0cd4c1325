//! A term of the law as series along a measured motion, each against φ, φ' or φ''.

use super::trajectory::Trajectory;
use crate::diagnose::piece::Piece;
use crate::law::{self, Expression, Monomial, Term, term_series};

/// Points at which the mean about a reversal of the velocity is taken.
const PARTS: usize = 16;

/// One series of a term: what stands against a derivative of φ, and its slopes by the readings of q and q̇.
#[derive(Clone, Debug)]
pub struct Series {
    /// Which derivative of φ.
    pub order: usize,
    /// One value per sample.
    pub values: Vec<f64>,
    /// Its slopes by the reading of q and of q̇; `None` for 0.
    pub slopes: [Option<Vec<f64>>; 2],
}

/// The force of a term at every sample, without what multiplies q̈: the one place that knows how a term follows from a
/// motion.
fn force_series(term: Term, q: &[f64], qd: &[f64], excitation: &[f64]) -> Vec<f64> {
    q.iter().zip(qd).zip(excitation).map(|((q, qd), excitation)| term.force(*q, *qd, *excitation)).collect()
}

/// Half the jump of a term's force at every sample whose velocity is no further from 0 than √3 std of what is known of
/// it: then the instant of a reversal is uncertain by as much as a uniform distribution over those samples says. Empty
/// for a force that does not jump.
pub(super) fn doubt(term: Term, motion: &Trajectory) -> Vec<f64> {
    if !matches!(term, Term::Effect(effect) if effect.is_pointwise()) {
        return Vec::new();
    }
    let near = (3.0 * motion.velocity_variance).sqrt();
    let jump = |q: f64| 0.5 * (term.force(q, f64::MIN_POSITIVE, 0.0) - term.force(q, -f64::MIN_POSITIVE, 0.0)).abs();
    let pairs = motion.q.iter().zip(&motion.qd);
    let doubt: Vec<f64> = pairs.map(|(q, qd)| if qd.abs() <= near { jump(*q) } else { 0.0 }).collect();
    if doubt.iter().all(|jump| *jump == 0.0) { Vec::new() } else { doubt }
}

/// Variance of ∫ f φ dt where the force is uniform within ± `doubt` over every run of samples.
pub(super) fn jumped(phi: &[f64], doubt: &[f64]) -> f64 {
    let (mut variance, mut run) = (0.0, 0.0);
    for (phi, doubt) in phi.iter().zip(doubt) {
        if *doubt > 0.0 {
            run += phi * doubt;
        } else {
            variance += run * run / 3.0;
            run = 0.0;
        }
    }
    variance + run * run / 3.0
}

/// A term as series against φ and its derivatives. Products of powers take the readings themselves, whose noise is
/// known; effects, which may jump, the smoothed motion.
pub(super) fn series(term: Term, expressions: &[Expression], piece: &Piece, motion: &Trajectory) -> Vec<Series> {
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

/// The force of an effect at every sample; where the velocity reverses next to a sample, so that a force may jump
/// there, its mean between the middles of the intervals on both sides.
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
