//! What every candidate would gain, from one run under the law without them.
//!
//! The score test (Rao 1948): with M and g the information and score of the unknowns, c, i and s those of a candidate beside them,
//! the candidate's own information is i − cᵀM⁻¹c, its own score s − cᵀM⁻¹g, and its gain in log-likelihood ½ score² ÷ information.

use super::beside::Beside;
use super::fit::{Fit, Parts, solve};
use super::means;
use super::piece::Piece;
use super::run::{self, Law, Place, Sums};
use super::tableau::{Gram, Tableau};
use crate::evidence::Pass;
use crate::law::{Expression, State, Term};

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
    screen_columns(fit, pieces, &|piece, states| columns(candidates, expressions, piece, states))
}

/// Columns of mean forces over a piece's intervals, along its smoothed motion.
pub(super) type Columns<'a> = dyn Fn(&Piece, &[State]) -> Vec<Vec<f64>> + 'a;

/// The gain of every column, in their order.
pub(super) fn screen_columns(fit: &Fit, pieces: &[Piece], columns: &Columns) -> Vec<Gain> {
    let all: Vec<Vec<Vec<f64>>> =
        pieces.iter().zip(&fit.states).map(|(piece, states)| columns(piece, states)).collect();
    gains(&run_all(fit, pieces, &all, None))
}

/// One column per term.
pub(super) fn columns(terms: &[Term], expressions: &[Expression], piece: &Piece, states: &[State]) -> Vec<Vec<f64>> {
    terms.iter().map(|term| means::means(*term, expressions, piece, states)).collect()
}

/// Every candidate, given as one column for each piece, beside every other; none where a run leaves no numbers.
pub(super) fn tableau(fit: &Fit, pieces: &[Piece], columns: &[Vec<Vec<f64>>]) -> Option<Tableau> {
    let parts = Parts::of(&fit.form);
    let beginnings = Beside::count(&fit.form, &parts, pieces);
    let kinds = columns.first().map_or(0, Vec::len);
    let mut gram = Gram::none(parts.unknowns.len() + beginnings, kinds);
    run_all(fit, pieces, columns, Some(&mut gram));
    gram.swept()
}

fn run_all(fit: &Fit, pieces: &[Piece], columns: &[Vec<Vec<f64>>], mut joint: Option<&mut Gram>) -> Sums {
    let parts = Parts::of(&fit.form);
    let pick = |positions: &[usize]| -> Vec<f64> { positions.iter().map(|index| fit.coefficients[*index]).collect() };
    let terms: Vec<Term> = parts.of_state.iter().map(|index| fit.form.terms[*index]).collect();
    let beside = Beside::along((&fit.form, &fit.coefficients), &[], pieces, &fit.states, &fit.beginnings);
    let of_state = pick(&parts.of_state);
    let mut pass = Pass::new(parts.free.len());
    let mut total: Option<Sums> = None;
    let all = pieces.iter().zip(columns).zip(beside.rows.iter()).zip(Place::of(pieces));
    for (number, (((piece, columns), series), place)) in all.enumerate() {
        let rows = means::rows(columns);
        let weights = beside.weights(&parts, &fit.coefficients, number);
        let (free, noise) = (&parts.free, fit.noise);
        let tangents = &beside.tangents[number];
        let law = Law { terms: &terms, coefficients: &of_state, free, series: &weights, tangents, noise };
        let span = beside.span(&parts, number);
        if let Some(joint) = joint.as_deref_mut() {
            joint.begin(span);
        }
        let outcome = run::run(&law, piece, &mut pass, series, &rows, place, joint.as_deref_mut()).among(span);
        for sums in outcome.sums {
            match &mut total {
                Some(total) => total.merge(&sums),
                None => total = Some(sums),
            }
        }
    }
    let mut total = total.unwrap_or_else(|| Sums::none(parts.unknowns.len(), 0));
    beside.add_prior(&mut total);
    if let Some(joint) = joint {
        joint.add_prior(beside.prior());
    }
    total
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
