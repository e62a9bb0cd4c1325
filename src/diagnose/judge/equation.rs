//! A law as a regression: which column is the target, which ones explain it.
//!
//! `m q̈ + Σ θ_j f_j = F` is solved for the column that carries the most propagated noise, so that it stands alone on
//! one side: as a rule q̈ = F/m − Σ (θ_j/m) f_j; F = m q̈ + Σ θ_j f_j where F is the output, or is the noisier. A
//! column ∫ φ' F dt beside them takes what a little delay of the excitation would explain.

use super::beginning;
use super::memory::Memory;
use super::record::{Column, Record, Timing};
use super::regression::{self, Normal};
use super::windows::COUNT;
use crate::law::{Effect, Term};
use nalgebra::{DMatrix, DVector};

/// Which column stands alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The inertia term.
    Inertia,
    /// The force.
    Force,
}

/// A law's form on a record.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Equation {
    /// Its terms.
    pub(in crate::diagnose) terms: Vec<Term>,
    pub(in crate::diagnose) target: Target,
    pub(in crate::diagnose) timing: Timing,
    /// The target's rows.
    pub(in crate::diagnose) right: Column,
    /// Std of the target by window length.
    pub(in crate::diagnose) spread: [f64; COUNT],
    /// Test functions of a window, by its length.
    functions: [usize; COUNT],
    /// By window length, whether a window holds readings at all.
    pub(in crate::diagnose) tells: [bool; COUNT],
    /// Whether the force's slope is among the columns.
    takes_delay: bool,
    /// What explains it: the force where it is not the target, the terms but the inertia where that is, the force's
    /// slope last.
    pub(in crate::diagnose) left: Vec<Column>,
    /// What each of them is to the target.
    roles: Vec<Role>,
    /// What its terms remember; all columns of the equations that this voids are 0.
    pub(super) memory: Memory,
}

/// What a column is to the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::diagnose) enum Role {
    /// It holds the target itself: q̈ where that is the target, F where it is.
    Holds,
    /// It is the other side of the law: F where q̈ is the target, q̈ where F is.
    Closes,
    /// It holds q̈ beside the law's own: a filtered q̈ is a smoother q̈ too, and what is left below the floor with it
    /// is the readings' noise.
    Smooths,
    /// None of these.
    Explains,
}

impl Role {
    /// Whether errors with it count no lower than what the sensors alone would leave.
    pub(super) fn may_smooth(self) -> bool {
        matches!(self, Role::Holds | Role::Smooths)
    }
}

impl Equation {
    /// Of a law of these terms; `nuisance`: with the column that takes a little delay.
    pub(in crate::diagnose) fn new(
        record: &Record,
        terms: &[Term],
        target: Target,
        timing: Timing,
        nuisance: bool,
    ) -> Equation {
        let mut equation = Equation::from_rest(record, terms, target, timing, nuisance);
        for (index, term) in terms.iter().enumerate() {
            let law = (equation.left.as_slice(), &equation.right, &equation.memory);
            let of = |place| Some((place, beginning::begun(record, (*term, timing), law, place)?));
            let begun = equation.place(index).and_then(of);
            begun.into_iter().for_each(|(place, column)| equation.left[place] = column);
        }
        equation.voided()
    }

    /// The same on a record before which nothing moved.
    pub(super) fn from_rest(
        record: &Record,
        terms: &[Term],
        target: Target,
        timing: Timing,
        nuisance: bool,
    ) -> Equation {
        let right = match target {
            Target::Inertia => record.measured_inertia(),
            Target::Force => record.force(timing),
        };
        let mut left = Vec::new();
        if target == Target::Inertia && record.forced {
            left.push(record.force(timing));
        }
        let mut roles = vec![Role::Closes; left.len()];
        for term in terms.iter().filter(|term| has_column(**term, target)) {
            left.push(record.term(*term, timing));
            roles.push(role(record, *term, target));
        }
        let takes_delay = nuisance && record.forced;
        if takes_delay {
            left.push(record.force_slope(timing));
            roles.push(if target == Target::Inertia { Role::Closes } else { Role::Explains });
        }
        let functions = [0, 1, 2].map(|which| record.windows[which].functions);
        let spread = [0, 1, 2].map(|which| spread(&right[which], functions[which]));
        let tells = [0, 1, 2].map(|which| record.windows[which].length >= record.sample_time);
        let memory = record.memory(terms);
        let terms = terms.to_vec();
        Equation { terms, target, timing, right, spread, functions, tells, takes_delay, left, roles, memory }.voided()
    }

    /// With nothing in the equations that are none.
    fn voided(mut self) -> Equation {
        for which in 0..COUNT {
            for row in &self.memory.void[which] {
                self.right[which][*row] = 0.0;
                self.left.iter_mut().for_each(|column| column[which][*row] = 0.0);
            }
        }
        self
    }

    /// Which column a term has; none where it is the target or stands in the excitation's.
    pub(super) fn place(&self, index: usize) -> Option<usize> {
        let own = |term: &&Term| has_column(**term, self.target);
        let first = self.left.len() - usize::from(self.takes_delay) - self.terms.iter().filter(own).count();
        own(&&self.terms[index]).then(|| first + self.terms[..index].iter().filter(own).count())
    }

