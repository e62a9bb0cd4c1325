//! Coefficients of a law with a covariance that holds whatever the error is like.
//!
//! The robust regression's covariance is the sandwich A⁻¹ B A⁻¹ with B summed over blocks that are longer than the
//! residual is correlated (Liang and Zeger, Biometrika 73 (1986), 13).

use super::equation::Equation;
use super::record::Record;
use super::regression::{self, Normal};
use super::significance::Blocks;
use super::windows::{COUNT, PRINCIPAL};
use nalgebra::{DMatrix, DVector};

/// A law's coefficients.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Estimate {
    /// One for each term of the equation.
    pub(in crate::diagnose) coefficients: Vec<f64>,
    /// Their std; 0 where held.
    pub(in crate::diagnose) std: Vec<f64>,
    /// The regression's solution, by window length.
    pub(in crate::diagnose) solutions: [Vec<f64>; COUNT],
    /// How much later than the equation has it the excitation acted, s, and its std; none without the column that takes
    /// it.
    pub(in crate::diagnose) delay: Option<[f64; 2]>,
}

/// Estimates from the windows of the principal length. `inertia` is that of a free motion. None where the record has
/// too few equations.
pub(in crate::diagnose) fn estimate(
    record: &Record,
    equation: &Equation,
    blocks: &Blocks,
    inertia: f64,
) -> Option<Estimate> {
    let of = |which: usize| {
        let right = &equation.right[which];
        regression::fit(&equation.columns(which), right, &vec![1.0; right.len()])
    };
    let fits = [0, 1, 2].map(of);
    let which = if fits[PRINCIPAL].is_some() { PRINCIPAL } else { 0 };
    let (solution, weights) = fits[which].clone()?;
    let covariance = sandwich(record, equation, blocks, (which, &solution, &weights))?;
    let (coefficients, slopes) = equation.coefficients(&solution, record.forced, inertia);
    let std = slopes.iter().map(|slope| {
        let slope = DVector::from_column_slice(slope);
        (slope.transpose() * &covariance * &slope)[(0, 0)].max(0.0).sqrt()
    });
    let delay = equation
        .delay(&solution)
        .map(|(delay, slope)| [delay, slope * covariance[(solution.len() - 1, solution.len() - 1)].sqrt()]);
    let solutions = fits.map(|fit| fit.map_or_else(|| solution.clone(), |(solution, _)| solution));
    Some(Estimate { std: std.collect(), coefficients, solutions, delay })
}

fn sandwich(
    record: &Record,
    equation: &Equation,
    blocks: &Blocks,
    (which, solution, weights): (usize, &[f64], &[f64]),
) -> Option<DMatrix<f64>> {
    let (columns, right) = (equation.columns(which), &equation.right[which]);
    let inverse = Normal::of(&columns, right, weights).inverse()?;
    let left = regression::residuals(&columns, right, solution);
    let p = columns.len();
    let mut scores = vec![DVector::<f64>::zeros(p); blocks.len()];
    for (row, (left, weight)) in left.iter().zip(weights).enumerate() {
        let score = &mut scores[blocks.of(record.windows[which].centre(row))];
        (0..p).for_each(|index| score[index] += weight * left * columns[index][row]);
    }
    let count = blocks.len() as f64;
    let meat = scores.iter().fold(DMatrix::zeros(p, p), |sum, score| sum + score * score.transpose());
    // as many scores as unknowns are used up by the fit
    let correction = count / (count - p as f64).max(1.0);
    Some(&inverse * meat * &inverse * correction)
}
