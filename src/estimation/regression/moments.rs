//! Moments Σ w x xᵀ of the rows x of a regression, its right side one of the columns.
//!
//! A law λ with −1 at the right side leaves xᵀλ of a row, so that Mλ is its score and λᵀMλ its loss. Moments add and
//! subtract: any stretch of a record is the difference of two.

use crate::estimation::symmetric::System;
use serde::{Deserialize, Serialize};

/// What a row counts.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    /// w.
    pub value: f64,
    /// Expectation of w (xᵀλ)² ÷ σ² under the right law.
    pub freedom: f64,
}

/// Moments of the rows of a stretch of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    width: usize,
    /// Upper triangle, row by row.
    entries: Vec<f64>,
    /// Degrees of freedom: the rows, each with its own.
    pub count: f64,
}

impl Weight {
    /// Of a row that counts as every other one.
    pub const WHOLE: Weight = Weight { value: 1.0, freedom: 1.0 };
}

impl Moments {
    /// Of no rows, of `width` entries.
    pub fn none(width: usize) -> Moments {
        Moments { width, entries: vec![0.0; width * (width + 1) / 2], count: 0.0 }
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.entries.fill(0.0);
        self.count = 0.0;
    }

    /// Takes one row.
    pub fn add(&mut self, row: &[f64], weight: Weight) {
        let mut entries = self.entries.iter_mut();
        for (index, first) in row.iter().enumerate() {
            let scaled = weight.value * first;
            row[index..].iter().zip(entries.by_ref()).for_each(|(second, entry)| *entry += scaled * second);
        }
        self.count += weight.freedom;
    }

    /// Copies the other's into this room.
    pub fn copy_from(&mut self, other: &Moments) {
        self.entries.copy_from_slice(&other.entries);
        self.count = other.count;
    }

    /// Adds `sign` times the other's.
    pub fn merge(&mut self, other: &Moments, sign: f64) {
        self.entries.iter_mut().zip(&other.entries).for_each(|(own, other)| *own += sign * other);
        self.count += sign * other.count;
    }

    /// Becomes the sum of all `parts`.
    pub fn sum(&mut self, parts: &[Moments]) {
        self.clear();
        parts.iter().for_each(|part| self.merge(part, 1.0));
    }

    /// Takes out what errors of these variances in the columns have added.
    pub fn take_out(&mut self, variances: &[f64]) {
        for (column, variance) in variances.iter().enumerate() {
            let place = self.place(column);
            self.entries[place] -= self.count * variance;
        }
    }

    /// Where a row's entry on the diagonal stands.
    fn place(&self, row: usize) -> usize {
        row * (2 * self.width + 1 - row) / 2
    }

    /// An entry of the symmetric matrix.
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        let (upper, lower) = (row.min(column), row.max(column));
        self.entries[self.place(upper) + lower - upper]
    }

    /// Row `row` times a vector, which may leave out the last columns.
    pub fn row_times(&self, row: usize, vector: &[f64]) -> f64 {
        vector.iter().enumerate().map(|(column, value)| self.entry(row, column) * value).sum()
    }

    /// vᵀ M v.
    pub fn quadratic(&self, vector: &[f64]) -> f64 {
        vector.iter().enumerate().map(|(row, value)| value * self.row_times(row, vector)).sum()
    }

    /// Loads the normal equations of the first n columns for the one behind them.
    pub fn load(&self, n: usize, system: &mut System) {
        for row in 0..n {
            let from = self.place(row);
            system.row(row)[row..=n].copy_from_slice(&self.entries[from..=from + n - row]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five rows [1, x, 2 − 3x, 1] of weights 1 to 5.
    fn line() -> Moments {
        let mut moments = Moments::none(4);
        for k in 1..=5 {
            let x = f64::from(k * k);
            moments.add(&[1.0, x, 2.0 - 3.0 * x, 1.0], Weight { value: f64::from(k), freedom: 1.0 });
        }
        moments
    }

    #[test]
    fn the_law_of_exact_rows_has_neither_score_nor_loss() {
        let (moments, mut system, mut law) = (line(), System::new(2), [0.0, 0.0, -1.0]);
        moments.load(2, &mut system);
        system.eliminate(1e-12);
        system.solve(&mut law);
        assert!((law[0] - 2.0).abs() < 1e-12 && (law[1] + 3.0).abs() < 1e-12, "{law:?}");
        assert!((0..4).all(|row| moments.row_times(row, &law).abs() < 1e-9) && moments.quadratic(&law).abs() < 1e-9);
        assert_eq!((moments.entry(3, 3), moments.entry(1, 3), moments.entry(3, 1)), (15.0, 225.0, 225.0));
    }

    #[test]
    fn what_is_merged_can_be_taken_away_again() {
        let (mut moments, mut twice) = (line(), line());
        moments.merge(&twice, 1.0);
        twice.sum(&[line(), line()]);
        assert_eq!(moments, twice);
        moments.merge(&line(), -1.0);
        assert_eq!(moments, line());
        moments.take_out(&[0.0, 2.0]);
        assert_eq!(moments.entry(1, 1), line().entry(1, 1) - 10.0);
    }
}
