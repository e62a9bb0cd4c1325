//! Hypotheses that the law switched, at many instants at once.
//!
//! Each [`Hypothesis`] says: since its start the coefficients differ by δ from those in use. δ makes the innovations ε of the
//! law in use linear in it, ε = ψδ + white, ψ carried from sensitivity 0 at the start (the state is continuous across a
//! switch). With M = Σψψᵀ/s and g = Σψε/s, and a Gaussian prior N(μ, Λ⁻¹) of δ, the log-evidence of the data since the
//! start is
//!
//! ```text
//! ½ (g + Λμ)ᵀ (M + Λ)⁻¹ (g + Λμ) − ½ μᵀΛμ − ½ ln det(M + Λ) + ½ ln det Λ   (+ what all priors share)
//! ```
//!
//! "No switch" has the information that the stage gave on its own coefficients up to the start; "switch" a prior as wide as
//! physics makes plausible. Their difference is the evidence of a switch (Willsky and Jones 1976, with a prior in the
//! place of the maximum). Starts are kept on a grid whose spacing grows with age.

use super::filter::Innovation;
use super::information::Information;
use super::pass::IntervalMap;
use super::symmetric;
use serde::{Deserialize, Serialize};

/// Pivots this far below their diagonal are rounding.
const TOLERANCE: f64 = 1e-13;

/// The law in use is trusted with this fraction of its information: its covariance is that of a linearisation.
const CAUTION: f64 = 0.03;

/// A hypothesis is looked at again when its age has grown by this factor.
const AGING: f64 = 1.1;

/// Innovations of the law in use that a start is old, at the least, before it is looked at.
const YOUNGEST: u32 = 2;

/// What the law in use knows of its coefficients when a hypothesis starts.
#[derive(Clone, Copy, Debug)]
pub struct Law<'a> {
    /// Information on the coefficients from the stage so far.
    pub information: &'a Information,
    /// Which of them the law has.
    pub active: &'a [bool],
}

/// A switch that the data speak for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspect {
    /// Log-evidence of the switch, nats.
    pub evidence: f64,
    /// Number of the last sample before the switch.
    pub start: u64,
    /// The hypothesis it is.
    index: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Hypothesis {
    start: u64,
    age: u32,
    next_look: u32,
    evidence: f64,
    sensitivity: Vec<[f64; 2]>,
    information: Information,
    /// Λ of "no switch", lower triangle.
    prior: Vec<f64>,
    /// μ of "no switch": what has been added to the coefficients in use since the start, with a minus.
    mean: Vec<f64>,
    prior_log_determinant: f64,
    active: Vec<bool>,
}

/// A bounded set of hypotheses, ordered by start, the youngest last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bank {
    n: usize,
    hypotheses: Vec<Hypothesis>,
    count: usize,
    /// 1/τ² by coefficient, the prior of "switch".
    spread: Vec<f64>,
    spread_log_determinant: f64,
    row: Vec<f64>,
    matrix: Vec<f64>,
    vector: Vec<f64>,
    looked: usize,
}

impl Bank {
    /// Room for `capacity` ≥ 4 hypotheses on `n` coefficients.
    pub fn new(n: usize, capacity: usize) -> Bank {
        let hypothesis = Hypothesis {
            start: 0,
            age: 0,
            next_look: 0,
            evidence: 0.0,
            sensitivity: vec![[0.0; 2]; n],
            information: Information::none(n),
            prior: vec![0.0; n * n],
            mean: vec![0.0; n],
            prior_log_determinant: 0.0,
            active: vec![false; n],
        };
        Bank {
            n,
            hypotheses: vec![hypothesis; capacity],
            count: 0,
            spread: vec![1.0; n],
            spread_log_determinant: 0.0,
            row: vec![0.0; n],
            matrix: vec![0.0; n * n],
            vector: vec![0.0; n],
            looked: 0,
        }
    }

    /// Forgets all hypotheses.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// How far a switch moves the coefficients, std τ > 0 of each.
    pub fn set_spread(&mut self, std: &[f64]) {
        for (spread, std) in self.spread.iter_mut().zip(std) {
            *spread = (std * std).recip();
        }
        self.spread_log_determinant = self.spread.iter().map(|spread| spread.ln()).sum();
    }

