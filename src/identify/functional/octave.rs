//! One length of variation: rows from samples averaged so far that there are two in a time constant of the variation.

use super::regression::{Estimate, Regression};
use crate::estimation::{Blocks, FEWEST, Weight};
use crate::identify::problem::Problem;
use crate::identify::sample::{GAP, Sample};
use crate::law::{State, Term};
use crate::weak::{Functional, Pole, signal};
use serde::{Deserialize, Serialize};

/// Rate a of the variation times the distance of two averaged samples.
pub(super) const ADVANCE: f64 = 0.5;

/// Rows of one length of variation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Octave {
    /// Usual distance of two averaged samples, s.
    dt: f64,
    /// How many samples are averaged.
    averaged: f64,
    /// The first of two that are to become one of the next octave.
    first: Option<Sample>,
    last: [Sample; 2],
    /// Averaged samples since the last gap.
    since: u32,
    /// Of every free term, the right side, q̇ and q̈.
    functionals: Vec<Functional>,
    row: Vec<f64>,
    blocks: Blocks,
    /// Σ of squares of q̇'s and q̈'s integrals.
    energies: [f64; 2],
    /// Mean of the right side, and Σ of its squares about it.
    mean: f64,
    spread: f64,
    rows: f64,
    estimate: Estimate,
    solved: bool,
}

/// What white noise in the displacement and the velocity adds to a row's entries, by order of derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sensors {
    /// Variances of (q, q̇).
    pub(super) variance: [f64; 2],
    /// As [`Functional::noise_gain`] has it, by order of derivative.
    pub(super) gains: [f64; 3],
}

impl Octave {
    pub(super) fn new(n: usize) -> Octave {
        Octave {
            dt: 0.0,
            averaged: 1.0,
            first: None,
            last: [Sample::default(); 2],
            since: 0,
            functionals: vec![Functional::default(); n + 3],
            row: vec![0.0; n + 1],
            blocks: Blocks::new(n + 1),
            energies: [0.0; 2],
            mean: 0.0,
            spread: 0.0,
            rows: 0.0,
            estimate: Estimate::new(n),
            solved: false,
        }
    }

    /// Forgets all samples; the next are averages of `averaged`, `dt` apart.
    pub(super) fn begin(&mut self, averaged: f64, dt: f64) {
        (self.averaged, self.dt, self.first) = (averaged, dt, None);
        self.resume();
    }

    /// Forgets all rows.
    pub(super) fn resume(&mut self) {
        (self.energies, self.mean, self.spread, self.rows) = ([0.0; 2], 0.0, 0.0, 0.0);
        self.blocks.clear();
        self.estimate.clear();
        self.solved = false;
        self.interrupt();
    }

    fn interrupt(&mut self) {
        self.since = 0;
        self.functionals.fill(Functional::default());
    }

    /// Takes an averaged sample; returns the one of the next octave where it is complete.
    pub(super) fn take(&mut self, problem: &Problem, sample: Sample) -> Option<Sample> {
        let [before, middle] = self.last;
        if self.since > 0 && sample.t - middle.t > GAP * self.dt {
            self.interrupt();
            self.first = None;
        }
        self.last = [middle, sample];
        self.since += 1;
        if self.since > 2 {
            let qd = (sample.q - before.q) / (sample.t - before.t);
            let qd = if problem.channels.qd { middle.qd } else { qd };
            self.form_row(problem, &Sample { qd, ..middle }, middle.t - before.t);
        }
        self.average(sample)
    }

    /// Takes an averaged sample without a row of its own; returns the one of the next octave where it is complete.
    pub(super) fn average(&mut self, sample: Sample) -> Option<Sample> {
        match self.first.take() {
            None => {
                self.first = Some(sample);
                None
            }
            Some(first) => Some(mean(&first, &sample)),
        }
    }

