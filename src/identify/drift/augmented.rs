//! Coefficients that drift away from a law which explained its record.
//!
//! After an alarm two stories are told of the record from a while before it: the law switched at the instant that the
//! evidence found, and the coefficients wander, a random walk of one of several intensities. Each is a filter of the
//! state and the coefficients together ([`AugmentedFilter`]), so that each has a likelihood: that of the record,
//! whatever it predicts. A switch makes slow wandering improbable at once, for the jump is nowhere near what a walk
//! does between two samples; a drift makes any constant law improbable a period or two later. A walk fast enough to
//! look like a switch speaks for one.
//!
//! When slow wandering has won, its filters go on with the stream: their mean by weight is the law, their covariance
//! its std. A filter whose coefficients have ceased to wander is begun again and again from the likeliest of them,
//! until for some periods it loses nothing: the coefficients rest. So are filters whose coefficients switch, each at
//! another sample, until one explains more than chance does: the law has switched while it wandered.

use crate::estimation::{
    AugmentedFilter, Channel, InnovationGate, KnownEffect, Noise, Observation, Start, Unknowns, log_sum,
};
use crate::evidence::SWITCH_SIZE;
use crate::identify::problem::Problem;
use crate::identify::window::Window;
use crate::law::Term;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Std of the wandering over a natural period relative to the reach, of the coefficients and of the inertia. The last
/// is too fast for a drift; with a slower one than the first, 0.3 %, std came out too small (docs/decisions/drift.md).
const INTENSITIES: [[f64; 2]; 5] = [[0.01, 0.0], [0.03, 0.0], [0.01, 0.01], [0.03, 0.03], [0.1, 0.1]];

/// How many of them are a drift.
const SLOW: usize = 4;

/// Place of the filter whose coefficients are constant: throughout a trial, or since they may have come to rest.
const CONSTANT: usize = 5;

/// Place of the first filter whose coefficients switch once, at one of several samples.
const SWITCHED: usize = 6;

/// How many of them there are: with three 9 of 432 switches were missed, with five 5 (docs/decisions/drift.md).
pub const INSTANTS: usize = 5;

/// Filters.
const RIVALS: usize = SWITCHED + INSTANTS;

/// A switch comes somewhere within an interval: over it the coefficients are others than before, and than after, by
/// these parts of a switch's std, ½ and √¾, whose squares make up the whole. At steps of 50 ms one at the interval's
/// beginning lost 25 nats to a drift (docs/decisions/drift.md).
const WITHIN: [f64; 2] = [0.5, 0.866];

/// Samples that every filter takes in a step, until all are taken: 11 filters of 4 samples bound the step's work.
const BUDGET: usize = 4;

/// A switch within a drift is looked for from this part of a natural period on to the next.
const BETWEEN: f64 = 0.125;

/// What decides a trial, nats (odds of 160 000 to one) …
const DECIDED: f64 = 12.0;

/// … that has lasted this many natural periods.
const LASTING: f64 = 0.25;

/// For how many natural periods a trial goes on: as long as a switch explains the record as well, and at most. With
/// sixteen the next switch came within the trial (docs/decisions/drift.md).
const PATIENCE: [f64; 2] = [3.0, 6.0];

/// For how many natural periods what a walk predicted counts in its weight: longer than [`REST`], so that a rest is not
/// forgotten before it is told.
const MEMORY: f64 = 4.0;

/// Log-likelihood by which coefficients that wander are told from ones that rest, nats: odds of 150 to one.
const WANDERED: f64 = 5.0;

/// Coefficients that may have been at rest for this many natural periods are; a constant law that has explained as many
/// is the law. Without a least length ramps of four periods were never said (docs/decisions/drift.md).
const REST: f64 = 2.0;

/// How far the trial of a drift, or its following, has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Course {
    Idle,
    Trial,
    Following,
}