    /// Adds the hypothesis that the law switches after sample `start`, in the place of the one that is missed least.
    pub fn spawn(&mut self, start: u64, law: &Law) {
        if self.count == self.hypotheses.len() {
            let least = self.least_missed(start);
            self.remove(least);
        }
        let n = self.n;
        let hypothesis = &mut self.hypotheses[self.count];
        (hypothesis.start, hypothesis.age, hypothesis.next_look) = (start, 0, YOUNGEST);
        hypothesis.evidence = 0.0;
        hypothesis.sensitivity.fill([0.0; 2]);
        hypothesis.information.clear();
        hypothesis.mean.fill(0.0);
        hypothesis.prior.iter_mut().zip(&law.information.matrix).for_each(|(slot, entry)| *slot = CAUTION * entry);
        for (index, (slot, active)) in hypothesis.active.iter_mut().zip(law.active).enumerate() {
            *slot = *active && law.information.matrix[index * n + index] > 0.0;
        }
        isolate(&mut self.matrix, &hypothesis.prior, &hypothesis.active, n);
        symmetric::cholesky(&mut self.matrix, n, TOLERANCE);
        for index in 0..n {
            hypothesis.active[index] &= self.matrix[index * n + index].is_finite();
        }
        hypothesis.prior_log_determinant = symmetric::log_determinant(&self.matrix, n);
        self.count += 1;
    }

    /// Drops hypotheses that start before sample `oldest`.
    pub fn forget_before(&mut self, oldest: u64) {
        while self.count > 0 && self.hypotheses[0].start < oldest {
            self.remove(0);
        }
    }

    /// Takes what one interval did and what its measurements said.
    pub fn step(&mut self, map: &IntervalMap, innovations: &[Option<Innovation>; 2]) {
        for hypothesis in &mut self.hypotheses[..self.count] {
            map.carry(&mut hypothesis.sensitivity);
            hypothesis.age += 1;
            for (channel, innovation) in innovations.iter().enumerate() {
                if let Some(innovation) = innovation {
                    hypothesis.take(channel, innovation, &mut self.row);
                }
            }
        }
    }

    /// The coefficients in use have become those plus `step`.
    pub fn shift(&mut self, step: &[f64]) {
        for hypothesis in &mut self.hypotheses[..self.count] {
            hypothesis.information.shift(step);
            hypothesis.mean.iter_mut().zip(step).for_each(|(mean, step)| *mean -= step);
        }
    }

    /// Looks at up to `looks` hypotheses that are due, the youngest first.
    pub fn look(&mut self, looks: usize) {
        let mut left = looks;
        for index in (0..self.count).rev() {
            let hypothesis = &self.hypotheses[index];
            if left > 0 && hypothesis.age >= hypothesis.next_look {
                let evidence = self.evidence(index);
                let hypothesis = &mut self.hypotheses[index];
                hypothesis.evidence = evidence;
                hypothesis.next_look = hypothesis.age + 1 + (f64::from(hypothesis.age) * (AGING - 1.0)) as u32;
                left -= 1;
            }
        }
    }

    /// The hypothesis with most evidence, as last looked at.
    pub fn suspect(&self) -> Option<Suspect> {
        let live = self.hypotheses[..self.count].iter().enumerate();
        let best = live.max_by(|a, b| a.1.evidence.total_cmp(&b.1.evidence));
        best.map(|(index, hypothesis)| Suspect { evidence: hypothesis.evidence, start: hypothesis.start, index })
    }

    /// Brings every evidence up to date.
    pub fn look_at_all(&mut self) {
        for index in 0..self.count {
            self.hypotheses[index].evidence = self.evidence(index);
        }
    }

    /// The latest start whose evidence is within `margin` nats of the suspect's.
    pub fn latest_start(&self, suspect: &Suspect, margin: f64) -> u64 {
        self.hypotheses[self.latest(suspect, margin)].start
    }

    /// The first start that is too late by `margin` nats: a switch after it is not plausible.
    pub fn after(&self, suspect: &Suspect, margin: f64) -> u64 {
        self.hypotheses[(self.latest(suspect, margin) + 1).min(self.count - 1)].start
    }

    fn latest(&self, suspect: &Suspect, margin: f64) -> usize {
        let plausible = |hypothesis: &Hypothesis| hypothesis.evidence >= suspect.evidence - margin;
        self.hypotheses[..self.count].iter().rposition(plausible).unwrap_or(suspect.index)
    }