    /// The columns of one window length.
    pub(in crate::diagnose) fn columns(&self, which: usize) -> Vec<&[f64]> {
        self.left.iter().map(|column| column[which].as_slice()).collect()
    }

    /// The same with one more term, whose column stands before the force's slope.
    pub(in crate::diagnose) fn with(&self, record: &Record, term: Term) -> Equation {
        let mut equation = self.clone();
        let place = equation.left.len() - usize::from(equation.takes_delay);
        if has_column(term, self.target) {
            equation.left.insert(place, record.term(term, self.timing));
            equation.roles.insert(place, role(record, term, self.target));
        }
        equation.terms.push(term);
        equation.memory = record.memory(&equation.terms);
        equation.voided()
    }

    /// The same with the inertia term of another record as its target.
    pub(in crate::diagnose) fn for_motion(&self, record: &Record) -> Equation {
        let right = record.measured_inertia();
        let spread = [0, 1, 2].map(|which| spread(&right[which], self.functions[which]));
        Equation { right, spread, ..self.clone() }.voided()
    }

    /// The same regressors for other rows, such as noise, that none of them holds.
    pub(in crate::diagnose) fn for_rows(&self, right: Column) -> Equation {
        Equation { right, roles: vec![Role::Explains; self.left.len()], ..self.clone() }.voided()
    }

    /// The same without the term of that position.
    pub(in crate::diagnose) fn without(&self, index: usize) -> Equation {
        let mut equation = self.clone();
        if let Some(place) = self.place(index) {
            equation.left.remove(place);
            equation.roles.remove(place);
        }
        equation.terms.remove(index);
        equation
    }

    /// What a residual under a solution is relative to the target that the law then has.
    pub(super) fn relative(&self, which: usize, solution: &[f64]) -> f64 {
        if !self.roles.contains(&Role::Holds) {
            return 1.0;
        }
        let (columns, right) = (self.columns(which), &self.right[which]);
        let weights = vec![1.0; right.len()];
        let energy = right.iter().map(|value| value * value).sum();
        relative(&Normal::of(&columns, right, &weights), energy, solution, &self.roles)
    }

    /// What each column is to the target, that of a candidate last.
    pub(super) fn roles_with(&self, candidate: Option<Role>) -> Vec<Role> {
        self.roles.iter().copied().chain(candidate).collect()
    }

    /// The columns of one window length that neither hold the target nor close the law; none where nothing closes it.
    pub(super) fn aside(&self, which: usize) -> Vec<&[f64]> {
        let aside = aside(&self.roles);
        aside.into_iter().map(|index| self.left[index][which].as_slice()).collect()
    }

    /// Share of a column's variance that the law's columns are, over windows of one length.
    pub(in crate::diagnose) fn resemblance(&self, which: usize, column: &[f64]) -> f64 {
        let columns = self.columns(which);
        let weights = vec![1.0; column.len()];
        let Some(solution) = Normal::of(&columns, column, &weights).solve() else { return 0.0 };
        let left = regression::residuals(&columns, column, &solution);
        // a column that hardly varies, a constant force, is measured by its size
        let size = column.iter().map(|value| value * value).sum::<f64>() / column.len().max(1) as f64;
        let spread = spread(column, self.functions[which]).powi(2);
        let variance = if spread > CONSTANT * size { spread } else { size };
        let mean = left.iter().map(|value| value * value).sum::<f64>() / column.len().max(1) as f64;
        if variance > 0.0 { 1.0 - mean / variance } else { 1.0 }
    }

    /// How much later than the timing the excitation acted, s, and what a change of the last entry of the solution
    /// changes in it; none without the column that takes it.
    pub(in crate::diagnose) fn delay(&self, solution: &[f64]) -> Option<(f64, f64)> {
        let last = solution.last().filter(|_| self.takes_delay)?;
        match self.target {
            Target::Force => Some((-last, 1.0)),
            Target::Inertia => Some((last / solution[0], solution[0].abs().recip())),
        }
    }

    /// Coefficients of the law's terms, the last entries those of candidates, from a solution of the regression, with
    /// the matrix that takes the solution's small changes to theirs. `inertia` is the inertia of a free motion.
    pub(in crate::diagnose) fn coefficients(
        &self,
        solution: &[f64],
        forced: bool,
        inertia: f64,
    ) -> (Vec<f64>, Vec<Vec<f64>>) {
        let (mass, mut next) = match self.target {
            Target::Inertia if forced => (solution[0].recip(), 1),
            Target::Inertia => (inertia, 0),
            Target::Force => (1.0, 0),
        };
        let divides = self.target == Target::Inertia && forced;
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        for term in &self.terms {
            let mut slope = vec![0.0; solution.len()];
            let mut value = if delay_of(*term).is_some() { 1.0 } else { mass };
            if has_column(*term, self.target) {
                let sign = if self.target == Target::Force { 1.0 } else { -mass };
                slope[next] = sign;
                value = sign * solution[next];
                next += 1;
            }
            if divides && delay_of(*term).is_none() {
                slope[0] = -mass * value;
            }
            values.push(value);
            slopes.push(slope);
        }
        (values, slopes)
    }
}

