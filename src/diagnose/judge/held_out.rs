//! Errors on what a law has not been fitted to.
//!
//! The record is cut into five contiguous parts; the law is fitted to the windows of four, those nearer than half a
//! window to the fifth left out, and judged by the windows of the fifth. Inner parameters are chosen by the training
//! windows alone.

use super::equation::{Equation, Role, relative};
use super::record::{Column, Record};
use super::regression::{self, Normal};
use super::windows::COUNT;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Parts of a record that are held out in turn: four fifths of it train, and a stretch of its own tests.
const FOLDS: usize = 5;

/// Fewest equations of which an error is told: its own error is then a quarter, 1 ÷ √(2 · 8).
const FEWEST: usize = 8;

/// Which equations train and which are held out, by window length and part.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Folds {
    /// 1 for an equation that trains, else 0.
    training: [Vec<Vec<f64>>; COUNT],
    /// Equations held out.
    held_out: [Vec<Vec<usize>>; COUNT],
    /// The same as ranges that leave none out.
    parts: [Vec<Range<usize>>; COUNT],
}

/// What is held out, and how well it is predicted.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct HeldOut {
    /// Residual of every equation; NaN where no part could be fitted.
    pub(in crate::diagnose) residuals: Column,
    /// RMS residual ÷ std of the target, by window length; NaN where nothing could be told.
    pub(in crate::diagnose) errors: [f64; COUNT],
    /// By window length, equations that the law's loops leave void.
    void: [Vec<usize>; COUNT],
}

impl Folds {
    pub(in crate::diagnose) fn new(record: &Record) -> Folds {
        let part = record.duration / FOLDS as f64;
        let bounds = |fold: usize| [part * fold as f64, part * (fold + 1) as f64];
        let training = [0, 1, 2].map(|which| {
            let windows = &record.windows[which];
            let trains = |row: usize, [from, to]: [f64; 2]| {
                let centre = windows.centre(row);
                f64::from(u8::from(centre < from - 0.5 * windows.length || centre >= to + 0.5 * windows.length))
            };
            (0..FOLDS).map(|fold| (0..windows.rows()).map(|row| trains(row, bounds(fold))).collect()).collect()
        });
        let held_out = [0, 1, 2].map(|which| {
            let windows = &record.windows[which];
            let inside = |row: &usize, [from, to]: [f64; 2]| (from..to).contains(&windows.centre(*row));
            (0..FOLDS).map(|fold| (0..windows.rows()).filter(|row| inside(row, bounds(fold))).collect()).collect()
        });
        let parts = [0, 1, 2].map(|which| {
            let windows = &record.windows[which];
            let before =
                |bound: f64| windows.functions * windows.centres.iter().filter(|centre| **centre < bound).count();
            let last = |fold: usize| if fold + 1 == FOLDS { windows.rows() } else { before(bounds(fold)[1]) };
            (0..FOLDS).map(|fold| before(bounds(fold)[0])..last(fold)).collect()
        });
        Folds { training, held_out, parts }
    }

    /// Products of two sets of equations' rows, by the part of the record that holds them out.
    pub(super) fn products(&self, which: usize, one: &[f64], other: &[f64]) -> Vec<f64> {
        let sum = |rows: &Range<usize>| one[rows.clone()].iter().zip(&other[rows.clone()]).map(|(a, b)| a * b).sum();
        self.parts[which].iter().map(sum).collect()
    }

    /// A law's errors.
    pub(in crate::diagnose) fn judge(&self, equation: &Equation) -> HeldOut {
        self.judge_with(equation, &|_| None)
    }

    /// The same with one more column in each part, and what it is to the target.
    pub(in crate::diagnose) fn judge_with<'a>(
        &self,
        equation: &Equation,
        joining: &dyn Fn(usize) -> Option<(&'a Column, Role)>,
    ) -> HeldOut {
        let residuals = [0, 1, 2].map(|which| {
            let mut left = vec![f64::NAN; equation.right[which].len()];
            for fold in 0..FOLDS {
                let joined = joining(fold);
                let mut columns = equation.columns(which);
                columns.extend(joined.map(|(column, _)| column[which].as_slice()));
                let right = &equation.right[which];
                let Some((solution, weights)) = regression::fit(&columns, right, &self.training[which][fold]) else {
                    continue;
                };
                let roles = equation.roles_with(joined.map(|(_, role)| role));
                let scale = if roles.contains(&Role::Holds) {
                    let energy = weights.iter().zip(right).map(|(weight, value)| weight * value * value).sum();
                    relative(&Normal::of(&columns, right, &weights), energy, &solution, &roles)
                } else {
                    1.0
                };
                for row in &self.held_out[which][fold] {
                    let predicted: f64 =
                        columns.iter().zip(&solution).map(|(column, value)| column[*row] * value).sum();
                    left[*row] = scale * (right[*row] - predicted);
                }
            }
            left
        });
        HeldOut::new(residuals, equation)
    }
}

