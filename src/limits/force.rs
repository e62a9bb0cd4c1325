//! Limits of a law whose output is F: readings F_k = Σ θ_j f_j(q_k, q̇_k) + noise, the motion known.
//!
//! The Fisher information is J = Σ φφᵀ/σ², φ the features; a known change is seen once Σ (old − new force)²/(2σ²)
//! passes the level.

use super::bound::{Bound, GROWTH, SETTLED_ERROR};
use super::detection::{Detection, SHARE, STARTS};
use super::error::LimitsError;
use super::law::Law;
use crate::law::State;
use nalgebra::DMatrix;

/// Where the motion was at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imposed {
    /// Time, s.
    pub t: f64,
    /// Displacement and velocity.
    pub state: State,
}

/// The Cramér–Rao bound of a force law along a motion, `std` that of the force's noise, N.
///
/// # Errors
/// [`LimitsError::Noise`] where that is not positive.
pub fn force_bound(law: &Law, motion: &[Imposed], std: f64) -> Result<Bound, LimitsError> {
    check(std)?;
    let n = law.sought().len();
    let mut information = DMatrix::zeros(n, n);
    let mut features = vec![0.0; n];
    let mut shortest = None;
    let mut next_look = n.max(2);
    for (index, instant) in motion.iter().enumerate() {
        for (feature, sought) in features.iter_mut().zip(law.sought()) {
            *feature = law.terms()[*sought].force(instant.state.q, instant.state.qd, 0.0) / std;
        }
        for row in 0..n {
            (0..n).for_each(|column| information[(row, column)] += features[row] * features[column]);
        }
        if shortest.is_none() && index + 1 >= next_look {
            next_look = index + 2 + (GROWTH * index as f64) as usize;
            let error = Bound::of(law, &information).relative_error;
            shortest = error.filter(|error| *error < SETTLED_ERROR).map(|_| instant.t - motion[0].t);
        }
    }
    Ok(Bound { shortest_record: shortest, ..Bound::of(law, &information) })
}

/// How soon a change from one force law to another is seen; `level` in nats.
///
/// # Errors
/// [`LimitsError::Noise`] where the noise is not positive.
pub fn force_detection(
    old: &Law,
    new: &Law,
    motion: &[Imposed],
    std: f64,
    level: f64,
) -> Result<Detection, LimitsError> {
    check(std)?;
    let force = |law: &Law, State { q, qd }: State| -> f64 {
        law.terms().iter().zip(law.coefficients()).map(|(term, value)| value * term.force(q, qd, 0.0)).sum()
    };
    let evidence: Vec<f64> = motion
        .iter()
        .map(|instant| 0.5 * ((force(old, instant.state) - force(new, instant.state)) / std).powi(2))
        .collect();
    let last = (SHARE * motion.len() as f64).ceil() as usize;
    let stride = last.div_ceil(STARTS).max(1);
    let delay = |start: usize| {
        let mut sum = 0.0;
        let seen = evidence[start..].iter().position(|evidence| {
            sum += evidence;
            sum > level
        });
        seen.map(|after| motion[start + after].t - motion[start].t)
    };
    Ok(Detection::of(&(0..last).step_by(stride).map(delay).collect::<Vec<_>>()))
}

fn check(std: f64) -> Result<(), LimitsError> {
    if std > 0.0 && std.is_finite() { Ok(()) } else { Err(LimitsError::Noise { channel: "F", std }) }
}
