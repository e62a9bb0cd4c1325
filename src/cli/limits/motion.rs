//! The limits of a law of motion: q and q̇ are what its sensors read.

use super::asked::Asked;
use super::found::{Limits, pointwise, warnings};
use crate::cli::error::CommandError;
use crate::cli::input::Input;
use crate::diagnose::{Evidence, Fit, best_as_given, is_evident};
use crate::law::{Given, ModelError, Term};
use crate::limits::{Course, Law, LimitsError, Start, bound, detection, level};

/// The limits of the model's law on the input's recording.
pub(super) fn limits<'a>(input: &'a Input, asked: &'a Asked) -> Result<Limits<'a>, CommandError> {
    let refused = |source: LimitsError| CommandError::Limits { model: input.file.clone(), source };
    let massless = |source: ModelError| CommandError::Build { model: input.file.clone(), source: source.into() };
    input.model.check_inertia().map_err(massless)?;
    pointwise(input).map_err(refused)?;
    let recordings = input.held();
    let (recording, hold) = recordings[0];
    let evidence = Evidence::new(&recordings);
    let fit = best_as_given(&input.model, &evidence).ok_or_else(|| input.undetermined())?;
    let numbers_only = input.model.terms.iter().all(|entry| matches!(entry.given, Given::Known(_)));
    let law = law(&fit, numbers_only, recording.channels().excitation).map_err(refused)?;
    let sensors = asked.sensors(recording, &fit.noise)?;
    let pairs = evidence.pieces.iter().zip(&fit.states);
    let courses: Vec<Course> = pairs.map(|(piece, states)| piece.course(states)).collect();
    let bound_of = |start| bound(&law, &courses, sensors, start).map_err(refused);
    let (bound, after_switch) = (bound_of(Start::Unknown)?, bound_of(Start::Known)?.shortest_record);
    let level = level(asked.false_alarm_interval, recording.sample_time());
    // law and sensors have limits, so that what is refused now is the change
    let detection = match asked.change.as_slice() {
        [] => None,
        change => {
            let seen = law.changed(change).and_then(|changed| detection(&law, &changed, &courses, sensors, level));
            Some(seen.map_err(|source| asked.change_refused(&source))?)
        }
    };
    let noise = ["q", "qd"].into_iter().zip(sensors.0).filter_map(|(channel, std)| Some((channel, std?))).collect();
    let warnings = warnings(recording, is_evident(&fit), asked.noise_is_too_small(&sensors, recording));
    let hold = Some(hold);
    Ok(Limits {
        input,
        asked,
        recording,
        hold,
        law,
        noise,
        warnings,
        numbers_only,
        bound,
        after_switch,
        level,
        detection,
    })
}

/// The fitted law. In free motion the inertia only sets the scale.
fn law(fit: &Fit, numbers_only: bool, forced: bool) -> Result<Law, LimitsError> {
    let pairs: Vec<(Term, f64)> = fit.form.terms.iter().copied().zip(fit.coefficients.iter().copied()).collect();
    let is_sought = |index: &usize| match (numbers_only, fit.form.terms[*index]) {
        (true, Term::Inertia) => forced,
        (true, _) => true,
        (false, _) => fit.form.held[*index].is_none(),
    };
    let sought: Vec<usize> = (0..pairs.len()).filter(is_sought).collect();
    Law::new(&pairs, &sought)
}
