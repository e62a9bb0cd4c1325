//! Where a record may have changed its law: at the instant that leaves least when each side has coefficients of its
//! own.
//!
//! Binary segmentation (Vostrikova, Soviet Mathematics Doklady 24, 1981) of the weak equations: the best cut of a
//! stretch, then the best of either part. An effect that the law lacks leaves its share on both sides, so that it hides
//! no change and is none. The rival of all cuts of a stretch is one law whose coefficients drift, each on a straight
//! line over time: where it leaves less, nothing switches.

use super::equation::Equation;
use super::record::Record;
use super::regression::Normal;
use super::windows::PRINCIPAL;
use nalgebra::{DMatrix, DVector};

/// T₀ that a stage is long at least: a law's coefficients need some periods of motion.
const LEAST: f64 = 5.0;

/// Part of a stretch's residual energy that two laws in place of one must leave at most: a change takes a third of it
/// or more, as an effect that is large does.
const LEFT: f64 = 2.0 / 3.0;

/// Sums over the equations of all windows up to each; every column once as it is and once times its window's time.
struct Sums {
    gram: Vec<DMatrix<f64>>,
    moment: Vec<DVector<f64>>,
    square: Vec<f64>,
}

/// A stretch of windows: where its law changes, and how much is left by laws that do not drift.
struct Stretch {
    cuts: Vec<usize>,
    left: f64,
}

/// Instants at which the record may have changed its law, in seconds on the axis of all pieces end to end.
pub(in crate::diagnose) fn changes(record: &Record, equation: &Equation) -> Vec<f64> {
    let windows = &record.windows[PRINCIPAL];
    let centres = &windows.centres;
    let sums = Sums::of(&equation.columns(PRINCIPAL), &equation.right[PRINCIPAL], centres);
    let is_long = |from: usize, to: usize| centres[to - 1] - centres[from] >= LEAST * record.period;
    let found = sums.stretch(0, centres.len(), &is_long);
    let cuts = found.map_or_else(Vec::new, |found| found.cuts);
    cuts.into_iter().map(|cut| 0.5 * (centres[cut - 1] + centres[cut])).collect()
}

/// The instant, on the same axis, at which two laws in place of one leave least, however little that takes. None where
/// the record is too short for two.
pub(in crate::diagnose) fn best_change(record: &Record, equation: &Equation) -> Option<f64> {
    let windows = &record.windows[PRINCIPAL];
    let centres = &windows.centres;
    let sums = Sums::of(&equation.columns(PRINCIPAL), &equation.right[PRINCIPAL], centres);
    let (at, _) = sums.best(0, centres.len(), &|from, to| centres[to - 1] - centres[from] >= LEAST * record.period)?;
    Some(0.5 * (centres[at - 1] + centres[at]))
}

