//! The forces that a run takes from outside: terms that no state gives, along a smoothed motion.
//!
//! Each is a straight line over every interval. Where its memory stood when the record began nobody knows: how far from
//! rest is an unknown of its own, for each piece, beside the coefficients. It has a prior as wide as the motion lets
//! one expect; its price, the logarithm of how much the record narrows it, is taken off the likelihood (Laplace's
//! approximation of what is left when it is integrated out).

use super::course::Course;
use super::form::{Form, Parts};
use super::inner_slopes::{self, Along, Sought};
use super::outcome::{Span, Tangent};
use crate::diagnose::piece::Piece;
use crate::estimation::Information;
use crate::law::{Effect, Hold, Line, Model, Motion, State, Term, interval_forces};
use nalgebra::DMatrix;
use std::rc::Rc;

/// Part of a beginning's spread by which it is moved to see what it does.
const NUDGE: f64 = 1e-3;

/// The series of a form over all pieces.
#[derive(Clone, Debug, Default)]
pub(super) struct Exogenous {
    /// By piece and interval: the force of every series per unit of its coefficient, of every inner parameter that is
    /// sought per unit of its logarithm, then of every beginning of the piece per unit of it.
    pub(super) rows: Rc<Vec<Vec<Vec<Line>>>>,
    /// By piece and interval: how the series of a hysteresis changes where the motion leaves the smoothed one.
    pub(super) tangents: Rc<Vec<Vec<Tangent>>>,
    /// By how much each beginning may be expected to differ from rest.
    spreads: Vec<f64>,
    /// Number of inner parameters.
    inner: usize,
    /// Number of beginnings of one piece.
    own: usize,
    /// How far from rest the memories began when the rows were made, piece by piece …
    beginnings: Vec<f64>,
    /// … and by how much they changed since.
    changes: Vec<f64>,
}

impl Exogenous {
    /// Numbers that say where the memories begin, of all pieces.
    pub(super) fn count(form: &Form, parts: &Parts, pieces: &[Piece]) -> usize {
        effects(form, parts).map(Effect::beginning_length).sum::<usize>() * pieces.len()
    }

    /// Forces of 0, as long as there is no motion.
    pub(super) fn none(form: &Form, parts: &Parts, inner: &[Sought], pieces: &[Piece]) -> Exogenous {
        let count = Exogenous::count(form, parts, pieces);
        let own = count / pieces.len().max(1);
        let columns = parts.series.len() + inner.len() + own;
        let rows = |piece: &Piece| vec![vec![[0.0; 2]; columns]; if columns > 0 { piece.len() - 1 } else { 0 }];
        Exogenous {
            rows: Rc::new(pieces.iter().map(rows).collect()),
            tangents: Rc::new(vec![Vec::new(); pieces.len()]),
            inner: inner.len(),
            own,
            spreads: vec![1.0; count],
            beginnings: vec![0.0; count],
            changes: vec![0.0; count],
        }
    }

    /// Along these motions, from these beginnings.
    pub(super) fn along(
        (form, coefficients): (&Form, &[f64]),
        inner: &[Sought],
        pieces: &[Piece],
        states: &[Vec<State>],
        beginnings: &[f64],
    ) -> Exogenous {
        let parts = Parts::of(form);
        let mut all = Exogenous::none(form, &parts, inner, pieces);
        let rows = Rc::make_mut(&mut all.rows);
        let smooth = Smooth::of(form, &parts, coefficients);
        let mut first = 0;
        for (number, (piece, states)) in pieces.iter().zip(states).enumerate() {
            let mut column = parts.series.len() + inner.len();
            let course = Course::of(piece, states);
            let bends = smooth.bends(piece, states);
            let begin = |term: usize| own_beginnings(form, &parts, term, &beginnings[first..]);
            for (position, one) in inner.iter().enumerate() {
                let along = Along { piece, states, bends: &bends, begin: begin(one.term) };
                let slope = inner_slopes::slope((form, coefficients), *one, along);
                put(&mut rows[number], parts.series.len() + position, &slope, |line| *line);
            }
            for (position, index) in parts.series.iter().enumerate() {
                let (term, coefficient) = (form.terms[*index], coefficients[*index]);
                let length = term.effect().map_or(0, Effect::beginning_length);
                let begin = &beginnings[first..first + length];
                let force =
                    |begin: &[f64]| interval_forces(term, &form.expressions, &course.trajectory(), &bends, begin);
                let own = force(begin);
                if form.terms.len() < Model::MAX_TERMS
                    && let Some(tangents) = tangents(position, term, piece, states, &own)
                {
                    Rc::make_mut(&mut all.tangents)[number] = tangents;
                }
                let spreads = spreads(term, &own, &piece.excitation);
                put(&mut rows[number], position, &own, |line| *line);
                for (offset, spread) in spreads.iter().enumerate() {
                    let mut moved = begin.to_vec();
                    moved[offset] += NUDGE * spread;
                    let change = force(&moved);
                    let pairs: Vec<(Line, Line)> = own.iter().copied().zip(change).collect();
                    let scale = coefficient / (NUDGE * spread);
                    put(&mut rows[number], column, &pairs, |(from, to)| {
                        [scale * (to[0] - from[0]), scale * (to[1] - from[1])]
                    });
                    all.spreads[first + offset] = *spread;
                    column += 1;
                }
                first += length;
            }
        }
        all.beginnings.copy_from_slice(beginnings);
        all
    }

