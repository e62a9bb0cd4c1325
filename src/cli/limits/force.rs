//! The limits of a model without inertia: F is what its law gives.

use super::super::error::CommandError;
use super::super::input::Input;
use super::asked::Asked;
use super::found::{Limits, pointwise, warnings};
use crate::identify::{BuildError, ForceFit, fit_force_law};
use crate::law::{Given, Term};
use crate::limits::{Detection, Imposed, Law, LimitsError, force_bound, force_detection, level};

/// The limits of the model's law on the input's recording.
pub(super) fn limits<'a>(input: &'a Input, asked: &'a Asked) -> Result<Limits<'a>, CommandError> {
    let refused = |source: LimitsError| CommandError::Limits { model: input.file.clone(), source };
    let unfit = |source: BuildError| CommandError::Build { model: input.file.clone(), source };
    pointwise(input).map_err(refused)?;
    let recording = input.recordings()[0];
    let numbers_only = input.model.terms.iter().all(|entry| matches!(entry.given, Given::Known(_)));
    let freed = numbers_only.then(|| input.model.freed());
    let fit = fit_force_law(freed.as_ref().unwrap_or(&input.model), recording).map_err(unfit)?;
    let fit = fit.ok_or_else(|| input.undetermined())?;
    let law = law(input, &fit, numbers_only).map_err(refused)?;
    let std = asked.noise_of_force().unwrap_or(fit.residual);
    let motion: Vec<Imposed> = fit.motion.iter().map(|(t, state)| Imposed { t: *t, state: *state }).collect();
    let bound = force_bound(&law, &motion, std).map_err(refused)?;
    let level = level(asked.false_alarm_interval, recording.sample_time());
    let detection = match asked.change.as_slice() {
        [] => None,
        change => Some(detection(&law, change, &motion, std, level).map_err(|source| asked.change_refused(&source))?),
    };
    Ok(Limits {
        input,
        asked,
        recording,
        hold: None,
        law,
        noise: vec![("F", std)],
        warnings: warnings(recording, !fit.is_white, false),
        numbers_only,
        bound,
        after_switch: None,
        level,
        detection,
    })
}

fn detection(
    law: &Law,
    change: &[(Term, f64)],
    motion: &[Imposed],
    std: f64,
    level: f64,
) -> Result<Detection, LimitsError> {
    force_detection(law, &law.changed(change)?, motion, std, level)
}

/// The law with the model's numbers where it has them, else with those of the fit; terms that the fit dropped are left
/// out.
fn law(input: &Input, fit: &ForceFit, numbers_only: bool) -> Result<Law, LimitsError> {
    let entries = input.model.terms.iter().zip(&fit.coefficients);
    let kept: Vec<(Term, f64, bool)> = entries
        .filter(|(entry, value)| entry.given != Given::Maybe || **value != 0.0)
        .map(|(entry, fitted)| match entry.given {
            Given::Known(value) => (entry.term, value, numbers_only),
            Given::Fit | Given::Maybe => (entry.term, *fitted, true),
        })
        .collect();
    let pairs: Vec<(Term, f64)> = kept.iter().map(|(term, value, _)| (*term, *value)).collect();
    let sought: Vec<usize> = (0..kept.len()).filter(|index| kept[*index].2).collect();
    Law::new(&pairs, &sought)
}
