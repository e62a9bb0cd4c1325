//! The best coefficients that a form of law can have, over any number of pieces.
//!
//! The prediction-error method of the streaming identifier, with the whole record at hand: Gauss–Newton steps on the innovations'
//! likelihood, sensor noise from the innovations, process noise from two rival filters, from much of it down to what the data want.
//! Terms that no state gives (memory, delay, expressions of time) are series along the smoothed motion, renewed with it.

use super::beside::Beside;
use super::diagnosis::effect_name;
use super::inner_slopes::{self, Sought};
use super::means::is_series;
use super::piece::Piece;
use super::run::{self, Law, Outcome, Sums};
use super::smooth::smooth;
use super::start;
use super::variants::Scale;
use crate::evidence::{Noise, Pass, RIVALS};
use crate::law::{Expression, State, Term};
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

/// Rate at which the measurements hold the motion of the series, relative to the motion's own angular frequency.
const HELD: f64 = 1.0;

/// Factor by which a step may change the inertia.
const LARGEST_RATIO: f64 = 2.5;

/// Guesses from which a fit begins, at most.
const STARTS: usize = 4;

/// Factor by which the inertia has grown in a fit that forgets its excitation.
const FORGETFUL: f64 = 30.0;

/// A form of law: which terms it has, and what is known of each coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// The terms, inertia among them.
    pub terms: Vec<Term>,
    /// Their coefficients where held; `None` where sought.
    pub held: Vec<Option<f64>>,
    /// Which inner parameters of each are sought beside them.
    pub open: Vec<Vec<bool>>,
    /// What [`Term::Expression`] names.
    pub expressions: Vec<Expression>,
}

/// A form with its best coefficients.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The form.
    pub form: Form,
    /// One coefficient per term.
    pub coefficients: Vec<f64>,
    /// Covariance of what is sought: coefficients in the order of the terms, terms that the state gives first, then logarithms of inner
    /// parameters.
    pub covariance: DMatrix<f64>,
    /// Noise levels: the sensors', and the white acceleration that the law leaves unexplained.
    pub noise: Noise,
    /// Log-likelihood of all pieces.
    pub log_likelihood: f64,
    /// The same with all error in the sensors: as if the law were right.
    pub log_likelihood_if_right: f64,
    /// Number of scalar measurements.
    pub measurements: f64,
    /// Smoothed states at every sample, one list per piece.
    pub states: Vec<Vec<State>>,
    /// How far from rest the memories of its effects began, piece by piece.
    pub beginnings: Vec<f64>,
}

impl Form {
    /// A form of these terms, inner parameters as they are; `held` says which coefficients are known.
    pub fn new(terms: Vec<Term>, held: Vec<Option<f64>>, expressions: Vec<Expression>) -> Form {
        Form { open: vec![Vec::new(); terms.len()], terms, held, expressions }
    }

    /// Positions of the terms that the state gives and whose coefficients are sought.
    pub(super) fn free(&self) -> Vec<usize> {
        let parts = Parts::of(self);
        parts.free.iter().map(|position| parts.of_state[*position]).collect()
    }

    /// The form with every coefficient sought; without excitation the inertia stays at what it is, or 1.
    pub fn freed(&self, forced: bool) -> Form {
        let held = self.terms.iter().zip(&self.held).map(|(term, held)| match term {
            Term::Inertia if !forced => Some(held.unwrap_or(1.0)),
            _ => None,
        });
        Form { held: held.collect(), ..self.clone() }
    }

    /// The form with one more term, sought with its inner parameters.
    pub fn with(&self, term: Term) -> Form {
        let mut form = self.clone();
        form.terms.push(term);
        form.held.push(None);
        form.open.push(vec![true; term.effect().map_or(0, |effect| effect.inner().len())]);
        form
    }

    /// The form without the term of that position.
    pub fn without(&self, index: usize) -> Form {
        let mut form = self.clone();
        form.terms.remove(index);
        form.held.remove(index);
        form.open.remove(index);
        form
    }

    /// The effect id of a term; the user's name of an expression.
    pub fn effect_name(&self, term: Term) -> String {
        if matches!(term, Term::Expression(_)) { self.term_name(term) } else { effect_name(term) }
    }

    /// The canonical name of a term; the user's name of an expression.
    pub fn term_name(&self, term: Term) -> String {
        match term {
            Term::Expression(index) => {
                self.expressions.get(usize::from(index)).map_or_else(|| term.name(), |own| own.name().into())
            }
            _ => term.name(),
        }
    }

    fn inertia(&self) -> Option<usize> {
        self.terms.iter().position(|term| *term == Term::Inertia)
    }
}

impl Fit {
    /// By how much the record speaks for an error of the law, nats: what the likelihood gains from a white acceleration that the law does
    /// not have.
    pub fn lack(&self) -> f64 {
        (self.log_likelihood - self.log_likelihood_if_right).max(0.0)
    }

    /// Std of the coefficient of that position; 0 where it is held.
    pub fn std(&self, index: usize) -> f64 {
        let unknowns = Parts::of(&self.form).unknowns;
        let row = unknowns.iter().position(|unknown| *unknown == index);
        row.map_or(0.0, |row| self.covariance[(row, row)].max(0.0).sqrt())
    }
}