    /// Writes the most plausible change of the coefficients under the suspect into `change`.
    pub fn change(&mut self, suspect: &Suspect, change: &mut [f64]) {
        self.switched(suspect.index);
        change.copy_from_slice(&self.vector);
        symmetric::backward(&self.matrix, self.n, change);
    }

    fn evidence(&mut self, index: usize) -> f64 {
        let switched = self.switched(index);
        switched - self.unswitched(index)
    }

    /// Log-evidence of a switch; leaves L and L⁻¹(g + Λμ) behind.
    fn switched(&mut self, index: usize) -> f64 {
        let (n, hypothesis) = (self.n, &self.hypotheses[index]);
        self.matrix.copy_from_slice(&hypothesis.information.matrix);
        for (row, spread) in self.spread.iter().enumerate() {
            self.matrix[row * n + row] += spread;
        }
        symmetric::cholesky(&mut self.matrix, n, TOLERANCE);
        self.vector.copy_from_slice(&hypothesis.information.score);
        symmetric::forward(&self.matrix, n, &mut self.vector);
        let squares: f64 = self.vector.iter().map(|v| v * v).sum();
        0.5 * (squares - symmetric::log_determinant(&self.matrix, n) + self.spread_log_determinant)
    }

    /// Log-evidence of no switch.
    fn unswitched(&mut self, index: usize) -> f64 {
        let (n, hypothesis) = (self.n, &self.hypotheses[index]);
        isolate(&mut self.matrix, &hypothesis.prior, &hypothesis.active, n);
        let mut at_mean = 0.0;
        for row in 0..n {
            let pull = if hypothesis.active[row] { row_times(&self.matrix, n, row, &hypothesis.mean) } else { 0.0 };
            at_mean += pull * hypothesis.mean[row];
            self.vector[row] = if hypothesis.active[row] { hypothesis.information.score[row] + pull } else { 0.0 };
        }
        for row in (0..n).filter(|row| hypothesis.active[*row]) {
            for column in (0..=row).filter(|column| hypothesis.active[*column]) {
                self.matrix[row * n + column] += hypothesis.information.matrix[row * n + column];
            }
        }
        symmetric::cholesky(&mut self.matrix, n, TOLERANCE);
        symmetric::forward(&self.matrix, n, &mut self.vector);
        let squares: f64 = self.vector.iter().map(|v| v * v).sum();
        let log_determinant = symmetric::log_determinant(&self.matrix, n);
        0.5 * (squares - at_mean - log_determinant + hypothesis.prior_log_determinant)
    }

    /// The hypothesis whose neighbours leave the smallest gap, relative to their age.
    fn least_missed(&self, now: u64) -> usize {
        let gap = |index: usize| {
            let (before, after) = (self.hypotheses[index - 1].start, self.hypotheses[index + 1].start);
            (after - before) as f64 / ((now - after) as f64 + 4.0)
        };
        (1..self.count - 1).min_by(|a, b| gap(*a).total_cmp(&gap(*b))).unwrap_or(0)
    }

    fn remove(&mut self, index: usize) {
        self.hypotheses[index..self.count].rotate_left(1);
        self.count -= 1;
    }
}

impl Hypothesis {
    #[inline]
    fn take(&mut self, channel: usize, innovation: &Innovation, row: &mut [f64]) {
        for (row, sensitivity) in row.iter_mut().zip(&mut self.sensitivity) {
            *row = sensitivity[channel];
            sensitivity[0] -= innovation.gain[0] * *row;
            sensitivity[1] -= innovation.gain[1] * *row;
        }
        self.information.add(row, innovation.residual, innovation.variance);
    }
}

/// Copies the part of a matrix that concerns active unknowns; the others get a row of their own.
fn isolate(target: &mut [f64], source: &[f64], active: &[bool], n: usize) {
    for row in 0..n {
        for column in 0..=row {
            let both = active[row] && active[column];
            let alone = if row == column { 1.0 } else { 0.0 };
            target[row * n + column] = if both { source[row * n + column] } else { alone };
        }
    }
}

/// Row of a symmetric matrix, given by its lower triangle, times a vector.
fn row_times(matrix: &[f64], n: usize, row: usize, vector: &[f64]) -> f64 {
    let lower: f64 = (0..=row).map(|column| matrix[row * n + column] * vector[column]).sum();
    let upper: f64 = (row + 1..n).map(|column| matrix[column * n + row] * vector[column]).sum();
    lower + upper
}
