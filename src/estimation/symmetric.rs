//! Small symmetric positive systems \[A | b\], eliminated in room that is fixed at construction.
//!
//! A = Uᵀ D U with U unit upper triangular (Golub and Van Loan, *Matrix Computations*, 4.1): no square roots, and b
//! goes through the elimination as one more column, which leaves z = U⁻ᵀ b. Rows are cut into lanes of four numbers, so
//! that the innermost loops have a fixed length (a lane is read whole before it is written, or they would not
//! vectorise); what stands below the diagonal in a row's first lane is carried along and never read.

use serde::{Deserialize, Serialize};

/// Four neighbours in a row.
pub type Lane = [f64; WIDTH];

/// Numbers in a lane: two registers of SSE2, one of AVX.
pub const WIDTH: usize = 4;

/// Bounds between which a product of pivots or variances is kept before its logarithm is taken: with one more factor
/// above 1e-200 it is still a normal number.
const PRODUCT: std::ops::Range<f64> = 1e-100..1e100;

/// Σ ln x over many x > 0 with few logarithms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogSum {
    sum: f64,
    product: f64,
}

impl Default for LogSum {
    fn default() -> LogSum {
        LogSum { sum: 0.0, product: 1.0 }
    }
}

impl LogSum {
    /// Adds ln x.
    #[inline]
    pub fn add(&mut self, x: f64) {
        let product = self.product * x;
        if PRODUCT.contains(&product) {
            self.product = product;
        } else {
            self.sum += self.product.ln() + x.ln();
            self.product = 1.0;
        }
    }

    /// Σ ln x.
    pub fn total(&self) -> f64 {
        self.sum + self.product.ln()
    }
}

/// Σ a b.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// row − factor · above, which have as many lanes.
///
/// Loops of a length that the compiler knows have neither counters nor checks; of a factor 0 nothing is taken: unknowns
/// that are not in a law have no other.
#[inline]
fn subtract(row: &mut [Lane], factor: f64, above: &[Lane]) {
    match row.len() {
        _ if factor == 0.0 => {}
        1 => subtract_lanes::<1>(row, factor, above),
        2 => subtract_lanes::<2>(row, factor, above),
        3 => subtract_lanes::<3>(row, factor, above),
        4 => subtract_lanes::<4>(row, factor, above),
        _ => row.iter_mut().zip(above).for_each(|(lane, above)| *lane = difference(lane, factor, above)),
    }
}

#[inline]
fn subtract_lanes<const L: usize>(row: &mut [Lane], factor: f64, above: &[Lane]) {
    if let (Some(row), Some(above)) = (row.first_chunk_mut::<L>(), above.first_chunk::<L>()) {
        row.iter_mut().zip(above).for_each(|(lane, above)| *lane = difference(lane, factor, above));
    }
}

#[inline]
fn difference(lane: &Lane, factor: f64, above: &Lane) -> Lane {
    std::array::from_fn(|index| lane[index] - factor * above[index])
}

/// A system of n equations under elimination.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct System {
    n: usize,
    /// Lanes in a row of A and b.
    lanes: usize,
    rows: Vec<Lane>,
    /// Entries of D⁻¹; 0 for an unknown that is fixed to 0.
    inverse_pivots: Vec<f64>,
}

impl System {
    /// Room for `n` unknowns.
    pub fn new(n: usize) -> System {
        let lanes = (n + 1).div_ceil(WIDTH);
        System { n, lanes, rows: vec![[0.0; WIDTH]; n * lanes], inverse_pivots: vec![0.0; n] }
    }

    /// Row of A and b; its entries from the diagonal on count, b is entry n.
    #[inline]
    pub fn row(&mut self, row: usize) -> &mut [f64] {
        self.rows[row * self.lanes..(row + 1) * self.lanes].as_flattened_mut()
    }

    /// Takes row-major n × n matrices' sum as A, of which the upper triangle counts; each has room for a row's last
    /// lane behind it.
    #[inline]
    pub fn load(&mut self, first: &[f64], second: Option<&[f64]>) {
        let (n, lanes) = (self.n, self.n.div_ceil(WIDTH));
        for (row, target) in self.rows.chunks_exact_mut(self.lanes).enumerate() {
            let range = row * n + WIDTH * (row / WIDTH)..row * n + WIDTH * lanes;
            let target = &mut target[row / WIDTH..lanes];
            let first = first[range.clone()].as_chunks::<WIDTH>().0;
            match second {
                None => target.copy_from_slice(first),
                Some(second) => {
                    let pairs = first.iter().zip(second[range].as_chunks::<WIDTH>().0);
                    for (sums, (a, b)) in target.iter_mut().zip(pairs) {
                        *sums = std::array::from_fn(|lane| a[lane] + b[lane]);
                    }
                }
            }
        }
    }