    /// What multiplies the columns of the rows of the piece of that number under these coefficients of the form.
    pub(super) fn weights(&self, parts: &Parts, coefficients: &[f64], piece: usize) -> Vec<f64> {
        let series = parts.series.iter().map(|index| coefficients[*index]);
        let changes = &self.changes[piece * self.own..(piece + 1) * self.own];
        series.chain(std::iter::repeat_n(0.0, self.inner)).chain(changes.iter().copied()).collect()
    }

    /// Where the columns of the piece of that number stand among the unknowns of all pieces.
    pub(super) fn span(&self, parts: &Parts, piece: usize) -> Span {
        let shared = parts.unknowns.len() + self.inner;
        Span { shared, first: piece * self.own, all: self.spreads.len() }
    }

    /// Changes the beginnings by a fraction of the last unknowns of a step.
    pub(super) fn take(&mut self, step: &[f64], fraction: f64) {
        let own = &step[step.len() - self.changes.len()..];
        self.changes.iter_mut().zip(own).for_each(|(change, step)| *change += fraction * step);
    }

    /// Where the memories begin, as far as they can.
    pub(super) fn beginnings(&self, form: &Form, parts: &Parts) -> Vec<f64> {
        let own = |effect: Effect| std::iter::repeat_n(effect, effect.beginning_length());
        let owners: Vec<Effect> = effects(form, parts).flat_map(own).collect();
        let values = self.beginnings.iter().zip(&self.changes).map(|(value, change)| value + change);
        owners.iter().cycle().zip(values).map(|(effect, value)| effect.possible_beginning(value)).collect()
    }

    /// Adds what the prior says of the beginnings, the last unknowns.
    pub(super) fn add_prior(&self, information: &mut Information) {
        let before = information.n - self.spreads.len();
        for (offset, (weight, score)) in self.prior().enumerate() {
            information.add_prior(before + offset, weight, score);
        }
    }

    /// Information and score of each beginning by its prior.
    pub(super) fn prior(&self) -> impl Iterator<Item = (f64, f64)> {
        let weights = self.spreads.iter().map(|spread| (spread * spread).recip());
        weights.zip(self.present()).map(|(weight, value)| (weight, -weight * value))
    }

    fn present(&self) -> impl Iterator<Item = f64> {
        self.beginnings.iter().zip(&self.changes).map(|(value, change)| value + change)
    }

    /// What the beginnings cost in log-likelihood; `information` without their prior.
    pub(super) fn price(&self, information: &Information) -> f64 {
        let (count, before) = (self.spreads.len(), information.n - self.spreads.len());
        let narrowed = DMatrix::from_fn(count, count, |row, column| {
            let scaled = self.spreads[row] * self.spreads[column] * information.entry(before + row, before + column);
            scaled + if row == column { 1.0 } else { 0.0 }
        });
        let distance: f64 = self.present().zip(&self.spreads).map(|(value, spread)| (value / spread).powi(2)).sum();
        let logarithm = narrowed.cholesky().map_or(0.0, |root| root.l().diagonal().map(f64::ln).sum());
        logarithm + 0.5 * distance
    }
}

/// Where the memory of a form's term begins, `beginnings` being those of its piece; empty where it has none.
fn own_beginnings<'a>(form: &Form, parts: &Parts, term: usize, beginnings: &'a [f64]) -> &'a [f64] {
    let length = |index: usize| form.terms[index].effect().map_or(0, Effect::beginning_length);
    let before: usize = parts.series.iter().take_while(|index| **index != term).map(|index| length(*index)).sum();
    if parts.series.contains(&term) { &beginnings[before..before + length(term)] } else { &[] }
}

