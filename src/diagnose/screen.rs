//! What every candidate would gain, from one run under the law without them.
//!
//! The score test (Rao 1948): with M and g the information and score of the unknowns, c, i and s those of a candidate beside them,
//! the candidate's own information is i − cᵀM⁻¹c, its own score s − cᵀM⁻¹g, and its gain in log-likelihood ½ score² ÷ information.

use super::beside::Beside;
use super::fit::{Fit, Parts, solve};
use super::means;
use super::piece::Piece;
use super::run::{self, Law, Sums};
use super::tableau::{Gram, Tableau};
use crate::evidence::Pass;
use crate::law::{Expression, State, Term};

/// Stretches into which the record is cut.
pub(super) const STRETCHES: usize = 24;

/// What one candidate would gain.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Linear estimate of its coefficient.
    pub coefficient: f64,
    /// Std of it.
    pub std: f64,
    /// Gain in log-likelihood, nats.
    pub gain: f64,
}

/// The gain of every candidate term, in their order.
pub fn screen(fit: &Fit, pieces: &[Piece], candidates: &[Term]) -> Vec<Gain> {
    let expressions = &fit.form.expressions;
    gains(&merged(&sums(fit, pieces, &|piece, states| columns(candidates, expressions, piece, states))))
}

/// Columns of mean forces over a piece's intervals, along its smoothed motion.
pub(super) type Columns<'a> = dyn Fn(&Piece, &[State]) -> Vec<Vec<f64>> + 'a;

/// The gain of every column, in their order.
pub(super) fn screen_columns(fit: &Fit, pieces: &[Piece], columns: &Columns) -> Vec<Gain> {
    gains(&merged(&sums(fit, pieces, columns)))
}

pub(super) fn columns(terms: &[Term], expressions: &[Expression], piece: &Piece, states: &[State]) -> Vec<Vec<f64>> {
    terms.iter().map(|term| means::means(*term, expressions, piece, states)).collect()
}

fn merged(sums: &[Sums]) -> Sums {
    let mut total = sums[0].clone();
    sums[1..].iter().for_each(|other| total.merge(other));
    total
}

/// Every candidate beside every other; none where a run leaves no numbers.
pub(super) fn tableau(fit: &Fit, pieces: &[Piece], candidates: &[Term]) -> Option<Tableau> {
    let expressions = &fit.form.expressions;
    let parts = Parts::of(&fit.form);
    let beginnings = Beside::count(&fit.form, &parts, pieces);
    let mut gram = Gram::none(parts.unknowns.len() + beginnings, candidates.len());
    let columns = |piece: &Piece, states: &[State]| columns(candidates, expressions, piece, states);
    run_all(fit, pieces, &columns, Some(&mut gram));
    gram.swept()
}

/// Sums by stretch of the record, with columns as candidates.
pub(super) fn sums(fit: &Fit, pieces: &[Piece], candidates: &Columns) -> Vec<Sums> {
    run_all(fit, pieces, candidates, None)
}

fn run_all(fit: &Fit, pieces: &[Piece], candidates: &Columns, mut joint: Option<&mut Gram>) -> Vec<Sums> {
    let parts = Parts::of(&fit.form);
    let pick = |positions: &[usize]| -> Vec<f64> { positions.iter().map(|index| fit.coefficients[*index]).collect() };
    let terms: Vec<Term> = parts.of_state.iter().map(|index| fit.form.terms[*index]).collect();
    let beside = Beside::along((&fit.form, &fit.coefficients), &[], pieces, &fit.states, &fit.beginnings);
    let (of_state, of_series) = (pick(&parts.of_state), beside.weights(&parts, &fit.coefficients));
    let law = Law { terms: &terms, coefficients: &of_state, free: &parts.free, series: &of_series, noise: fit.noise };
    let unknowns = parts.free.len() + of_series.len();
    let samples: usize = pieces.iter().map(|piece| piece.len() - 1).sum();
    let mut all: Vec<Sums> = Vec::new();
    let mut before = 0;
    let mut pass = Pass::new(parts.free.len());
    for ((piece, states), series) in pieces.iter().zip(&fit.states).zip(&beside.rows) {
        let rows = means::rows(&candidates(piece, states));
        let stretch = |k: usize| (before + k) * STRETCHES / samples.max(1);
        let stretches: Vec<usize> = (0..piece.len() - 1).map(stretch).collect();
        before += piece.len() - 1;
        let outcome = run::run(&law, piece, &mut pass, series, &rows, &stretches, joint.as_deref_mut());
        if all.is_empty() {
            let kinds = outcome.sums[0].own.len();
            all = vec![Sums::none(unknowns, kinds); STRETCHES];
        }
        all.iter_mut().zip(&outcome.sums).for_each(|(sum, other)| sum.merge(other));
    }
    all.first_mut().into_iter().for_each(|sums| beside.add_prior(sums));
    if let Some(joint) = joint {
        joint.add_prior(beside.prior());
    }
    all
}

/// Score test of each candidate.
pub(super) fn gains(total: &Sums) -> Vec<Gain> {
    let Some(solved) = solve(&total.information, &total.score) else { return Vec::new() };
    let gain = |candidate: usize| {
        let cross = total.cross.column(candidate);
        let shared = &solved.covariance * cross;
        let information = total.own[candidate] - cross.dot(&shared);
        let score = total.own_score[candidate] - shared.dot(&total.score);
        let own = information > 1e-9 * total.own[candidate];
        match own {
            true => Gain {
                coefficient: score / information,
                std: information.sqrt().recip(),
                gain: 0.5 * score * score / information,
            },
            false => Gain { coefficient: 0.0, std: f64::INFINITY, gain: 0.0 },
        }
    };
    (0..total.own.len()).map(gain).collect()
}