    /// Takes b.
    #[inline]
    pub fn set_right(&mut self, right: impl Iterator<Item = f64>) {
        let n = self.n;
        for (row, value) in self.rows.chunks_exact_mut(self.lanes).zip(right) {
            row.as_flattened_mut()[n] = value;
        }
    }

    /// Takes the unknown out of the system: it is fixed to 0.
    pub fn isolate(&mut self, unknown: usize) {
        for row in 0..unknown {
            self.row(row)[unknown] = 0.0;
        }
        self.row(unknown)[unknown..].fill(0.0);
    }

    /// Eliminates. A pivot that falls below `tolerance` times its diagonal entry is not positive for what rounding
    /// leaves: its unknown is then fixed to 0.
    pub fn eliminate(&mut self, tolerance: f64) {
        for (row, slot) in self.inverse_pivots.iter_mut().enumerate() {
            *slot = tolerance * self.rows[row * self.lanes + row / WIDTH][row % WIDTH];
        }
        let lanes = self.lanes;
        for k in 0..self.n {
            let (head, tail) = self.rows.split_at_mut((k + 1) * lanes);
            let above = &head[k * lanes..];
            let pivot = above[k / WIDTH][k % WIDTH];
            let positive = pivot > self.inverse_pivots[k] && pivot.is_finite();
            let inverse = if positive { pivot.recip() } else { 0.0 };
            self.inverse_pivots[k] = inverse;
            for (below, row) in tail.chunks_exact_mut(lanes).zip(k + 1..) {
                let first = row / WIDTH;
                subtract(&mut below[first..], above[first][row % WIDTH] * inverse, &above[first..]);
            }
        }
    }

    /// Takes more right sides through the elimination, the columns of B, of which a row has as many lanes as n needs:
    /// U⁻ᵀ B.
    pub fn forward(&self, columns: &mut [Lane]) {
        let width = self.n.div_ceil(WIDTH);
        for k in 0..self.n {
            let (head, tail) = columns.split_at_mut((k + 1) * width);
            let (above, row) = (&head[k * width..], self.rows[k * self.lanes..(k + 1) * self.lanes].as_flattened());
            for (below, entry) in tail.chunks_exact_mut(width).zip(&row[k + 1..]) {
                subtract(below, entry * self.inverse_pivots[k], above);
            }
        }
    }

    /// βᵀ A⁻¹ β and βᵀ A⁻¹ b, β being the column of B that [`System::forward`] made of.
    pub fn products(&self, columns: &[Lane], column: usize) -> [f64; 2] {
        let width = self.n.div_ceil(WIDTH);
        let rows = self.rows.chunks_exact(self.lanes).zip(columns.chunks_exact(width)).zip(&self.inverse_pivots);
        rows.fold([0.0; 2], |[own, pulled], ((row, columns), inverse)| {
            let entry = columns.as_flattened()[column];
            [own + entry * entry * inverse, pulled + entry * row.as_flattened()[self.n] * inverse]
        })
    }

    /// βᵀ A⁻¹ γ, β and γ being columns of B that [`System::forward`] made of.
    pub fn product(&self, columns: &[Lane], [first, second]: [usize; 2]) -> f64 {
        let rows = columns.chunks_exact(self.n.div_ceil(WIDTH)).map(<[Lane]>::as_flattened);
        rows.zip(&self.inverse_pivots).map(|(row, inverse)| row[first] * row[second] * inverse).sum()
    }

    /// Whether the unknown could be solved for.
    #[inline]
    pub fn is_solved(&self, unknown: usize) -> bool {
        self.inverse_pivots[unknown] > 0.0
    }

    /// The unknown's entry of D, 0 where it is fixed.
    pub fn pivot(&self, unknown: usize) -> f64 {
        if self.is_solved(unknown) { self.inverse_pivots[unknown].recip() } else { 0.0 }
    }

    /// bᵀ A⁻¹ b.
    pub fn squares(&self) -> f64 {
        let ends = self.rows.chunks_exact(self.lanes).map(|row| row.as_flattened()[self.n]);
        ends.zip(&self.inverse_pivots).map(|(z, inverse)| z * z * inverse).sum()
    }

    /// ln det A, fixed unknowns left out.
    pub fn log_determinant(&self) -> f64 {
        let mut sum = LogSum::default();
        self.inverse_pivots.iter().filter(|inverse| **inverse > 0.0).for_each(|inverse| sum.add(*inverse));
        -sum.total()
    }

