//! Whether noise in the readings biases the coefficients: even and odd readings as each other's instruments.
//!
//! Least squares with noise in its columns errs by the square of noise ÷ signal (errors in variables). Columns from the
//! odd readings hold the same motion and other noise, so that Zᵀ(y − X θ) = 0 with X and y of the even ones, Z of the
//! odd ones, has no such bias (Söderström and Stoica, Instrumental Variable Methods for System Identification, Springer
//! 1983, ch. 3).

use super::equation::Equation;
use super::record::Record;
use super::regression;
use super::significance::Blocks;
use super::windows::PRINCIPAL;
use nalgebra::{DMatrix, DVector};

/// A solution and its std.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Instrumented {
    /// The regression's solution with instruments, the mean of both ways round.
    pub(in crate::diagnose) solution: Vec<f64>,
    /// Std of each of its entries, over blocks.
    pub(in crate::diagnose) std: Vec<f64>,
}

/// The law's equation solved with instruments: `halves` are the same law's on the even and on the odd readings. None
/// where they do not determine it.
pub(in crate::diagnose) fn instrumented(
    record: &Record,
    halves: &[Equation; 2],
    blocks: &Blocks,
) -> Option<Instrumented> {
    let [one, other] =
        [solved(record, &halves[0], &halves[1], blocks)?, solved(record, &halves[1], &halves[0], blocks)?];
    let mean = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect::<Vec<f64>>();
    Some(Instrumented { solution: mean(&one.solution, &other.solution), std: mean(&one.std, &other.std) })
}

fn solved(record: &Record, own: &Equation, instruments: &Equation, blocks: &Blocks) -> Option<Instrumented> {
    let (columns, right) = (own.columns(PRINCIPAL), &own.right[PRINCIPAL]);
    let instruments = instruments.columns(PRINCIPAL);
    let (_, weights) = regression::fit(&columns, right, &vec![1.0; right.len()])?;
    let p = columns.len();
    let product =
        |a: &[f64], b: &[f64]| a.iter().zip(b).zip(&weights).map(|((a, b), weight)| a * b * weight).sum::<f64>();
    let scale: Vec<f64> = columns.iter().map(|column| product(column, column).sqrt().max(f64::MIN_POSITIVE)).collect();
    let cross = DMatrix::from_fn(p, p, |a, b| product(instruments[a], columns[b]) / (scale[a] * scale[b]));
    let inverse = cross.try_inverse()?;
    let moment = DVector::from_fn(p, |a, _| product(instruments[a], right) / scale[a]);
    let solution: Vec<f64> = (&inverse * moment).iter().zip(&scale).map(|(value, scale)| value / scale).collect();
    let left = regression::residuals(&columns, right, &solution);
    let mut scores = vec![DVector::<f64>::zeros(p); blocks.len()];
    for (row, (left, weight)) in left.iter().zip(&weights).enumerate() {
        let score = &mut scores[blocks.of(record.windows[PRINCIPAL].centre(row))];
        (0..p).for_each(|index| score[index] += weight * left * instruments[index][row] / scale[index]);
    }
    let meat = scores.iter().fold(DMatrix::zeros(p, p), |sum, score| sum + score * score.transpose());
    let covariance = &inverse * meat * inverse.transpose();
    let std: Vec<f64> = (0..p).map(|index| covariance[(index, index)].max(0.0).sqrt() / scale[index]).collect();
    solution.iter().chain(&std).all(|value| value.is_finite()).then_some(Instrumented { solution, std })
}