    fn form_row(&mut self, problem: &Problem, at: &Sample, dt: f64) {
        let pole = Pole::new(self.rate(), dt);
        let by_parts = problem.channels.q;
        let n = problem.n();
        let state = State { q: at.q, qd: at.qd };
        let of = |term: Term| signal(term, &problem.own, state, at.excitation, by_parts);
        for ((entry, functional), term) in self.row.iter_mut().zip(&mut self.functionals).zip(&problem.free_terms) {
            *entry = functional.step(&pole, of(*term));
        }
        let mut right = [at.excitation, 0.0, 0.0];
        for (term, value) in problem.terms.iter().zip(&problem.known).filter(|(_, value)| **value != 0.0) {
            right.iter_mut().zip(of(*term)).for_each(|(sum, part)| *sum -= value * part);
        }
        self.row[n] = self.functionals[n].step(&pole, right);
        let motion = [Term::power(0, 1), Term::Inertia].map(of);
        let [velocity, acceleration] = [0, 1].map(|order| self.functionals[n + 1 + order].step(&pole, motion[order]));
        if !self.row.iter().all(|entry| (entry * entry).is_finite()) {
            self.interrupt();
        } else if f64::from(self.since - 2) * ADVANCE > Functional::FADED {
            self.energies[0] += velocity * velocity;
            self.energies[1] += acceleration * acceleration;
            self.rows += 1.0;
            let off = self.row[n] - self.mean;
            self.mean += off / self.rows;
            self.spread += off * (self.row[n] - self.mean);
            self.solved &= !self.blocks.add(&self.row, Weight::WHOLE);
        }
    }

    /// The rate a of the variation, 1/s.
    pub(super) fn rate(&self) -> f64 {
        ADVANCE / self.dt
    }

    /// Whether there are blocks enough for a regression.
    pub(super) fn is_ready(&self) -> bool {
        self.blocks.full().len() >= FEWEST
    }

    /// rms q̈ ÷ rms q̇ of the motion as this octave sees it, rad/s; none before it has seen any, or where noise is most
    /// of it.
    pub(super) fn frequency(&self, problem: &Problem, sensors: &Sensors) -> Option<f64> {
        let noise = self.noise(problem, sensors);
        let [velocity, acceleration] = [0, 1].map(|order| self.energies[order] - self.rows * noise[order]);
        let seen = velocity > 0.5 * self.energies[0] && acceleration > 0.5 * self.energies[1];
        (seen && self.rows > 0.0).then(|| (acceleration / velocity).sqrt())
    }

    /// Variances that noise gives the integrals of q̇ and q̈.
    fn noise(&self, problem: &Problem, sensors: &Sensors) -> [f64; 2] {
        let square = self.rate().powi(2);
        let [q, qd] = sensors.variance.map(|variance| variance / self.averaged);
        match problem.channels.q {
            true => [q * sensors.gains[1] * square, q * sensors.gains[2] * square * square],
            false => [qd * sensors.gains[0], qd * sensors.gains[1] * square],
        }
    }

    /// Solves the rows unless that has been done since the last block; returns whether it did.
    pub(super) fn solve(&mut self, problem: &Problem, sensors: &Sensors, regression: &mut Regression) -> bool {
        if self.solved || !self.is_ready() {
            return false;
        }
        let (noise, variance) = (self.noise(problem, sensors), self.spread / self.rows);
        regression.solve(problem, self.blocks.full(), noise, variance, &mut self.estimate);
        self.solved = true;
        true
    }

    /// Root of Σ of squares of q̈'s integrals and of the right side's.
    pub(super) fn amplitudes(&self) -> [f64; 2] {
        [self.energies[1].sqrt(), (self.spread + self.rows * self.mean * self.mean).sqrt()]
    }

    pub(super) fn estimate(&self) -> &Estimate {
        &self.estimate
    }
}

fn mean(a: &Sample, b: &Sample) -> Sample {
    Sample {
        t: 0.5 * (a.t + b.t),
        q: 0.5 * (a.q + b.q),
        qd: 0.5 * (a.qd + b.qd),
        excitation: 0.5 * (a.excitation + b.excitation),
    }
}
