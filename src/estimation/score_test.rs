//! What the law in use lacks most: the score test of effects that it does not have, in the stream.
//!
//! Beside a run of the filter the sensitivity of the innovations to each candidate's coefficient is carried, as if it
//! were a term with coefficient 0. With M and g the information and score of the law's own terms, c, i and s those of a
//! candidate beside them, its gain in log-likelihood is ½ (s − cᵀM⁻¹g)² ÷ (i − cᵀM⁻¹c) (Rao, *Proc. Cambridge Phil.
//! Soc.* 44 (1948), 50).

use super::filter::{Channel, Innovation};
use super::information::{Information, Solution};
use super::pass::{Observation, Pass, gains};
use super::track::Track;
use crate::law::{Catalogue, Effect, Entry, Motion, State, Term};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Evidence, nats, from which an effect is named: odds of 22 000 to one after the price of the number of candidates.
const NAMED: f64 = 10.0;

/// Share of a candidate's information that must be its own: of less, rounding (1e-12 of the whole) is more than a
/// millionth.
const OWN: f64 = 1e-6;

/// Inner parameters of candidates, as parts of the largest motion: a gap that half of the motion is in …
const GAP: f64 = 0.5;
/// … a Stribeck speed that most of it exceeds …
const SPEED: f64 = 0.1;
/// … and that many ripples over the way. The test is for what a law lacks, the diagnosis refines them.
const RIPPLES: f64 = 2.0;

/// The effect that a law lacks most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Missing {
    /// Its place in [`Catalogue::ENTRIES`].
    pub entry: usize,
    /// Log-likelihood that it would gain, less the logarithm of the number of candidates, nats.
    pub evidence: f64,
}

impl Missing {
    /// Of an effect of the catalogue.
    pub fn of(term: Term, evidence: f64) -> Option<Missing> {
        let entry = Catalogue::ENTRIES.iter().position(|entry| is_same(entry.term, term))?;
        Some(Missing { entry, evidence })
    }

    /// Whether it explains enough to be named.
    pub fn is_named(&self) -> bool {
        self.evidence > NAMED
    }

    /// The effect.
    pub fn effect(&self) -> &'static Entry {
        &Catalogue::ENTRIES[self.entry]
    }
}

/// An effect that the law lacks as it was tested.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lacked {
    /// Which, and how much it explains.
    pub missing: Missing,
    /// It, with inner parameters.
    pub term: Term,
    /// Its coefficient.
    pub coefficient: f64,
}

/// When F acted, by the motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lag {
    /// By how many samples F acted later than it is taken to.
    pub samples: f64,
    /// Std of that; infinite where the motion says nothing.
    pub std: f64,
    /// Log-likelihood that it gains over none, nats.
    pub evidence: f64,
}

impl Lag {
    /// Nothing is said.
    pub const UNKNOWN: Lag = Lag { samples: 0.0, std: f64::INFINITY, evidence: 0.0 };

    /// What a record of Gaussian scatter says.
    pub fn of(samples: f64, std: f64) -> Lag {
        Lag { samples, std, evidence: 0.5 * (samples / std).powi(2) }
    }

    /// What it says where whatever is assumed is known to that std only.
    pub fn blurred(&self, std: f64) -> Lag {
        let variance = self.std * self.std + std * std;
        let share = if self.std.is_finite() { self.std * self.std / variance } else { 1.0 };
        Lag { std: variance.sqrt(), evidence: share * self.evidence, ..*self }
    }

    /// Log-likelihood that a lag of so many samples gains over none, nats.
    pub fn evidence_of(&self, samples: f64) -> f64 {
        self.evidence - 0.5 * ((self.samples - samples) / self.std).powi(2)
    }
}

/// What a run says of when F acted, and how well it explains its record with its coefficients at the maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// The lag, against none in the same run.
    pub lag: Lag,
    /// Log-likelihood without a lag, nats.
    pub without: f64,
}

impl Told {
    /// Log-likelihood with the lag, nats.
    pub fn with(&self) -> f64 {
        self.without + self.lag.evidence
    }
}

/// The candidates beside a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScoreTest {
    candidates: Vec<Candidate>,
    own: Own,
    /// Whether they have gone with the run from its beginning: what speaks for another law of late is no effect.
    whole: bool,
    before: State,
    /// The excitation for which the candidates' forces there are known.
    excitation: f64,
}