impl HeldOut {
    fn new(mut residuals: Column, equation: &Equation) -> HeldOut {
        for (left, void) in residuals.iter_mut().zip(&equation.void) {
            void.iter().for_each(|row| left[*row] = f64::NAN);
        }
        let errors = [0, 1, 2].map(|which| {
            let told = || residuals[which].iter().filter(|value| value.is_finite());
            let tells = told().count() >= FEWEST && equation.tells[which];
            if tells { mean_square(told()).sqrt() / equation.spread[which] } else { f64::NAN }
        });
        HeldOut { residuals, errors, void: equation.void.clone() }
    }

    /// Errors of a law whose numbers are held, over all windows.
    pub(in crate::diagnose) fn as_given(equation: &Equation, solutions: &[Vec<f64>; COUNT]) -> HeldOut {
        let residuals = [0, 1, 2].map(|which| {
            let scale = equation.relative(which, &solutions[which]);
            let left = regression::residuals(&equation.columns(which), &equation.right[which], &solutions[which]);
            left.into_iter().map(|value| scale * value).collect()
        });
        HeldOut::new(residuals, equation)
    }

    /// The same with errors no lower than a floor.
    pub(in crate::diagnose) fn no_lower(&self, floor: &[f64; COUNT]) -> HeldOut {
        let raised = |error: f64, floor: f64| if error.is_nan() { error } else { error.max(floor) };
        let errors = std::array::from_fn(|which| raised(self.errors[which], floor[which]));
        HeldOut { errors, ..self.clone() }
    }

    /// Own ÷ another's error over the equations that both tell; NaN where one tells none.
    fn ratio(&self, before: &HeldOut, which: usize) -> f64 {
        let ratio = self.errors[which] / before.errors[which];
        if self.void[which] == before.void[which] {
            return ratio;
        }
        let share = |one: &HeldOut, other: &HeldOut| {
            let told = || one.residuals[which].iter().zip(&other.residuals[which]).filter(|(own, _)| own.is_finite());
            let both = told().filter(|(_, other)| other.is_finite());
            mean_square(both.map(|(own, _)| own)) / mean_square(told().map(|(own, _)| own))
        };
        ratio * (share(self, before) / share(before, self)).sqrt()
    }

    /// S = Σ ln(own error ÷ another's) over the window lengths that tell both; 0 where none does.
    pub(in crate::diagnose) fn score(&self, before: &HeldOut) -> f64 {
        self.ratios(before).into_iter().map(f64::ln).sum()
    }

    /// Ratios own ÷ another's error, of the window lengths that tell both.
    pub(in crate::diagnose) fn ratios(&self, before: &HeldOut) -> Vec<f64> {
        (0..COUNT).map(|which| self.ratio(before, which)).filter(|ratio| !ratio.is_nan()).collect()
    }
}

fn mean_square<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let [sum, count] = values.fold([0.0; 2], |[sum, count], value| [sum + value * value, count + 1.0]);
    sum / count
}

/// Sums that every candidate beside a law shares, so that one more column costs little: the weights are those of the
/// law without it.
pub(in crate::diagnose) struct Screen<'a> {
    folds: &'a Folds,
    equation: &'a Equation,
    /// By window length and part: weights, sums of the law's columns, Σ weight target².
    parts: [Vec<Option<Part>>; COUNT],
    /// Share of what the law leaves that the sensors alone would leave, by window length.
    sensors: [f64; COUNT],
}

struct Part {
    weights: Vec<f64>,
    normal: Normal,
    energy: f64,
    /// Weighted Σ residual² of the law ÷ Σ target².
    left: f64,
}

