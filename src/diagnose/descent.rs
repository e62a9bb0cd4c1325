//! Gauss–Newton steps on the innovations' likelihood, and the noise that follows them.

use super::beside::Beside;
use super::fit::{Fit, Form, Parts, solve, solve_damped};
use super::inner_slopes::{self, Sought};
use super::piece::Piece;
use super::run::{self, Law, Outcome, Sums};
use super::smooth::smooth;
use super::start;
use super::variants::Scale;
use crate::evidence::{Noise, Pass, RIVALS};
use crate::law::{Effect, State, Term};
use nalgebra::{DMatrix, DVector};

/// Most passes of one descent.
const PASSES: usize = 40;

/// Gauss–Newton decrement per unknown below which a step is no longer one.
const SETTLED: f64 = 1e-3;

/// Gain in log-likelihood, nats, that another level of process noise must promise.
const GAIN: f64 = 0.1;

/// Smallest sensor noise std, relative to the largest value measured.
const NOISE_FLOOR: f64 = 1e-7;

/// The sensors alone do not come to explain the record where a pass makes good only this part of what is missing, 1 ÷.
const HOPELESS: f64 = 5.0;

/// Passes in which the sensors alone take all error.
const QUIET_PASSES: usize = 8;

/// Factor by which a step may change the inertia.
const LARGEST_RATIO: f64 = 2.5;

/// Rate at which the measurements hold the motion of the series, relative to the motion's own angular frequency.
const HELD: f64 = 1.0;

/// Passes without a gain after which a descent has come to its end.
const IDLE: usize = 6;

/// Loss in log-likelihood, nats, for which a pass is taken back.
const LOSS: f64 = 1.0;

/// Damping of a step that is shortened, as part of each unknown's information: first, and at most.
const DAMPING: [f64; 2] = [1e-3, 1e3];

/// Factor by which damping grows and falls.
const DAMPING_RATIO: f64 = 10.0;

/// Std of the prior of a delayed excitation's coefficient about 1: for short delays only its product with the delay can be told.
const DELAYED: f64 = 0.2;

/// Where a descent stands.
#[derive(Clone, Debug)]
pub(super) struct Descent<'a> {
    pub(super) form: Form,
    pub(super) pieces: &'a [Piece],
    pub(super) parts: Parts,
    pub(super) inner: Vec<Sought>,
    pub(super) coefficients: Vec<f64>,
    pub(super) noise: Noise,
    /// The series.
    pub(super) beside: Beside,
}