/// When F acted, beside a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LagTest {
    /// F as it was a sample before and as it is a sample later, each less what it is: their coefficients are F's lag,
    /// and by how much it acts too early.
    lags: [Sums; 2],
    own: Own,
}

/// What a run says of the law's own terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Own {
    solution: Solution,
    active: Vec<bool>,
    score: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Candidate {
    entry: usize,
    term: Term,
    /// Its force at the last sample.
    force: f64,
    sums: Sums,
}

/// What the innovations say of one more coefficient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Sums {
    /// ∂(q, q̇)/∂ its coefficient.
    pub(super) sensitivity: [f64; 2],
    /// Its expected measurement by channel.
    rows: [f64; 2],
    pub(super) information: f64,
    pub(super) score: f64,
    /// With each free term of the law.
    pub(super) cross: Vec<f64>,
}

impl ScoreTest {
    /// The catalogue's effects that one instant gives and that the law of these terms does not have, beside `n` free
    /// terms.
    pub fn new(terms: &[Term], n: usize) -> ScoreTest {
        let absent = |term: &Term| !terms.iter().any(|other| is_same(*other, *term));
        let entries = Catalogue::ENTRIES.iter().enumerate();
        let candidates = entries.filter(|(_, entry)| entry.term.is_pointwise() && absent(&entry.term));
        let candidate = |(entry, found): (usize, &crate::law::Entry)| Candidate {
            entry,
            term: found.term,
            force: 0.0,
            sums: Sums::new(n),
        };
        let candidates = candidates.map(candidate).collect();
        ScoreTest { candidates, own: Own::new(n), whole: false, before: State::default(), excitation: f64::NAN }
    }

    /// Begins beside a run; inner parameters follow the largest motion seen, once there is one.
    pub fn begin(&mut self, state: State, largest: [f64; 2]) {
        for candidate in &mut self.candidates {
            candidate.sums.clear();
            if largest.iter().all(|largest| *largest > 0.0) {
                candidate.term = scaled(candidate.term, largest);
            }
        }
        (self.whole, self.before, self.excitation) = (true, state, f64::NAN);
    }

    /// The run goes without them.
    pub fn end(&mut self) {
        self.whole = false;
    }

    /// Takes the sample that the run has just taken, under the law `motion`.
    pub fn step(
        &mut self,
        motion: &Motion,
        pass: &Pass,
        observation: &Observation,
        innovations: &[Option<Innovation>; 2],
    ) {
        if !self.whole {
            return;
        }
        let (before, state) = (self.before, pass.filter.state());
        let (inverse_mass, gains) = (motion.mass(state.q).recip(), gains(innovations));
        let acceleration = (state.qd - before.qd) / observation.dt;
        let [from, _, to] = observation.drive.part(0, 1);
        let known = self.excitation == from;
        for Candidate { term, force, sums, .. } in &mut self.candidates {
            let first = if known { *force } else { term.force(before.q, before.qd, from) };
            *force = term.force(state.q, state.qd, to);
            let pushed = -(0.5 * (first + *force) + term.mass(state.q) * acceleration) * inverse_mass;
            sums.carry(pass, pushed, &gains);
        }
        (self.before, self.excitation) = (state, to);
        self.candidates.iter_mut().for_each(|candidate| candidate.sums.take(pass, innovations));
    }

    /// The coefficients have become those plus `step`, under which the state at the last sample is this.
    pub fn shift(&mut self, step: &[f64], state: State) {
        (self.before, self.excitation) = (state, f64::NAN);
        self.candidates.iter_mut().for_each(|candidate| candidate.sums.shift(step));
    }

    /// The candidate with the most evidence beside the law's own terms, of which `own` is what the run says,
    /// `overdispersion` being what the law's lasting error makes of a nat; one with a sign that physics does not allow
    /// has none; none where they have not gone with the whole run.
    pub fn likeliest(&mut self, own: &Information, active: &[bool], overdispersion: f64) -> Option<Lacked> {
        if !self.whole {
            return None;
        }
        self.own.solve(own, active);
        let price = (self.candidates.len().max(1) as f64).ln();
        let lacked = |candidate: &Candidate| {
            let (entry, term) = (candidate.entry, candidate.term);
            let (coefficient, gain, _) = candidate.sums.gain(&self.own);
            let allowed = Catalogue::ENTRIES[entry].sign.allows(coefficient);
            let evidence = if allowed { gain / overdispersion.max(1.0) - price } else { 0.0 };
            Lacked { missing: Missing { entry, evidence }, term, coefficient }
        };
        self.candidates.iter().map(lacked).max_by(|a, b| a.missing.evidence.total_cmp(&b.missing.evidence))
    }