impl Sums {
    fn of(columns: &[&[f64]], right: &[f64], centres: &[f64]) -> Sums {
        let p = columns.len();
        let functions = right.len() / centres.len().max(1);
        let end = centres.last().copied().unwrap_or(1.0);
        let (mut gram, mut moment, mut square) = (DMatrix::zeros(2 * p, 2 * p), DVector::zeros(2 * p), 0.0);
        let mut sums = Sums { gram: vec![gram.clone()], moment: vec![moment.clone()], square: vec![0.0] };
        for (window, centre) in centres.iter().enumerate() {
            for row in window * functions..(window + 1) * functions {
                let own = |column: usize| columns[column % p][row] * if column < p { 1.0 } else { centre / end };
                let own = DVector::from_fn(2 * p, |column, _| own(column));
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
        self.left_by(self.moment[0].len() / 2, from, to)
    }

    /// The same of coefficients that drift.
    fn left_by_drift(&self, from: usize, to: usize) -> Option<f64> {
        self.left_by(self.moment[0].len(), from, to)
    }

    fn left_by(&self, columns: usize, from: usize, to: usize) -> Option<f64> {
        let gram = (&self.gram[to] - &self.gram[from]).view((0, 0), (columns, columns)).into_owned();
        let moment = (&self.moment[to] - &self.moment[from]).rows(0, columns).into_owned();
        let square = self.square[to] - self.square[from];
        let explained = Normal { gram, moment: moment.clone() }.solve()?;
        let explained: f64 = explained.iter().zip(moment.iter()).map(|(solution, moment)| solution * moment).sum();
        Some((square - explained).max(0.0))
    }

    /// The first window behind the best cut between `from` and `to`; none where no cut that may be takes enough.
    fn cut(&self, from: usize, to: usize, is_long: &impl Fn(usize, usize) -> bool) -> Option<usize> {
        let whole = self.left(from, to)?;
        self.best(from, to, is_long).filter(|(_, least)| *least < LEFT * whole).map(|(at, _)| at)
    }

    /// The first window behind the best cut of all that may be, and what two laws leave there.
    fn best(&self, from: usize, to: usize, is_long: &impl Fn(usize, usize) -> bool) -> Option<(usize, f64)> {
        let parts = (from + 1..to).filter(|at| is_long(from, *at) && is_long(*at, to));
        let left = parts.filter_map(|at| Some((at, self.left(from, at)? + self.left(at, to)?)));
        left.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The windows from `from` to `to` under one law, several or a drifting one.
    fn stretch(&self, from: usize, to: usize, is_long: &impl Fn(usize, usize) -> bool) -> Option<Stretch> {
        let left = self.left(from, to)?;
        let one = Some(Stretch { cuts: Vec::new(), left });
        let Some(cut) = self.cut(from, to, is_long) else { return one };
        let (before, after) = (self.stretch(from, cut, is_long)?, self.stretch(cut, to, is_long)?);
        let several = before.left + after.left;
        let drifts = self.left_by_drift(from, to)? < several;
        let cuts = if drifts { Vec::new() } else { [before.cuts, vec![cut], after.cuts].concat() };
        Some(Stretch { cuts, left: several })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equations y = a x + noise, two in each of 200 windows; a over the windows.
    fn sums(coefficient: impl Fn(usize) -> f64) -> Sums {
        let x: Vec<f64> = (0..400).map(|row| (0.37 * f64::from(row)).sin()).collect();
        let noise = |row: usize| 0.1 * ((43758.5453 * (12.9898 * row as f64).sin()).rem_euclid(1.0) - 0.5);
        let y: Vec<f64> = x.iter().enumerate().map(|(row, x)| coefficient(row / 2) * x + noise(row)).collect();
        Sums::of(&[&x], &y, &(1..=200).map(f64::from).collect::<Vec<_>>())
    }

    fn cuts(sums: &Sums) -> Vec<usize> {
        sums.stretch(0, 200, &|from, to| to - from >= 20).unwrap().cuts
    }

    fn step(window: usize, at: usize) -> f64 {
        if window < at { 0.0 } else { 0.3 }
    }

    #[test]
    fn a_change_is_found_where_it_is_and_none_where_none_is() {
        let found = cuts(&sums(|window| 1.0 + step(window, 120)));
        assert!(found.len() == 1 && (118..=122).contains(&found[0]), "{found:?}");
        assert_eq!(cuts(&sums(|_| 1.0)), [0; 0]);
        assert_eq!(cuts(&sums(|window| 1.0 + step(window, 10))), [0; 0], "too short a stage");
    }

    #[test]
    fn a_drift_is_no_change_and_a_staircase_no_drift() {
        assert_eq!(cuts(&sums(|window| 1.0 + 0.005 * window as f64)), [0; 0]);
        let found = cuts(&sums(|window| 1.0 + step(window, 70) + step(window, 140)));
        assert!(found.len() == 2 && found[0].abs_diff(70) <= 2 && found[1].abs_diff(140) <= 2, "{found:?}");
    }
}
