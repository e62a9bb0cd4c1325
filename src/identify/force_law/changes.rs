//! Hypotheses "the coefficients changed at sample k", and the log Bayes factor of each against "they did not".
//!
//! The sums before k tell θ, those since k tell θ + δ. With θ marginalised the record since k has information V = Λ₁ −
//! Λ₁(Λ₀ + Λ₁)⁻¹Λ₁ on δ and
//! score h = g − Λ₁(Λ₀ + Λ₁)⁻¹g, g = b₁ − Λ₁θ₀. Under δ ~ N(0, T) and an unknown variance of which the record before k
//! has ν degrees of freedom (the normal
//! inverse-gamma pair; Bernardo and Smith, *Bayesian Theory*, 1994, 5.2) the factor is
//! −½ ln det(1 + VT/σ²) + ½(ν + n₁) ln((νσ² + Q)/(νσ² + Q − hᵀ(V + σ²T⁻¹)⁻¹h)), Q what the law leaves since k. T is a
//! switch of all coefficients, or of
//! one alone, even chances each. Summed over the instants that each hypothesis stands for this is the Shiryaev–Roberts
//! statistic: mean time
//! between false alarms at least its threshold, in samples (Pollak, *Annals of Statistics* 13, 1985).

use super::sums::{Sums, dot};
use crate::estimation::System;
use crate::evidence::SWITCH_SIZE;
use serde::{Deserialize, Serialize};

/// Most hypotheses: twice those of the tracker of motion, since each costs a regression and no filter.
const MOST: usize = 40;

/// Hypotheses looked at in a step: each of them once in ten steps.
const LOOKS: usize = 4;

/// Share of the posterior by which an instant is too late to be the switch: one chance in a thousand that it came
/// later.
const TOO_LATE: f64 = 0.999;

/// One hypothesis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Hypothesis {
    /// Its sample, the first of the new law; counted from the stage's start.
    sample: u64,
    /// Time of that sample and of the one before it, s.
    t: f64,
    previous: f64,
    /// Sums before it.
    before: Sums,
    /// Log Bayes factor, and the sample at which it was looked at.
    evidence: f64,
    looked: u64,
}

/// The hypotheses, oldest first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Changes {
    hypotheses: Vec<Hypothesis>,
    count: usize,
    work: Work,
}

/// Room for the sums since an instant and what is made of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Work {
    since: Sums,
    both: Sums,
    law: Vec<f64>,
    score: Vec<f64>,
    inverse: Vec<f64>,
    /// Λ₁(Λ₀ + Λ₁)⁻¹, then V.
    matrix: Vec<f64>,
    h: Vec<f64>,
    system: System,
}

/// Where the law switched, as far as the evidence tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// The likeliest instant, s.
    pub time: f64,
    /// Std of it, s.
    pub std: f64,
    /// Place of the first hypothesis that is not too early: all samples since belong to the new law.
    place: usize,
}

impl Changes {
    /// For n unknowns.
    pub fn new(n: usize) -> Changes {
        let hypothesis =
            Hypothesis { sample: 0, t: 0.0, previous: 0.0, before: Sums::none(n), evidence: 0.0, looked: 0 };
        let work = Work {
            since: Sums::none(n),
            both: Sums::none(n),
            law: vec![0.0; n],
            score: vec![0.0; n],
            inverse: vec![0.0; n * n],
            matrix: vec![0.0; n * n],
            h: vec![0.0; n],
            system: System::new(n),
        };
        Changes { hypotheses: vec![hypothesis; MOST], count: 0, work }
    }

    /// Forgets every hypothesis.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// The law may have changed between two samples, at times `previous` and `t`; `before` are the sums without the
    /// latter.
    pub fn suppose(&mut self, sample: u64, [previous, t]: [f64; 2], before: &Sums) {
        if self.count == MOST {
            self.thin(sample);
        }
        let slot = &mut self.hypotheses[self.count];
        slot.before.copy(before);
        (slot.sample, slot.previous, slot.t) = (sample, previous, t);
        (slot.evidence, slot.looked) = (f64::NEG_INFINITY, sample);
        self.count += 1;
    }

    /// Drops the hypothesis whose neighbours lie closest together for their age; never the likeliest.
    fn thin(&mut self, now: u64) {
        let best = self.likeliest();
        let at = |index: usize| self.hypotheses[index].sample as f64;
        let gap = |index: &usize| (at(index + 1) - at(index - 1)) / (now as f64 + 1.0 - at(*index));
        let candidates = (1..self.count - 1).filter(|index| *index != best);
        if let Some(index) = candidates.min_by(|a, b| gap(a).total_cmp(&gap(b))) {
            self.hypotheses[index..self.count].rotate_left(1);
            self.count -= 1;
        }
    }

