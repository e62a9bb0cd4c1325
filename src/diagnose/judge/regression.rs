//! Huber's regression by reweighting (Huber, Robust Statistics, Wiley 1981, ch. 7): a bad stretch of the record pulls
//! no harder than a good one.

use crate::diagnose::products::dot;
use nalgebra::{DMatrix, DVector};

/// Residual ÷ robust std beyond which an equation's pull stays: 95 % of the efficiency of least squares under Gaussian
/// noise.
const THRESHOLD: f64 = 1.345;

/// Median of |x| ÷ std of Gaussian x.
const MEDIAN: f64 = 0.6745;

/// Times that weights are renewed: each changes the law by less than the one before.
const ROUNDS: usize = 3;

/// Part of a scaled Gram matrix's largest singular value below which a direction is not determined.
const RANK: f64 = 1e-10;

/// Sums of weighted products of columns and target.
#[derive(Clone, Debug)]
pub(super) struct Normal {
    pub(super) gram: DMatrix<f64>,
    pub(super) moment: DVector<f64>,
}

impl Normal {
    pub(super) fn of(columns: &[&[f64]], target: &[f64], weights: &[f64]) -> Normal {
        let p = columns.len();
        let (mut gram, mut moment) = (DMatrix::zeros(p, p), DVector::zeros(p));
        let mut weighted = vec![0.0; target.len()];
        for a in 0..p {
            weighted.iter_mut().zip(columns[a]).zip(weights).for_each(|((own, value), weight)| *own = value * weight);
            moment[a] = dot(&weighted, target);
            for b in a..p {
                gram[(a, b)] = dot(&weighted, columns[b]);
                gram[(b, a)] = gram[(a, b)];
            }
        }
        Normal { gram, moment }
    }

    /// The inverse, columns scaled to unit diagonal; directions that nothing determines are left out.
    pub(super) fn inverse(&self) -> Option<DMatrix<f64>> {
        let p = self.moment.len();
        let scale = |index: usize| {
            let diagonal: f64 = self.gram[(index, index)];
            if diagonal > 0.0 { diagonal.sqrt().recip() } else { 0.0 }
        };
        let scale: Vec<f64> = (0..p).map(scale).collect();
        let scaled = DMatrix::from_fn(p, p, |a, b| self.gram[(a, b)] * scale[a] * scale[b]);
        if !scaled.iter().all(|value| value.is_finite()) {
            return None;
        }
        let inverse = scaled.pseudo_inverse(RANK).ok()?;
        Some(DMatrix::from_fn(p, p, |a, b| inverse[(a, b)] * scale[a] * scale[b]))
    }

    /// The solution; empty where there are no columns.
    pub(super) fn solve(&self) -> Option<Vec<f64>> {
        if self.moment.is_empty() {
            return Some(Vec::new());
        }
        let solution = self.inverse()? * &self.moment;
        solution.iter().all(|value| value.is_finite()).then(|| solution.iter().copied().collect())
    }
}

/// Target − columns · solution.
pub(super) fn residuals(columns: &[&[f64]], target: &[f64], solution: &[f64]) -> Vec<f64> {
    let mut left = target.to_vec();
    for (column, coefficient) in columns.iter().zip(solution) {
        left.iter_mut().zip(*column).for_each(|(left, value)| *left -= coefficient * value);
    }
    left
}

/// Huber's weights of residuals, with the robust std of those that count (weight above 0 in `counted`).
pub(super) fn huber(residuals: &[f64], counted: &[f64]) -> Vec<f64> {
    let pairs = || residuals.iter().zip(counted);
    let mut sizes: Vec<f64> = pairs().filter(|(_, counted)| **counted > 0.0).map(|(left, _)| left.abs()).collect();
    if sizes.is_empty() {
        return counted.to_vec();
    }
    let middle = sizes.len() / 2;
    let scale = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 / MEDIAN;
    if scale <= 0.0 {
        return counted.to_vec();
    }
    pairs().map(|(left, counted)| counted * (THRESHOLD * scale / left.abs()).min(1.0)).collect()
}

/// A robust solution and the weights that it ends with; `counted` is 1 for an equation that is used and 0 for one that
/// is not. None with fewer equations than twice the unknowns.
pub(super) fn fit(columns: &[&[f64]], target: &[f64], counted: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let used = counted.iter().filter(|counted| **counted > 0.0).count();
    if used < 2 * columns.len() + 2 {
        return None;
    }
    let mut weights = counted.to_vec();
    let mut solution = Normal::of(columns, target, &weights).solve()?;
    for _ in 0..ROUNDS {
        weights = huber(&residuals(columns, target, &solution), counted);
        solution = Normal::of(columns, target, &weights).solve()?;
    }
    Some((solution, weights))
}

/// Adds a column times a factor to another.
pub(super) fn add(column: &mut super::record::Column, other: &super::record::Column, factor: f64) {
    for (rows, more) in column.iter_mut().zip(other) {
        rows.iter_mut().zip(more).for_each(|(value, more)| *value += factor * more);
    }
}