impl Equation {
    /// The inertia among coefficients of the terms.
    pub(super) fn inertia(&self, coefficients: &[f64]) -> Option<f64> {
        self.terms.iter().position(|term| *term == Term::Inertia).map(|index| coefficients[index])
    }

    /// The regression's solution that these coefficients of the terms are; none where a free inertia is 0.
    pub(in crate::diagnose) fn solution(&self, coefficients: &[f64], forced: bool) -> Option<Vec<f64>> {
        let place = self.terms.iter().position(|term| *term == Term::Inertia);
        let mass = place.map_or(1.0, |index| coefficients[index]);
        let (first, by) = match self.target {
            Target::Force => (None, 1.0),
            Target::Inertia if mass == 0.0 => return None,
            Target::Inertia => (forced.then_some(mass.recip()), -mass.recip()),
        };
        let own = self.terms.iter().zip(coefficients).filter(|(term, _)| has_column(**term, self.target));
        Some(first.into_iter().chain(own.map(|(_, value)| by * value)).collect())
    }
}

/// Whether a term has a column among those that explain: the inertia has none where it is the target, a delay or a lag
/// none as it is in the excitation's own.
fn has_column(term: Term, target: Target) -> bool {
    delay_of(term).is_none() && (target == Target::Force || term != Term::Inertia)
}

/// What a term's column is to the target.
pub(in crate::diagnose) fn role(record: &Record, term: Term, target: Target) -> Role {
    let holds = match target {
        Target::Inertia => record.accelerates(term),
        Target::Force => term.uses_excitation(),
    };
    match holds {
        true => Role::Holds,
        false if term == Term::Inertia => Role::Closes,
        false if record.accelerates(term) => Role::Smooths,
        false => Role::Explains,
    }
}

/// Columns that neither hold the target nor close the law; none where nothing closes it.
fn aside(roles: &[Role]) -> Vec<usize> {
    let is_closed = roles.contains(&Role::Closes);
    (0..roles.len()).filter(|index| is_closed && matches!(roles[*index], Role::Explains | Role::Smooths)).collect()
}

/// What a residual is relative to the target that a law then has: of y = X b + z, z what the columns that hold the
/// target give, it is a law of y − z, and what cancels the target explains nothing of it. Both are taken less what the
/// law's other terms give of them: a filtered q̇ is q̇ and some q̈. 1 where nothing holds the target. By the sums of
/// all columns and the target's Σ weight y².
pub(super) fn relative(sums: &Normal, energy: f64, solution: &[f64], roles: &[Role]) -> f64 {
    let own: Vec<usize> = (0..roles.len()).filter(|index| roles[*index] == Role::Holds).collect();
    if own.is_empty() {
        return 1.0;
    }
    let aside = aside(roles);
    let gram = DMatrix::from_fn(aside.len(), aside.len(), |a, b| sums.gram[(aside[a], aside[b])]);
    let beyond = |square: f64, products: DVector<f64>| {
        let normal = Normal { gram: gram.clone(), moment: products };
        let given = normal.solve().map_or(0.0, |solution| normal.moment.iter().zip(solution).map(|(a, b)| a * b).sum());
        square - given
    };
    let with = |product: &dyn Fn(usize) -> f64| own.iter().map(|index| solution[*index] * product(*index)).sum::<f64>();
    let all =
        energy - 2.0 * with(&|index| sums.moment[index]) + with(&|index| with(&|other| sums.gram[(index, other)]));
    let target = beyond(energy, DVector::from_fn(aside.len(), |a, _| sums.moment[aside[a]]));
    let products = |a: usize, _| sums.moment[aside[a]] - with(&|index| sums.gram[(aside[a], index)]);
    let law = beyond(all, DVector::from_fn(aside.len(), products));
    (target / law).abs().sqrt()
}

/// How late the excitation acts by a term, s, as far as its rate tells: a delay, or an actuator's time constant.
pub(in crate::diagnose) fn delay_of(term: Term) -> Option<f64> {
    match term {
        Term::Effect(Effect::ExcitationDelay { delay }) => Some(delay.value()),
        Term::Effect(Effect::ActuatorLag { time }) => Some(time.value()),
        _ => None,
    }
}

/// Variance ÷ mean square of a column below which it is a constant.
const CONSTANT: f64 = 1e-12;

/// Std of a column's rows, each test function about its own mean: a constant force is no motion to be explained.
fn spread(rows: &[f64], functions: usize) -> f64 {
    let count = rows.len() / functions.max(1);
    let variance = |function: usize| {
        let own = || rows.iter().skip(function).step_by(functions);
        let mean = own().sum::<f64>() / count as f64;
        own().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64
    };
    ((0..functions).map(variance).sum::<f64>() / functions as f64).sqrt()
}