    /// By how much the law's own coefficients, n, are others beside that effect, as it was found last.
    pub fn moved(&self, lacked: Option<&Lacked>, step: &mut [f64]) {
        step.fill(0.0);
        let Some(Lacked { missing, coefficient, .. }) = lacked else { return };
        for candidate in self.candidates.iter().filter(|candidate| candidate.entry == missing.entry) {
            self.own.determined().for_each(|row| step[row] = -coefficient * candidate.sums.shared(row, &self.own));
        }
    }
}

impl LagTest {
    /// Beside `n` free terms.
    pub fn new(n: usize) -> LagTest {
        LagTest { lags: [Sums::new(n), Sums::new(n)], own: Own::new(n) }
    }

    /// Begins beside a run.
    pub fn begin(&mut self) {
        self.lags.iter_mut().for_each(Sums::clear);
    }

    /// Takes the sample that the run has just taken, under the law `motion`; `shifts` is what F was a sample before and
    /// will be a sample later, less what it is.
    pub fn step(&mut self, motion: &Motion, pass: &Pass, shifts: [f64; 2], innovations: &[Option<Innovation>; 2]) {
        let inverse_mass = motion.mass(pass.filter.mean[0]).recip();
        let gains = gains(innovations);
        for (sums, shift) in self.lags.iter_mut().zip(shifts) {
            sums.carry(pass, shift * inverse_mass, &gains);
            sums.take(pass, innovations);
        }
    }

    /// The coefficients have become those plus `step`.
    pub fn shift(&mut self, step: &[f64]) {
        self.lags.iter_mut().for_each(|sums| sums.shift(step));
    }

    /// When F acted against when it is taken to have, by a run of that track which says `own` of the law's terms;
    /// `slope` becomes what a lag of one sample makes of the free coefficients, n.
    pub fn told(
        &mut self,
        own: &Information,
        active: &[bool],
        track: &Track,
        overdispersion: f64,
        slope: &mut [f64],
    ) -> Told {
        self.own.solve(own, active);
        let track = track.no_quieter();
        let solved = self.lags.each_ref().map(|sums| sums.gain(&self.own));
        let (place, sign) = if solved[0].1 >= solved[1].1 { (0, 1.0) } else { (1, -1.0) };
        let (samples, gain, information) = solved[place];
        for (row, slope) in slope.iter_mut().enumerate() {
            *slope = if active[row] { -sign * self.lags[place].shared(row, &self.own) } else { 0.0 };
        }
        // what the coefficients' step and the lag take off the squares, from which the noise is known
        let step = self.own.gain();
        let squares = (track.squares[0] + track.squares[1]).max(f64::MIN_POSITIVE);
        let left = |gain: f64| (1.0 - 2.0 * gain / squares).max(f64::MIN_POSITIVE);
        let gained = |gain: f64| -0.5 * track.total() * left(gain).ln();
        let overdispersion = overdispersion.max(1.0);
        let variance = overdispersion * left(step + gain) * squares / (track.total() * information);
        let evidence = (gained(step + gain) - gained(step)) / overdispersion;
        let lag = Lag { samples: sign * samples, std: variance.sqrt(), evidence };
        let lag = if information > 0.0 { lag } else { Lag::UNKNOWN };
        Told { lag, without: track.log_likelihood() + gained(step) }
    }
}

impl Own {
    fn new(n: usize) -> Own {
        Own { solution: Solution::none(n), active: vec![true; n], score: vec![0.0; n] }
    }

    fn solve(&mut self, own: &Information, active: &[bool]) {
        self.active.copy_from_slice(active);
        self.score.copy_from_slice(&own.score);
        self.solution.solve(own, active);
    }

    /// Log-likelihood that the law's own terms gain at the maximum, nats.
    fn gain(&self) -> f64 {
        0.5 * self.determined().map(|row| self.solution.step[row] * self.score[row]).sum::<f64>()
    }

    /// The terms that the law has and its record determines.
    fn determined(&self) -> impl Iterator<Item = usize> {
        (0..self.active.len()).filter(|index| self.active[*index] && self.solution.determined[*index])
    }
}

