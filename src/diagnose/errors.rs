//! The error of a fitted law on samples that its coefficients have not seen.
//!
//! The stretches of the record are dealt out to folds. Without a fold the information is that of the others, and the coefficients move by one
//! Newton step from those of all; the weak residual of the fold's windows under them is the held-out error, in the same measure as
//! `compare` gives.

use super::coefficients::Held;
use super::fit::{Fit, Parts, solve};
use super::piece::Piece;
use super::record::Record;
use super::rows::Rows;
use super::run::STRETCHES;
use super::window::choose_window;
use crate::identify::Recording;
use crate::law::{Expression, Hold, Term};

/// Folds into which stretches are dealt out.
const FOLDS: usize = 4;

/// Weak windows of a set of recordings, with the integral of every term that is to be compared.
pub(super) struct Windows {
    records: Vec<Record>,
    rows: Vec<Rows>,
    terms: Vec<Term>,
    /// Length of a window, s.
    pub(super) length: f64,
    inertia: Option<usize>,
}

/// One window's residual, and where the motion was.
#[derive(Clone, Copy, Debug)]
pub(super) struct Left {
    pub(super) q: f64,
    pub(super) qd: f64,
    pub(super) squared: f64,
}

impl Windows {
    /// Windows of a length that suits the law of these terms, the first `own` of which it has.
    pub(super) fn new(
        recordings: &[(&Recording, Hold)],
        terms: Vec<Term>,
        own: usize,
        expressions: &[Expression],
    ) -> Windows {
        let of = |(recording, hold): &(&Recording, Hold)| Record::new(recording, *hold, &terms, expressions);
        let records: Vec<Record> = recordings.iter().map(of).collect();
        let held = Held { terms: terms[..own].to_vec(), values: vec![None; own] };
        let length = choose_window(&records, &held);
        let rows = records.iter().flat_map(|record| record.rows(record.windows(length))).collect();
        let unforced = records.iter().all(|record| !record.forced);
        let inertia = terms.iter().position(|term| *term == Term::Inertia).filter(|_| unforced);
        Windows { records, rows, terms, length, inertia }
    }

    /// RMS weak residual ÷ RMS weak excitation (of free motion ÷ inertia), held out, and every window's share.
    pub(super) fn error(&self, fit: &Fit, pieces: &[Piece]) -> (f64, Vec<Left>) {
        let folds = folds(fit);
        let positions: Vec<usize> =
            fit.form.terms.iter().filter_map(|term| self.terms.iter().position(|other| other == term)).collect();
        let samples: usize = pieces.iter().map(|piece| piece.len() - 1).sum();
        let motions = self.records.iter().flat_map(|record| &record.pieces);
        let (mut residual, mut force, mut before) = (0.0, 0.0, 0);
        let mut left = Vec::new();
        for (rows, prepared) in self.rows.iter().zip(motions) {
            for index in 0..rows.len() {
                let centre = rows.centre[index];
                let fold = (before + centre) * STRETCHES / samples.max(1) % FOLDS;
                let row = rows.row(index);
                let law: f64 = positions.iter().zip(&folds[fold]).map(|(position, value)| row[*position] * value).sum();
                let inertia =
                    |index: usize| row[index] * folds[fold][positions.iter().position(|p| *p == index).unwrap_or(0)];
                let squared = (rows.right[index] - law).powi(2) / rows.norm;
                residual += squared;
                force += self.inertia.map_or(rows.right[index], inertia).powi(2) / rows.norm;
                left.push(Left { q: prepared.motion.q[centre], qd: prepared.motion.qd[centre], squared });
            }
            before += prepared.piece.len() - 1;
        }
        ((residual / force).sqrt(), left)
    }
}

/// Coefficients without each fold; those of all samples where no inertia lets a filter follow the law.
fn folds(fit: &Fit) -> Vec<Vec<f64>> {
    if fit.form.inertia().is_none() {
        return vec![fit.coefficients.clone(); FOLDS];
    }
    let unknowns = Parts::of(&fit.form).unknowns;
    let without = |fold: usize| {
        let stretches = fit.by_stretch.iter().enumerate();
        let mut others = stretches.filter(|(stretch, _)| stretch % FOLDS != fold).map(|(_, sums)| sums);
        let mut coefficients = fit.coefficients.clone();
        let Some(first) = others.next() else { return coefficients };
        let mut total = first.clone();
        others.for_each(|other| total.merge(other));
        // inner parameters and beginnings stay as they are
        let information = total.information.view((0, 0), (unknowns.len(), unknowns.len())).into_owned();
        if let Some(solved) = solve(&information, &total.score.rows(0, unknowns.len()).into_owned()) {
            unknowns.iter().zip(solved.step.iter()).for_each(|(index, step)| coefficients[*index] += step);
        }
        coefficients
    };
    (0..FOLDS).map(without).collect()
}
