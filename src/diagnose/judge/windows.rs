//! Test functions over windows of 0.1, 0.3 and 1 T₀.
//!
//! A window carries (1 − s²)⁴ · {1, cos kπs, sin kπs}, −1 < s < 1, with up to four cycles per T₀, and advances by an
//! eighth of its length. φ and its first three derivatives vanish at both ends, so that derivatives of q may move to
//! it.

use nalgebra::DMatrix;
use std::f64::consts::{FRAC_PI_2, PI};

/// How many window lengths there are.
pub(in crate::diagnose) const COUNT: usize = 3;

/// The lengths, in T₀.
pub(in crate::diagnose) const LENGTHS: [f64; COUNT] = [0.1, 0.3, 1.0];

/// The length by which errors are told.
pub(in crate::diagnose) const PRINCIPAL: usize = 1;

/// Cells in a window of each length: sixteen a tenth of T₀, so that four cycles in T₀ have forty each.
const CELLS: [usize; COUNT] = [16, 48, 160];

/// Cycles in a window, at most.
const CYCLES: [usize; COUNT] = [0, 1, 4];

/// By which part of its length a window advances: what finer steps would tell, these share.
const ADVANCE: usize = 8;

/// Windows of one length, at most: beyond them they advance further. Their equations hardly differ from those between
/// them.
const MOST: usize = 1500;

/// Length of a cell, s.
pub(super) fn cell(period: f64) -> f64 {
    LENGTHS[0] * period / CELLS[0] as f64
}

/// Integrals over cells of all pieces, and their first moments about the middles of the cells, in cells.
pub(super) type Cells = Vec<Vec<[f64; 2]>>;

/// Windows of one length over all pieces, end to end.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Windows {
    /// Length, s.
    pub(in crate::diagnose) length: f64,
    /// Test functions of a window.
    pub(in crate::diagnose) functions: usize,
    /// (piece, first cell) of every window.
    places: Vec<(usize, usize)>,
    /// Windows of every piece.
    counts: Vec<usize>,
    /// Cells by which a window advances.
    stride: usize,
    /// Advances in a window.
    parts: usize,
    /// Middle of every window on the axis of all pieces end to end, s.
    pub(in crate::diagnose) centres: Vec<f64>,
    /// φ, φ' and φ'' in the cells of one advance, means and rises in turn: a row by part of the window and function.
    weights: [DMatrix<f64>; 3],
}

impl Windows {
    /// Of the length of that number, over pieces of so many cells; `distance` is the usual one of two readings, s.
    pub(super) fn new(which: usize, cells: &[usize], cell: f64, distance: f64) -> Windows {
        let size = CELLS[which];
        let total: usize = cells.iter().sum();
        let stride = (size / ADVANCE).max((distance / cell) as usize).max(total.div_ceil(MOST)).max(1);
        let (mut places, mut counts, mut centres, mut begin) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for (piece, count) in cells.iter().enumerate() {
            let firsts = (0..(count + 1).saturating_sub(size)).step_by(stride);
            counts.push(firsts.len());
            places.extend(firsts.clone().map(|first| (piece, first)));
            centres.extend(firsts.map(|first| ((begin + first) as f64 + 0.5 * size as f64) * cell));
            begin += count;
        }
        let length = size as f64 * cell;
        let phases = |cycles: usize| if cycles == 0 { &[0.0][..] } else { &[0.0, FRAC_PI_2][..] };
        let shapes = (0..=CYCLES[which]).flat_map(|cycles| phases(cycles).iter().map(move |phase| (cycles, *phase)));
        let functions: Vec<_> = shapes.map(|(cycles, phase)| tabulated(size, length, cycles as f64, phase)).collect();
        let (parts, width) = (size.div_ceil(stride), 2 * size.min(stride));
        let weight = |order: usize, (row, entry): (usize, usize)| {
            let own = functions[row % functions.len()][order].as_flattened();
            own.get(row / functions.len() * width + entry).copied().unwrap_or(0.0)
        };
        let weights = [0, 1, 2]
            .map(|order| DMatrix::from_fn(parts * functions.len(), width, |row, entry| weight(order, (row, entry))));
        Windows { length, functions: functions.len(), places, counts, stride, parts, centres, weights }
    }

    /// Number of equations.
    pub(super) fn rows(&self) -> usize {
        self.places.len() * self.functions
    }

    /// The equations whose windows begin before so many cells of their pieces.
    pub(super) fn before(&self, cells: &[usize]) -> Vec<usize> {
        let windows = (0..self.places.len()).filter(|window| self.places[*window].1 < cells[self.places[*window].0]);
        windows.flat_map(|window| window * self.functions..(window + 1) * self.functions).collect()
    }

    /// Where an equation's window has its middle, s.
    pub(super) fn centre(&self, row: usize) -> f64 {
        self.centres[row / self.functions]
    }

