//! The best coefficients that a form of law can have, over any number of pieces.
//!
//! The prediction-error method of the streaming identifier, with the whole record at hand: Gauss–Newton steps on the
//! innovations' likelihood, sensor noise from the innovations, process noise from two rival filters, from much of it
//! down to what the data want. Terms that no state gives (memory, delay, expressions of time) are series along the
//! smoothed motion, renewed with it.

use super::descent::Descent;
use super::form::{Fit, Form};
use super::start;
use crate::diagnose::piece::Piece;
use crate::estimation::{Noise, Pass};

/// Guesses from which a fit begins, at most: the best lengths of seven.
const STARTS: usize = 4;

/// Factor by which the inertia has grown in a fit that forgets its excitation.
const FORGETFUL: f64 = 30.0;

/// Fits the form to the pieces; none where nothing can be made of them: no motion, or coefficients that no row
/// determines.
///
/// The likelihood has another maximum where the inertia grows without bounds: the excitation is forgotten, and process
/// noise drives the motion. A descent that runs there begins again from the next guess.
pub fn fit(form: &Form, pieces: &[Piece]) -> Option<Fit> {
    let mut best: Option<Fit> = None;
    for begin in start::starts(form, pieces).into_iter().take(STARTS) {
        let Some(fitted) = refit(form, pieces, &begin.coefficients, begin.noise) else { continue };
        let kept = form.inertia().is_none_or(|index| {
            let ratio = fitted.coefficients[index] / begin.coefficients[index];
            (0.0..FORGETFUL).contains(&ratio) && begin.coefficients[index] > 0.0
        });
        if best.as_ref().is_none_or(|best| fitted.log_likelihood > best.log_likelihood) {
            best = Some(fitted);
        }
        if kept {
            break;
        }
    }
    best
}

/// Fits the form from coefficients and noise that are near already. The likelihood may have two maxima, one that leaves
/// error to the law and one that leaves it all to the sensors: both are tried.
pub fn refit(form: &Form, pieces: &[Piece], coefficients: &[f64], noise: Noise) -> Option<Fit> {
    let mut descent = Descent::new(form, pieces, coefficients, noise)?;
    let mut pass = descent.pass();
    descent.renew_series(&mut pass);
    best_of(descent, pass)
}

/// The better of the maxima that a descent comes to: with error of the law, and with all error in the sensors.
pub(super) fn best_of(mut descent: Descent, mut pass: Pass) -> Option<Fit> {
    let mut loud = descent.descend(&mut pass)?;
    if loud.noise.process <= start::negligible(&loud.noise) {
        loud.log_likelihood_if_right = loud.log_likelihood;
        return Some(loud);
    }
    loud.log_likelihood_if_right = descent.fit_output_error(&mut pass, loud.log_likelihood);
    if loud.log_likelihood_if_right <= loud.log_likelihood {
        return Some(loud);
    }
    let quiet = descent.descend(&mut pass).filter(|quiet| quiet.log_likelihood > loud.log_likelihood);
    let quiet = quiet.map(|quiet| Fit { log_likelihood_if_right: loud.log_likelihood_if_right, ..quiet });
    Some(quiet.unwrap_or(loud))
}
