//! Errors on what a law has not been fitted to.
//!
//! The record is cut into five contiguous parts; the law is fitted to the windows of four, those nearer to the fifth
//! than half a window and the law's memory left out, and judged by the windows of the fifth. Inner parameters and what
//! the excitation did between readings are chosen by the training windows alone.

use super::equation::{Equation, Role, relative};
use super::memory::{FOLDS, Memory};
use super::record::{Column, Record};
use super::regression::{self, Normal};
use super::windows::COUNT;
use crate::diagnose::products::dot;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Fewest equations of which an error is told: its own error is then a quarter, 1 ÷ √(2 · 8).
const FEWEST: usize = 8;

/// Which equations train and which are held out, by window length and part.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Folds {
    /// Where an equation's window has its middle, s.
    centres: [Vec<f64>; COUNT],
    /// Lengths of the windows, s.
    lengths: [f64; COUNT],
    /// Length of a part, s.
    part: f64,
    /// Equations held out.
    held_out: [Vec<Vec<usize>>; COUNT],
    /// The same as ranges that leave none out.
    parts: [Vec<Range<usize>>; COUNT],
}

/// What comes to a law: a column, or none to judge the law alone by the equations that the column's memory leaves.
#[derive(Clone, Copy, Debug)]
pub(in crate::diagnose) struct Joined<'a> {
    pub(in crate::diagnose) column: Option<(&'a Column, Role)>,
    pub(in crate::diagnose) memory: &'a Memory,
}

/// What is held out, and how well it is predicted.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct HeldOut {
    /// Residual of every equation; NaN where no part could be fitted.
    pub(in crate::diagnose) residuals: Column,
    /// RMS residual ÷ std of the target, by window length; NaN where nothing could be told.
    pub(in crate::diagnose) errors: [f64; COUNT],
    /// Σ ln of what training leaves of the target over the window lengths, by part.
    trained: [f64; FOLDS],
    /// Std of the target, by window length; none of windows that tell nothing.
    spread: [Option<f64>; COUNT],
}

impl Folds {
    pub(in crate::diagnose) fn new(record: &Record) -> Folds {
        let part = record.duration / FOLDS as f64;
        let bounds = |fold: usize| [part * fold as f64, part * (fold + 1) as f64];
        let centres = [0, 1, 2].map(|which| {
            let windows = &record.windows[which];
            (0..windows.rows()).map(|row| windows.centre(row)).collect()
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
        let lengths = [0, 1, 2].map(|which| record.windows[which].length);
        Folds { centres, lengths, part, held_out, parts }
    }

    /// 1 for an equation that trains beside a part, else 0: one in which a law with these memories holds nothing of it.
    fn training(&self, which: usize, fold: usize, memories: &[&Memory]) -> Vec<f64> {
        let aside = |bound: usize| {
            0.5 * self.lengths[which] + memories.iter().map(|memory| memory.aside[bound]).fold(0.0, f64::max)
        };
        let [from, to] = [self.part * fold as f64 - aside(fold), self.part * (fold + 1) as f64 + aside(fold + 1)];
        let trains = |centre: &f64| f64::from(u8::from(*centre < from || *centre >= to));
        self.centres[which].iter().map(trains).collect()
    }

    /// Products of two sets of equations' rows, by the part of the record that holds them out.
    pub(super) fn products(&self, which: usize, one: &[f64], other: &[f64]) -> Vec<f64> {
        let sum = |rows: &Range<usize>| dot(&one[rows.clone()], &other[rows.clone()]);
        self.parts[which].iter().map(sum).collect()
    }

    /// A law's errors.
    pub(in crate::diagnose) fn judge(&self, equation: &Equation) -> HeldOut {
        self.judge_with(equation, &|_| None)
    }

    /// The same with what comes to it in each part.
    pub(in crate::diagnose) fn judge_with<'a>(
        &self,
        equation: &Equation,
        joining: &dyn Fn(usize) -> Option<Joined<'a>>,
    ) -> HeldOut {
        let mut trained = [0.0; FOLDS];
        let residuals = [0, 1, 2].map(|which| {
            let mut left = vec![f64::NAN; equation.right[which].len()];
            for (fold, trained) in trained.iter_mut().enumerate() {
                let Some(part) = self.trained(equation, joining(fold), which, fold) else { continue };
                *trained += part.loss.max(f64::MIN_POSITIVE).ln();
                self.held_out[which][fold].iter().for_each(|row| left[*row] = part.left[*row]);
            }
            left
        });
        HeldOut::new(residuals, equation).after(trained)
    }

    /// The law fitted beside one part of the record: what it leaves everywhere, NaN where that is not to be told.
    fn trained(&self, equation: &Equation, joined: Option<Joined>, which: usize, fold: usize) -> Option<Trained> {
        let mut columns = equation.columns(which);
        let own = joined.and_then(|joined| joined.column);
        columns.extend(own.map(|(column, _)| column[which].as_slice()));
        let right = &equation.right[which];
        let memories: Vec<&Memory> = [&equation.memory].into_iter().chain(joined.map(|joined| joined.memory)).collect();
        let training = self.training(which, fold, &memories);
        let (solution, weights) = regression::fit(&columns, right, &training)?;
        let weighted = |values: &[f64]| weights.iter().zip(values).map(|(weight, value)| weight * value * value).sum();
        let roles = equation.roles_with(own.map(|(_, role)| role));
        let energy: f64 = weighted(right);
        let scale = match roles.contains(&Role::Holds) {
            true => relative(&Normal::of(&columns, right, &weights), energy, &solution, &roles),
            false => 1.0,
        };
        let mut left = regression::residuals(&columns, right, &solution);
        left.iter_mut().for_each(|value| *value *= scale);
        let lost: f64 = weighted(&left);
        Some(Trained { left, loss: lost / energy })
    }
}

/// A law fitted beside one part of the record.
struct Trained {
    left: Vec<f64>,
    /// Weighted Σ residual² ÷ Σ target² of training.
    loss: f64,
}

impl HeldOut {
    fn new(mut residuals: Column, equation: &Equation) -> HeldOut {
        for (left, void) in residuals.iter_mut().zip(&equation.memory.void) {
            void.iter().for_each(|row| left[*row] = f64::NAN);
        }
        let spread = [0, 1, 2].map(|which| equation.tells[which].then_some(equation.spread[which]));
        HeldOut { errors: errors(&residuals, &spread), residuals, trained: [0.0; FOLDS], spread }
    }

