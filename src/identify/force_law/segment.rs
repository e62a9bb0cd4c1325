//! The regression of one stage: its coefficients, how well they are known, and whether they explain the force.

use super::features::{Expected, expect};
use crate::estimation::{
    BEYOND_CHANCE, Blocks, Instant, LONGEST, Moments, OUTLYING, SAMPLES_OF_A_VARIANCE, SURPRISE, System, Weight,
    Whiteness, dot, price_of_a_term,
};
use crate::identify::problem::Problem;
use crate::identify::report::Coefficient;
use crate::identify::settings::Settings;
use crate::identify::validation::VALIDATED;
use serde::{Deserialize, Serialize};

/// Part of a pivot's diagonal entry below which it is rounding: what the others leave of its term is nothing.
pub const ROUNDING: f64 = 1e-10;

/// Part of a term that another one must be for both to count as not told apart.
const TOUCHED: f64 = 1e-3;

/// Largest correlation that is told from 1.
const MOST_ALIKE: f64 = 1.0 - 1e-6;

/// Samples over which the motion's error is one and the same: as far as the smoother looks.
pub const COHERENT: f64 = LONGEST as f64;

/// Samples per unknown, at least, of a law in which a switch can be seen.
const RECORD: f64 = 8.0;

/// The regression of one stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    pub sums: Moments,
    blocks: Blocks,
    whiteness: Whiteness,
    row: Vec<f64>,
    pub samples: u64,
    pub start: f64,
    system: System,
    /// Λ⁻¹ over the active terms.
    inverse: Vec<f64>,
    /// Free coefficients, and −1 of the force; all of them, with the known ones.
    law: Vec<f64>,
    all: Vec<f64>,
    /// Variances of all coefficients, but no more than the law's own force allows.
    variances: Vec<f64>,
    active: Vec<bool>,
    /// Whether the record determines the coefficient.
    determined: Vec<bool>,
    /// Mean square of the recursive residuals, their mean product with the one before, and mean variance by the
    /// motion's error.
    residual: f64,
    lagged: f64,
    pub of_motion: f64,
    means: f64,
    last_residual: f64,
    /// The force's own noise, variance; none before the first block.
    pub white: Option<f64>,
    pub established: bool,
    /// Least variance of what the law leaves: that of the force's sensor, where it is given.
    least: f64,
}

impl Segment {
    /// Of no record; the force sensor's noise has at least that std.
    pub fn new(problem: &Problem, noise: f64) -> Segment {
        let n = problem.n();
        Segment {
            sums: Moments::none(n + 2),
            blocks: Blocks::new(n + 2),
            whiteness: Whiteness::unknown(n),
            row: vec![1.0; n + 2],
            samples: 0,
            start: 0.0,
            system: System::new(n),
            inverse: vec![0.0; n * n],
            law: [vec![0.0; n], vec![-1.0]].concat(),
            all: problem.known.clone(),
            variances: vec![0.0; problem.terms.len()],
            active: vec![true; n],
            determined: vec![false; n],
            residual: 0.0,
            lagged: 0.0,
            last_residual: 0.0,
            of_motion: 0.0,
            means: 0.0,
            white: None,
            established: false,
            least: (noise * noise).max(f64::MIN_POSITIVE),
        }
    }

    /// Goes on with the sums as they are, since sample `first`; what is known of the sensors stays.
    pub fn begin_anew(&mut self, start: f64, first: u64, problem: &Problem) {
        self.samples -= first;
        self.start = start;
        self.blocks.begin(&self.sums);
        self.whiteness.clear();
        self.active.fill(true);
        (self.established, self.means) = (false, 0.0);
        self.solve(problem, false);
    }

    /// Number of free coefficients.
    fn n(&self) -> usize {
        self.active.len()
    }

    /// Forgets the record; the law and what is known of the force's noise stay.
    pub fn restart(&mut self) {
        self.sums.clear();
        self.blocks.clear();
        self.whiteness.clear();
        (self.samples, self.means) = (0, 0.0);
    }

    /// All coefficients, the known ones among them.
    pub fn coefficients(&self) -> &[f64] {
        &self.all
    }

    /// Whether the record determines every coefficient that the law has.
    pub fn is_determined(&self) -> bool {
        (0..self.n()).all(|row| self.std(row).is_some())
    }

    /// Takes the law for one in which a switch can be seen, where its record is long enough.
    pub fn establish(&mut self) {
        self.established |= self.is_long() && self.whiteness.is_known;
    }

    fn is_long(&self) -> bool {
        self.sums.count >= RECORD * self.n() as f64
    }

    /// What the law gives at an instant; none where that is too large to be weighed.
    pub fn expected(&self, problem: &Problem, instant: &Instant) -> Option<Expected> {
        expect(problem, &self.all, &self.variances, instant)
    }