/// Where a descent stands.
#[derive(Clone, Debug)]
struct Descent<'a> {
    form: Form,
    pieces: &'a [Piece],
    parts: Parts,
    inner: Vec<Sought>,
    coefficients: Vec<f64>,
    noise: Noise,
    /// The series.
    beside: Beside,
}

/// The terms of a form by the way they enter a run.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    /// Positions of the terms that the state gives.
    pub(super) of_state: Vec<usize>,
    /// Positions of the series.
    pub(super) series: Vec<usize>,
    /// Which of the former are sought, as positions among them.
    pub(super) free: Vec<usize>,
    /// Positions of all that is sought, in the order of a run's unknowns.
    pub(super) unknowns: Vec<usize>,
}

impl Parts {
    pub(super) fn of(form: &Form) -> Parts {
        let (series, of_state): (Vec<usize>, Vec<usize>) =
            (0..form.terms.len()).partition(|index| is_series(form.terms[*index]));
        let sought = |index: &usize| form.held[*index].is_none();
        let free: Vec<usize> = (0..of_state.len()).filter(|position| sought(&of_state[*position])).collect();
        let unknowns = free.iter().map(|position| of_state[*position]).chain(series.iter().copied()).collect();
        Parts { of_state, series, free, unknowns }
    }
}

/// Fits the form to the pieces; none where nothing can be made of them: no motion, or coefficients that no row determines.
///
/// The likelihood has another maximum where the inertia grows without bounds: the excitation is forgotten, and process noise drives the
/// motion. A descent that runs there begins again from the next guess.
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

/// Fits the form from coefficients and noise that are near already. The likelihood may have two maxima, one that leaves error to the law
/// and one that leaves it all to the sensors: both are tried.
pub fn refit(form: &Form, pieces: &[Piece], coefficients: &[f64], noise: Noise) -> Option<Fit> {
    let parts = Parts::of(form);
    let mut pass = Pass::new(parts.free.len());
    let inner = inner_slopes::sought(form);
    let beside = Beside::none(form, &parts, &inner, pieces);
    let mut descent =
        Descent { form: form.clone(), pieces, parts, inner, coefficients: coefficients.to_vec(), noise, beside };
    descent.renew_series(&mut pass);
    let mut loud = descent.descend(&mut pass)?;
    if loud.noise.process <= start::negligible(&loud.noise) {
        loud.log_likelihood_if_right = loud.log_likelihood;
        return Some(loud);
    }
    loud.log_likelihood_if_right = descent.quieten(&mut pass, loud.log_likelihood);
    if loud.log_likelihood_if_right <= loud.log_likelihood {
        return Some(loud);
    }
    let quiet = descent.descend(&mut pass).filter(|quiet| quiet.log_likelihood > loud.log_likelihood);
    let quiet = quiet.map(|quiet| Fit { log_likelihood_if_right: loud.log_likelihood_if_right, ..quiet });
    Some(quiet.unwrap_or(loud))
}

