//! Gauss–Newton steps on the innovations' likelihood, and the noise that follows them.

use super::exogenous::Exogenous;
use super::form::{Fit, Form, Parts};
use super::inner_slopes::{self, Sought};
use super::noise_covariance::{self, GAIN, Signals};
use super::outcome::{self, Law, Outcome};
use super::run;
use super::start;
use crate::diagnose::piece::Piece;
use crate::diagnose::scale::Scale;
use crate::estimation::{Information, Noise, Pass, RIVALS, Solution, smooth};
use crate::law::{Effect, State, Term};

/// Most passes of one descent, a bound of its cost.
const PASSES: usize = 25;

/// Gauss–Newton decrement per unknown below which a step is no longer one: a thirtieth of a std.
const SETTLED: f64 = 1e-3;

/// The sensors alone do not come to explain the record where a pass makes good only this part of what is missing, 1 ÷.
const HOPELESS: f64 = 5.0;

/// Passes in which the sensors alone take all error, a bound of the cost.
const QUIET_PASSES: usize = 8;

/// Factor by which a step may change the inertia: beyond, what is linear in m is not in 1 ÷ m.
const LARGEST_RATIO: f64 = 2.5;

/// Rate at which the measurements hold the motion of the series, relative to the motion's own angular frequency.
const HELD: f64 = 1.0;

/// Gain, nats, that a pass must bring to count as one.
const PROGRESS: f64 = 0.3;

/// Passes without a gain after which a descent has come to its end.
const IDLE: usize = 5;

/// The same where no step had to be taken back.
const STILL: usize = 2;

/// Loss in log-likelihood, nats, for which a pass is taken back.
const LOSS: f64 = 1.0;

/// Factor on the information of an inner parameter that is held: so much more than any record says, and no rounding.
const HELD_FAST: f64 = 1e12;

/// Damping of a step that is shortened, as part of each unknown's information: first, and at most.
const DAMPING: [f64; 2] = [1e-3, 1e3];

/// Factor by which damping grows and falls.
const DAMPING_RATIO: f64 = 10.0;

/// Std of the prior of a delayed excitation's coefficient about 1: for short delays only its product with the delay can
/// be told.
const DELAYED: f64 = 0.2;

/// A step, and what the record says without its damping.
struct Solved {
    step: Vec<f64>,
    solution: Solution,
}

impl Solved {
    /// The Gauss–Newton step with that part of each unknown's information added to it; unknowns that the record leaves
    /// open stay. None where a run left no numbers.
    fn of(information: &Information, damping: f64) -> Option<Solved> {
        let solve = |information: &Information| {
            let mut solution = Solution::none(information.n);
            solution.solve(information, &vec![true; information.n]);
            solution.step.iter().all(|value| value.is_finite()).then_some(solution)
        };
        let solution = information.is_finite().then(|| solve(information)).flatten()?;
        let step = if damping > 0.0 { solve(&information.damped(damping))?.step } else { solution.step.clone() };
        Some(Solved { step, solution })
    }
}

/// Where a descent stands.
#[derive(Clone, Debug)]
pub(super) struct Descent<'a> {
    form: Form,
    pieces: &'a [Piece],
    signals: Signals,
    parts: Parts,
    inner: Vec<Sought>,
    /// Between which values of each the motion can tell; empty before there is a motion.
    limits: Vec<[f64; 2]>,
    coefficients: Vec<f64>,
    pub(super) noise: Noise,
    /// The rivals' process noise, relative to it.
    ratios: [f64; 2],
    /// The series.
    exogenous: Exogenous,
}

