//! Normal equations, columns scaled to unit diagonal.

use nalgebra::{DMatrix, DVector};

/// A step and the covariance behind it.
pub(super) struct Solved {
    pub(super) step: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
}

/// Solves information · step = score, columns scaled to unit diagonal, by pseudo-inverse. None where a run left no numbers: the singular
/// value decomposition of those would not end.
pub(super) fn solve(information: &DMatrix<f64>, score: &DVector<f64>) -> Option<Solved> {
    solve_damped(information, score, 0.0)
}

/// The same with that part of each diagonal added to it; the covariance is that of the solution without.
pub(super) fn solve_damped(information: &DMatrix<f64>, score: &DVector<f64>, damping: f64) -> Option<Solved> {
    let n = score.len();
    if !information.iter().chain(score.iter()).all(|value| value.is_finite()) {
        return None;
    }
    if n == 0 {
        return Some(Solved { step: DVector::zeros(0), covariance: DMatrix::zeros(0, 0) });
    }
    let scale = DVector::from_fn(n, |row, _| {
        let diagonal = information[(row, row)];
        if diagonal > 0.0 { diagonal.sqrt().recip() } else { 0.0 }
    });
    let scaled = DMatrix::from_fn(n, n, |row, column| information[(row, column)] * scale[row] * scale[column]);
    let unscaled = |inverse: &DMatrix<f64>| {
        DMatrix::from_fn(n, n, |row, column| inverse[(row, column)] * scale[row] * scale[column])
    };
    let covariance = unscaled(&scaled.clone().pseudo_inverse(1e-12).ok()?);
    let step = match damping {
        0.0 => &covariance * score,
        _ => unscaled(&(scaled + DMatrix::identity(n, n) * damping).pseudo_inverse(1e-12).ok()?) * score,
    };
    step.iter().all(|value| value.is_finite()).then_some(Solved { step, covariance })
}