impl Descent<'_> {
    /// Passes until coefficients and noise stay; leaves them where they are best.
    fn descend(&mut self, pass: &mut Pass) -> Option<Fit> {
        let mut best: Option<Fit> = None;
        let mut calm = 0;
        for _ in 0..PASSES {
            let outcomes = self.run(pass);
            if outcomes.iter().any(|outcome| !outcome.finite) {
                self.noise.process *= 100.0;
                let last = best.as_ref()?;
                self.coefficients.clone_from(&last.coefficients);
                self.form.clone_from(&last.form);
                self.beside.set(&last.beginnings);
                calm = 0;
                continue;
            }
            let mut sums = total(&outcomes);
            let log_likelihood = self.log_likelihood(&outcomes, &sums);
            self.beside.add_prior(&mut sums);
            let solved = solve(&sums.information, &sums.score)?;
            let decrement = solved.step.dot(&sums.score) / solved.step.len().max(1) as f64;
            let followed = self.is_followed(best.as_ref(), log_likelihood);
            let present = self.summary(log_likelihood, solved.covariance, sums.count);
            if best.as_ref().is_none_or(|best| present.log_likelihood >= best.log_likelihood) {
                best = Some(present);
            }
            let steady = move_noise(&mut self.noise, &outcomes, start::largest(self.pieces)) && followed;
            calm = if steady && decrement < SETTLED.max(1e-9 * sums.count) { calm + 1 } else { 0 };
            if calm >= 2 {
                break;
            }
            self.take(&solved.step);
            self.follow(&outcomes, pass);
        }
        let mut best = best?;
        self.beside.set(&best.beginnings);
        (self.coefficients, self.noise) = (best.coefficients.clone(), best.noise);
        self.form.clone_from(&best.form);
        best.states = self.smoothed(&self.run(pass));
        Some(best)
    }

    /// Log-likelihood under no process noise, the sensors' noise taking all error, coefficients moving along.
    /// Gives up where it will not come near `loud`.
    fn quieten(&mut self, pass: &mut Pass, loud: f64) -> f64 {
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
            self.beside.add_prior(&mut sums);
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
    fn is_followed(&self, before: Option<&Fit>, log_likelihood: f64) -> bool {
        let gained = before.map_or(f64::INFINITY, |before| (log_likelihood - before.log_likelihood).abs());
        self.parts.series.is_empty() || gained < GAIN
    }

    /// Series need a motion before there is one: that of the law without them.
    fn renew_series(&mut self, pass: &mut Pass) {
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
        outcomes.iter().map(|outcome| outcome.log_likelihood).sum::<f64>() - self.beside.price(sums)
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

    /// Takes the Gauss–Newton step; the inertia becomes at most [`LARGEST_RATIO`] times larger or smaller: as it grows without bounds, the law
    /// forgets its excitation.
    fn take(&mut self, step: &DVector<f64>) {
        let inertia =
            self.form.inertia().and_then(|inertia| self.parts.unknowns.iter().position(|index| *index == inertia));
        let fraction = inertia.map_or(1.0, |row| {
            let (old, change) = (self.coefficients[self.parts.unknowns[row]], step[row]);
            let relative = change / old;
            let bounded = relative.clamp(LARGEST_RATIO.recip() - 1.0, LARGEST_RATIO - 1.0);
            if relative == bounded { 1.0 } else { bounded / relative }
        });
        for (index, change) in self.parts.unknowns.iter().zip(step.iter()) {
            self.coefficients[*index] += fraction * change;
        }
        let inner: Vec<f64> = step.iter().skip(self.parts.unknowns.len()).map(|change| fraction * change).collect();
        inner_slopes::take(&mut self.form, &self.inner, &inner);
        self.beside.take(step.as_slice(), fraction);
    }
}

fn total(outcomes: &[Outcome]) -> Sums {
    let mut sums = outcomes[0].sums[0].clone();
    outcomes[1..].iter().flat_map(|outcome| &outcome.sums).for_each(|other| sums.merge(other));
    sums
}

/// Sensor noise follows the innovations, process noise the likelihood; returns whether both stayed.
fn move_noise(noise: &mut Noise, outcomes: &[Outcome], largest: [f64; 2]) -> bool {
    let sum = |value: fn(&Outcome) -> f64| outcomes.iter().map(value).sum::<f64>();
    let squares = [sum(|outcome| outcome.squares[0]), sum(|outcome| outcome.squares[1])];
    let count = [sum(|outcome| outcome.count[0]), sum(|outcome| outcome.count[1])];
    let mut steady = true;
    for channel in 0..2 {
        let scale = if count[channel] > 0.0 { squares[channel] / count[channel] } else { 1.0 };
        let floor = (NOISE_FLOOR * largest[channel]).powi(2).max(f64::MIN_POSITIVE);
        let value = (noise.sensor[channel] * scale).max(floor);
        steady &= (value / noise.sensor[channel] - 1.0).abs() < 0.02;
        noise.sensor[channel] = value;
    }
    let present = sum(|outcome| outcome.log_likelihood);
    let [less, more] = [sum(|outcome| outcome.rivals[0]) - present, sum(|outcome| outcome.rivals[1]) - present];
    let ratio = match (less >= more, less > -GAIN, more > GAIN) {
        // where a part of it does as well, it is none: a law that explains its record is not to be approached step by step
        (true, true, _) if less < GAIN => 0.0,
        (true, true, _) => RIVALS[0],
        (false, _, true) => RIVALS[1],
        _ => 1.0,
    };
    let mean = (squares[0] + squares[1]) / (count[0] + count[1]).max(1.0);
    let process = noise.process * ratio * mean;
    // once there is less than the motion itself could show, it is none
    let negligible = process < start::negligible(noise);
    steady &= ratio == 1.0 || negligible;
    noise.process = if negligible { start::negligible(noise) } else { process };
    steady
}

/// A step and the covariance behind it.
pub(super) struct Solved {
    pub(super) step: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
}

/// Solves information · step = score, columns scaled to unit diagonal, by pseudo-inverse. None where a run left no numbers: the singular
/// value decomposition of those would not end.
pub(super) fn solve(information: &DMatrix<f64>, score: &DVector<f64>) -> Option<Solved> {
    let n = score.len();
    if !information.iter().chain(score.iter()).all(|value| value.is_finite()) {
        return None;
    }
    if n == 0 {
        return Some(Solved { step: DVector::zeros(0), covariance: DMatrix::zeros(0, 0) });
    }
    let scale = DVector::from_fn(n, |row, _| {
        let diagonal = information[(row, row)];
        if diagonal > 0.0 { diagonal.sqrt().recip() } else { 0.0 }
    });
    let scaled = DMatrix::from_fn(n, n, |row, column| information[(row, column)] * scale[row] * scale[column]);
    let inverse = scaled.pseudo_inverse(1e-12).ok()?;
    let covariance = DMatrix::from_fn(n, n, |row, column| inverse[(row, column)] * scale[row] * scale[column]);
    let step = &covariance * score;
    step.iter().all(|value| value.is_finite()).then_some(Solved { step, covariance })
}