impl<'a> Descent<'a> {
    /// Begins there; none where a piece has no samples.
    pub(super) fn new(form: &Form, pieces: &'a [Piece], coefficients: &[f64], noise: Noise) -> Option<Descent<'a>> {
        let parts = Parts::of(form);
        let inner = inner_slopes::sought(form);
        let exogenous = Exogenous::none(form, &parts, &inner, pieces);
        Some(Descent {
            form: form.clone(),
            pieces,
            signals: Signals { largest: start::largest(pieces), sample_time: pieces.first()?.observations.first()?.dt },
            parts,
            inner,
            limits: Vec::new(),
            coefficients: coefficients.to_vec(),
            noise,
            ratios: RIVALS,
            exogenous,
        })
    }

    /// Room for its runs.
    pub(super) fn pass(&self) -> Pass {
        Pass::new(self.parts.free.len())
    }

    /// Passes until coefficients and noise stay; leaves them where they are best.
    ///
    /// A pass that is worse than the last one is taken back, and looked at again under the noise that it had; the next
    /// step is shorter (Marquardt, SIAM Journal 11 (1963), 431). So a step is judged apart from the noise that moves
    /// with it.
    pub(super) fn descend(&mut self, pass: &mut Pass) -> Option<Fit> {
        let mut best: Option<(Fit, Descent<'a>, Vec<Outcome>)> = None;
        let mut last: Option<Descent<'a>> = None;
        let mut needed = f64::NEG_INFINITY;
        let (mut calm, mut damping, mut idle, mut still) = (0, 0.0, 0, 0);
        for _ in 0..PASSES {
            let outcomes = self.run(pass);
            let mut information = total(&outcomes);
            let measurements: f64 = outcomes.iter().flat_map(|outcome| outcome.count).sum();
            let log_likelihood = self.log_likelihood(&outcomes, &information);
            let reached = best.as_ref().map_or(f64::NEG_INFINITY, |(best, ..)| best.log_likelihood);
            let gained = log_likelihood > reached + PROGRESS;
            idle = if gained { 0 } else { idle + 1 };
            still = if gained || needed == f64::NEG_INFINITY { 0 } else { still + 1 };
            if idle > IDLE || still > STILL {
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
            self.add_priors(&mut information);
            let solved = self.solved(&mut information, damping)?;
            damping = if needed.is_finite() { relaxed(damping) } else { damping };
            let descended: f64 = solved.step.iter().zip(&information.score).map(|(step, score)| step * score).sum();
            let decrement = descended / solved.step.len().max(1) as f64;
            let followed = self.is_followed(needed, log_likelihood);
            let reached = (log_likelihood >= reached).then(|| {
                let mut fit = self.summary(log_likelihood, solved.solution, measurements);
                fit.noise = noise_covariance::calibrated(&self.noise, &outcomes);
                (fit, self.clone())
            });
            let steady = noise_covariance::follow(&mut self.noise, &mut self.ratios, &outcomes, self.signals);
            let level = (log_likelihood - needed).abs() < GAIN;
            let steady = (steady || level) && followed;
            calm = if steady && decrement < SETTLED.max(1e-9 * measurements) { calm + 1 } else { 0 };
            if calm < 2 {
                (last, needed) = (Some(self.clone()), log_likelihood);
                self.take(&solved.step);
                self.follow(&outcomes, pass);
            }
            best = reached.map(|(fit, point)| (fit, point, outcomes)).or(best);
            if calm >= 2 {
                break;
            }
        }
        let (mut fit, point, outcomes) = best?;
        *self = point;
        fit.states = self.smoothed(&outcomes);
        Some(fit)
    }

    /// The step, without inner parameters that it would carry out of what the motion can tell.
    fn solved(&self, information: &mut Information, damping: f64) -> Option<Solved> {
        let solved = Solved::of(information, damping)?;
        let first = self.parts.unknowns.len();
        let steps = &solved.step[first..first + self.inner.len()];
        let held = inner_slopes::outward(&self.form, &self.inner, &self.limits, steps);
        if held.is_empty() {
            return Some(solved);
        }
        for row in held.iter().map(|position| first + position) {
            let own = information.entry_mut(row, row);
            *own = HELD_FAST * own.max(f64::MIN_POSITIVE);
            information.score[row] = 0.0;
        }
        Solved::of(information, damping)
    }

    /// Back to where the last step began; where that bore no motion either, with more process noise to hold it.
    fn take_back(&mut self, last: &Descent<'a>, needed: f64) {
        let process = self.noise.process;
        self.clone_from(last);
        if needed == f64::NEG_INFINITY {
            self.noise.process = 100.0 * process;
        }
    }

    /// Log-likelihood under no process noise, the sensors' noise taking all error, coefficients moving along; ends
    /// where it is largest. Gives up where it will not come near `loud`.
    pub(super) fn fit_output_error(&mut self, pass: &mut Pass, loud: f64) -> f64 {
        let mut best: Option<(f64, Descent<'a>)> = None;
        self.ratios = RIVALS;
        for _ in 0..QUIET_PASSES {
            self.noise.process = start::negligible(&self.noise);
            let reached = best.as_ref().map_or(f64::NEG_INFINITY, |(reached, _)| *reached);
            let outcomes = self.run(pass);
            if outcomes.iter().any(|outcome| !outcome.finite) {
                break;
            }
            let mut information = total(&outcomes);
            let log_likelihood = self.log_likelihood(&outcomes, &information);
            self.add_priors(&mut information);
            let gained = log_likelihood - reached;
            if gained > 0.0 {
                best = Some((log_likelihood, self.clone()));
            }
            let Some(solved) = Solved::of(&information, 0.0) else { break };
            noise_covariance::follow(&mut self.noise, &mut self.ratios, &outcomes, self.signals);
            if gained.abs() < GAIN || loud - reached.max(log_likelihood) > HOPELESS * gained {
                break;
            }
            self.take(&solved.step);
        }
        let Some((reached, point)) = best else { return f64::NEG_INFINITY };
        *self = point;
        reached
    }

    pub(super) fn run(&self, pass: &mut Pass) -> Vec<Outcome> {
        let terms: Vec<Term> = self.parts.of_state.iter().map(|index| self.form.terms[*index]).collect();
        let coefficients: Vec<f64> = self.parts.of_state.iter().map(|index| self.coefficients[*index]).collect();
        pass.rivals.ratios = self.ratios;
        let pieces = self.pieces.iter().zip(self.exogenous.rows.iter()).enumerate();
        let outcome = |(number, (piece, rows)): (usize, (&Piece, &Vec<_>))| {
            let series = self.exogenous.weights(&self.parts, &self.coefficients, number);
            let (free, noise) = (&self.parts.free, self.noise);
            let tangents = &self.exogenous.tangents[number];
            let law = Law { terms: &terms, coefficients: &coefficients, free, series: &series, tangents, noise };
            run::run(&law, piece, pass, rows).among(self.exogenous.span(&self.parts, number))
        };
        pieces.map(outcome).collect()
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

    /// Renews the series along a motion that the measurements hold: one that the law alone carries from end to end
    /// would follow its own errors, growing from pass to pass where a memory resonates.
    pub(super) fn follow(&mut self, outcomes: &[Outcome], pass: &mut Pass) {
        if self.parts.series.is_empty() || outcomes.iter().all(|outcome| outcome.smoothed.is_some()) {
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
            let beginnings = self.exogenous.beginnings(&self.form, &self.parts);
            if self.limits.is_empty() {
                self.limits = inner_slopes::limits(&self.form, &self.inner, &Scale::of(self.pieces, &states));
            }
            let law = (&self.form, self.coefficients.as_slice());
            self.exogenous = Exogenous::along(law, &self.inner, self.pieces, &states, &beginnings);
        }
    }

    /// Of all pieces, the price of unknown beginnings taken off; `information` without their prior.
    pub(super) fn log_likelihood(&self, outcomes: &[Outcome], information: &Information) -> f64 {
        let unlikely: f64 = self.delays().map(|(_, value)| 0.5 * ((value - 1.0) / DELAYED).powi(2)).sum();
        outcomes.iter().map(|outcome| outcome.log_likelihood).sum::<f64>()
            - self.exogenous.price(information)
            - unlikely
    }

    fn smoothed(&self, outcomes: &[Outcome]) -> Vec<Vec<State>> {
        let of = |outcome: &Outcome| match &outcome.smoothed {
            Some(states) => states.clone(),
            None => outcome::states(&smooth(&outcome.first, &outcome.steps)),
        };
        outcomes.iter().map(of).collect()
    }

    fn summary(&self, log_likelihood: f64, solution: Solution, measurements: f64) -> Fit {
        Fit {
            form: self.form.clone(),
            coefficients: self.coefficients.clone(),
            solution,
            noise: self.noise,
            log_likelihood,
            log_likelihood_if_right: f64::NEG_INFINITY,
            measurements,
            states: Vec::new(),
            beginnings: self.exogenous.beginnings(&self.form, &self.parts),
        }
    }

    /// Takes the Gauss–Newton step as far as it goes: the inertia becomes at most [`LARGEST_RATIO`] times larger or
    /// smaller (as it grows without bounds, the law forgets its excitation), an inner parameter by a third.
    pub(super) fn take(&mut self, step: &[f64]) {
        let (coefficients, others) = step.split_at(self.parts.unknowns.len());
        let inner = &others[..self.inner.len()];
        let fraction = self.bounded(coefficients).min(inner_slopes::bounded(inner));
        for (index, change) in self.parts.unknowns.iter().zip(coefficients) {
            self.coefficients[*index] += fraction * change;
        }
        inner_slopes::take(&mut self.form, &self.inner, &self.limits, inner, fraction);
        self.exogenous.take(step, fraction);
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

    /// Adds what is known before the record speaks: where memories begin, and that a delayed excitation takes the place
    /// of the excitation.
    pub(super) fn add_priors(&self, information: &mut Information) {
        for (row, value) in self.delays() {
            information.add_prior(row, DELAYED.powi(-2), (1.0 - value) * DELAYED.powi(-2));
        }
        self.exogenous.add_prior(information);
    }

    /// Row and coefficient of every excitation that acts late.
    fn delays(&self) -> impl Iterator<Item = (usize, f64)> {
        let unknowns = self.parts.unknowns.iter().enumerate();
        let delayed = |index: usize| {
            matches!(self.form.terms[index], Term::Effect(Effect::ExcitationDelay { .. } | Effect::ActuatorLag { .. }))
        };
        unknowns.filter(move |(_, index)| delayed(**index)).map(|(row, index)| (row, self.coefficients[*index]))
    }
}

pub(super) fn total(outcomes: &[Outcome]) -> Information {
    let mut information = Information::none(outcomes.first().map_or(0, |outcome| outcome.information.n));
    outcomes.iter().for_each(|outcome| information.merge(&outcome.information));
    information
}

fn relaxed(damping: f64) -> f64 {
    if damping > DAMPING[0] { damping / DAMPING_RATIO } else { 0.0 }
}
