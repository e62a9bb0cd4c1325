//! Moments of weak rows by blocks of time: what a regression and the scatter of its coefficients from block to block
//! need.

use serde::{Deserialize, Serialize};

/// Blocks that are kept; then neighbours become one. Their scores tell a variance to √(2 ÷ 16), a third.
const MOST: usize = 32;

/// Rows in the first blocks: 4 ÷ a, about the length of a variation, since rows are half of 1 ÷ a apart.
const ROWS: u32 = 8;

/// Σ x xᵀ over blocks of rows, upper triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Blocks {
    width: usize,
    rows: u32,
    filled: u32,
    count: usize,
    moments: Vec<f64>,
}

impl Blocks {
    /// Room for rows of `width` entries.
    pub fn new(width: usize) -> Blocks {
        Blocks { width, rows: ROWS, filled: 0, count: 0, moments: vec![0.0; MOST * triangle(width)] }
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        (self.rows, self.filled, self.count) = (ROWS, 0, 0);
        self.moments.fill(0.0);
    }

    /// Takes a row; returns whether it completes a block.
    pub fn add(&mut self, row: &[f64]) -> bool {
        let size = triangle(self.width);
        let mut slots = self.moments[self.count * size..(self.count + 1) * size].iter_mut();
        for (index, entry) in row.iter().enumerate() {
            for (other, slot) in row[index..].iter().zip(slots.by_ref()) {
                *slot += entry * other;
            }
        }
        self.filled += 1;
        let complete = self.filled == self.rows;
        if complete {
            (self.filled, self.count) = (0, self.count + 1);
        }
        if self.count == MOST {
            self.halve();
        }
        complete
    }

    fn halve(&mut self) {
        let size = triangle(self.width);
        for block in 0..MOST / 2 {
            for entry in 0..size {
                let from = 2 * block * size + entry;
                self.moments[block * size + entry] = self.moments[from] + self.moments[from + size];
            }
        }
        self.moments[MOST / 2 * size..].fill(0.0);
        (self.rows, self.count) = (2 * self.rows, MOST / 2);
    }

    /// Complete blocks.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Rows of one complete block.
    pub fn rows(&self) -> f64 {
        f64::from(self.rows)
    }

    /// Writes the sum over blocks `from` to `to`, exclusive, as a full matrix.
    pub fn sum(&self, from: usize, to: usize, matrix: &mut [f64]) {
        let (width, size) = (self.width, triangle(self.width));
        matrix.fill(0.0);
        for block in self.moments[from * size..to * size].chunks_exact(size) {
            let mut entries = block.iter();
            for row in 0..width {
                for (slot, entry) in matrix[row * width + row..(row + 1) * width].iter_mut().zip(entries.by_ref()) {
                    *slot += entry;
                }
            }
        }
        for row in 1..width {
            for column in 0..row {
                matrix[row * width + column] = matrix[column * width + row];
            }
        }
    }
}

fn triangle(width: usize) -> usize {
    width * (width + 1) / 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_when_blocks_become_one() {
        let mut blocks = Blocks::new(2);
        let rows = 8 * 32 * 4;
        (0..rows).for_each(|row| _ = blocks.add(&[1.0, f64::from(row)]));
        let mut sum = [0.0; 4];
        blocks.sum(0, blocks.count(), &mut sum);
        let [n, last] = [f64::from(rows), f64::from(rows - 1)];
        assert_eq!(sum, [n, 0.5 * last * n, 0.5 * last * n, last * n * (2.0 * last + 1.0) / 6.0]);
        assert_eq!((blocks.count(), blocks.rows()), (16, n / 16.0));
    }
}
