//! Where a record may have changed its law: at the instant that leaves least when each side has coefficients of its own.
//!
//! Binary segmentation (Vostrikova, Soviet Mathematics Doklady 24, 1981) of the weak equations: the best cut of a stretch, then the best of
//! either part. An effect that the law lacks leaves its share on both sides, so that it hides no change and is none.

use super::equation::Equation;
use super::record::Record;
use super::regression::Normal;
use super::windows::PRINCIPAL;
use nalgebra::{DMatrix, DVector};

/// T₀ that a stage is long at least: a law's coefficients need some periods of motion.
const LEAST: f64 = 5.0;

/// Part of a stretch's residual energy that two laws in place of one must leave at most: a change takes a third of it or more, as an effect
/// that is large does.
const LEFT: f64 = 2.0 / 3.0;

/// Sums over the equations of all windows up to each.
struct Sums {
    gram: Vec<DMatrix<f64>>,
    moment: Vec<DVector<f64>>,
    square: Vec<f64>,
}

/// Instants at which the record may have changed its law, in seconds on the axis of all pieces end to end.
pub(in crate::diagnose) fn changes(record: &Record, equation: &Equation) -> Vec<f64> {
    let windows = &record.windows[PRINCIPAL];
    let sums = Sums::of(&equation.columns(PRINCIPAL), &equation.right[PRINCIPAL], windows.functions);
    let centres = &windows.centres;
    let mut stretches = vec![(0, centres.len())];
    let mut found = Vec::new();
    while let Some((from, to)) = stretches.pop() {
        let Some(cut) = sums.cut(from, to, |at| {
            let length = |from: usize, to: usize| centres[to - 1] - centres[from];
            length(from, at).min(length(at, to)) >= LEAST * record.period
        }) else {
            continue;
        };
        found.push(0.5 * (centres[cut - 1] + centres[cut]));
        stretches.extend([(from, cut), (cut, to)]);
    }
    found.sort_by(f64::total_cmp);
    found
}

impl Sums {
    fn of(columns: &[&[f64]], right: &[f64], functions: usize) -> Sums {
        let p = columns.len();
        let (mut gram, mut moment, mut square) = (DMatrix::zeros(p, p), DVector::zeros(p), 0.0);
        let mut sums = Sums { gram: vec![gram.clone()], moment: vec![moment.clone()], square: vec![0.0] };
        for window in 0..right.len() / functions {
            for row in window * functions..(window + 1) * functions {
                let own = DVector::from_fn(p, |column, _| columns[column][row]);
                gram += &own * own.transpose();
                moment += &own * right[row];
                square += right[row] * right[row];
            }
            sums.gram.push(gram.clone());
            sums.moment.push(moment.clone());
            sums.square.push(square);
        }
        sums
    }

    /// What the best coefficients leave of the equations of these windows.
    fn left(&self, from: usize, to: usize) -> Option<f64> {
        let (gram, moment) = (&self.gram[to] - &self.gram[from], &self.moment[to] - &self.moment[from]);
        let square = self.square[to] - self.square[from];
        let explained = Normal { gram, moment: moment.clone() }.solve()?;
        let explained: f64 = explained.iter().zip(moment.iter()).map(|(solution, moment)| solution * moment).sum();
        Some((square - explained).max(0.0))
    }

    /// The first window behind the best cut between `from` and `to`; none where no cut that may be takes enough.
    fn cut(&self, from: usize, to: usize, may_be: impl Fn(usize) -> bool) -> Option<usize> {
        let whole = self.left(from, to)?;
        let parts = (from + 1..to).filter(|at| may_be(*at));
        let left = parts.filter_map(|at| Some((at, self.left(from, at)? + self.left(at, to)?)));
        let (at, least) = left.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (least < LEFT * whole).then_some(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equations y = a x + noise whose a changes at window 120 of 200.
    fn sums(change: f64) -> Sums {
        let x: Vec<f64> = (0..400).map(|row| (0.37 * f64::from(row)).sin()).collect();
        let noise = |row: usize| 0.05 * (12.9898 * row as f64).sin();
        let slope = |row: usize| if row < 240 { 1.0 } else { 1.0 + change };
        let y: Vec<f64> = x.iter().enumerate().map(|(row, x)| slope(row) * x + noise(row)).collect();
        Sums::of(&[&x], &y, 2)
    }

    #[test]
    fn a_change_is_found_where_it_is_and_none_where_none_is() {
        let found = sums(0.3).cut(0, 200, |_| true).unwrap();
        assert!((118..=122).contains(&found), "{found}");
        assert_eq!(sums(0.0).cut(0, 200, |_| true), None);
        assert_eq!(sums(0.3).cut(0, 200, |at| at < 20), None, "too short a stage");
    }
}
