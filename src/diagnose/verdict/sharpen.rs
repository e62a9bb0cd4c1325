//! The likelihood sharpens what the judge has named: where all error is the sensors' noise it is the best there is.

use super::case::Case;
use super::law::Law;
use crate::diagnose::fit::{Evidence, Form, refit};
use crate::diagnose::judge::{COUNT, delay_of};
use crate::evidence::Noise;
use crate::identify::Recording;
use crate::law::Term;

/// Factor by which the likelihood's numbers may leave more than the judge's own, in any window, to be taken.
const NO_WORSE: f64 = 1.005;

/// Timing errors, in samples, beyond which the likelihood, which knows of none, is not asked.
const PUNCTUAL: f64 = 0.25;

/// The law with the coefficients, inner parameters and std of largest likelihood, where they leave no more than the judge's in any window;
/// else as it is. Never for a law without inertia: it has no motion of its own.
pub(in crate::diagnose) fn sharpened(case: &Case, law: &Law, recordings: &[&Recording]) -> Law {
    likelier(case, law, recordings).unwrap_or_else(|| law.clone())
}

fn likelier(case: &Case, law: &Law, recordings: &[&Recording]) -> Option<Law> {
    let inertia = law.terms.iter().position(|term| *term == Term::Inertia)?;
    if !(law.coefficients[inertia] > 0.0 && is_punctual(case, law)) {
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
    let noise = case.record.motions.first()?.sensors.noise;
    let sensor = noise.map(|std| (std * std).max(f64::MIN_POSITIVE));
    let fit = refit(&form, &evidence.pieces, &law.coefficients, Noise { sensor, process: sensor[0].max(sensor[1]) })?;
    let std = (0..law.terms.len()).map(|index| fit.std(index)).collect();
    let sharp = Law { terms: fit.form.terms.clone(), coefficients: fit.coefficients.clone(), std, ..law.clone() };
    let (own, other) = (case.errors_as_given(&sharp)?.0, case.errors_as_given(law)?.0);
    let no_worse = (0..COUNT).all(|which| {
        let [own, other] = [own[which].after, other[which].after];
        own.is_nan() || own <= NO_WORSE * other
    });
    let certain = sharp.coefficients.iter().zip(&sharp.std).all(|(value, std)| *std < value.abs());
    (no_worse && certain).then_some(sharp)
}

/// Whether the channels are in time, or the law's own delay says how late the excitation acts.
fn is_punctual(case: &Case, law: &Law) -> bool {
    let most = PUNCTUAL * case.record.sample_time;
    let taken = law.terms.iter().find_map(|term| delay_of(*term)).unwrap_or(0.0);
    let late = |[delay, std]: [f64; 2]| (delay - taken).abs() > most.max(3.0 * std);
    let velocity = case.record.motions.iter().filter_map(|motion| motion.kinematics);
    !law.delay.is_some_and(late)
        && velocity.into_iter().all(|own| own.lag.abs() < most && (own.scale - 1.0).abs() < 0.01)
}