/// What a trial stands on.
#[derive(Clone, Copy, Debug)]
pub struct Before<'a> {
    /// Terms of the law before.
    pub terms: &'a [Term],
    /// All coefficients of it.
    pub all: &'a [f64],
    /// Value of each free coefficient at which its force moves the acceleration by as much as the law's own forces do;
    /// 0 where the law does not have it.
    pub reach: &'a [f64],
    /// Noise under that law.
    pub noise: Noise,
    /// Parts into which its filter cuts an interval.
    pub parts: usize,
    /// Its natural period, samples.
    pub period: f64,
    /// Samples at which the law may have switched, in their order.
    pub switch: [u64; INSTANTS],
    /// The sample to begin with.
    pub start: u64,
}

/// Filters that tell a drift from a switch, and follow it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AugmentedDrift {
    course: Course,
    terms: Vec<Term>,
    /// Places of the free coefficients and of the effect that the model lacks, n + 1, and their terms.
    free: Vec<usize>,
    free_terms: Vec<Term>,
    rivals: Vec<AugmentedFilter>,
    sound: Vec<bool>,
    weights: Vec<f64>,
    reach: Vec<f64>,
    noise: Noise,
    parts: usize,
    period: f64,
    switch: [u64; INSTANTS],
    /// Logarithm of what the slow walks together predicted, and by how much each filter that switched was ahead of that
    /// when it did.
    predicted: f64,
    ahead: [f64; INSTANTS],
    /// As which walk each filter wanders.
    walk: [usize; RIVALS],
    gate: InnovationGate,
    next: u64,
    /// Since which sample the trial speaks for a drift.
    leading_since: Option<u64>,
    /// What wandering had lost when the law may first have switched, nats: coefficients that began to then had not.
    spent: f64,
    /// Since which sample the coefficients may be constant, and the walk that this was begun from.
    rest: (u64, usize),
    coefficients: Vec<f64>,
    variances: Vec<f64>,
}

impl AugmentedDrift {
    /// Nothing is on trial.
    pub fn new(problem: &Problem) -> AugmentedDrift {
        let n = problem.n() + 1;
        let terms = problem.terms_and_effect();
        let free: Vec<usize> = problem.free.iter().copied().chain([problem.terms.len()]).collect();
        AugmentedDrift {
            course: Course::Idle,
            free_terms: free.iter().map(|place| terms[*place]).collect(),
            terms,
            free,
            rivals: vec![AugmentedFilter::new(problem.known.len(), n); RIVALS],
            sound: vec![true; RIVALS],
            weights: vec![0.0; INTENSITIES.len()],
            reach: vec![0.0; n],
            noise: Noise { sensor: [1.0; 2], process: 1.0 },
            parts: 1,
            period: 1.0,
            switch: [0; INSTANTS],
            predicted: 0.0,
            ahead: [0.0; INSTANTS],
            walk: [0; RIVALS],
            gate: InnovationGate::default(),
            next: 0,
            leading_since: None,
            spent: 0.0,
            rest: (0, 0),
            coefficients: vec![0.0; problem.n()],
            variances: vec![0.0; problem.n()],
        }
    }

    /// Whether a drift is on trial.
    pub fn is_on_trial(&self) -> bool {
        self.course == Course::Trial
    }

    /// Whether a drift is followed.
    pub fn is_following(&self) -> bool {
        self.course == Course::Following
    }

    /// Ends trial and following.
    pub fn end(&mut self) {
        self.course = Course::Idle;
    }

    /// A constant law has explained this many samples: where they are many, no drift is on trial any more.
    pub fn end_trial(&mut self, samples: u64) {
        if self.is_on_trial() && samples as f64 > REST * self.period {
            self.end();
        }
    }

    /// Puts a drift on trial against a switch.
    pub fn begin(&mut self, problem: &Problem, window: &Window, before: &Before) {
        let effect = problem.n();
        self.terms.copy_from_slice(before.terms);
        self.free_terms[effect] = self.terms[problem.terms.len()];
        self.reach[..effect].copy_from_slice(before.reach);
        if let Some(index) = problem.free_inertia() {
            self.reach[index] = before.all[problem.inertia];
        }
        // what the law was said to lack may have been the drift that began: it may be nothing
        self.reach[effect] = before.all[problem.terms.len()].abs() / SWITCH_SIZE;
        let unknowns = unknowns(problem, &self.terms, &self.free, &self.free_terms);
        let first = window.initial_state(before.start, &before.noise);
        let start = Start { all: before.all, reach: &self.reach, width: SWITCH_SIZE, first };
        self.rivals.iter_mut().for_each(|rival| rival.begin(&unknowns, &start));
        self.sound.fill(true);
        self.weights.fill(0.0);
        self.walk = std::array::from_fn(|index| if index < CONSTANT { index } else { RIVALS });
        (self.noise, self.parts, self.period) = (before.noise, before.parts, before.period);
        (self.switch, self.next, self.predicted) = (before.switch, before.start + 1, 0.0);
        (self.course, self.leading_since, self.gate) = (Course::Trial, None, InnovationGate::default());
        self.spent = 0.0;
    }

