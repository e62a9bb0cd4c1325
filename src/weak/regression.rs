//! The overdetermined system of weak equations, solved by pseudo-inverse.
//!
//! Rows enter a triangular factor one by one (Givens rotations), so that memory and cost per row do not grow with their
//! number; the factor has the singular values of the whole system (Golub and Van Loan, *Matrix Computations*, 5.4).

use crate::law::Model;
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

/// Singular values below this fraction of the largest, columns scaled to unit length, count as zero: rounding of
/// the factor leaves 10⁻¹⁴, readings of 16 bits 10⁻⁵ of a direction.
const RANK_TOLERANCE: f64 = 1e-9;

/// Square of an unknown's share in open directions below which the rows determine it: its value then moves by 10⁻³ of
/// them.
const OPEN: f64 = 1e-6;

/// Share in an open direction from which an unknown is named as part of it: the root of [`OPEN`].
const NAMED: f64 = 1e-3;

/// A combination of unknowns that the rows leave open: the unknowns with a share in it.
pub type Direction = Vec<usize>;

/// U, singular values, Vᵀ.
type Decomposed<const N: usize> = (SMatrix<f64, N, N>, SVector<f64, N>, SMatrix<f64, N, N>);

/// nalgebra's singular value decomposition at one concrete size.
macro_rules! decomposer {
    () => {
        |matrix| {
            let svd = matrix.try_svd(true, true, f64::EPSILON, 1000)?;
            Some((svd.u?, svd.singular_values, svd.v_t?))
        }
    };
}

/// The triangular factor of rows \[a | b\] of a system a·θ = b.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Regression {
    n: usize,
    /// (n + 1) × (n + 1), upper triangle, row-major.
    factor: Vec<f64>,
    row: Vec<f64>,
    rows: u32,
}

/// A least-squares solution of minimal norm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// θ, n of them, in the units of the rows.
    pub coefficients: Vec<f64>,
    /// Diagonal of (AᵀA)⁺, n: times the residual's variance it is the variance of θ, were the rows independent.
    pub spread: Vec<f64>,
    /// Number of singular values that count.
    pub rank: usize,
    /// Largest ÷ smallest singular value that counts, columns scaled to unit length.
    pub condition: f64,
    /// Whether the rows determine the unknown, n.
    pub determined: Vec<bool>,
    /// Length of the right side ÷ length of the unknown's column, n: the value at which its term alone would be as
    /// large as the right side; infinite for a column of zeros.
    pub reach: Vec<f64>,
    /// RMS of the residual over the rows, in their unit.
    pub residual: f64,
    /// Right singular vectors that do not count, one row of n for each.
    null: Vec<f64>,
}

impl Regression {
    /// A system without rows in `n` ≤ [`Model::MAX_TERMS`] unknowns.
    pub fn new(n: usize) -> Regression {
        Regression { n, factor: vec![0.0; (n + 1) * (n + 1)], row: vec![0.0; n + 1], rows: 0 }
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.factor.fill(0.0);
        self.rows = 0;
    }

    /// Number of rows taken.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Takes the equation `coefficients · θ = right`.
    pub fn add(&mut self, coefficients: &[f64], right: f64) {
        let width = self.n + 1;
        self.row[..self.n].copy_from_slice(coefficients);
        self.row[self.n] = right;
        self.rows += 1;
        for k in 0..width {
            let (pivot, entry) = (self.factor[k * width + k], self.row[k]);
            let radius = pivot.hypot(entry);
            if radius == 0.0 {
                continue;
            }
            let (cos, sin) = (pivot / radius, entry / radius);
            for (kept, new) in self.factor[k * width + k..(k + 1) * width].iter_mut().zip(&mut self.row[k..]) {
                (*kept, *new) = (cos * *kept + sin * *new, cos * *new - sin * *kept);
            }
        }
    }

    /// Solves by pseudo-inverse into `fit`, without allocating.
    pub fn solve(&self, fit: &mut Fit) {
        match self.n {
            0..=4 => self.solve_padded::<4>(fit, decomposer!()),
            5..=8 => self.solve_padded::<8>(fit, decomposer!()),
            9..=12 => self.solve_padded::<12>(fit, decomposer!()),
            13..=16 => self.solve_padded::<16>(fit, decomposer!()),
            _ => self.solve_padded::<{ Model::MAX_TERMS }>(fit, decomposer!()),
        }
    }

