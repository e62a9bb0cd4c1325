//! What any two candidates leave together beside a law, at the cost of one product a pair.
//!
//! Candidates and target are made orthogonal to the law's columns once (Frisch and Waugh, Econometrica 1 (1933), 387);
//! two of them then are a regression with two unknowns. Sums are kept by the parts of the record that are held out, so
//! that each part is predicted from the others.

use super::equation::{Equation, Role};
use super::held_out::Folds;
use super::record::Column;
use super::regression::{self, Normal};
use super::windows::COUNT;

/// Energy of a candidate that the law's columns leave, below which it is one of them.
const NONE: f64 = 1e-9;

/// Square of the correlation of two candidates from which they are one.
const ONE: f64 = 0.9999;

/// A law beside which pairs are tried.
pub(in crate::diagnose) struct PairScreen<'a> {
    equation: &'a Equation,
    folds: &'a Folds,
    /// By window length.
    parts: [Option<Part>; COUNT],
    /// Share of what the law leaves that the sensors alone would leave, by window length.
    sensors: [f64; COUNT],
}

/// The law on windows of one length.
struct Part {
    weights: Vec<f64>,
    normal: Normal,
    /// The target less what the law's columns give of it, times the roots of the weights.
    target: Vec<f64>,
    /// Its energy, by part of the record.
    energy: Vec<f64>,
    /// The target less what the law's terms give of it that do not close it.
    open: Vec<f64>,
}

/// A candidate beside the law.
pub(in crate::diagnose) struct Partialled {
    /// Whether errors with it count no lower than the floor.
    smooths: bool,
    /// By window length; none where the law's columns are it.
    own: [Option<Own>; COUNT],
}

/// A candidate on windows of one length, less what the law's columns give of it.
struct Own {
    rows: Vec<f64>,
    energy: Vec<f64>,
    /// Product with the target, by part of the record.
    product: Vec<f64>,
    /// Of one that holds the target: less what the law's terms give of it that do not close it.
    open: Option<Vec<f64>>,
}

/// What two candidates come to.
#[derive(Clone, Copy, Debug)]
pub(in crate::diagnose) struct Together {
    /// Σ ln(error with both ÷ without) over the window lengths.
    pub(in crate::diagnose) score: f64,
    /// Their coefficients in the regression, at the longest windows that tell.
    pub(in crate::diagnose) coefficients: [f64; 2],
}

impl<'a> PairScreen<'a> {
    /// `sensors`: the share of the law's energy that the sensors alone would leave.
    pub(in crate::diagnose) fn new(folds: &'a Folds, equation: &'a Equation, sensors: [f64; COUNT]) -> PairScreen<'a> {
        let part = |which: usize| {
            let (columns, right) = (equation.columns(which), &equation.right[which]);
            let (_, weights) = regression::fit(&columns, right, &vec![1.0; right.len()])?;
            let normal = Normal::of(&columns, right, &weights);
            let target = left(&columns, &normal, right, &weights)?;
            let energy = folds.products(which, &target, &target);
            let open = aside(equation, which, right, &weights)?;
            Some(Part { weights, normal, target, energy, open })
        };
        let parts = [0, 1, 2].map(|which| part(which).filter(|_| equation.tells[which]));
        PairScreen { equation, folds, parts, sensors }
    }

    /// A candidate's column beside the law.
    pub(in crate::diagnose) fn partialled(&self, (column, role): &(Column, Role)) -> Partialled {
        let own = |which: usize| {
            let part = self.parts[which].as_ref()?;
            let columns = self.equation.columns(which);
            let sums = Normal::of(&columns, &column[which], &part.weights);
            let normal = Normal { gram: part.normal.gram.clone(), moment: sums.moment };
            let rows = left(&columns, &normal, &column[which], &part.weights)?;
            let energy = self.folds.products(which, &rows, &rows);
            let whole =
                column[which].iter().zip(&part.weights).map(|(value, weight)| weight * value * value).sum::<f64>();
            let product = self.folds.products(which, &rows, &part.target);
            let holds = *role == Role::Holds;
            let open = if holds { Some(aside(self.equation, which, &column[which], &part.weights)?) } else { None };
            (energy.iter().sum::<f64>() > NONE * whole).then_some(Own { rows, energy, product, open })
        };
        Partialled { smooths: role.may_smooth(), own: [0, 1, 2].map(own) }
    }

    /// What two candidates come to, each part of the record predicted from the others. None where they are one.
    pub(in crate::diagnose) fn together(&self, one: &Partialled, other: &Partialled) -> Option<Together> {
        let (mut score, mut coefficients, mut told) = (0.0, [0.0; 2], false);
        for which in 0..COUNT {
            let Some(part) = &self.parts[which] else { continue };
            let (Some(a), Some(b)) = (&one.own[which], &other.own[which]) else { return None };
            let common = self.folds.products(which, &a.rows, &b.rows);
            let sums = |fold: usize| Sums {
                own: [a.energy[fold], b.energy[fold]],
                common: common[fold],
                target: [a.product[fold], b.product[fold]],
                energy: part.energy[fold],
            };
            let each: Vec<Sums> = (0..common.len()).map(sums).collect();
            let whole = each.iter().fold(Sums::default(), Sums::plus);
            let mut left = 0.0;
            for held_out in &each {
                left += held_out.left(whole.less(held_out).solved()?);
            }
            coefficients = whole.solved()?;
            let least = if one.smooths || other.smooths { self.sensors[which] } else { 0.0 };
            score += 0.5 * (left / whole.energy * part.relative([a, b], coefficients)).max(least).ln();
            told = true;
        }
        (told && score.is_finite()).then_some(Together { score, coefficients })
    }
}

