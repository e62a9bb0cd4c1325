//! What speaks against a candidate: physics, the law's own terms, its std, chance.

use super::errors::ADEQUATE;
use crate::diagnose::judge::{COUNT, HeldOut};

/// Chance, shared among all candidates tried, below which a gain is none.
pub const LEVEL: f64 = 0.01;

/// Mean ratio of errors that is worth the word: 5 %.
pub const WORTH: f64 = 0.95;

/// Ratio of errors beyond the sensors' in every window that needs no test: a third of the energy is gone.
pub(super) const LARGE: f64 = 0.816;

/// Ratio of errors in one window that disqualifies: 2 % worse.
pub(super) const WORSE: f64 = 1.02;

/// Std that a coefficient must be away from 0.
pub(super) const SURE: f64 = 2.0;

/// Why a candidate is not named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// Physics forbids its sign.
    Sign,
    /// The law's own terms, the excitation among them, nearly are it.
    Trap,
    /// Its coefficient is within its uncertainty.
    Uncertain,
    /// It makes the error worse in a window.
    Worse,
    /// Its gain may be chance, or is too small to speak of.
    Chance,
}

/// What a gain from one law to another leaves to doubt, with its probability by chance and the floor of the first.
pub(super) fn doubt_of_gain(
    before: &HeldOut,
    after: &HeldOut,
    p_value: Option<f64>,
    floor: &[f64; COUNT],
) -> Option<Doubt> {
    let ratios = after.ratios(before);
    // where only the sensors' noise is left, a little more of it is no worse law
    let worse = |((before, after), floor): ((&f64, &f64), &f64)| *after > WORSE * before && *after > ADEQUATE * floor;
    let windows = before.errors.iter().zip(&after.errors).zip(floor);
    if windows.into_iter().any(worse) || after.errors.iter().any(|error| *error >= 1.0) {
        return Some(Doubt::Worse);
    }
    let mean = after.score(before) / ratios.len().max(1) as f64;
    let significant = p_value.is_some_and(|p| p < LEVEL) && mean.exp() <= WORTH;
    (!(is_large(before, after, floor) || significant)).then_some(Doubt::Chance)
}

/// Whether a gain takes a third of the energy that the sensors do not explain in every window that has such, in two at
/// least.
pub(super) fn is_large(before: &HeldOut, after: &HeldOut, floor: &[f64; COUNT]) -> bool {
    let errors = before.errors.iter().zip(&after.errors).zip(floor);
    let told = errors.filter(|((before, _), floor)| **before > ADEQUATE * **floor);
    let beyond = |error: f64, floor: f64| (error * error - floor * floor).max(0.0).sqrt();
    let ratios: Vec<f64> =
        told.map(|((before, after), floor)| beyond(*after, *floor) / beyond(*before, *floor)).collect();
    let told = after.ratios(before).len();
    ratios.len() >= told.min(2) && !ratios.is_empty() && ratios.iter().all(|ratio| *ratio <= LARGE)
}

/// Whether a candidate may be what is there, as far as only chance or the law's own terms speak against it.
pub(super) fn may_be(doubt: Option<Doubt>) -> bool {
    matches!(doubt, None | Some(Doubt::Chance | Doubt::Trap))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_effect_beats_another_where_the_difference_is_no_chance_or_is_large() {
        let held = HeldOut::of_error;
        let doubt = |better: f64, p: f64| doubt_of_gain(&held(0.10), &held(better), Some(p), &[0.01; COUNT]);
        // 9 % a window, as chance has it between a cubic and a quintic spring under a disturbance
        assert_eq!(doubt(0.091, 0.02), Some(Doubt::Chance));
        assert_eq!(doubt(0.091, 0.005), None);
        assert_eq!(doubt(0.097, 0.005), Some(Doubt::Chance));
        assert_eq!(doubt(0.080, 0.5), None);
    }
}
