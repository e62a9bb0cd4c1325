//! What weak rows of one variation length say of coefficients that may wander: a bank of [`RandomWalk`]s, weighed
//! against each other by how well they predict the next row.

use crate::estimation::{Equation, RandomWalk};
use crate::identify::problem::Problem;
use crate::law::Term;
use crate::weak::Row;
use serde::{Deserialize, Serialize};

/// Rows that are less than a quarter of a variation apart share what they say, less than half of one their noise.
const INDEPENDENT: [f64; 2] = [0.25, 0.5];

/// How far the coefficients wander over a variation, relative to their reach; 0 first: the law is constant.
const INTENSITIES: [f64; 5] = [0.0, 0.006, 0.02, 0.06, 0.2];

/// Whether the inertia wanders like the others: the excitation fixes the scale of all coefficients, and a law that
/// loosens it is attenuated.
const INERTIA_WANDERS: [bool; 2] = [false, true];

/// How large the law's own error is, relative to a row.
const ERRORS: [f64; 2] = [0.01, 0.1];

/// For how many variations a row counts in the weights of the walks: twice as many as a constant law is waited for.
const MEMORY: f64 = 16.0;

/// No walk is less probable than e to the minus this: what was wrong may become right, and comes back within a few
/// rows.
const FAINTEST: f64 = 20.0;

/// A bank of walks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariationLength {
    /// Samples in the variation.
    pub samples: usize,
    /// Number of the sample at which the next row ends.
    pub next: u64,
    /// θ, n.
    pub coefficients: Vec<f64>,
    /// Its variances at the end of the last row, n.
    pub variances: Vec<f64>,
    /// All coefficients of the law.
    pub all: Vec<f64>,
    /// What predictions gained over knowing no law, nats.
    pub evidence: f64,
    /// Number of the sample at which that evidence began to grow, the estimate of a change of Page's test (*Biometrika*
    /// 41 (1954), 100): before the motion no row is predicted.
    pub predicts_from: u64,
    rows: f64,
    walks: Vec<RandomWalk>,
    weights: Vec<f64>,
    reach: Vec<f64>,
    columns: Vec<f64>,
    right: f64,
    size: f64,
    left: Vec<f64>,
    bias: Vec<f64>,
}

impl VariationLength {
    /// Knows nothing yet.
    pub fn new(problem: &Problem, samples: usize) -> VariationLength {
        let n = problem.n();
        let walks = walks(problem);
        let count = walks.len();
        VariationLength {
            samples,
            next: samples as u64,
            coefficients: vec![0.0; n],
            variances: vec![f64::INFINITY; n],
            all: problem.known.clone(),
            evidence: 0.0,
            predicts_from: 0,
            rows: 0.0,
            walks,
            weights: vec![(count as f64).recip(); count],
            reach: vec![0.0; n],
            columns: vec![0.0; n],
            right: 0.0,
            size: 0.0,
            left: vec![0.0; n],
            bias: vec![0.0; n],
        }
    }

    /// Forgets the coefficients, but not how well they were predicted; rows begin at sample `start`.
    pub fn restart(&mut self, start: u64) {
        (self.next, self.predicts_from) = (start + self.samples as u64, start);
        self.walks.iter_mut().for_each(RandomWalk::clear);
        let even = (self.walks.len() as f64).recip();
        self.weights.fill(even);
        self.variances.fill(f64::INFINITY);
    }

    /// The value of the free coefficient at which its term alone would be as large as the right side.
    pub fn reach(&self, free: usize) -> f64 {
        self.reach[free]
    }

    /// What a row's prediction gained on the average, nats.
    pub fn score(&self) -> f64 {
        self.evidence / self.rows.max(1.0)
    }

    /// Log-likelihood ratio of coefficients that wander to constant ones, nats.
    pub fn wandering(&self) -> f64 {
        let (constant, wandering) = self.weights.split_at(ERRORS.len());
        let mean = |weights: &[f64]| weights.iter().sum::<f64>() / weights.len() as f64;
        (mean(wandering) / mean(constant)).ln()
    }