impl Sums {
    pub(super) fn new(n: usize) -> Sums {
        Sums { sensitivity: [0.0; 2], rows: [0.0; 2], information: 0.0, score: 0.0, cross: vec![0.0; n] }
    }

    pub(super) fn clear(&mut self) {
        (self.sensitivity, self.information, self.score) = ([0.0; 2], 0.0, 0.0);
        self.cross.fill(0.0);
    }

    /// Copies the other's into this room.
    pub(super) fn copy_from(&mut self, other: &Sums) {
        (self.sensitivity, self.rows) = (other.sensitivity, other.rows);
        (self.information, self.score) = (other.information, other.score);
        self.cross.copy_from_slice(&other.cross);
    }

    /// The law's own coefficients have become those plus `step`.
    pub(super) fn shift(&mut self, step: &[f64]) {
        let moved: f64 = self.cross.iter().zip(step).map(|(cross, step)| cross * step).sum();
        self.score -= moved;
    }

    /// Goes with the run over an interval in which a coefficient of 1 accelerates by `push`.
    pub(super) fn carry(&mut self, pass: &Pass, push: f64, gains: &[[f64; 2]; 2]) {
        (self.rows, self.sensitivity) = pass.carry(self.sensitivity, push, gains);
    }

    /// Takes the innovations of a sample of the run.
    pub(super) fn take(&mut self, pass: &Pass, innovations: &[Option<Innovation>; 2]) {
        let [precision, residual] = [
            innovations.map(|innovation| innovation.map_or(0.0, |innovation| innovation.precision)),
            innovations.map(|innovation| innovation.map_or(0.0, |innovation| innovation.residual)),
        ];
        let [q, qd] = [0, 1].map(|channel| self.rows[channel] * precision[channel]);
        self.information += q * self.rows[0] + qd * self.rows[1];
        self.score += q * residual[0] + qd * residual[1];
        let own = pass.expected(Channel::Q).iter().zip(pass.expected(Channel::Qd));
        self.cross.iter_mut().zip(own).for_each(|(sum, own)| *sum += q * own.0 + qd * own.1);
    }

    /// (coefficient, gain in log-likelihood, information of its own) beside the law's own terms.
    fn gain(&self, own: &Own) -> (f64, f64, f64) {
        let (mut information, mut score) = (self.information, self.score);
        for row in own.determined() {
            let shared = self.shared(row, own);
            information -= self.cross[row] * shared;
            score -= shared * own.score[row];
        }
        match information > OWN * self.information {
            true => (score / information, 0.5 * score * score / information, information),
            false => (0.0, 0.0, 0.0),
        }
    }

    /// Row of M⁻¹c: how much of the coefficient is one of the law's own.
    fn shared(&self, row: usize, own: &Own) -> f64 {
        let n = self.cross.len();
        own.determined().map(|column| own.solution.covariance[row * n + column] * self.cross[column]).sum()
    }
}

/// The acceleration over the run's last interval, from the state `before` it, that a coefficient of 1 of the term is.
pub(super) fn push(term: Term, motion: &Motion, before: State, pass: &Pass, observation: &Observation) -> f64 {
    let state = pass.filter.state();
    let acceleration = (state.qd - before.qd) / observation.dt;
    let [from, _, to] = observation.drive.part(0, 1);
    let force = 0.5 * (term.force(before.q, before.qd, from) + term.force(state.q, state.qd, to));
    -(force + term.mass(state.q) * acceleration) / motion.mass(state.q)
}

/// Whether both are the same effect, whatever their inner parameters.
fn is_same(one: Term, other: Term) -> bool {
    match (one.effect(), other.effect()) {
        (Some(one), Some(other)) => one.id() == other.id(),
        _ => one == other,
    }
}

/// The term with inner parameters that suit a motion of this size.
fn scaled(term: Term, largest: [f64; 2]) -> Term {
    let Term::Effect(effect) = term else { return term };
    let [q, qd] = largest;
    let moved = match effect {
        Effect::DeadZoneStiffness { .. } | Effect::OneSidedStop { .. } => effect.with_inner(&[GAP * q]),
        Effect::StribeckFriction { .. } => effect.with_inner(&[SPEED * qd]),
        Effect::Cogging { .. } => effect.with_inner(&[RIPPLES * PI / q, 0.0]),
        _ => Ok(effect),
    };
    Term::Effect(moved.unwrap_or(effect))
}
