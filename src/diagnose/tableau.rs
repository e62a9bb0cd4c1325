//! Every candidate beside every other: one run of the filter, and the gain of any set of them in closed form.
//!
//! The score test (Rao 1948) for several candidates at once. With the law's unknowns swept out of the joint information, S and g are the
//! candidates' own information and score; a set J gains ½ g_Jᵀ S_JJ⁻¹ g_J. Two effects that are missing together are found where
//! neither of them alone gains much: the search for one after the other takes what imitates their sum.

use super::fit::solve;
use super::run::Span;
use crate::evidence::Innovation;
use nalgebra::{DMatrix, DVector};

/// Innovations that are gathered before they are summed, so that the sum is a product of matrices.
const BLOCK: usize = 256;

/// Part of its information that a candidate must keep beside the others of its set.
const OWN: f64 = 1e-7;

/// Sums of products of all columns: unknowns, candidates, residual.
#[derive(Clone, Debug)]
pub(super) struct Gram {
    unknowns: usize,
    /// Where those of the piece that is run stand.
    span: Span,
    block: DMatrix<f64>,
    filled: usize,
    sum: DMatrix<f64>,
}

impl Gram {
    /// Nothing seen of so many columns.
    pub(super) fn none(unknowns: usize, candidates: usize) -> Gram {
        let width = unknowns + candidates + 1;
        let span = Span { shared: unknowns, first: 0, all: 0 };
        Gram { unknowns, span, block: DMatrix::zeros(width, BLOCK), filled: 0, sum: DMatrix::zeros(width, width) }
    }

    /// Begins a piece whose unknowns stand there.
    pub(super) fn begin(&mut self, span: Span) {
        self.span = span;
    }

    /// Adds an innovation with the sensitivities of what was expected.
    pub(super) fn add(&mut self, unknowns: &[f64], candidates: &[f64], innovation: &Innovation) {
        let weight = innovation.precision.sqrt();
        let mut column = self.block.column_mut(self.filled);
        column.rows_mut(0, self.unknowns).fill(0.0);
        unknowns.iter().enumerate().for_each(|(index, entry)| column[self.span.place(index)] = entry * weight);
        let rest = candidates.iter().chain([&innovation.residual]);
        column.iter_mut().skip(self.unknowns).zip(rest).for_each(|(slot, entry)| *slot = entry * weight);
        self.filled += 1;
        if self.filled == BLOCK {
            self.flush();
        }
    }

    /// Adds information and score that the last unknowns have from elsewhere.
    pub(super) fn add_prior(&mut self, prior: impl Iterator<Item = (f64, f64)>) {
        self.flush();
        let prior: Vec<(f64, f64)> = prior.collect();
        let (first, last) = (self.unknowns - prior.len(), self.sum.ncols() - 1);
        for (index, (weight, score)) in (first..).zip(prior) {
            self.sum[(index, index)] += weight;
            self.sum[(index, last)] += score;
            self.sum[(last, index)] += score;
        }
    }

    fn flush(&mut self) {
        let seen = self.block.columns(0, self.filled);
        self.sum.gemm(1.0, &seen, &seen.transpose(), 1.0);
        self.filled = 0;
    }

    /// The candidates with the unknowns swept out; none where a run left no numbers.
    pub(super) fn swept(mut self) -> Option<Tableau> {
        self.flush();
        let (n, width) = (self.unknowns, self.sum.nrows());
        let rest = width - n;
        let information = self.sum.view((0, 0), (n, n)).into_owned();
        let cross = self.sum.view((0, n), (n, rest)).into_owned();
        let covariance = solve(&information, &DVector::zeros(n))?.covariance;
        let shift = &covariance * &cross;
        let swept = self.sum.view((n, n), (rest, rest)) - cross.tr_mul(&shift);
        let kinds = rest - 1;
        let raw = (0..kinds).map(|kind| self.sum[(n + kind, n + kind)]).collect();
        swept.iter().all(|entry| entry.is_finite()).then(|| Tableau {
            information: swept.view((0, 0), (kinds, kinds)).into_owned(),
            score: swept.view((0, kinds), (kinds, 1)).column(0).into_owned(),
            raw,
            shift,
            energy: swept[(kinds, kinds)],
        })
    }
}

/// Information and score of the candidates, the law's unknowns swept out.
#[derive(Clone, Debug)]
pub(super) struct Tableau {
    information: DMatrix<f64>,
    score: DVector<f64>,
    /// Information of each before the unknowns were swept out.
    raw: Vec<f64>,
    /// By how much the unknowns move for a unit of each candidate less; in the last column, without any.
    shift: DMatrix<f64>,
    /// Σ ε²/s that the unknowns leave.
    pub(super) energy: f64,
}