    fn after(self, trained: [f64; FOLDS]) -> HeldOut {
        HeldOut { trained, ..self }
    }

    /// Of one law under several assumptions on what its sensors hide, each part under the one that its training
    /// prefers: that of index `usual` unless another leaves less than it by more than a tie.
    pub(in crate::diagnose) fn by_part(folds: &Folds, all: &[&HeldOut], usual: usize, tie: f64) -> HeldOut {
        let best = |fold: usize| {
            let others = (0..all.len())
                .map(|index| (all[index].trained[fold] + f64::from(u8::from(index != usual)) * tie, index));
            others.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(usual, |(_, index)| index)
        };
        let mut held = all[usual].clone();
        for fold in 0..FOLDS {
            let chosen = all[best(fold)];
            for which in 0..COUNT {
                let by = match (held.spread[which], chosen.spread[which]) {
                    (Some(own), Some(other)) => own / other,
                    _ => 1.0,
                };
                let rows = folds.held_out[which][fold].iter();
                rows.for_each(|row| held.residuals[which][*row] = by * chosen.residuals[which][*row]);
            }
        }
        HeldOut { errors: errors(&held.residuals, &held.spread), ..held }
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
        let share = |one: &HeldOut, other: &HeldOut| {
            let told = || one.residuals[which].iter().zip(&other.residuals[which]).filter(|(own, _)| own.is_finite());
            let both = told().filter(|(_, other)| other.is_finite());
            mean_square(both.map(|(own, _)| own)) / mean_square(told().map(|(own, _)| own))
        };
        self.errors[which] / before.errors[which] * (share(self, before) / share(before, self)).sqrt()
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

#[cfg(test)]
impl HeldOut {
    /// The same error in every equation.
    pub(in crate::diagnose) fn of_error(error: f64) -> HeldOut {
        let residuals = [0; COUNT].map(|_| vec![error; FEWEST]);
        HeldOut { residuals, errors: [error; COUNT], trained: [0.0; FOLDS], spread: [Some(1.0); COUNT] }
    }
}

/// RMS residual ÷ std of the target, by window length.
fn errors(residuals: &Column, spread: &[Option<f64>; COUNT]) -> [f64; COUNT] {
    [0, 1, 2].map(|which| {
        let told = || residuals[which].iter().filter(|value| value.is_finite());
        let spread = spread[which].filter(|_| told().count() >= FEWEST);
        spread.map_or(f64::NAN, |spread| mean_square(told()).sqrt() / spread)
    })
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
                let (solution, weights) =
                    regression::fit(&columns, right, &folds.training(which, fold, &[&equation.memory]))?;
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
        let columns = self.equation.columns(which);
        let p = columns.len();
        let mut cross: Vec<f64> = columns.iter().map(|column| dot(&weighted, column)).collect();
        cross.push(dot(&weighted, column));
        let own = &part.normal;
        let entry = |a: usize, b: usize| if a < p && b < p { own.gram[(a, b)] } else { cross[a.min(b)] };
        let right = dot(&weighted, &self.equation.right[which]);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten equations of one window length in 10 s, one in the middle of every second.
    fn folds() -> Folds {
        let centres = [0, 1, 2].map(|_| (0..10).map(|row| f64::from(row) + 0.5).collect());
        let held_out = [0, 1, 2].map(|_| (0..FOLDS).map(|fold| vec![2 * fold, 2 * fold + 1]).collect());
        let parts = [0, 1, 2].map(|_| (0..FOLDS).map(|fold| 2 * fold..2 * fold + 2).collect());
        Folds { centres, lengths: [0.8; COUNT], part: 2.0, held_out, parts }
    }

    #[test]
    fn what_a_memory_ties_to_the_part_held_out_does_not_train() {
        let folds = folds();
        let training = |memory: &Memory| -> Vec<usize> {
            let training = folds.training(0, 2, &[memory]);
            (0..10).filter(|row| training[*row] > 0.0).collect()
        };
        assert_eq!(training(&Memory::default()), [0, 1, 2, 3, 6, 7, 8, 9]);
        let aside = [9.0, 9.0, 1.0, 2.0, 9.0, 9.0];
        assert_eq!(training(&Memory { aside, ..Memory::default() }), [0, 1, 2, 8, 9]);
    }

    #[test]
    fn each_part_is_predicted_under_what_its_training_prefers_and_the_usual_where_that_is_alike() {
        let held = |value: f64, trained: [f64; FOLDS]| {
            let residuals = [0, 1, 2].map(|_| vec![value; 10]);
            HeldOut { residuals, errors: [value; COUNT], trained, spread: [Some(1.0); COUNT] }
        };
        let (usual, other) = (held(1.0, [-5.0; FOLDS]), held(2.0, [-4.0, -5.1, -5.0, -7.0, -4.0]));
        let found = HeldOut::by_part(&folds(), &[&other, &usual], 1, 0.2);
        assert_eq!(found.residuals[1], [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0]);
        assert!((found.errors[1] - 1.6_f64.sqrt()).abs() < 1e-12, "{:?}", found.errors);
    }
}