    /// Writes A⁻¹ b into `x`, n.
    pub fn solve(&self, x: &mut [f64]) {
        for k in (0..self.n).rev() {
            let row = self.rows[k * self.lanes..(k + 1) * self.lanes].as_flattened();
            x[k] = (row[self.n] - dot(&row[k + 1..self.n], &x[k + 1..])) * self.inverse_pivots[k];
        }
    }

    /// Writes A⁻¹ into `inverse`, n × n, both triangles; rows and columns of fixed unknowns are 0.
    pub fn invert(&self, inverse: &mut [f64]) {
        let n = self.n;
        for row in (0..n).rev() {
            let entries = self.rows[row * self.lanes..(row + 1) * self.lanes].as_flattened();
            let scale = self.inverse_pivots[row];
            // A⁻¹ = D⁻¹ + (1 − U) A⁻¹ on and above the diagonal, from the last row up
            for column in (row..n).rev() {
                let behind = &inverse[column * n + row + 1..(column + 1) * n];
                let known = dot(&entries[row + 1..n], behind);
                let own = if column == row { 1.0 } else { 0.0 };
                let value = if self.is_solved(column) { (own - known) * scale } else { 0.0 };
                inverse[row * n + column] = value;
                inverse[column * n + row] = value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper triangle, row-major, with room for the last row's lane.
    const MATRIX: [f64; 10] = [4.0, 2.0, 0.4, 0.0, 5.0, 1.0, 0.0, 0.0, 3.0, 0.0];

    fn entry(row: usize, column: usize) -> f64 {
        MATRIX[3 * row.min(column) + row.max(column)]
    }

    fn eliminated() -> System {
        let mut system = System::new(3);
        system.load(&MATRIX, None);
        system.set_right([3.0, -1.0, 2.0].into_iter());
        system.eliminate(1e-12);
        system
    }

    #[test]
    fn the_inverse_times_the_matrix_is_one() {
        let mut inverse = [0.0; 9];
        eliminated().invert(&mut inverse);
        for row in 0..3 {
            for column in 0..3 {
                let product: f64 = (0..3).map(|k| entry(row, k) * inverse[k * 3 + column]).sum();
                let expected = if row == column { 1.0 } else { 0.0 };
                assert!((product - expected).abs() < 1e-14, "({row}, {column}) = {product}");
            }
        }
        let determinant = 4.0 * (15.0 - 1.0) - 2.0 * (6.0 - 0.4) + 0.4 * (2.0 - 2.0);
        assert!((eliminated().log_determinant() - f64::ln(determinant)).abs() < 1e-14);
    }

    #[test]
    fn the_solution_satisfies_the_system() {
        let (system, mut x) = (eliminated(), [0.0; 3]);
        system.solve(&mut x);
        for (row, right) in [3.0, -1.0, 2.0].into_iter().enumerate() {
            let left: f64 = (0..3).map(|column| entry(row, column) * x[column]).sum();
            assert!((left - right).abs() < 1e-14, "row {row}: {left}");
        }
        let squares = 3.0 * x[0] - x[1] + 2.0 * x[2];
        assert!((system.squares() - squares).abs() < 1e-14);
    }

    #[test]
    fn a_collinear_unknown_is_fixed_to_zero() {
        let mut system = System::new(2);
        system.load(&[1.0, 1.0, 0.0, 1.0, 0.0, 0.0], None);
        system.set_right([3.0, 3.0].into_iter());
        system.eliminate(1e-12);
        let (mut x, mut inverse) = ([0.0; 2], [0.0; 4]);
        system.solve(&mut x);
        system.invert(&mut inverse);
        assert_eq!((x, inverse), ([3.0, 0.0], [1.0, 0.0, 0.0, 0.0]));
        assert!(system.is_solved(0) && !system.is_solved(1));
    }

    #[test]
    fn an_isolated_unknown_leaves_the_others_alone() {
        let mut system = System::new(3);
        system.load(&MATRIX, None);
        system.set_right([4.0, 7.0, 0.4].into_iter());
        system.isolate(1);
        system.eliminate(1e-12);
        let mut x = [0.0; 3];
        system.solve(&mut x);
        assert!((x[0] - 1.0).abs() < 1e-15 && x[1] == 0.0 && x[2].abs() < 1e-15, "{x:?}");
    }

    #[test]
    fn a_sum_of_logarithms_survives_products_beyond_any_float() {
        let mut sum = LogSum::default();
        (0..1000).for_each(|k| sum.add(if k % 3 == 0 { 1e-20 } else { 3e-14 }));
        let expected = 334.0 * f64::ln(1e-20) + 666.0 * f64::ln(3e-14);
        assert!((sum.total() / expected - 1.0).abs() < 1e-13);
    }
}
