//! The likelihood sharpens what the judge has named: where all error is the sensors' noise it is the best there is.

use super::case::Case;
use super::errors::TIE;
use super::law::Law;
use crate::diagnose::fit::{Evidence, Form, refit};
use crate::diagnose::judge::COUNT;
use crate::estimation::Noise;
use crate::identify::Recording;
use crate::law::Term;
use std::f64::consts::TAU;

/// The law with the coefficients, inner parameters and std of largest likelihood, where the judge sees no difference:
/// they leave what the sensors alone would, or tie with its own numbers; else as it is. Never for a law without
/// inertia: it has no motion of its own.
pub(in crate::diagnose) fn sharpened(case: &Case, law: &Law, recordings: &[&Recording]) -> Law {
    likelier(case, law, recordings).unwrap_or_else(|| law.clone())
}

fn likelier(case: &Case, law: &Law, recordings: &[&Recording]) -> Option<Law> {
    let inertia = law.terms.iter().position(|term| *term == Term::Inertia)?;
    if law.coefficients[inertia] <= 0.0 {
        return None;
    }
    let held: Vec<_> = recordings.iter().map(|recording| (*recording, law.timing.hold)).collect();
    let evidence = Evidence::new(&held);
    let keep = |index: usize| (law.std[index] == 0.0).then_some(law.coefficients[index]);
    let form = Form {
        terms: law.terms.clone(),
        held: (0..law.terms.len()).map(keep).collect(),
        open: law.terms.iter().map(|term| vec![true; term.effect().map_or(0, |effect| effect.inner().len())]).collect(),
        expressions: law.expressions.clone(),
    };
    let levels = case.record.motions.first()?.sensors.noise;
    let sensor = levels.map(|std| (std * std).max(f64::MIN_POSITIVE));
    let noise = Noise { sensor, process: unexplained(case, law)?.max(f64::MIN_POSITIVE) };
    let fit = refit(&form, &evidence.pieces, &law.coefficients, noise)?;
    let std = (0..law.terms.len()).map(|index| fit.std(index)).collect();
    let sharp = Law { terms: fit.form.terms.clone(), coefficients: fit.coefficients.clone(), std, ..law.clone() };
    let ((errors, adequate), (judged, _)) = (case.errors_as_given(&sharp)?, case.errors_as_given(law)?);
    let worse = errors.iter().zip(&judged).map(|(sharp, own)| (sharp.after / own.after).ln());
    let ties = worse.filter(|worse| !worse.is_nan()).sum::<f64>() <= TIE * COUNT as f64;
    let certain = sharp.coefficients.iter().zip(&sharp.std).all(|(value, std)| *std < value.abs());
    ((adequate || ties) && certain).then_some(sharp)
}

/// Intensity of the acceleration that a law leaves, (m/s²)² s: its share of the motion's own, over the shortest window.
fn unexplained(case: &Case, law: &Law) -> Option<f64> {
    let [shortest, principal, _] = case.errors_as_given(law)?.0;
    let share = [shortest.after, principal.after].into_iter().find(|error| error.is_finite())?;
    let speeds = || case.record.motions.iter().flat_map(|motion| &motion.tracks).flat_map(|track| &track.states);
    let mean = speeds().map(|state| state[1] * state[1]).sum::<f64>() / speeds().count().max(1) as f64;
    let acceleration = TAU / case.record.period * mean.sqrt();
    Some((share * acceleration).powi(2) * shortest.window)
}