/// What a set of candidates would gain, and their coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Joint<const N: usize> {
    pub(super) gain: f64,
    pub(super) coefficients: [f64; N],
    pub(super) variances: [f64; N],
}

impl Tableau {
    /// Number of candidates.
    pub(super) fn len(&self) -> usize {
        self.raw.len()
    }

    /// By how much the unknowns move when the candidates of a set join with these coefficients.
    pub(super) fn shift(&self, set: &[usize], coefficients: &[f64]) -> DVector<f64> {
        let alone = self.shift.column(self.len()).into_owned();
        set.iter()
            .zip(coefficients)
            .fold(alone, |sum, (index, coefficient)| sum - self.shift.column(*index) * *coefficient)
    }

    /// The gain of a set; none where its members cannot be told apart.
    pub(super) fn joint<const N: usize>(&self, set: [usize; N]) -> Option<Joint<N>> {
        let mut left = [[0.0; N]; N];
        for (row, one) in set.iter().enumerate() {
            for (column, other) in set.iter().enumerate() {
                left[row][column] = self.information[(*one, *other)];
            }
        }
        let mut inverse = [[0.0; N]; N];
        (0..N).for_each(|index| inverse[index][index] = 1.0);
        // Gauss–Jordan; the matrix is positive definite, so that the order of the pivots does not matter
        for pivot in 0..N {
            let own = left[pivot][pivot];
            if own <= OWN * self.raw[set[pivot]] {
                return None;
            }
            for column in 0..N {
                left[pivot][column] /= own;
                inverse[pivot][column] /= own;
            }
            for row in (0..N).filter(|row| *row != pivot) {
                let factor = left[row][pivot];
                for column in 0..N {
                    left[row][column] -= factor * left[pivot][column];
                    inverse[row][column] -= factor * inverse[pivot][column];
                }
            }
        }
        let score = set.map(|index| self.score[index]);
        let coefficients: [f64; N] =
            std::array::from_fn(|row| (0..N).map(|column| inverse[row][column] * score[column]).sum());
        let gain = 0.5 * coefficients.iter().zip(score).map(|(coefficient, score)| coefficient * score).sum::<f64>();
        Some(Joint { gain, coefficients, variances: std::array::from_fn(|index| inverse[index][index]) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns a, b and their sum's image: the residual is 2 a − b, and a column that looks like it gains nothing beside them.
    #[test]
    fn a_set_is_a_regression_beside_the_unknowns() {
        let mut gram = Gram::none(1, 3);
        for k in 0..600 {
            let x = k as f64 * 0.02;
            let (a, b, offset) = (x.sin(), (1.7 * x).cos(), 1.0);
            let residual = 2.0 * a - b + 0.4 * offset;
            let innovation = Innovation { residual, variance: 0.25, precision: 4.0, gain: [0.0; 2] };
            gram.add(&[offset], &[a, b, a - 0.3 * b], &innovation);
        }
        let tableau = gram.swept().unwrap();
        let both = tableau.joint([0, 1]).unwrap();
        assert!((both.coefficients[0] - 2.0).abs() < 1e-9 && (both.coefficients[1] + 1.0).abs() < 1e-9, "{both:?}");
        assert!((2.0 * both.gain / tableau.energy - 1.0).abs() < 1e-9, "{both:?} of {}", tableau.energy);
        let imitation = tableau.joint([2]).unwrap();
        assert!(imitation.gain > tableau.joint([0]).unwrap().gain && imitation.gain < both.gain, "{imitation:?}");
        assert!((tableau.shift(&[0, 1], &both.coefficients)[0] - 0.4).abs() < 1e-9);
        assert_eq!(tableau.joint([0, 1, 2]), None);
    }

    /// Two pieces with an unknown of their own each: what one of them sees says nothing of the other's.
    #[test]
    fn a_piece_adds_to_its_own_unknowns() {
        let mut gram = Gram::none(3, 1);
        for (first, offset) in [(0, 0.4), (1, -0.7)] {
            gram.begin(Span { shared: 1, first, all: 2 });
            for k in 0..300 {
                let (slope, force) = (k as f64 * 0.01, (0.3 * k as f64).sin());
                let residual = 2.0 * slope + offset + 5.0 * force;
                gram.add(
                    &[slope, 1.0],
                    &[force],
                    &Innovation { residual, variance: 1.0, precision: 1.0, gain: [0.0; 2] },
                );
            }
        }
        let tableau = gram.swept().unwrap();
        let found = tableau.joint([0]).unwrap();
        assert!((found.coefficients[0] - 5.0).abs() < 1e-9, "{found:?}");
        let shift = tableau.shift(&[0], &found.coefficients);
        let expected = [2.0, 0.4, -0.7];
        assert!(shift.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-9), "{shift}");
    }
}