impl<'a> Descent<'a> {
    /// Passes until coefficients and noise stay; leaves them where they are best.
    ///
    /// A pass that is worse than the last one is taken back, and looked at again under the noise that it had; the next step is shorter
    /// (Marquardt, SIAM Journal 11 (1963), 431). So a step is judged apart from the noise that moves with it.
    pub(super) fn descend(&mut self, pass: &mut Pass) -> Option<Fit> {
        let mut best: Option<(Fit, Descent<'a>)> = None;
        let mut last: Option<Descent<'a>> = None;
        let mut needed = f64::NEG_INFINITY;
        let (mut calm, mut damping, mut idle) = (0, 0.0, 0);
        for _ in 0..PASSES {
            let outcomes = self.run(pass);
            let mut sums = total(&outcomes);
            let log_likelihood = self.log_likelihood(&outcomes, &sums);
            let reached = best.as_ref().map_or(f64::NEG_INFINITY, |(best, _)| best.log_likelihood);
            idle = if log_likelihood > reached + GAIN { 0 } else { idle + 1 };
            if idle > IDLE {
                break;
            }
            let finite = outcomes.iter().all(|outcome| outcome.finite) && log_likelihood.is_finite();
            if !finite || log_likelihood < needed - LOSS {
                self.take_back(last.as_ref()?, needed);
                damping = (DAMPING_RATIO * damping).max(DAMPING[0]);
                (calm, needed) = (0, f64::NEG_INFINITY);
                if damping > DAMPING[1] {
                    break;
                }
                continue;
            }
            self.add_priors(&mut sums);
            let solved = solve_damped(&sums.information, &sums.score, damping)?;
            damping = if needed.is_finite() { relaxed(damping) } else { damping };
            let decrement = solved.step.dot(&sums.score) / solved.step.len().max(1) as f64;
            let followed = self.is_followed(needed, log_likelihood);
            if log_likelihood >= reached {
                let mut fit = self.summary(log_likelihood, solved.covariance, sums.count);
                fit.noise = calibrated(&self.noise, &outcomes);
                best = Some((fit, self.clone()));
            }
            let steady = move_noise(&mut self.noise, &outcomes, start::largest(self.pieces)) && followed;
            calm = if steady && decrement < SETTLED.max(1e-9 * sums.count) { calm + 1 } else { 0 };
            if calm >= 2 {
                break;
            }
            (last, needed) = (Some(self.clone()), log_likelihood);
            self.take(&solved.step);
            self.follow(&outcomes, pass);
        }
        let (mut fit, point) = best?;
        *self = point;
        fit.states = self.smoothed(&self.run(pass));
        Some(fit)
    }

    /// Back to where the last step began; where that bore no motion either, with more process noise to hold it.
    fn take_back(&mut self, last: &Descent<'a>, needed: f64) {
        let process = self.noise.process;
        self.clone_from(last);
        if needed == f64::NEG_INFINITY {
            self.noise.process = 100.0 * process;
        }
    }

    /// Log-likelihood under no process noise, the sensors' noise taking all error, coefficients moving along.
    /// Gives up where it will not come near `loud`.
    pub(super) fn quieten(&mut self, pass: &mut Pass, loud: f64) -> f64 {
        let mut reached = f64::NEG_INFINITY;
        let largest = start::largest(self.pieces);
        for _ in 0..QUIET_PASSES {
            self.noise.process = start::negligible(&self.noise);
            let outcomes = self.run(pass);
            if outcomes.iter().any(|outcome| !outcome.finite) {
                return reached;
            }
            let mut sums = total(&outcomes);
            let log_likelihood = self.log_likelihood(&outcomes, &sums);
            self.add_priors(&mut sums);
            let gained = log_likelihood - reached;
            reached = reached.max(log_likelihood);
            let Some(solved) = solve(&sums.information, &sums.score) else { return reached };
            move_noise(&mut self.noise, &outcomes, largest);
            if gained.abs() < GAIN || loud - reached > HOPELESS * gained {
                return reached;
            }
            self.take(&solved.step);
        }
        reached
    }

    fn run(&self, pass: &mut Pass) -> Vec<Outcome> {
        let terms: Vec<Term> = self.parts.of_state.iter().map(|index| self.form.terms[*index]).collect();
        let coefficients: Vec<f64> = self.parts.of_state.iter().map(|index| self.coefficients[*index]).collect();
        let series = self.beside.weights(&self.parts, &self.coefficients);
        let law = Law {
            terms: &terms,
            coefficients: &coefficients,
            free: &self.parts.free,
            series: &series,
            noise: self.noise,
        };
        let pairs = self.pieces.iter().zip(&self.beside.rows);
        pairs.map(|(piece, rows)| run::run(&law, piece, pass, rows, &[], &[], None)).collect()
    }

    /// Whether the series have followed the motion that they are part of: they are renewed pass by pass.
    fn is_followed(&self, before: f64, log_likelihood: f64) -> bool {
        self.parts.series.is_empty() || (log_likelihood - before).abs() < GAIN
    }

    /// Series need a motion before there is one: that of the law without them.
    pub(super) fn renew_series(&mut self, pass: &mut Pass) {
        if self.has_series() {
            let outcomes = self.run(pass);
            self.take_series(&outcomes);
        }
    }

    fn has_series(&self) -> bool {
        !self.parts.series.is_empty() || !self.inner.is_empty()
    }

    /// Renews the series along a motion that the measurements hold: one that the law alone carries from end to end would follow its own errors,
    /// growing from pass to pass where a memory resonates.
    fn follow(&mut self, outcomes: &[Outcome], pass: &mut Pass) {
        if self.parts.series.is_empty() {
            return self.take_series(outcomes);
        }
        let scale = Scale::of(self.pieces, &self.smoothed(outcomes));
        let rate = HELD * scale.frequency[0];
        let [q, qd] = self.noise.sensor;
        let displaced = self.pieces.iter().all(|piece| piece.q.is_some());
        let process = if displaced { rate.powi(4) * q } else { rate.powi(2) * qd } * scale.sample_time;
        let own = self.noise.process;
        if own >= process {
            return self.take_series(outcomes);
        }
        self.noise.process = process;
        let held = self.run(pass);
        self.noise.process = own;
        self.take_series(&held);
    }

    fn take_series(&mut self, outcomes: &[Outcome]) {
        if self.has_series() {
            let states = self.smoothed(outcomes);
            let beginnings = self.beside.beginnings(&self.form, &self.parts);
            let law = (&self.form, self.coefficients.as_slice());
            self.beside = Beside::along(law, &self.inner, self.pieces, &states, &beginnings);
        }
    }

    /// Of all pieces, the price of unknown beginnings taken off; `sums` without their prior.
    fn log_likelihood(&self, outcomes: &[Outcome], sums: &Sums) -> f64 {
        let unlikely: f64 = self.delays().map(|(_, value)| 0.5 * ((value - 1.0) / DELAYED).powi(2)).sum();
        outcomes.iter().map(|outcome| outcome.log_likelihood).sum::<f64>() - self.beside.price(sums) - unlikely
    }

    fn smoothed(&self, outcomes: &[Outcome]) -> Vec<Vec<State>> {
        outcomes.iter().map(|outcome| smooth(&outcome.first, &outcome.steps)).collect()
    }

    fn summary(&self, log_likelihood: f64, covariance: DMatrix<f64>, measurements: f64) -> Fit {
        let sought = self.parts.unknowns.len() + self.inner.len();
        Fit {
            form: self.form.clone(),
            coefficients: self.coefficients.clone(),
            covariance: covariance.view((0, 0), (sought, sought)).into_owned(),
            noise: self.noise,
            log_likelihood,
            log_likelihood_if_right: f64::NEG_INFINITY,
            measurements,
            states: Vec::new(),
            beginnings: self.beside.beginnings(&self.form, &self.parts),
        }
    }

    /// Takes the Gauss–Newton step as far as it goes: the inertia becomes at most [`LARGEST_RATIO`] times larger or smaller (as it grows without
    /// bounds, the law forgets its excitation), an inner parameter by a third.
    fn take(&mut self, step: &DVector<f64>) {
        let (coefficients, others) = step.as_slice().split_at(self.parts.unknowns.len());
        let inner = &others[..self.inner.len()];
        let fraction = self.bounded(coefficients).min(inner_slopes::bounded(inner));
        for (index, change) in self.parts.unknowns.iter().zip(coefficients) {
            self.coefficients[*index] += fraction * change;
        }
        inner_slopes::take(&mut self.form, &self.inner, inner, fraction);
        self.beside.take(step.as_slice(), fraction);
    }

    /// The part of a step that the inertia allows.
    fn bounded(&self, step: &[f64]) -> f64 {
        let inertia = self.form.inertia();
        let row = inertia.and_then(|inertia| self.parts.unknowns.iter().position(|index| *index == inertia));
        row.map_or(1.0, |row| {
            let relative = step[row] / self.coefficients[self.parts.unknowns[row]];
            let bounded = relative.clamp(LARGEST_RATIO.recip() - 1.0, LARGEST_RATIO - 1.0);
            if relative == bounded { 1.0 } else { bounded / relative }
        })
    }

    /// Adds what is known before the record speaks: where memories begin, and that a delayed excitation takes the place of the excitation.
    fn add_priors(&self, sums: &mut Sums) {
        for (row, value) in self.delays() {
            sums.information[(row, row)] += DELAYED.powi(-2);
            sums.score[row] -= (value - 1.0) * DELAYED.powi(-2);
        }
        self.beside.add_prior(sums);
    }

    /// Row and coefficient of every delayed excitation.
    fn delays(&self) -> impl Iterator<Item = (usize, f64)> {
        let unknowns = self.parts.unknowns.iter().enumerate();
        let delayed = |index: usize| matches!(self.form.terms[index], Term::Effect(Effect::ExcitationDelay { .. }));
        unknowns.filter(move |(_, index)| delayed(**index)).map(|(row, index)| (row, self.coefficients[*index]))
    }
}

fn total(outcomes: &[Outcome]) -> Sums {
    let mut sums = outcomes[0].sums[0].clone();
    outcomes[1..].iter().flat_map(|outcome| &outcome.sums).for_each(|other| sums.merge(other));
    sums
}

fn relaxed(damping: f64) -> f64 {
    if damping > DAMPING[0] { damping / DAMPING_RATIO } else { 0.0 }
}

/// The noise with the scale that the innovations have: the likelihood is that of the best scale, whatever the noise was.
fn calibrated(noise: &Noise, outcomes: &[Outcome]) -> Noise {
    let sum = |value: &dyn Fn(&Outcome) -> f64| outcomes.iter().map(value).sum::<f64>();
    let squares = [0, 1].map(|channel| sum(&|outcome| outcome.squares[channel]));
    let count = [0, 1].map(|channel| sum(&|outcome| outcome.count[channel]));
    let scale = |channel: usize| if count[channel] > 0.0 { squares[channel] / count[channel] } else { 1.0 };
    let mean = (squares[0] + squares[1]) / (count[0] + count[1]).max(1.0);
    Noise { sensor: [0, 1].map(|channel| noise.sensor[channel] * scale(channel)), process: noise.process * mean }
}

/// Sensor noise follows the innovations, process noise the likelihood; returns whether both stayed.
///
/// Where a sensor's noise would fall below its floor, all noise is lifted with it: the likelihood depends on the ratios alone.
fn move_noise(noise: &mut Noise, outcomes: &[Outcome], largest: [f64; 2]) -> bool {
    let old = *noise;
    *noise = calibrated(&old, outcomes);
    noise.process *= towards(outcomes);
    let measured = [0, 1].map(|channel| outcomes.iter().any(|outcome| outcome.count[channel] > 0.0));
    let floor = |channel: usize| (NOISE_FLOOR * largest[channel]).powi(2).max(f64::MIN_POSITIVE);
    let lift = (0..2)
        .filter(|channel| measured[*channel])
        .map(|channel| floor(channel) / noise.sensor[channel])
        .fold(1.0, f64::max);
    for channel in (0..2).filter(|channel| measured[*channel]) {
        noise.sensor[channel] *= lift;
    }
    // once there is less than the motion itself could show, it is none
    noise.process = (noise.process * lift).max(start::negligible(noise));
    let near = |new: f64, old: f64| (new / old - 1.0).abs() < 0.02;
    let none = noise.process <= start::negligible(noise);
    let settled = |channel: usize| !measured[channel] || near(noise.sensor[channel], old.sensor[channel]);
    settled(0) && settled(1) && (none || near(noise.process, old.process))
}

/// Factor by which the process noise moves: a rival's, or none.
fn towards(outcomes: &[Outcome]) -> f64 {
    let sum = |value: fn(&Outcome) -> f64| outcomes.iter().map(value).sum::<f64>();
    let present = sum(|outcome| outcome.log_likelihood);
    let [less, more] = [sum(|outcome| outcome.rivals[0]) - present, sum(|outcome| outcome.rivals[1]) - present];
    match (less >= more, less > -GAIN, more > GAIN) {
        // where a part of it does as well, it is none: a law that explains its record is not to be approached step by step
        (true, true, _) if less < GAIN => 0.0,
        (true, true, _) => RIVALS[0],
        (false, _, true) => RIVALS[1],
        _ => 1.0,
    }
}