    /// Takes a row formed about `all`, with sensor variances by channel. The row ends this `part` of a variation after
    /// the last one; `memory` is for how many variations it counts in the score.
    pub fn take(&mut self, problem: &Problem, row: &Row, sensor: [f64; 2], part: f64, memory: f64) {
        let right = self.load(problem, row, sensor, part);
        let [share, overlap] = INDEPENDENT.map(|apart| (part / apart).min(1.0));
        let variance = noise(row.residual_noise, sensor) / row.norm / overlap;
        if !(self.size > 0.0 && variance.is_finite()) {
            return;
        }
        let equation = Equation { left: &self.left, right, variance, bias: &self.bias, size: self.size };
        let mut predicted = 0.0;
        for (walk, weight) in self.walks.iter_mut().zip(&self.weights) {
            walk.wander(&self.reach, part);
            let log_density = walk.learn(&equation);
            predicted += weight * log_density.exp();
            walk.log_weight += share * log_density - walk.log_weight * part / MEMORY;
        }
        let kept = 1.0 - (part / memory).min(1.0);
        self.rows = self.rows * kept + share;
        // the density of a row of the usual size under no law at all is exp(−½)
        let gain = predicted.max(f64::MIN_POSITIVE).ln() + 0.5;
        self.evidence = (self.evidence * kept + share * gain).max(0.0);
        self.weigh();
        self.mix(problem);
    }

    /// The equation in the free coefficients, normalised; what is usual follows.
    fn load(&mut self, problem: &Problem, row: &Row, sensor: [f64; 2], part: f64) -> f64 {
        let weight = row.norm.sqrt().recip();
        let right = problem.weak_equation(row, &mut self.left) * weight;
        let due = (self.rows + 1.0).recip();
        let [slow, fast] = [4.0, 1.0].map(|variations| due.max((part / variations).min(1.0)));
        self.right += slow * (right * right - self.right);
        self.size += fast * (right * right - self.size);
        for (index, free) in problem.free.iter().enumerate() {
            let entry = &mut self.left[index];
            *entry *= weight;
            // a constant force has no part in variations whose integral is zero
            if problem.terms[*free] == Term::power(0, 0) {
                *entry = 0.0;
            }
            self.columns[index] += slow * (*entry * *entry - self.columns[index]);
            self.reach[index] = if self.columns[index] > 0.0 { (self.right / self.columns[index]).sqrt() } else { 0.0 };
            self.bias[index] = noise(row.shared_noise[*free], sensor) * weight * weight;
        }
        right
    }

    /// Weights from their logarithms, the largest of which becomes 0.
    fn weigh(&mut self) {
        let largest = self.walks.iter().map(|walk| walk.log_weight).fold(f64::NEG_INFINITY, f64::max);
        for (walk, weight) in self.walks.iter_mut().zip(&mut self.weights) {
            walk.log_weight = (walk.log_weight - largest).max(-FAINTEST);
            *weight = walk.log_weight.exp();
        }
        let sum: f64 = self.weights.iter().sum();
        self.weights.iter_mut().for_each(|weight| *weight /= sum);
    }

    /// Mean and variance over all walks. A row knows the coefficients at its middle: they may have wandered since.
    fn mix(&mut self, problem: &Problem) {
        for index in 0..self.coefficients.len() {
            let pairs = || self.walks.iter().zip(&self.weights);
            let mean: f64 = pairs().map(|(walk, weight)| weight * walk.coefficients[index]).sum();
            let variance = |walk: &RandomWalk| {
                let since = walk.step(index, self.reach[index]) / 2.0;
                walk.variance(index) + since + (walk.coefficients[index] - mean).powi(2)
            };
            let variance = pairs().map(|(walk, weight)| weight * variance(walk)).sum();
            self.coefficients[index] = mean;
            self.variances[index] = if self.reach[index] > 0.0 { variance } else { f64::INFINITY };
        }
        problem.scatter(&self.coefficients, &mut self.all);
    }
}

/// Constant coefficients first; then all that wander, the inertia with the others or not.
fn walks(problem: &Problem) -> Vec<RandomWalk> {
    let inertia = problem.free_inertia();
    let kinds = if inertia.is_some() { &INERTIA_WANDERS[..] } else { &INERTIA_WANDERS[1..] };
    let wandering = kinds.iter().flat_map(|wanders| INTENSITIES[1..].iter().map(|intensity| (*intensity, *wanders)));
    let all = std::iter::once((INTENSITIES[0], true)).chain(wandering);
    let walk =
        |intensity, error, wanders: bool| RandomWalk::new(problem.n(), intensity, error, inertia.filter(|_| !wanders));
    all.flat_map(|(intensity, wanders)| ERRORS.map(|error| walk(intensity, error, wanders))).collect()
}

fn noise(by_channel: [f64; 2], sensor: [f64; 2]) -> f64 {
    by_channel[0] * sensor[0] + by_channel[1] * sensor[1]
}