    /// Adds ∫ φ⁽ⁿ⁾ f dt, n the order, times a factor, to every equation.
    pub(super) fn add(&self, order: usize, cells: &Cells, factor: f64, rows: &mut [f64]) {
        let (weights, mut rows) = (&self.weights[order], rows.chunks_exact_mut(self.functions));
        for (cells, count) in cells.iter().zip(&self.counts).filter(|(_, count)| **count > 0) {
            let advances = count - 1 + self.parts;
            // windows overlap: what each part of one has in an advance of the record is told once, for all of them
            let mut values = cells.as_flattened().to_vec();
            values.resize(2 * self.stride * advances, 0.0);
            let shares = weights * DMatrix::from_vec(2 * self.stride, advances, values).rows(0, weights.ncols());
            let of_window = shares.as_slice().windows(weights.nrows() * self.parts).step_by(weights.nrows());
            for (rows, shares) in rows.by_ref().zip(of_window).take(*count) {
                for share in shares.chunks_exact(self.functions).step_by(self.parts + 1) {
                    rows.iter_mut().zip(share).for_each(|(row, share)| *row += factor * share);
                }
            }
        }
    }
}

/// φ, φ' and φ'' in `size` cells, each by its mean over the cell and its rise. φ is a straight line in every cell, so
/// that φ' is what it has there and ∫ φ q̈ dt = −∫ φ' q̇ dt exactly, however rough q̈ is.
fn tabulated(size: usize, length: f64, cycles: f64, phase: f64) -> [Vec<[f64; 2]>; 3] {
    let at = |edge: usize| test_function(2.0 * edge as f64 / size as f64 - 1.0, cycles, phase);
    let cell = length / size as f64;
    let slope = |order: usize, by: f64| {
        (0..size).map(|index| [by * (at(index + 1)[order] - at(index)[order]) / cell, 0.0]).collect()
    };
    let line = |index: usize| {
        let [from, to] = [at(index)[0], at(index + 1)[0]];
        [0.5 * (from + to), to - from]
    };
    [(0..size).map(line).collect(), slope(0, 1.0), slope(1, 2.0 / length)]
}

/// (1 − s²)⁴ cos(kπs − phase) and its first two derivatives by s.
fn test_function(s: f64, cycles: f64, phase: f64) -> [f64; 3] {
    let u = 1.0 - s * s;
    let bump = [u.powi(4), -8.0 * s * u.powi(3), 48.0 * s * s * u * u - 8.0 * u.powi(3)];
    let rate = PI * cycles;
    let (sin, cos) = (rate * s - phase).sin_cos();
    let wave = [cos, -rate * sin, -rate * rate * cos];
    [
        bump[0] * wave[0],
        bump[1] * wave[0] + bump[0] * wave[1],
        bump[2] * wave[0] + 2.0 * bump[1] * wave[1] + bump[0] * wave[2],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_test_functions() {
        let h = 1e-5;
        for (cycles, phase) in [(0.0, 0.0), (1.0, 0.0), (4.0, FRAC_PI_2)] {
            for s in [-0.83, 0.13, 0.6] {
                let [below, at, above] = [s - h, s, s + h].map(|s| test_function(s, cycles, phase));
                assert!(((above[0] - below[0]) / (2.0 * h) - at[1]).abs() < 1e-6, "{cycles} cycles at {s}");
                assert!(((above[1] - below[1]) / (2.0 * h) - at[2]).abs() < 1e-4, "{cycles} cycles at {s}");
            }
        }
    }

    /// ∫ φ'' q dt = ∫ φ q̈ dt for a motion that is known.
    #[test]
    fn derivatives_move_to_the_test_function() {
        let (period, omega) = (1.0, 7.0);
        let cell = cell(period);
        let count = 600;
        let at = |k: usize| (k as f64 + 0.5) * cell;
        for which in 0..COUNT {
            let windows = Windows::new(which, &[count], cell, 0.0);
            let rows = |order: usize, value: &dyn Fn(f64) -> f64| {
                let mut rows = vec![0.0; windows.rows()];
                let cells = vec![(0..count).map(|k| [cell * value(at(k)), 0.0]).collect()];
                windows.add(order, &cells, 1.0, &mut rows);
                rows
            };
            let moved = rows(2, &|t| (omega * t + 0.3).sin());
            let direct = rows(0, &|t| -omega * omega * (omega * t + 0.3).sin());
            let size = direct.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            assert!(moved.len() > 10 * windows.functions);
            assert!(moved.iter().zip(&direct).all(|(a, b)| (a - b).abs() < 1e-3 * size), "length {which}");
        }
    }

    /// Pieces that end within an advance, and windows that advance by less, by nearly and by more than their length.
    #[test]
    fn every_window_has_the_cells_of_its_own_piece() {
        for counts in [[600, 37, 170], [40_000, 5, 20_011]] {
            let cells: Cells = counts
                .map(|count| (0..count).map(|k| [f64::from(k * 7 % 11) - 4.0, f64::from(k * 5 % 13) - 6.0]).collect())
                .to_vec();
            for (which, size) in CELLS.into_iter().enumerate() {
                let windows = Windows::new(which, &cells.iter().map(Vec::len).collect::<Vec<_>>(), 0.1, 0.0);
                let mut rows = vec![1.0; windows.rows()];
                windows.add(0, &cells, 2.0, &mut rows);
                let bump = tabulated(size, windows.length, 0.0, 0.0)[0].clone();
                for ((piece, first), rows) in windows.places.iter().zip(rows.chunks_exact(windows.functions)) {
                    let own = bump.iter().zip(&cells[*piece][*first..]);
                    let integral: f64 = own.map(|(phi, cell)| phi[0] * cell[0] + phi[1] * cell[1]).sum();
                    assert!(
                        (rows[0] - 1.0 - 2.0 * integral).abs() < 1e-9,
                        "length {which}, piece {piece}, cell {first}"
                    );
                }
            }
        }
    }
}