impl Part {
    /// What a residual's energy is relative to the target that the law then has (see `equation::relative`).
    fn relative(&self, pair: [&Own; 2], coefficients: [f64; 2]) -> f64 {
        let energy = |rows: &[f64]| rows.iter().map(|value| value * value).sum::<f64>();
        let holding = pair.iter().zip(coefficients).filter_map(|(own, value)| Some((own.open.as_ref()?, value)));
        let mut law: Option<Vec<f64>> = None;
        for (rows, coefficient) in holding {
            let own = law.get_or_insert_with(|| self.open.clone());
            own.iter_mut().zip(rows).for_each(|(law, value)| *law -= coefficient * value);
        }
        law.map_or(1.0, |law| energy(&self.open) / energy(&law))
    }
}

/// Rows less what the law's terms give of them that do not close it, times the roots of the weights.
fn aside(equation: &Equation, which: usize, rows: &[f64], weights: &[f64]) -> Option<Vec<f64>> {
    let columns = equation.aside(which);
    left(&columns, &Normal::of(&columns, rows, weights), rows, weights)
}

/// Rows less what the law's columns give of them, times the roots of the weights.
fn left(columns: &[&[f64]], normal: &Normal, rows: &[f64], weights: &[f64]) -> Option<Vec<f64>> {
    let left = regression::residuals(columns, rows, &normal.solve()?);
    Some(left.iter().zip(weights).map(|(value, weight)| weight.sqrt() * value).collect())
}

/// Sums of products of two candidates with each other and with the target.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    own: [f64; 2],
    common: f64,
    target: [f64; 2],
    energy: f64,
}

impl Sums {
    fn combined(&self, other: &Sums, sign: f64) -> Sums {
        let two = |a: [f64; 2], b: [f64; 2]| [a[0] + sign * b[0], a[1] + sign * b[1]];
        Sums {
            own: two(self.own, other.own),
            common: self.common + sign * other.common,
            target: two(self.target, other.target),
            energy: self.energy + sign * other.energy,
        }
    }

    fn plus(self, other: &Sums) -> Sums {
        self.combined(other, 1.0)
    }

    fn less(&self, other: &Sums) -> Sums {
        self.combined(other, -1.0)
    }

    /// The coefficients of both; none where they are one.
    fn solved(&self) -> Option<[f64; 2]> {
        let [a, b] = self.own;
        let determinant = a * b - self.common * self.common;
        let [d, e] = self.target;
        let solution = [(b * d - self.common * e) / determinant, (a * e - self.common * d) / determinant];
        (determinant > (1.0 - ONE) * a * b).then_some(solution)
    }

    /// Energy that these coefficients leave.
    fn left(&self, [one, other]: [f64; 2]) -> f64 {
        let ([a, b], [d, e]) = (self.own, self.target);
        let explained = 2.0 * (one * d + other * e);
        self.energy - explained + one * one * a + 2.0 * one * other * self.common + other * other * b
    }
}