impl<'a> Screen<'a> {
    /// `sensors`: the share of the law's energy that the sensors alone would leave.
    pub(in crate::diagnose) fn new(folds: &'a Folds, equation: &'a Equation, sensors: [f64; COUNT]) -> Screen<'a> {
        let parts = [0, 1, 2].map(|which| {
            let (columns, right) = (equation.columns(which), &equation.right[which]);
            let part = |fold: usize| {
                let (solution, weights) = regression::fit(&columns, right, &folds.training[which][fold])?;
                let energy: f64 = weights.iter().zip(right).map(|(weight, value)| weight * value * value).sum();
                let normal = Normal::of(&columns, right, &weights);
                let explained: f64 = solution.iter().zip(normal.moment.iter()).map(|(value, own)| value * own).sum();
                Some(Part { normal, weights, energy, left: (energy - explained) / energy })
            };
            (0..FOLDS).map(part).collect()
        });
        Screen { folds, equation, parts, sensors }
    }

    /// Of several variants of one candidate: which one each part's training prefers among those whose coefficient in
    /// the regression is allowed, if there are any, and the errors of that choice.
    pub(in crate::diagnose) fn choose(
        &self,
        variants: &[&(Column, Role)],
        allows: &dyn Fn(f64) -> bool,
    ) -> (Vec<usize>, HeldOut) {
        let fits: Vec<Vec<[Option<Fitted>; COUNT]>> = variants.iter().map(|variant| self.fit(variant)).collect();
        let loss = |variant: usize, fold: usize| -> f64 {
            let relative = |fitted: &Fitted| fitted.loss * fitted.scale.powi(2);
            fits[variant][fold].iter().flatten().map(|fitted| relative(fitted).max(f64::MIN_POSITIVE).ln()).sum()
        };
        let forbidden = |variant: usize, fold: usize| {
            let mut fitted = fits[variant][fold].iter().rev().flatten();
            fitted.next().and_then(|fitted| fitted.solution.last()).is_some_and(|value| !allows(*value))
        };
        let best = |fold: usize| {
            let rank = |variant: &usize| (forbidden(*variant, fold), loss(*variant, fold));
            let ranked = (0..variants.len()).min_by(|a, b| {
                let ([one, other], [a, b]) = ([rank(a).0, rank(b).0], [rank(a).1, rank(b).1]);
                one.cmp(&other).then(a.total_cmp(&b))
            });
            ranked.unwrap_or(0)
        };
        let chosen: Vec<usize> = (0..FOLDS).map(best).collect();
        let residuals = [0, 1, 2].map(|which| {
            let right = &self.equation.right[which];
            let mut left = vec![f64::NAN; right.len()];
            for (fold, variant) in chosen.iter().enumerate() {
                let Some(Fitted { solution, scale, .. }) = &fits[*variant][fold][which] else { continue };
                let mut columns = self.equation.columns(which);
                columns.push(&variants[*variant].0[which]);
                for row in &self.folds.held_out[which][fold] {
                    let predicted: f64 = columns.iter().zip(solution).map(|(column, value)| column[*row] * value).sum();
                    left[*row] = scale * (right[*row] - predicted);
                }
            }
            left
        });
        (chosen, HeldOut::new(residuals, self.equation))
    }

    /// The law with one more column, in every part.
    fn fit(&self, candidate: &(Column, Role)) -> Vec<[Option<Fitted>; COUNT]> {
        (0..FOLDS).map(|fold| [0, 1, 2].map(|which| self.fit_part(which, fold, candidate))).collect()
    }

    fn fit_part(&self, which: usize, fold: usize, (column, role): &(Column, Role)) -> Option<Fitted> {
        let part = self.parts[which][fold].as_ref()?;
        let column = &column[which];
        let weighted: Vec<f64> = column.iter().zip(&part.weights).map(|(value, weight)| value * weight).collect();
        let dot = |other: &[f64]| weighted.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
        let columns = self.equation.columns(which);
        let p = columns.len();
        let mut cross: Vec<f64> = columns.iter().map(|column| dot(column)).collect();
        cross.push(dot(column));
        let own = &part.normal;
        let entry = |a: usize, b: usize| if a < p && b < p { own.gram[(a, b)] } else { cross[a.min(b)] };
        let right = dot(&self.equation.right[which]);
        let moment = DVector::from_fn(p + 1, |a, _| if a < p { own.moment[a] } else { right });
        let normal = Normal { gram: DMatrix::from_fn(p + 1, p + 1, entry), moment };
        let solution = normal.solve()?;
        let explained: f64 = solution.iter().zip(normal.moment.iter()).map(|(value, moment)| value * moment).sum();
        let scale = relative(&normal, part.energy, &solution, &self.equation.roles_with(Some(*role)));
        let least = if role.may_smooth() { self.sensors[which] * part.left } else { 0.0 };
        Some(Fitted { loss: ((part.energy - explained) / part.energy).max(least), solution, scale })
    }
}

struct Fitted {
    solution: Vec<f64>,
    /// What a residual is relative to the target that the law then has.
    scale: f64,
    /// Weighted Σ residual² ÷ Σ target² of training.
    loss: f64,
}
