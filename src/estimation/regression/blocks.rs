//! Moments by blocks of time: what the scatter of a regression's coefficients from block to block needs.

use super::moments::{Moments, Weight};
use serde::{Deserialize, Serialize};

/// Blocks that are kept; when all are full, neighbours become one. Even. The scores of those that then are left tell a
/// variance to √(2 ÷ 16), a third.
const MOST: usize = 32;

/// Rows in the first blocks; where rows are half of a variation's 1 ÷ a apart, about the length of the variation.
const ROWS: f64 = 8.0;

/// Fewest blocks of which a variance is told: its own error is then a half, √(2 ÷ 8).
pub const FEWEST: usize = 8;

/// A record cut into blocks of equal length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Blocks {
    blocks: Vec<Moments>,
    /// Blocks that are full; the next one is being filled.
    full: usize,
    length: f64,
}

impl Blocks {
    /// Room for rows of `width` entries.
    pub fn new(width: usize) -> Blocks {
        Blocks { blocks: vec![Moments::none(width); MOST], full: 0, length: ROWS }
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.blocks.iter_mut().for_each(Moments::clear);
        (self.full, self.length) = (0, ROWS);
    }

    /// Begins a record of which these moments are known.
    pub fn begin(&mut self, known: &Moments) {
        self.clear();
        self.blocks[0].copy_from(known);
    }

    /// Takes a row; returns whether it fills a block.
    pub fn add(&mut self, row: &[f64], weight: Weight) -> bool {
        let block = &mut self.blocks[self.full];
        block.add(row, weight);
        let is_full = block.count >= self.length;
        self.full += usize::from(is_full);
        if self.full == MOST {
            self.merge();
        }
        is_full
    }

    fn merge(&mut self) {
        for pair in 0..MOST / 2 {
            self.blocks.swap(pair, 2 * pair);
            let (head, tail) = self.blocks.split_at_mut(2 * pair + 1);
            head[pair].merge(&tail[0], 1.0);
        }
        self.blocks[MOST / 2..].iter_mut().for_each(Moments::clear);
        (self.full, self.length) = (MOST / 2, 2.0 * self.length);
    }

    /// Those that are full.
    pub fn full(&self) -> &[Moments] {
        &self.blocks[..self.full]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_when_blocks_become_one() {
        let mut blocks = Blocks::new(2);
        let rows = 8 * 32 * 4;
        (0..rows).for_each(|row| _ = blocks.add(&[1.0, f64::from(row)], Weight::WHOLE));
        let mut sum = Moments::none(2);
        sum.sum(blocks.full());
        let [n, last] = [f64::from(rows), f64::from(rows - 1)];
        let expected = [n, 0.5 * last * n, last * n * (2.0 * last + 1.0) / 6.0];
        assert_eq!([sum.entry(0, 0), sum.entry(1, 0), sum.entry(1, 1)], expected);
        assert!(blocks.full().len() == 16 && blocks.full().iter().all(|block| block.count == n / 16.0));
    }
}
