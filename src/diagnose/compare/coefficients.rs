//! The coefficients that suit the weak equations of a record best, some of them held.

use super::rows::Rows;
use crate::law::{Given, Model, Term};
use crate::weak::{Fit, Regression};
use nalgebra::{DMatrix, DVector};

/// Windows over which residuals count as correlated: four lengths, since they overlap by three quarters.
const LAGS: usize = 16;

/// What of a model's coefficients is held.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    /// The model's terms.
    pub terms: Vec<Term>,
    /// Their coefficients; `None` where sought.
    pub values: Vec<Option<f64>>,
}

/// Coefficients of all terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The terms.
    pub terms: Vec<Term>,
    /// One coefficient per term.
    pub coefficients: Vec<f64>,
    /// Its std; `None` where it is held or the data do not determine it.
    pub std: Vec<Option<f64>>,
    /// Terms whose coefficients the data do not determine.
    pub undetermined: Vec<Term>,
}

impl Held {
    /// Numbers as the model gives them. Free motion (`forced` false) has no scale: its inertia is the model's number,
    /// else 1.
    pub fn as_given(model: &Model, forced: bool) -> Held {
        Held::by(model, |term, given| match (term, given) {
            (_, Given::Known(value)) => Some(value),
            (Term::Inertia, _) if !forced => Some(1.0),
            _ => None,
        })
    }

    /// Every coefficient sought; of free motion all but the inertia.
    pub fn none(model: &Model, forced: bool) -> Held {
        Held::by(model, |term, given| match (term, given) {
            (Term::Inertia, Given::Known(value)) if !forced => Some(value),
            (Term::Inertia, _) if !forced => Some(1.0),
            _ => None,
        })
    }

    fn by(model: &Model, value: impl Fn(Term, Given) -> Option<f64>) -> Held {
        let terms = model.terms.iter().map(|entry| entry.term).collect();
        Held { terms, values: model.terms.iter().map(|entry| value(entry.term, entry.given)).collect() }
    }

    /// Positions of the terms whose coefficients are sought.
    pub fn free(&self) -> Vec<usize> {
        (0..self.values.len()).filter(|index| self.values[*index].is_none()).collect()
    }
}

/// The coefficients that leave the least residual over all windows, by pseudo-inverse.
pub fn best_coefficients(held: &Held, rows: &[Rows]) -> Estimate {
    let free = held.free();
    let mut regression = Regression::new(free.len());
    let mut left = vec![0.0; free.len()];
    for (rows, index) in rows.iter().flat_map(|rows| (0..rows.len()).map(move |index| (rows, index))) {
        let scale = rows.norm.sqrt().recip();
        left.iter_mut().zip(&free).for_each(|(entry, term)| *entry = scale * rows.row(index)[*term]);
        let known = rows.row(index).iter().zip(&held.values);
        let known: f64 = known.map(|(integral, value)| integral * value.unwrap_or(0.0)).sum();
        regression.add(&left, scale * (rows.right[index] - known));
    }
    let mut fit = Fit::new(free.len());
    regression.solve(&mut fit);
    spread_out(held, &free, &fit, rows)
}

fn spread_out(held: &Held, free: &[usize], fit: &Fit, rows: &[Rows]) -> Estimate {
    let mut coefficients: Vec<f64> = held.values.iter().map(|value| value.unwrap_or(0.0)).collect();
    free.iter().zip(&fit.coefficients).for_each(|(index, value)| coefficients[*index] = *value);
    let known: Vec<usize> = (0..free.len()).filter(|position| fit.determined[*position]).collect();
    let indices: Vec<usize> = known.iter().map(|position| free[*position]).collect();
    let variances = variances(&indices, rows, &coefficients);
    let mut std = vec![None; coefficients.len()];
    indices.iter().zip(variances).for_each(|(index, variance)| std[*index] = Some(variance.max(0.0).sqrt()));
    let open = free.iter().filter(|index| std[**index].is_none());
    let undetermined = open.map(|index| held.terms[*index]).collect();
    Estimate { terms: held.terms.clone(), coefficients, std, undetermined }
}

/// Variances of these coefficients, residuals of windows that overlap or follow each other being correlated: A⁻¹ M A⁻¹
/// with A = Σ aaᵀ and M the covariance of the scores a r, Bartlett-weighted over lags (Newey and West, Econometrica 55
/// (1987), 703).
fn variances(indices: &[usize], rows: &[Rows], coefficients: &[f64]) -> Vec<f64> {
    let n = indices.len();
    let (mut information, mut spread) = (DMatrix::<f64>::zeros(n, n), DMatrix::<f64>::zeros(n, n));
    let largest = |index: &usize| rows.iter().map(|rows| rows.largest(*index)).fold(f64::MIN_POSITIVE, f64::max);
    let scale: Vec<f64> = indices.iter().map(largest).collect();
    for rows in rows {
        let residuals = rows.residuals(coefficients);
        let column = |k: usize| DVector::from_fn(n, |i, _| rows.row(k)[indices[i]] / scale[i]);
        let left: Vec<DVector<f64>> = (0..rows.len()).map(column).collect();
        for k in 0..left.len() {
            let weight = rows.norm.recip();
            information += weight * &left[k] * left[k].transpose();
            for lag in 0..LAGS.min(left.len() - k) {
                let share = if lag == 0 { 0.5 } else { 1.0 - lag as f64 / LAGS as f64 };
                let product = share * weight * weight * residuals[k] * residuals[k + lag];
                spread += product * &left[k] * left[k + lag].transpose();
            }
        }
    }
    let Some(inverse) = information.try_inverse() else { return vec![f64::INFINITY; n] };
    let covariance = &inverse * (&spread + spread.transpose()) * &inverse;
    (0..n).map(|i| covariance[(i, i)] / (scale[i] * scale[i])).collect()
}
