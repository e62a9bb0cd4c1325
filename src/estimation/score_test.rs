//! What the law in use lacks most: the score test of effects that it does not have, in the stream.
//!
//! Beside a run of the filter the sensitivity of the innovations to each candidate's coefficient is carried, as if it
//! were a term with coefficient 0. With M and g the information and score of the law's own terms, c, i and s those of a
//! candidate beside them, its gain in log-likelihood is ½ (s − cᵀM⁻¹g)² ÷ (i − cᵀM⁻¹c) (Rao, *Proc. Cambridge Phil.
//! Soc.* 44 (1948), 50).

use super::filter::Innovation;
use super::one_more_coefficient::{OwnTerms, Sums};
use super::pass::{Observation, Pass, gains};
use crate::law::{Catalogue, Effect, Entry, Motion, State, Term};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Evidence, nats, from which an effect is named: odds of 22 000 to one after the price of the number of candidates.
const NAMED: f64 = 10.0;

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

/// The candidates beside a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScoreTest {
    pub(super) candidates: Vec<Candidate>,
    /// Whether they have gone with the run from its beginning: what speaks for another law of late is no effect.
    pub(super) whole: bool,
    before: State,
    /// The excitation for which the candidates' forces there are known.
    excitation: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Candidate {
    pub(super) entry: usize,
    pub(super) term: Term,
    /// Its force at the last sample.
    force: f64,
    pub(super) sums: Sums,
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
        ScoreTest { candidates, whole: false, before: State::default(), excitation: f64::NAN }
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

    /// Takes the sample that the run has just taken, under the law `motion`; `beside` is what the coefficient of the
    /// effect added to the law makes of the innovations.
    pub fn step(
        &mut self,
        motion: &Motion,
        pass: &Pass,
        observation: &Observation,
        innovations: &[Option<Innovation>; 2],
        beside: [f64; 2],
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
            sums.take(pass, pushed, &gains, innovations, beside);
        }
        (self.before, self.excitation) = (state, to);
    }

    /// The coefficients have become those plus `step`, under which the state at the last sample is this.
    pub fn shift(&mut self, step: &[f64], state: State) {
        (self.before, self.excitation) = (state, f64::NAN);
        self.candidates.iter_mut().for_each(|candidate| candidate.sums.shift(step));
    }

    /// The coefficient of the effect added to the law has become that plus `step`.
    pub fn shift_beside(&mut self, step: f64) {
        self.candidates.iter_mut().for_each(|candidate| candidate.sums.shift_beside(step));
    }

    /// The candidate with the most evidence beside the law's own terms, `overdispersion` being what the law's lasting
    /// error makes of a nat; one with a sign that physics does not allow has none; none where they have not gone with
    /// the whole run.
    pub fn likeliest(&self, own: &OwnTerms, overdispersion: f64) -> Option<Lacked> {
        if !self.whole {
            return None;
        }
        let price = (self.candidates.len().max(1) as f64).ln();
        let lacked = |candidate: &Candidate| {
            let (entry, term) = (candidate.entry, candidate.term);
            let (coefficient, gain, _) = candidate.sums.gain(own);
            let allowed = Catalogue::ENTRIES[entry].sign.allows(coefficient);
            let evidence = if allowed { gain / overdispersion.max(1.0) - price } else { 0.0 };
            Lacked { missing: Missing { entry, evidence }, term, coefficient }
        };
        self.candidates.iter().map(lacked).max_by(|a, b| a.missing.evidence.total_cmp(&b.missing.evidence))
    }

    /// By how much the law's own coefficients, n, are others beside that effect.
    pub fn moved(&self, own: &OwnTerms, lacked: &Lacked, step: &mut [f64]) {
        let Lacked { missing, coefficient, .. } = lacked;
        step.fill(0.0);
        for candidate in self.candidates.iter().filter(|candidate| candidate.entry == missing.entry) {
            for row in own.determined() {
                // the effect added to the law comes after its own terms
                step.get_mut(row).into_iter().for_each(|step| *step = -coefficient * candidate.sums.shared(row, own));
            }
        }
    }
}

/// Whether both are the same effect, whatever their inner parameters.
pub(super) fn is_same(one: Term, other: Term) -> bool {
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