    /// Takes one instant, of which that is expected; true where that filled a block.
    pub fn add(&mut self, problem: &Problem, instant: &Instant, expected: &Expected) -> bool {
        let Expected { features, force, of_motion } = expected;
        self.row.iter_mut().zip(&problem.free).for_each(|(slot, index)| *slot = features[*index]);
        self.row[problem.n()] = instant.force - dot(features, &problem.known);
        let weight = self.weight(*of_motion);
        if self.is_long() {
            self.compare(instant.force - force, weight, *of_motion);
        }
        self.sums.add(&self.row, weight);
        self.samples += 1;
        let is_full = self.blocks.add(&self.row, weight);
        if is_full && self.is_long() {
            self.white = Some(self.variance());
        }
        is_full
    }

    /// Whether the instant's force is no part of an established law.
    pub fn is_outlier(&self, instant: &Instant, expected: &Expected) -> bool {
        let residual = instant.force - expected.force;
        let variance = self.variance() + expected.of_motion;
        self.established && self.white.is_some() && residual * residual > OUTLYING * OUTLYING * variance
    }

    /// What a sample counts. Where the motion hardly tells which side of a jump it is on, it does so for as long as
    /// that lasts: errors that the motion makes are one error over [`COHERENT`] samples.
    fn weight(&self, of_motion: f64) -> Weight {
        self.white.map_or(Weight::WHOLE, |white| {
            let value = white / (white + COHERENT * of_motion);
            Weight { value, freedom: value * (white + of_motion) / white }
        })
    }

    /// Takes the residual that the law of the samples before leaves: under the right law these recursive residuals,
    /// scaled to equal variance, are white (Brown, Durbin and Evans, J. Royal Statistical Society B 37, 1975).
    fn compare(&mut self, residual: f64, weight: Weight, of_motion: f64) {
        let features = &self.row[..self.n()];
        let leverage = |row: usize| match self.active[row] {
            true => features[row] * dot(self.inverse_row(row), features),
            // a dropped term counts as one of variance 1
            false => features[row] * features[row],
        };
        let leverage: f64 = (0..self.n()).map(leverage).sum();
        let scaled = residual * (weight.value / weight.freedom / (1.0 + weight.value * leverage.max(0.0))).sqrt();
        let last = std::mem::replace(&mut self.last_residual, scaled);
        self.means = (self.means + 1.0).min(SAMPLES_OF_A_VARIANCE);
        self.residual += (scaled * scaled - self.residual) / self.means;
        self.lagged += (scaled * last - self.lagged) / self.means;
        self.of_motion += (of_motion - self.of_motion) / self.means;
    }

    /// Solves for the coefficients; where `choose`, for the terms that the law has, and what the blocks say of it.
    pub fn solve(&mut self, problem: &Problem, choose: bool) {
        if choose {
            self.active.fill(true);
        }
        self.regress();
        while choose && self.drop_one(problem) {
            self.regress();
        }
        if choose {
            self.find_determined();
            let variance = self.variance();
            self.whiteness.judge(self.blocks.full(), &self.law, &self.inverse, variance);
        }
        problem.scatter(&self.law, &mut self.all);
        self.renew_variances(problem);
    }

    /// A coefficient that the record does not determine is one whose force is within the force measured.
    fn renew_variances(&mut self, problem: &Problem) {
        let (n, variance) = (self.n(), self.variance());
        for (row, index) in problem.free.iter().enumerate() {
            let widest = self.sums.entry(n, n) / self.sums.entry(row, row);
            let own = self.own(row);
            let stated = if own > 0.0 { variance * own } else { f64::INFINITY };
            self.variances[*index] = if widest.is_finite() { stated.min(widest) } else { 0.0 };
        }
    }

    fn regress(&mut self) {
        let n = self.n();
        self.sums.load(n, &mut self.system);
        (0..n).filter(|row| !self.active[*row]).for_each(|row| self.system.isolate(row));
        self.system.eliminate(ROUNDING);
        self.system.solve(&mut self.law);
        self.system.invert(&mut self.inverse);
    }

    fn inverse_row(&self, row: usize) -> &[f64] {
        &self.inverse[row * self.n()..(row + 1) * self.n()]
    }

    /// Variance of a coefficient under noise of variance 1; 0 where the law has none or the record tells none.
    fn own(&self, row: usize) -> f64 {
        self.inverse_row(row)[row]
    }

    /// Drops the "maybe" term that is worth least, where it is not worth its price.
    fn drop_one(&mut self, problem: &Problem) -> bool {
        let scale = self.variance() * self.inflation();
        let price = price_of_a_term(self.sums.count);
        let worth = |row: &usize| self.law[*row].powi(2) / (scale * self.own(*row));
        let candidates = (0..self.n()).filter(|row| self.active[*row] && problem.maybe[*row]);
        let least = candidates.min_by(|a, b| worth(a).total_cmp(&worth(b)));
        match least.filter(|row| worth(row).is_nan() || worth(row) < price) {
            Some(row) => {
                self.active[row] = false;
                true
            }
            None => false,
        }
    }

