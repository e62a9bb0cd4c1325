//! The Cramér–Rao bound of a record.

use super::course::{Course, Sensors};
use super::error::LimitsError;
use super::law::Law;
use super::marginal::{Marginal, Start};
use crate::law::Term;
use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

/// e, eq. (8), below which a law counts as known: a mean error of its coefficients of 5 %, the publication's bound.
pub const SETTLED_ERROR: f64 = 0.05 * 0.05;

/// Part by which the record grows between two looks for the shortest one: as exactly is its length told.
pub(super) const GROWTH: f64 = 0.01;

/// Eigenvalue, or pivot, of an information matrix scaled to a unit diagonal below which it is rounding: a sum of 10⁴
/// products is exact to some 10⁻¹². Nothing is known in that direction.
pub const ROUNDING: f64 = 1e-12;

/// Part in such a direction from which a coefficient counts as touched by it.
const TOUCHED: f64 = 1e-3;

/// What any method could reach on a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// Smallest std of each sought coefficient, in the order of [`Law::sought`]; `None` where the record does not
    /// determine it.
    pub std: Vec<Option<f64>>,
    /// Trace of the inverse information ÷ Σθ²: the smallest mean of e, eq. (8); `None` where a coefficient is not
    /// determined.
    pub relative_error: Option<f64>,
    /// Terms that nothing on this record tells apart, one list per open direction.
    pub open: Vec<Vec<Term>>,
    /// Length of the shortest record from the start whose limit of e is below [`SETTLED_ERROR`], s; `None` where none
    /// is.
    pub shortest_record: Option<f64>,
}

/// The bound of a law on a record, cut into courses at its gaps, each with an initial state of its own.
/// Of a whole record it is unknown; at a switch the law before tells it.
///
/// # Errors
/// [`LimitsError`] for a law without positive inertia, for sensors without noise.
pub fn bound(law: &Law, courses: &[Course], sensors: Sensors, start: Start) -> Result<Bound, LimitsError> {
    sensors.check()?;
    law.check(courses)?;
    let mut marginal = Marginal::new(law, sensors);
    let mut shortest = None;
    let (mut count, mut next_look) = (0_usize, law.sought().len().max(2));
    let begin = courses.first().and_then(|course| course.t.first()).copied().unwrap_or(0.0);
    for course in courses.iter().filter(|course| !course.is_empty()) {
        marginal.begin(course, start);
        for k in 0..course.drives.len() {
            marginal.step(course, k);
            count += 1;
            if shortest.is_none() && count >= next_look {
                next_look = count + 1 + (GROWTH * count as f64) as usize;
                let error = Bound::of(law, &marginal.information).relative_error;
                shortest = error.filter(|error| *error < SETTLED_ERROR).map(|_| course.t[k + 1] - begin);
            }
        }
    }
    Ok(Bound { shortest_record: shortest, ..Bound::of(law, &marginal.information) })
}

impl Bound {
    pub(super) fn of(law: &Law, information: &DMatrix<f64>) -> Bound {
        let n = law.sought().len();
        let terms = |rows: Vec<usize>| rows.into_iter().map(|row| law.terms()[law.sought()[row]]).collect();
        let Some(directions) = Directions::of(information) else {
            let open = vec![terms((0..n).collect())];
            return Bound { std: vec![None; n], relative_error: None, open, shortest_record: None };
        };
        let std: Vec<Option<f64>> = (0..n).map(|row| directions.std(row)).collect();
        Bound {
            relative_error: relative_error(&std, law.coefficients()),
            std,
            open: directions.open.iter().map(|direction| terms(directions.touched_by(*direction))).collect(),
            shortest_record: None,
        }
    }
}

/// The information scaled to a unit diagonal, along its eigenvectors.
struct Directions {
    scale: Vec<f64>,
    eigen: SymmetricEigen<f64, Dyn>,
    /// Eigenvectors of which nothing is known …
    open: Vec<usize>,
    /// … and the others.
    known: Vec<usize>,
}

impl Directions {
    /// None where the information is beyond all numbers.
    fn of(information: &DMatrix<f64>) -> Option<Directions> {
        let n = information.nrows();
        let scale: Vec<f64> = (0..n).map(|row| inverse_root(information[(row, row)])).collect();
        let scaled = DMatrix::from_fn(n, n, |row, column| information[(row, column)] * scale[row] * scale[column]);
        if !scaled.iter().all(|value| value.is_finite()) {
            return None;
        }
        let eigen = eigen(scaled);
        let (open, known) = (0..n).partition(|direction| eigen.eigenvalues[*direction] < ROUNDING);
        Some(Directions { scale, eigen, open, known })
    }

    /// The smallest std of a coefficient, none where an open direction touches it.
    fn std(&self, row: usize) -> Option<f64> {
        let part =
            |direction: &usize| self.eigen.eigenvectors[(row, *direction)].powi(2) / self.eigen.eigenvalues[*direction];
        let determined = self.open.iter().all(|direction| !self.touches(*direction, row));
        determined.then(|| self.scale[row] * self.known.iter().map(part).sum::<f64>().sqrt())
    }

    fn touched_by(&self, direction: usize) -> Vec<usize> {
        (0..self.scale.len()).filter(|row| self.touches(direction, *row)).collect()
    }

    fn touches(&self, direction: usize, row: usize) -> bool {
        self.eigen.eigenvectors[(row, direction)].abs() > TOUCHED
    }
}

/// Also of the empty matrix, which nalgebra refuses: a law of which nothing is sought.
fn eigen(matrix: DMatrix<f64>) -> SymmetricEigen<f64, Dyn> {
    match matrix.is_empty() {
        true => SymmetricEigen { eigenvalues: DVector::zeros(0), eigenvectors: matrix },
        false => SymmetricEigen::new(matrix),
    }
}

fn relative_error(std: &[Option<f64>], coefficients: &[f64]) -> Option<f64> {
    let trace: f64 = std.iter().map(|std| std.map(|std| std * std)).sum::<Option<f64>>()?;
    let size: f64 = coefficients.iter().map(|value| value * value).sum();
    (size > 0.0).then_some(trace / size)
}

fn inverse_root(diagonal: f64) -> f64 {
    if diagonal > 0.0 { diagonal.sqrt().recip() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_of_which_nothing_is_sought_has_no_limit_to_miss() {
        let law = Law::new(&[(Term::Inertia, 1.0)], &[]).unwrap();
        let bound = Bound::of(&law, &DMatrix::zeros(0, 0));
        assert_eq!((bound.std, bound.open, bound.relative_error), (Vec::new(), Vec::new(), Some(0.0)));
    }
}