    /// The factor padded to a size known at compile time, so that its decomposition stays on the stack.
    fn solve_padded<const N: usize>(
        &self,
        fit: &mut Fit,
        decompose: impl Fn(SMatrix<f64, N, N>) -> Option<Decomposed<N>>,
    ) {
        let (n, width) = (self.n, self.n + 1);
        let entry = |row: usize, column: usize| self.factor[row * width + column];
        let length = |column: usize| (0..=column).map(|row| entry(row, column).powi(2)).sum::<f64>().sqrt();
        let scale = SVector::<f64, N>::from_fn(|column, _| {
            let length = if column < n { length(column) } else { 0.0 };
            if length > 0.0 { length.recip() } else { 0.0 }
        });
        let matrix = SMatrix::<f64, N, N>::from_fn(|row, column| {
            if row <= column && column < n { entry(row, column) * scale[column] } else { 0.0 }
        });
        let right = SVector::<f64, N>::from_fn(|row, _| if row < n { entry(row, n) } else { 0.0 });
        fit.clear();
        let Some((left_vectors, values, right_vectors)) = decompose(matrix) else { return };
        let largest = values.max();
        let counts = |index: usize| values[index] > RANK_TOLERANCE * largest;
        let mut smallest = largest;
        let right_length = length(n);
        for (reach, scale) in fit.reach.iter_mut().zip(scale.iter()) {
            *reach = if *scale > 0.0 { right_length * scale } else { f64::INFINITY };
        }
        for index in (0..N).filter(|index| counts(*index)) {
            let along = left_vectors.column(index).dot(&right) / values[index];
            smallest = smallest.min(values[index]);
            fit.rank += 1;
            for unknown in 0..n {
                let share = right_vectors[(index, unknown)] * scale[unknown];
                fit.coefficients[unknown] += share * along;
                fit.spread[unknown] += (share / values[index]).powi(2);
            }
        }
        fit.condition = if fit.rank > 0 { largest / smallest } else { f64::INFINITY };
        for unknown in 0..n {
            let open: f64 = (0..N).filter(|i| !counts(*i)).map(|i| right_vectors[(i, unknown)].powi(2)).sum();
            fit.determined[unknown] = scale[unknown] > 0.0 && open < OPEN;
        }
        let mut direction = 0;
        for index in (0..N).filter(|index| !counts(*index)) {
            let inside: f64 = (0..n).map(|unknown| right_vectors[(index, unknown)].powi(2)).sum();
            if inside > 0.5 && direction < n {
                for unknown in 0..n {
                    fit.null[direction * n + unknown] = right_vectors[(index, unknown)];
                }
                direction += 1;
            }
        }
        let misfit = right - matrix * scale_down(fit, &scale);
        let rest = entry(n, n).powi(2) + misfit.norm_squared();
        fit.residual = if self.rows > 0 { (rest / f64::from(self.rows)).sqrt() } else { 0.0 };
    }
}

/// The solution in units of scaled columns.
fn scale_down<const N: usize>(fit: &Fit, scale: &SVector<f64, N>) -> SVector<f64, N> {
    SVector::from_fn(|unknown, _| match fit.coefficients.get(unknown) {
        Some(coefficient) if scale[unknown] > 0.0 => coefficient / scale[unknown],
        _ => 0.0,
    })
}

impl Fit {
    /// Room for `n` unknowns.
    pub fn new(n: usize) -> Fit {
        Fit {
            coefficients: vec![0.0; n],
            spread: vec![0.0; n],
            rank: 0,
            condition: f64::INFINITY,
            determined: vec![false; n],
            reach: vec![f64::INFINITY; n],
            residual: 0.0,
            null: vec![0.0; n * n],
        }
    }

    fn clear(&mut self) {
        self.coefficients.fill(0.0);
        self.spread.fill(0.0);
        self.null.fill(0.0);
        self.determined.fill(false);
        self.rank = 0;
        self.condition = f64::INFINITY;
    }

    /// The combinations of unknowns that the rows leave open, each by the unknowns that share in it.
    pub fn open_directions(&self) -> Vec<Direction> {
        let n = self.coefficients.len();
        let members = |row: &[f64]| (0..n).filter(|unknown| row[*unknown].abs() > NAMED).collect::<Vec<_>>();
        self.null.chunks(n.max(1)).map(members).filter(|direction| !direction.is_empty()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(columns: usize, rows: usize, column: impl Fn(usize, f64) -> f64, truth: &[f64]) -> Fit {
        let mut regression = Regression::new(columns);
        for k in 0..rows {
            let x = 0.1 + 0.37 * k as f64;
            let row: Vec<f64> = (0..columns).map(|index| column(index, x)).collect();
            let right = row.iter().zip(truth).map(|(a, b)| a * b).sum();
            regression.add(&row, right);
        }
        let mut fit = Fit::new(columns);
        regression.solve(&mut fit);
        fit
    }

    #[test]
    fn a_full_rank_system_gives_its_truth() {
        let truth = [1.5, -2.0, 300.0, 0.02, 7.0];
        let fit = system(5, 40, |index, x| (x * (index as f64 + 1.0)).sin() * 10f64.powi(index as i32 - 2), &truth);
        assert_eq!(fit.rank, 5);
        for (found, true_value) in fit.coefficients.iter().zip(truth) {
            assert!((found / true_value - 1.0).abs() < 1e-9, "{found} against {true_value}");
        }
        assert!(fit.residual < 1e-9, "{}", fit.residual);
        assert!(fit.determined.iter().all(|determined| *determined));
    }

    #[test]
    fn collinear_unknowns_are_named_and_the_others_still_found() {
        let column = |index: usize, x: f64| match index {
            0 => x.sin(),
            1 => -4.0 * x.sin(),
            2 => x.cos(),
            _ => 0.0,
        };
        let fit = system(4, 40, column, &[1.0, 0.5, 3.0, 2.0]);
        assert_eq!(fit.rank, 2);
        assert_eq!(fit.determined, [false, false, true, false]);
        assert!((fit.coefficients[2] - 3.0).abs() < 1e-9);
        let mut directions = fit.open_directions();
        directions.sort();
        assert_eq!(directions, [vec![0, 1], vec![3]]);
    }
}
