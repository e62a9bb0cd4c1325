//! Drift of the displacement's sensor: what it would leave of a law, and how large it is.
//!
//! A displacement that reads d(t) too much, d slow, leaves Σ θ_j ∂f_j/∂q d(t) of a law Σ θ_j f_j. No effect looks like
//! that, for none knows the time. d is a polynomial in the time of a recording.

use super::equation::{Equation, Target};
use super::record::{Column, Record};
use super::regression::{self, Normal};
use super::windows::PRINCIPAL;
use crate::law::Term;

/// Powers of the time: with six a wave as long as the record is followed to a few per cent.
const POWERS: usize = 6;

/// What the displacement of one recording reads too much: coefficients of 1, τ, τ², …, m, τ from −1 at its beginning to
/// 1 at its end.
pub(in crate::diagnose) type Drift = [f64; POWERS];

/// What each recording's displacement reads too much under a law with these coefficients, and by what factor the
/// residual falls without it; none where nothing tells.
pub(in crate::diagnose) fn drift(
    record: &Record,
    equation: &Equation,
    coefficients: &[f64],
) -> Option<(Vec<Drift>, f64)> {
    let law: Vec<(Term, f64)> = equation.terms.iter().copied().zip(coefficients.iter().copied()).collect();
    let slopes: Vec<Column> = (0..record.motions.len())
        .flat_map(|motion| (0..POWERS).map(move |power| (motion, power)))
        .map(|(motion, power)| record.leaning(&law, motion, power))
        .collect();
    let columns: Vec<&[f64]> = equation.left.iter().chain(&slopes).map(|column| column[PRINCIPAL].as_slice()).collect();
    let right = &equation.right[PRINCIPAL];
    let solve = |columns: &[&[f64]]| Normal::of(columns, right, &vec![1.0; right.len()]).solve();
    let left = |columns: &[&[f64]], solution: &[f64]| -> f64 {
        regression::residuals(columns, right, solution).iter().map(|value| value * value).sum()
    };
    let solution = solve(&columns)?;
    let own = equation.columns(PRINCIPAL);
    let ratio = (left(&columns, &solution) / left(&own, &solve(&own)?)).sqrt();
    // the law stands as F = …, or as q̈ = F/m − … ÷ m
    let factor = match equation.target {
        Target::Force => -1.0,
        Target::Inertia => equation.inertia(coefficients)?,
    };
    let found = solution[equation.left.len()..].chunks_exact(POWERS);
    Some((found.map(|own| std::array::from_fn(|power| factor * own[power])).collect(), ratio))
}
