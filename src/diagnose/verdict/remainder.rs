//! What a law leaves, in a sentence.

use super::case::{Case, Standing};
use super::errors::are_adequate;
use crate::diagnose::judge::{COUNT, PRINCIPAL};
use crate::law::{Effect, Monomial, Term};

/// Share of what is left that must follow something for it to be said.
const FOLLOWS: f64 = 0.15;

/// How much more must be left in the shortest windows than in the longest for it to be called fast.
const FAST: f64 = 2.0;

/// Cycles per T₀ that the longest windows still see.
const RESOLVED: f64 = 4.0;

/// What remains of the law's error: how much, and what it is like.
pub(super) fn sentence(case: &Case, standing: &Standing) -> String {
    let error = standing.held.errors[PRINCIPAL];
    let much = if error.is_finite() { format!("what is left ({:.2} %)", 100.0 * error) } else { "what is left".into() };
    if are_adequate(&case.errors_of(standing)) {
        return format!("{much} is what the sensors alone would leave");
    }
    let beyond = |which: usize| (standing.held.errors[which].powi(2) - standing.floor[which].powi(2)).max(0.0).sqrt();
    if beyond(0) > FAST * beyond(COUNT - 1) {
        return format!("{much} is faster than {:.3} Hz", RESOLVED / case.record.period);
    }
    match followed(case, standing) {
        Some(what) => format!("{much} depends on {what}"),
        None => format!("{much} is irregular"),
    }
}

/// What the held-out residual follows most, where it follows anything.
fn followed(case: &Case, standing: &Standing) -> Option<&'static str> {
    let known = [
        (Term::Effect(Effect::CoulombFriction), "the direction of motion"),
        (Term::Monomial(Monomial { q: 2, qd: 0, excitation: 0 }), "the position"),
        (Term::Monomial(Monomial { q: 0, qd: 2, excitation: 0 }), "the speed"),
        (Term::Monomial(Monomial { q: 3, qd: 0, excitation: 0 }), "the displacement"),
        (Term::Monomial(Monomial { q: 0, qd: 3, excitation: 0 }), "the velocity"),
    ];
    let left = &standing.held.residuals[PRINCIPAL];
    let share = |term: Term| {
        let column = &case.record.term(term, standing.equation.timing)[PRINCIPAL];
        let sums =
            left.iter().zip(column).filter(|(left, _)| left.is_finite()).fold([0.0; 3], |sums, (left, value)| {
                [sums[0] + left * value, sums[1] + left * left, sums[2] + value * value]
            });
        sums[0] * sums[0] / (sums[1] * sums[2])
    };
    let shares = known.map(|(term, what)| (share(term), what));
    let best = shares.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(share, _)| *share > FOLLOWS).map(|(_, what)| what)
}
