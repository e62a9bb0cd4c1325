//! What physics and the record do not let one say of a candidate beside a law, whatever its gain.

use super::case::{Case, Standing};
use super::doubt::{LEVEL, SURE};
use crate::diagnose::candidates::contender;
use crate::law::{Effect, State, Term};

/// Whether dry friction that changes along the way would push somewhere on it: the law's own friction and it, two std
/// nearer to none.
pub(super) fn drives(case: &Case, standing: &Standing, term: Term, [coefficient, std]: [f64; 2]) -> bool {
    if !matches!(term, Term::Effect(Effect::PositionDependentFriction { .. })) {
        return false;
    }
    let nearer = coefficient.signum() * (coefficient.abs() - SURE * std).max(0.0);
    let with = standing.equation.with(&case.record, term);
    let (terms, last) = (with.terms.clone(), with.terms.len() - 1);
    let Some(found) = case.estimated(with) else { return false };
    let dry = |index: &usize| terms[*index].effect().is_some_and(Effect::is_dry);
    let value = |index: usize| if index == last { nearer } else { found.coefficients[index] };
    let friction: Vec<(Term, f64)> = (0..terms.len()).filter(dry).map(|index| (terms[index], value(index))).collect();
    let power = |State { q, qd }: State| -> f64 {
        friction.iter().map(|(term, value)| value * term.force(q, qd, 0.0) * qd).sum()
    };
    case.record.motions.iter().flat_map(|motion| motion.states()).flatten().map(power).any(|power| power < 0.0)
}

/// Whether a candidate is the law's own damper with a lag, and the record cannot tell that damper from dry friction: in
/// its place friction, at once or over a way, leaves no more, or so little more that it may be chance. At a few speeds
/// any force of the velocity is as good as another.
pub(super) fn is_of_untold_damper(case: &Case, standing: &Standing, term: Term) -> bool {
    let damper = standing.equation.terms.iter().position(|own| *own == Term::power(0, 1));
    let Some(place) = damper.filter(|_| matches!(term, Term::Effect(Effect::Relaxation { .. }))) else { return false };
    let mut terms = standing.equation.terms.clone();
    terms[place] = Term::Effect(Effect::CoulombFriction);
    let Some(rubbed) = case.stand(&terms) else { return false };
    let undamped = rubbed.equation.without(place);
    let base = case.folds.judge(&undamped);
    let bent = Effect::prototype("presliding_friction").map(Term::Effect);
    let bent = bent.and_then(|term| contender(&case.record, &case.folds, &undamped, (&base, rubbed.floor), term));
    let mut frictions = bent.into_iter().map(|found| found.held).chain([rubbed.held]);
    frictions.any(|held| {
        let gains = standing.blocks.gains(&case.record, &held, &standing.held);
        standing.blocks.p_values(&[gains]).is_none_or(|values| values[0] >= LEVEL)
    })
}
