//! Normal equations, columns scaled to unit diagonal.

use crate::estimation::Information;
use crate::limits::ROUNDING;
use nalgebra::{DMatrix, DVector};

/// A step and the covariance behind it.
pub(super) struct Solved {
    pub(super) step: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
}

/// Solves information · step = score, columns scaled to unit diagonal, by pseudo-inverse. None where a run left no numbers: the singular
/// value decomposition of those would not end.
pub(super) fn solve(information: &Information) -> Option<Solved> {
    solve_damped(information, 0.0)
}

/// The same with that part of each diagonal added to it; the covariance is that of the solution without.
pub(super) fn solve_damped(information: &Information, damping: f64) -> Option<Solved> {
    let n = information.n;
    if !information.is_finite() {
        return None;
    }
    if n == 0 {
        return Some(Solved { step: DVector::zeros(0), covariance: DMatrix::zeros(0, 0) });
    }
    let scale = DVector::from_fn(n, |row, _| {
        let diagonal = information.entry(row, row);
        if diagonal > 0.0 { diagonal.sqrt().recip() } else { 0.0 }
    });
    let scaled = DMatrix::from_fn(n, n, |row, column| information.entry(row, column) * scale[row] * scale[column]);
    let score = DVector::from_column_slice(&information.score);
    let unscaled = |inverse: &DMatrix<f64>| {
        DMatrix::from_fn(n, n, |row, column| inverse[(row, column)] * scale[row] * scale[column])
    };
    let covariance = unscaled(&scaled.clone().pseudo_inverse(ROUNDING).ok()?);
    let step = match damping {
        0.0 => &covariance * &score,
        _ => unscaled(&(scaled + DMatrix::identity(n, n) * damping).pseudo_inverse(ROUNDING).ok()?) * &score,
    };
    step.iter().all(|value| value.is_finite()).then_some(Solved { step, covariance })
}