    /// Takes what is new in the window, a bounded number of samples; returns whether the law is new.
    pub fn step(&mut self, problem: &Problem, window: &Window) -> bool {
        if self.course == Course::Idle {
            return false;
        }
        if self.next <= window.oldest() {
            self.end();
        }
        let stop = window.ready().min(self.next + BUDGET as u64);
        while self.course != Course::Idle && self.next < stop {
            let observation = window.observation(self.next);
            let turned = TAU * observation.dt / (self.period * window.pace());
            self.take(problem, &observation, observation.is_lost(turned));
            self.next += 1;
            match self.course {
                Course::Trial => self.decide(),
                _ => {
                    self.look_for_rest();
                    self.look_for_switch();
                }
            }
        }
        if self.course != Course::Idle {
            self.mix(problem);
        }
        self.course != Course::Idle
    }

    /// Every filter takes a sample, which may be one after an outage in which the motion was lost; those that have left
    /// what can be computed fall out.
    fn take(&mut self, problem: &Problem, observation: &Observation, lost: bool) {
        let unknowns = unknowns(problem, &self.terms, &self.free, &self.free_terms);
        let switched = self.rivals[SWITCHED..].iter_mut().zip(&self.switch);
        for (rival, instant) in switched {
            let part = self.next.checked_sub(*instant).and_then(|since| WITHIN.get(since as usize));
            part.into_iter().for_each(|part| rival.wander(&unknowns, &self.reach, [part * SWITCH_SIZE; 2]));
        }
        let before: [f64; SLOW + 1] = std::array::from_fn(|index| self.rivals[index].log_likelihood);
        for (index, rival) in self.rivals.iter_mut().enumerate().filter(|(index, _)| self.sound[*index]) {
            if let Some(intensity) = INTENSITIES.get(self.walk[index]) {
                rival.wander(&unknowns, &self.reach, intensity.map(|std| std / self.period.sqrt()));
            }
            match lost {
                true => rival.resume(&self.noise, observation),
                false => rival.advance(&unknowns, self.noise.process, self.parts, observation),
            }
        }
        for channel in Channel::ALL.into_iter().filter(|_| !lost) {
            let Some(measured) = observation.measured[channel as usize] else { continue };
            let variance = self.noise.sensor[channel as usize];
            let (residual, total) = self.rivals[SLOW - 1].residual(channel, measured, variance);
            if !self.gate.admits(channel, residual, total) {
                continue;
            }
            let sound = self.rivals.iter_mut().zip(&self.sound).filter(|(_, sound)| **sound);
            sound.for_each(|(rival, _)| rival.update(channel, measured, variance));
        }
        for (rival, sound) in self.rivals.iter().zip(&mut self.sound) {
            *sound &= rival.is_sound(&unknowns);
        }
        self.weigh(before);
    }

    /// Weights of the walks, as logarithms: what they predicted, with a memory.
    fn weigh(&mut self, before: [f64; SLOW + 1]) {
        let kept = 1.0 - (MEMORY * self.period).recip();
        let (mut slow, mut slow_with) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for (index, weight) in self.weights.iter_mut().enumerate() {
            let gain = self.rivals[index].log_likelihood - before[index];
            *weight = if self.sound[index] { *weight * kept } else { f64::NEG_INFINITY };
            let before = *weight;
            *weight += gain;
            // one as fast as a jump explains a switch, but is no drift
            if index < SLOW {
                (slow, slow_with) = (log_sum(slow, before), log_sum(slow_with, *weight));
            }
        }
        self.predicted += slow_with - slow;
        let largest = self.weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        match largest.is_finite() {
            true => self.weights.iter_mut().for_each(|weight| *weight -= largest),
            false => self.end(),
        }
    }

