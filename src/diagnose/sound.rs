//! Whether an answer is one that an expert would sign: signs that physics allows, and no forces that cancel each other.

use super::fit::Fit;
use super::judge::Trial;
use super::piece::Piece;
use super::screen;
use super::variants::Scale;
use crate::law::{Catalogue, Expression, InnerParameter, InnerRange, State, Term};

/// Forces of a sound law are at most this many times as large as the largest of the law that it begins from: beyond, they cancel.
pub(super) const CANCELLING: f64 = 4.0;

/// Relative distance at which an inner parameter is at its limit.
const AT: f64 = 1e-6;

/// What a law's forces were before candidates joined.
#[derive(Clone, Debug)]
pub(super) struct Sound<'a> {
    base: &'a Fit,
    pieces: &'a [Piece],
    largest: f64,
    scale: Scale,
}

/// Whether physics allows the sign of that coefficient.
pub(super) fn is_physical(fit: &Fit, index: usize) -> bool {
    Catalogue::of(fit.form.terms[index]).is_none_or(|entry| entry.sign.allows(fit.coefficients[index]))
}

impl<'a> Sound<'a> {
    pub(super) fn new(base: &'a Fit, pieces: &'a [Piece]) -> Sound<'a> {
        let largest = forces(base, pieces).into_iter().fold(0.0, f64::max);
        Sound { base, pieces, largest, scale: Scale::of(pieces, &base.states) }
    }

    /// Whether no coefficient of the law turned to a sign that physics does not allow it, by more than its std, and no forces are so large
    /// that they must cancel.
    pub(super) fn is_plausible(&self, fit: &Fit) -> bool {
        let turned = |index: usize| {
            let allowed =
                |value: f64| Catalogue::of(fit.form.terms[index]).is_none_or(|entry| entry.sign.allows(value));
            let (old, new) = (self.base.coefficients[index], fit.coefficients[index]);
            allowed(old) && !allowed(new) && new.abs() > 2.0 * fit.std(index)
        };
        let own =
            self.base.form.terms.iter().enumerate().filter(|(index, term)| fit.form.terms.get(*index) == Some(term));
        let mut own = own.map(|(index, _)| index);
        !own.any(turned) && forces(fit, self.pieces).into_iter().all(|force| force < CANCELLING * self.largest)
    }

    /// Whether physics allows all its candidates, and the law with them is plausible.
    pub(super) fn is(&self, trial: &Trial) -> bool {
        trial.is_physical() && trial.terms().iter().all(|term| self.is_told(*term)) && self.is_plausible(&trial.fit)
    }

    /// Whether no inner parameter stands where the motion can no longer tell it, the effect being another one or none there.
    fn is_told(&self, term: Term) -> bool {
        let Some(effect) = term.effect() else { return true };
        let values = effect.inner_values().into_iter().zip(effect.inner()).enumerate();
        let told = |(index, (value, parameter)): (usize, (f64, &InnerParameter))| {
            let [low, high] = self.scale.limits(effect, index);
            let least = matches!(parameter.range, InnerRange::AtLeast(least) if value <= least * (1.0 + AT));
            (least || value > low * (1.0 + AT)) && value < high * (1.0 - AT)
        };
        values.into_iter().all(told)
    }

    /// Trials with the sound ones first; among those that the record cannot tell apart the simplest.
    pub(super) fn ranked(&self, trials: Vec<Trial>) -> Vec<Trial> {
        let (mut sound, unsound): (Vec<Trial>, Vec<Trial>) = trials.into_iter().partition(|trial| self.is(trial));
        if let Some(best) = sound.first().cloned() {
            let simpler = |trial: &Trial| {
                let contained = Catalogue::is_contained(&self.name(trial), &self.name(&best));
                contained || trial.inner_count() < best.inner_count()
            };
            let tied = (1..sound.len()).filter(|index| !best.is_clearly_better_than(&sound[*index]));
            let simplest = tied.filter(|index| simpler(&sound[*index])).min_by_key(|index| sound[*index].inner_count());
            if let Some(index) = simplest {
                let simplest = sound.remove(index);
                sound.insert(0, simplest);
            }
        }
        sound.extend(unsound);
        sound
    }

    fn name(&self, trial: &Trial) -> String {
        trial.fit.form.effect_name(trial.term())
    }
}

/// RMS force of every term of a fitted law along its motion.
pub(super) fn forces(fit: &Fit, pieces: &[Piece]) -> Vec<f64> {
    let rms = rms(&fit.form.terms, &fit.form.expressions, pieces, &fit.states);
    fit.coefficients.iter().zip(rms).map(|(coefficient, rms)| coefficient.abs() * rms).collect()
}

/// RMS of terms along smoothed motions.
fn rms(terms: &[Term], expressions: &[Expression], pieces: &[Piece], states: &[Vec<State>]) -> Vec<f64> {
    let own = |(piece, states): (&Piece, &Vec<State>)| screen::columns(terms, expressions, piece, states);
    rms_of(&pieces.iter().zip(states).map(own).collect::<Vec<_>>())
}

/// RMS of the columns of all pieces, each.
pub(super) fn rms_of(pieces: &[Vec<Vec<f64>>]) -> Vec<f64> {
    let mut squares = vec![0.0; pieces.first().map_or(0, Vec::len)];
    for columns in pieces {
        squares.iter_mut().zip(columns).for_each(|(sum, column)| *sum += column.iter().map(|f| f * f).sum::<f64>());
    }
    let count: usize = pieces.iter().filter_map(|columns| columns.first()).map(Vec::len).sum();
    squares.into_iter().map(|square| (square / count.max(1) as f64).sqrt()).collect()
}
