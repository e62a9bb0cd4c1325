//! Which further recording would tell two candidates apart.
//!
//! Under the law with candidate A, the force C_B f_B of its rival B stands beside the unknowns of the law as a column of its own. What of
//! it they cannot imitate has the information I, and ½ I nats is how far apart the two are on this record (the likelihood lost if B is
//! true and A is fitted). In a motion s times as large the unknowns imitate less, or more, of the column: I(s) ≈ I(1) · (RMS of what they
//! leave of it at s ÷ at 1)². In a record n times as long, I grows n times.

use super::diagnosis::{Diagnosis, Evidence};
use super::fit::{Fit, solve};
use super::piece::Piece;
use super::screen;
use crate::law::{Expression, State, Term};
use nalgebra::{DMatrix, DVector};

/// Motions that are asked for, as multiples of this one, the nearest first.
const SCALES: [f64; 8] = [1.5, 2.0, 0.5, 3.0, 0.33, 5.0, 0.2, 10.0];

/// Log-likelihood, nats, that tells two candidates apart.
const APART: f64 = 10.0;

/// Where that much has not told them apart, the difference scatters along the record: so many times as much is asked for, which doubles
/// the distance in standard errors.
const SCATTERED: f64 = 4.0;

/// The recording that would tell two candidates apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// The candidate that is in the law.
    pub one: String,
    /// Its rival.
    pub other: String,
    /// How far apart they are on this record, nats.
    pub apart: f64,
    /// How far apart they must be, nats.
    pub needed: f64,
    /// How often as long a record of the same motion would have to be; infinite where no length would do.
    pub longer: f64,
    /// A motion of another size that would do.
    pub motion: Option<Reach>,
}

/// A motion s times this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// s.
    pub scale: f64,
    /// Largest |q| in it.
    pub displacement: f64,
    /// Largest |q̇| in it.
    pub velocity: f64,
}

/// What would tell the first two of a tie apart; none without a tie.
pub fn decide(diagnosis: &Diagnosis, evidence: &Evidence) -> Option<Decision> {
    let group = diagnosis.indistinguishable.first()?;
    let law = &diagnosis.improved.as_ref()?.fit;
    let rival = diagnosis.candidates.iter().find(|candidate| Some(&candidate.effect) == group.get(1))?;
    let force = Force { term: rival.term, coefficient: rival.coefficient, expressions: &law.form.expressions };
    let column = |piece: &Piece, states: &[State]| vec![force.along(piece, states)];
    let std = screen::screen_columns(law, &evidence.pieces, &column).first()?.std;
    let best = diagnosis.candidates.iter().find(|candidate| candidate.effect == group[0])?;
    let (apart, needed) = distance(0.5 / (std * std), best.gain - rival.gain);
    let here = left(law, &force, evidence, 1.0)?;
    let nats = |scale: f64| left(law, &force, evidence, scale).map(|left| apart * left / here);
    let reached = SCALES.into_iter().find(|scale| nats(*scale).is_some_and(|nats| nats >= needed));
    Some(Decision {
        one: group[0].clone(),
        other: group[1].clone(),
        apart,
        needed,
        longer: if apart > 0.0 { needed / apart } else { f64::INFINITY },
        motion: reached.map(|scale| reach(law, scale)),
    })
}

/// How far apart two candidates are and must be, nats. Where they ought to be far apart and are not, noise that the law allows for absorbs
/// what sets them apart: then the difference of their gains says how far.
fn distance(ideal: f64, observed: f64) -> (f64, f64) {
    match (ideal < APART, observed < APART) {
        (true, _) => (ideal, APART),
        (false, true) => (observed.max(1.0), APART),
        (false, false) => (observed, SCATTERED * observed),
    }
}

fn reach(law: &Fit, scale: f64) -> Reach {
    let largest =
        |value: fn(&State) -> f64| law.states.iter().flatten().map(|state| value(state).abs()).fold(0.0, f64::max);
    Reach { scale, displacement: scale * largest(|state| state.q), velocity: scale * largest(|state| state.qd) }
}

/// The rival's force.
struct Force<'a> {
    term: Term,
    coefficient: f64,
    expressions: &'a [Expression],
}

impl Force<'_> {
    fn along(&self, piece: &Piece, states: &[State]) -> Vec<f64> {
        let column = screen::columns(&[self.term], self.expressions, piece, states).pop().unwrap_or_default();
        column.into_iter().map(|value| self.coefficient * value).collect()
    }
}

/// Sum of squares of what the law's own terms leave of the force in a motion of that scale.
fn left(law: &Fit, force: &Force, evidence: &Evidence, scale: f64) -> Option<f64> {
    let terms = &law.form.terms;
    let mut gram = DMatrix::zeros(terms.len(), terms.len());
    let mut shared = DVector::zeros(terms.len());
    let mut energy = 0.0;
    for (piece, states) in evidence.pieces.iter().zip(&law.states) {
        let (piece, states) = scaled(piece, states, scale);
        let columns = screen::columns(terms, &law.form.expressions, &piece, &states);
        let rival = force.along(&piece, &states);
        energy += dot(&rival, &rival);
        for (row, column) in columns.iter().enumerate() {
            shared[row] += dot(column, &rival);
            (0..terms.len()).for_each(|other| gram[(row, other)] += dot(column, &columns[other]));
        }
    }
    let imitated = solve(&gram, &shared)?.step.dot(&shared);
    Some((energy - imitated).max(f64::EPSILON * energy)).filter(|left| left.is_finite() && *left > 0.0)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The motion and its excitation, s times as large.
fn scaled(piece: &Piece, states: &[State], scale: f64) -> (Piece, Vec<State>) {
    let excitation = piece.excitation.iter().map(|value| scale * value).collect();
    let states = states.iter().map(|state| State { q: scale * state.q, qd: scale * state.qd });
    (Piece { excitation, observations: Vec::new(), ..piece.clone() }, states.collect())
}

/// The smallest share of the force from which on an effect would have been seen in an adequate law.
#[derive(Clone, Debug, PartialEq)]
pub struct Visible {
    /// The candidate that came nearest to being missing.
    pub effect: String,
    /// RMS of its force at three std of its coefficient ÷ RMS of the excitation (of free motion ÷ inertia force).
    pub share: f64,
}

/// What the record could have shown of the best candidate.
pub fn visible(diagnosis: &Diagnosis, evidence: &Evidence) -> Option<Visible> {
    let tempting = diagnosis.candidates.first()?;
    let law = &diagnosis.base;
    let inertia = law.form.terms.iter().position(|term| *term == Term::Inertia)?;
    let terms = [tempting.term, Term::Inertia];
    let (mut effect, mut force) = (0.0, 0.0);
    for (piece, states) in evidence.pieces.iter().zip(&law.states) {
        let columns = screen::columns(&terms, &law.form.expressions, piece, states);
        effect += dot(&columns[0], &columns[0]);
        force += match evidence.forced() {
            true => dot(&piece.excitation, &piece.excitation),
            false => law.coefficients[inertia].powi(2) * dot(&columns[1], &columns[1]),
        };
    }
    let share = 3.0 * tempting.std * (effect / force).sqrt();
    share.is_finite().then(|| Visible { effect: tempting.effect.clone(), share })
}