    fn log_likelihood(&self, index: usize) -> f64 {
        if self.sound[index] { self.rivals[index].log_likelihood } else { f64::NEG_INFINITY }
    }

    /// Log-likelihood ratio of slow wandering to the likeliest of its rivals, nats.
    fn lead(&self) -> f64 {
        let largest = (0..SLOW).map(|index| self.log_likelihood(index)).fold(f64::NEG_INFINITY, f64::max);
        let rival = (SLOW..RIVALS).map(|index| self.log_likelihood(index)).fold(f64::NEG_INFINITY, f64::max);
        largest - (SLOW as f64).ln() - rival - self.spent
    }

    /// What speaks for a drift that is on trial, nats; none where none is.
    pub fn evidence(&self) -> Option<f64> {
        self.is_on_trial().then(|| self.lead())
    }

    /// Ends a trial that is lost, or that has gone on for too long.
    fn decide(&mut self) {
        if self.next == self.switch[0] {
            self.spent = self.lead().min(0.0);
        }
        let lead = self.lead();
        self.leading_since = if lead > DECIDED { self.leading_since.or(Some(self.next)) } else { None };
        let patience = PATIENCE[usize::from(lead > 0.0)] * self.period;
        let late = self.next as f64 > self.switch[INSTANTS - 1] as f64 + patience;
        if self.next > self.switch[INSTANTS - 1] && (lead < -DECIDED || lead.is_nan() || late) {
            self.end();
        }
    }

    /// Whether the trial has found a drift.
    pub fn found_drift(&self) -> bool {
        let lasting = LASTING * self.period;
        let led = self.leading_since.is_some_and(|since| self.next as f64 > since as f64 + lasting);
        self.is_on_trial() && led && self.next as f64 > self.switch[INSTANTS - 1] as f64 + lasting
    }

    /// Follows the drift from now on.
    pub fn follow(&mut self) {
        self.course = Course::Following;
        self.begin_rest();
        (0..INSTANTS).for_each(|slot| self.begin_switch(slot));
    }

    /// The coefficients may switch at the next sample, from those of the likeliest walk, and wander on as it does.
    fn begin_switch(&mut self, slot: usize) {
        let likeliest = self.likeliest();
        let (walks, others) = self.rivals.split_at_mut(SWITCHED);
        others[slot].copy_from(&walks[likeliest]);
        self.sound[SWITCHED + slot] = true;
        (self.switch[slot], self.walk[SWITCHED + slot]) = (self.next, likeliest);
        self.ahead[slot] = others[slot].log_likelihood - self.predicted;
    }

    /// Evidence that the law has switched as that filter does, against all that it may have done else, nats.
    fn switch_evidence(&self, slot: usize) -> f64 {
        self.log_likelihood(SWITCHED + slot) - self.predicted - self.ahead[slot]
    }

    /// The filter that has switched and explains most.
    fn likeliest_switch(&self) -> usize {
        let evidence = |slot: &usize| self.switch_evidence(*slot);
        (0..INSTANTS).max_by(|a, b| evidence(a).total_cmp(&evidence(b))).unwrap_or(0)
    }

    /// Where it is time for another, the filter that has switched and explains least begins anew.
    fn look_for_switch(&mut self) {
        let last = self.switch.iter().copied().max().unwrap_or(0);
        if (self.next - last) as f64 > BETWEEN * self.period {
            let evidence = |slot: &usize| self.switch_evidence(*slot);
            let least = (0..INSTANTS).min_by(|a, b| evidence(a).total_cmp(&evidence(b)));
            least.into_iter().for_each(|slot| self.begin_switch(slot));
        }
    }

    /// The sample at which the law has switched while it is followed, by evidence above that level, nats.
    pub fn switched_since(&self, level: f64) -> Option<u64> {
        let slot = self.likeliest_switch();
        (self.is_following() && self.switch_evidence(slot) > level).then_some(self.switch[slot])
    }