fn effects<'a>(form: &'a Form, parts: &'a Parts) -> impl Iterator<Item = Effect> + 'a {
    parts.series.iter().filter_map(|index| form.terms[*index].effect())
}

fn put<T>(rows: &mut [Vec<Line>], column: usize, values: &[T], line: impl Fn(&T) -> Line) {
    rows.iter_mut().zip(values).for_each(|(row, value)| row[column] = line(value));
}

/// How a loop changes with the displacement over every interval; none of any other term.
fn tangents(series: usize, term: Term, piece: &Piece, states: &[State], forces: &[Line]) -> Option<Vec<Tangent>> {
    let effect = term.effect().filter(|effect| effect.loop_tangent(0.0, 1.0).is_some())?;
    let tangent = |(k, line): (usize, &Line)| {
        let (from, to) = (states[k], states[k + 1]);
        let (mean, way) = (0.5 * (line[0] + line[1]), to.q - from.q);
        let [slope, kept] = effect.loop_tangent(mean, way).unwrap_or([0.0, 1.0]);
        let displacement = displacement(from, to, piece.t[k + 1] - piece.t[k]);
        Tangent { series, slope, kept, displacement, ends: [from.q, to.q] }
    };
    Some(forces.iter().enumerate().map(tangent).collect())
}

/// The line with the mean and the first moment of the cubic between two states (Hermite).
fn displacement(from: State, to: State, dt: f64) -> Line {
    let mean = 0.5 * (from.q + to.q) + dt / 12.0 * (from.qd - to.qd);
    let moment = 0.1 * (to.q - from.q) - dt / 120.0 * (from.qd + to.qd);
    [mean - 6.0 * moment, mean + 6.0 * moment]
}

/// Spreads of a term's beginnings; 1 where the motion is none.
fn spreads(term: Term, forces: &[Line], excitation: &[f64]) -> Vec<f64> {
    let Some(effect) = term.effect() else { return Vec::new() };
    let rms = |squares: f64, count: usize| (squares / count.max(1) as f64).sqrt();
    let feature = rms(forces.iter().map(|line| (0.5 * (line[0] + line[1])).powi(2)).sum(), forces.len());
    let force = rms(excitation.iter().map(|value| value * value).sum(), excitation.len());
    let positive = |spread: f64| if spread > 0.0 && spread.is_finite() { spread } else { 1.0 };
    effect.beginning_spread(feature, force).into_iter().map(positive).collect()
}

/// The part of a law that tells how the acceleration changes between samples: what the state gives without a jump.
struct Smooth {
    terms: Vec<Term>,
    coefficients: Vec<f64>,
}

impl Smooth {
    fn of(form: &Form, parts: &Parts, coefficients: &[f64]) -> Smooth {
        let dry = |index: &&usize| form.terms[**index].effect().is_some_and(Effect::is_dry);
        let kept: Vec<usize> = parts.of_state.iter().filter(|index| !dry(index)).copied().collect();
        let terms = kept.iter().map(|index| form.terms[*index]).collect();
        Smooth { terms, coefficients: kept.iter().map(|index| coefficients[*index]).collect() }
    }

    /// Change of q̈ over every interval.
    fn bends(&self, piece: &Piece, states: &[State]) -> Vec<f64> {
        let motion = Motion::new(&self.terms, &self.coefficients);
        let bend = |k: usize| {
            let last = if piece.hold == Hold::Zero { k } else { k + 1 };
            motion.acceleration(states[k + 1], piece.excitation[last])
                - motion.acceleration(states[k], piece.excitation[k])
        };
        (0..states.len().saturating_sub(1)).map(bend).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// q = 1 − 2 s + 3 s² + 4 s³ over an interval: ∫ q ds = 2, ∫ q (s − ½) ds = 23 ÷ 60.
    #[test]
    fn a_displacement_keeps_the_mean_and_the_moment_of_its_cubic() {
        let dt = 0.1;
        let (from, to) = (State { q: 1.0, qd: -2.0 / dt }, State { q: 6.0, qd: 16.0 / dt });
        let [start, end] = displacement(from, to, dt);
        assert!((0.5 * (start + end) - 2.0).abs() < 1e-12, "{start}, {end}");
        assert!(((end - start) / 12.0 - 23.0 / 60.0).abs() < 1e-12, "{start}, {end}");
    }
}