    fn likeliest(&self) -> usize {
        let all = self.hypotheses[..self.count].iter().enumerate();
        all.max_by(|a, b| a.1.evidence.total_cmp(&b.1.evidence)).map_or(0, |(index, _)| index)
    }

    /// Looks again at the likeliest hypothesis and at those that have waited longest for their age; `inflation`
    /// divides what the record says.
    pub fn look(&mut self, now: u64, total: &Sums, active: &[bool], inflation: f64) {
        if self.count == 0 {
            return;
        }
        let best = self.likeliest();
        self.weigh(best, now, total, active, inflation);
        for _ in 1..LOOKS.min(self.count) {
            let waited =
                |hypothesis: &Hypothesis| (now + 1 - hypothesis.looked) as f64 / (now + 1 - hypothesis.sample) as f64;
            let all = self.hypotheses[..self.count].iter().enumerate();
            let longest = all.max_by(|a, b| waited(a.1).total_cmp(&waited(b.1))).map_or(0, |(index, _)| index);
            self.weigh(longest, now, total, active, inflation);
        }
    }

    /// Looks at every hypothesis.
    pub fn look_at_all(&mut self, now: u64, total: &Sums, active: &[bool], inflation: f64) {
        (0..self.count).for_each(|index| self.weigh(index, now, total, active, inflation));
    }

    fn weigh(&mut self, index: usize, now: u64, total: &Sums, active: &[bool], inflation: f64) {
        let hypothesis = &mut self.hypotheses[index];
        hypothesis.looked = now + 1;
        hypothesis.evidence = self.work.evidence(&hypothesis.before, total, active, inflation);
    }

    /// Largest log Bayes factor of an instant.
    fn largest(&self) -> f64 {
        self.hypotheses[..self.count].iter().map(|hypothesis| hypothesis.evidence).fold(f64::NEG_INFINITY, f64::max)
    }

    /// ln Σ of the Bayes factors over all instants.
    pub fn evidence(&self) -> f64 {
        let top = self.largest();
        if top == f64::NEG_INFINITY {
            return top;
        }
        top + (0..self.count).map(|index| self.mass(index, top)).sum::<f64>().ln()
    }

    /// exp(evidence − top) times the instants that a hypothesis stands for.
    fn mass(&self, index: usize, top: f64) -> f64 {
        let Hypothesis { sample, evidence, .. } = self.hypotheses[index];
        let before = index.checked_sub(1).map_or(sample.saturating_sub(1), |index| self.hypotheses[index].sample);
        (evidence - top).exp() * (sample - before).max(1) as f64
    }

    /// Where the law switched; none without a hypothesis.
    pub fn switch(&self) -> Option<Switch> {
        let top = self.largest();
        let total: f64 = (0..self.count).map(|index| self.mass(index, top)).sum();
        if self.count == 0 || total.is_nan() || total <= 0.0 {
            return None;
        }
        let best = &self.hypotheses[self.likeliest()];
        let time = 0.5 * (best.previous + best.t);
        let (mut sum, mut square, mut place) = (0.0, 0.0, self.count - 1);
        for index in (0..self.count).rev() {
            let (hypothesis, share) = (&self.hypotheses[index], self.mass(index, top) / total);
            let from = index.checked_sub(1).map_or(hypothesis.previous, |index| self.hypotheses[index].t);
            let to = self.hypotheses[(index + 1).min(self.count - 1)].t;
            let (away, width) = (0.5 * (hypothesis.previous + hypothesis.t) - time, to - from);
            // the instant may lie anywhere between the neighbours
            square += share * (away * away + width * width / 12.0);
            // from the latest instant back: those behind which next to nothing of the posterior lies
            if sum < 1.0 - TOO_LATE {
                place = index;
            }
            sum += share;
        }
        Some(Switch { time, std: square.sqrt(), place })
    }

    /// Leaves in `total` only what came since the switch; returns the number of its first sample.
    pub fn cut(&self, switch: &Switch, total: &mut Sums) -> u64 {
        let hypothesis = &self.hypotheses[switch.place];
        total.merge(&hypothesis.before, -1.0);
        hypothesis.sample
    }
}