    /// The law since then: `free` become its free coefficients, n; returns the effect that it has beside them.
    pub fn switched_law(&self, problem: &Problem, free: &mut [f64]) -> Option<KnownEffect> {
        self.law(problem, SWITCHED + self.likeliest_switch(), free)
    }

    fn law(&self, problem: &Problem, rival: usize, free: &mut [f64]) -> Option<KnownEffect> {
        let unknowns = unknowns(problem, &self.terms, &self.free, &self.free_terms);
        let coefficient = |index: usize| self.rivals[rival].coefficient(&unknowns, index).0;
        free.iter_mut().enumerate().for_each(|(index, value)| *value = coefficient(index));
        let effect = coefficient(free.len());
        let term = self.free_terms[free.len()];
        (effect != 0.0).then_some(KnownEffect { term, coefficient: effect, precision: 0.0 })
    }

    fn likeliest(&self) -> usize {
        (0..INTENSITIES.len()).max_by(|a, b| self.weights[*a].total_cmp(&self.weights[*b])).unwrap_or(0)
    }

    fn begin_rest(&mut self) {
        self.rest = (self.next, self.likeliest());
        let (walks, others) = self.rivals.split_at_mut(CONSTANT);
        others[0].copy_from(&walks[self.rest.1]);
        self.sound[CONSTANT] = true;
    }

    /// Log-likelihood ratio of coefficients that have been constant for a while to ones that wander, nats.
    fn quiet(&self) -> f64 {
        self.log_likelihood(CONSTANT) - self.log_likelihood(self.rest.1)
    }

    fn look_for_rest(&mut self) {
        let quiet = self.quiet();
        if quiet.is_nan() || quiet < -WANDERED || !self.sound[CONSTANT] {
            self.begin_rest();
        }
    }

    /// The sample since which the coefficients have been at rest, if they are.
    pub fn rests_since(&self) -> Option<u64> {
        let long = (self.next - self.rest.0) as f64 > REST * self.period;
        (self.is_following() && long && self.quiet() > 0.0).then_some(self.rest.0)
    }

    /// The law at rest: `free` become its free coefficients, n; returns the effect that it has beside them.
    pub fn resting_law(&self, problem: &Problem, free: &mut [f64]) -> Option<KnownEffect> {
        self.law(problem, CONSTANT, free)
    }

    /// Mean and variance over all walks.
    fn mix(&mut self, problem: &Problem) {
        let unknowns = unknowns(problem, &self.terms, &self.free, &self.free_terms);
        let sum: f64 = self.weights.iter().map(|weight| weight.exp()).sum();
        for free in 0..self.coefficients.len() {
            let (mut mean, mut square) = (0.0, 0.0);
            let (centre, _) = self.rivals[self.likeliest()].coefficient(&unknowns, free);
            for (rival, weight) in self.rivals.iter().zip(&self.weights).filter(|(_, weight)| weight.is_finite()) {
                let (value, variance) = rival.coefficient(&unknowns, free);
                let share = weight.exp() / sum;
                mean += share * (value - centre);
                square += share * ((value - centre).powi(2) + variance);
            }
            self.coefficients[free] = centre + mean;
            // how fast a slow drift is the record tells, not how fast what it does not tell of may be
            let (fastest, open) = self.rivals[SLOW - 1].coefficient(&unknowns, free);
            let open = if self.sound[SLOW - 1] { open + (fastest - centre - mean).powi(2) } else { 0.0 };
            self.variances[free] = (square - mean * mean).max(open);
        }
    }

    /// The free coefficient and its std.
    pub fn coefficient(&self, free: usize) -> (f64, f64) {
        (self.coefficients[free], self.variances[free].sqrt())
    }

    /// Variance that is stated for e of eq. (8), of the free coefficients.
    pub fn stated_error(&self) -> f64 {
        self.variances.iter().sum::<f64>() / self.coefficients.iter().map(|value| value * value).sum::<f64>()
    }
}

fn unknowns<'a>(problem: &'a Problem, terms: &'a [Term], free: &'a [usize], free_terms: &'a [Term]) -> Unknowns<'a> {
    Unknowns {
        terms,
        own: &problem.own,
        free,
        free_terms,
        inertia: problem.inertia,
        free_inertia: problem.free_inertia(),
    }
}