    /// Variance of what the law leaves, at full weight.
    pub fn variance(&self) -> f64 {
        let unknowns = self.active.iter().filter(|active| **active).count() as f64;
        let freedom = (self.sums.count - unknowns).max(1.0);
        let rounding = 1e-14 * self.sums.entry(self.n(), self.n());
        (self.sums.quadratic(&self.law).max(rounding) / freedom).max(self.least)
    }

    /// Terms that nothing tells apart from others have no value of their own.
    fn find_determined(&mut self) {
        let n = self.n();
        self.determined.fill(true);
        for unknown in (0..n).filter(|unknown| self.active[*unknown] && !self.system.is_solved(*unknown)) {
            for other in (0..n).filter(|other| self.active[*other]) {
                // what the other solved term takes of this one, in units of their features
                let share = self.sums.row_times(unknown, self.inverse_row(other));
                let [own, square] = [unknown, other].map(|row| self.sums.entry(row, row));
                let touched = share * share * square > TOUCHED * TOUCHED * own;
                self.determined[other] &= other != unknown && !touched;
            }
        }
    }

    /// Combinations of terms that the record does not tell apart.
    pub fn open(&self, problem: &Problem) -> Vec<String> {
        if !self.is_long() {
            return Vec::new();
        }
        let open = (0..self.n()).filter(|row| self.active[*row] && !self.determined[*row]);
        let open: Vec<usize> = open.collect();
        if open.is_empty() { Vec::new() } else { vec![problem.together(&open)] }
    }

    /// Std of a free coefficient: the sandwich where the rest is not white; 0 of one that the law does not have.
    fn std(&self, row: usize) -> Option<f64> {
        if !(self.whiteness.is_known && self.determined[row]) {
            return None;
        }
        let white = self.variance() * self.own(row);
        let variance = if self.is_coloured() { self.whiteness.variances[row].max(white) } else { white };
        Some(variance.sqrt()).filter(|std| std.is_finite())
    }

    /// e of eq. (8) by the stated covariance.
    fn error(&self) -> Option<f64> {
        let squares = (0..self.n()).map(|row| self.std(row).map(|std| std * std)).sum::<Option<f64>>()?;
        let size: f64 = self.all.iter().map(|value| value * value).sum();
        (size > 0.0).then_some(squares / size)
    }

    /// Correlation of neighbouring residuals, where it is no chance.
    fn correlation(&self) -> f64 {
        let found = if self.residual > 0.0 { self.lagged / self.residual } else { 0.0 };
        if found * found * self.means > SURPRISE * SURPRISE { found.clamp(0.0, MOST_ALIKE) } else { 0.0 }
    }

    /// Samples that say as much as one independent sample: residuals that follow from one another say less, as those
    /// of an autoregression do (Bartlett, J. Royal Statistical Society 8 Suppl., 1946).
    pub fn inflation(&self) -> f64 {
        let correlation = self.correlation();
        self.whiteness.inflation.max((1.0 + correlation) / (1.0 - correlation))
    }

    /// Whether what the law leaves is no white noise.
    pub fn is_coloured(&self) -> bool {
        self.whiteness.is_coloured || self.correlation() > 0.0
    }

    /// Whether the law explains its record down to white noise, holds throughout it, and is known.
    pub fn is_valid(&self) -> bool {
        let is_known = self.error().is_some_and(|error| error < VALIDATED);
        self.established && self.whiteness.is_known && !self.is_coloured() && is_known
    }

    /// Share of the force's variance that the law explains.
    pub fn explained(&self) -> Option<f64> {
        let n = self.n();
        let [square, mean, weight] = [(n, n), (n, n + 1), (n + 1, n + 1)].map(|(a, b)| self.sums.entry(a, b));
        let spread = square - mean * mean / weight;
        let is_known = self.whiteness.is_known && spread > 0.0;
        is_known.then(|| (1.0 - self.sums.quadratic(&self.law).max(0.0) / spread).max(0.0))
    }

    /// Writes the coefficients that are known, with their std.
    pub fn publish(&self, problem: &Problem, coefficients: &mut [Coefficient]) {
        let is_valid = self.is_valid();
        for (row, index) in problem.free.iter().enumerate() {
            let std = self.std(row).filter(|std| is_valid || *std <= self.law[row].abs());
            let coefficient = &mut coefficients[*index];
            if std.is_some() {
                coefficient.value = self.law[row];
            }
            coefficient.std = std;
            coefficient.needed = is_valid.then_some(0.0);
        }
        for index in (0..coefficients.len()).filter(|index| !problem.free.contains(index)) {
            coefficients[index].value = problem.known[index];
            coefficients[index].std = Some(0.0);
        }
    }

    /// A mean deviation that noise alone hardly gives.
    pub fn unusual_deviation(&self, of_motion: f64, settings: &Settings) -> f64 {
        let std = (self.variance() + of_motion).sqrt();
        let samples = (settings.deviation_interval / settings.sample_time / self.inflation()).max(1.0);
        let [mean, spread] = [std::f64::consts::FRAC_2_PI.sqrt(), (1.0 - std::f64::consts::FRAC_2_PI).sqrt()];
        std * (mean + BEYOND_CHANCE * spread / samples.sqrt())
    }
}