impl Work {
    /// The log Bayes factor of a change behind `before`.
    fn evidence(&mut self, before: &Sums, total: &Sums, active: &[bool], inflation: f64) -> f64 {
        let n = total.n();
        let unknowns = active.iter().filter(|active| **active).count() as f64;
        let freedom = before.count - unknowns;
        if freedom < unknowns.max(1.0) {
            return f64::NEG_INFINITY;
        }
        before.eliminate(active, &mut self.system);
        self.system.solve(&mut self.law);
        let variance = floor(before.loss(&self.law), before) / freedom;
        self.since.copy(total);
        self.since.merge(before, -1.0);
        self.since.score(&self.law, &mut self.score);
        let loss = self.since.loss(&self.law);
        total.eliminate(active, &mut self.system);
        self.system.invert(&mut self.inverse);
        for row in 0..n {
            for column in 0..n {
                let own = &self.since.information[row * n..(row + 1) * n];
                let of_total = &self.inverse[column * n..(column + 1) * n];
                self.matrix[row * n + column] = if active[row] && active[column] { dot(own, of_total) } else { 0.0 };
            }
        }
        self.marginalise(n);
        let left = loss - self.pulled_by_law(n, active);
        let freedom = [freedom * variance, freedom + self.since.count];
        self.mixture(before, active, freedom, left.max(0.0), variance, inflation)
    }

    /// V and h in place of Λ₁(Λ₀ + Λ₁)⁻¹ and g.
    fn marginalise(&mut self, n: usize) {
        for row in 0..n {
            let gain = &self.matrix[row * n..(row + 1) * n];
            self.h[row] = self.score[row] - dot(gain, &self.score);
            for (column, entry) in self.law.iter_mut().enumerate() {
                // the law's coefficients are no longer needed
                *entry = self.since.information[row * n + column]
                    - (0..n).map(|k| gain[k] * self.since.information[k * n + column]).sum::<f64>();
            }
            self.both.information[row * n..(row + 1) * n].copy_from_slice(&self.law);
        }
    }

    /// gᵀ(Λ₀ + Λ₁)⁻¹g.
    fn pulled_by_law(&self, n: usize, active: &[bool]) -> f64 {
        let rows = (0..n).filter(|row| active[*row]);
        rows.map(|row| {
            let columns = (0..n).filter(|column| active[*column]);
            self.score[row] * columns.map(|column| self.inverse[row * n + column] * self.score[column]).sum::<f64>()
        })
        .sum()
    }

    /// Even chances of a switch of all coefficients, and of one alone, any.
    fn mixture(
        &mut self,
        before: &Sums,
        active: &[bool],
        freedom: [f64; 2],
        left: f64,
        variance: f64,
        inflation: f64,
    ) -> f64 {
        let n = active.len();
        let [known, freedom] = freedom;
        let factor = |gained: f64| {
            let rest = (known + left - gained).max(f64::MIN_POSITIVE);
            0.5 * freedom / inflation * ((known + left) / rest).ln()
        };
        // T ÷ σ² of each coefficient
        let mean = before.squares / before.count;
        let width = |row: usize| {
            let feature = before.information[row * n + row] / before.count;
            if active[row] && feature > 0.0 {
                SWITCH_SIZE * SWITCH_SIZE * mean / (feature * variance * inflation)
            } else {
                0.0
            }
        };
        let sought = || (0..n).filter(|row| width(*row) > 0.0);
        let single = |row: usize| {
            let (own, width) = (self.both.information[row * n + row].max(0.0), width(row));
            factor(self.h[row] * self.h[row] / (own + width.recip())) - 0.5 * (own * width).ln_1p()
        };
        let singles = sought().map(single).fold(f64::NEG_INFINITY, log_sum) - (sought().count() as f64).ln();
        for row in 0..n {
            let entries = self.system.row(row);
            entries[..n].copy_from_slice(&self.both.information[row * n..(row + 1) * n]);
            entries[row] += if width(row) > 0.0 { width(row).recip() } else { 1.0 };
        }
        self.system.set_right(self.h.iter().copied());
        (0..n).filter(|row| width(*row) == 0.0).for_each(|row| self.system.isolate(row));
        self.system.eliminate(0.0);
        let widths: f64 = sought().map(|row| width(row).ln()).sum();
        let all = factor(self.system.squares()) - 0.5 * (self.system.log_determinant() + widths);
        log_sum(all, singles) - 2.0_f64.ln()
    }
}

/// ln(eᵃ + eᵇ).
fn log_sum(a: f64, b: f64) -> f64 {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    if low == f64::NEG_INFINITY { high } else { high + (low - high).exp().ln_1p() }
}

/// What a law leaves, but no less than rounding.
fn floor(loss: f64, sums: &Sums) -> f64 {
    // what sums of squares lose to rounding
    const ROUNDING: f64 = 1e-14;
    loss.max(ROUNDING * sums.squares).max(f64::MIN_POSITIVE)
}
