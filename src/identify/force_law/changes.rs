//! Hypotheses "the coefficients changed at sample k", and the log Bayes factor of each against "they did not".
//!
//! The moments before k tell θ, those since k tell θ + δ. With θ marginalised the record since k has information V =
//! Λ₁ − Λ₁(Λ₀ + Λ₁)⁻¹Λ₁ on δ and score h = b₁ − Λ₁θ, θ the law of both records. Under δ ~ N(0, T) and an unknown
//! variance of which the record before k has ν degrees of freedom (the normal inverse-gamma pair; Bernardo and Smith,
//! *Bayesian Theory*, 1994, 5.2) the factor is −½ ln det(1 + VT/σ²) + ½(ν + n₁) ln(S/(S − hᵀ(V + σ²T⁻¹)⁻¹h)), S what
//! that law leaves of both. T is a switch of all coefficients, or of one alone, even chances each. Summed over the
//! instants that each hypothesis stands for this is the Shiryaev–Roberts statistic: mean time between false alarms at
//! least its threshold, in samples (Pollak, *Annals of Statistics* 13, 1985).

use super::segment::ROUNDING;
use crate::estimation::{Lane, Moments, System, WIDTH, log_sum};
use crate::evidence::{OWN, SWITCH_SIZE};
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
    /// Moments before it.
    before: Moments,
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

/// Room to weigh a hypothesis in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Work {
    since: Moments,
    /// A record's law, and −1 of the force.
    law: Vec<f64>,
    /// Λ₁ through the elimination of Λ₀ + Λ₁: n rows of as many lanes as n needs.
    crossed: Vec<Lane>,
    /// A record's normal equations: at the end those of both.
    system: System,
    /// V + σ²T⁻¹ and h.
    change: System,
}

/// What noise of unknown variance leaves: S, and half its degrees of freedom.
#[derive(Clone, Copy, Debug)]
struct Rest {
    squares: f64,
    power: f64,
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
        let before = Moments::none(n + 2);
        let hypothesis = Hypothesis { sample: 0, t: 0.0, previous: 0.0, before, evidence: 0.0, looked: 0 };
        let work = Work {
            since: Moments::none(n + 2),
            law: [vec![0.0; n], vec![-1.0]].concat(),
            crossed: vec![[0.0; WIDTH]; n * n.div_ceil(WIDTH)],
            system: System::new(n),
            change: System::new(n),
        };
        Changes { hypotheses: vec![hypothesis; MOST], count: 0, work }
    }

    /// Forgets every hypothesis.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// The law may have changed between two samples, at times `previous` and `t`; `before` are the moments without
    /// the latter.
    pub fn suppose(&mut self, sample: u64, [previous, t]: [f64; 2], before: &Moments) {
        if self.count == MOST {
            self.thin(sample);
        }
        let slot = &mut self.hypotheses[self.count];
        slot.before.copy_from(before);
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
    pub fn look(&mut self, now: u64, total: &Moments, inflation: f64) {
        if self.count == 0 {
            return;
        }
        let best = self.likeliest();
        self.weigh(best, now, total, inflation);
        for _ in 1..LOOKS.min(self.count) {
            let waited =
                |hypothesis: &Hypothesis| (now + 1 - hypothesis.looked) as f64 / (now + 1 - hypothesis.sample) as f64;
            let all = self.hypotheses[..self.count].iter().enumerate();
            let longest = all.max_by(|a, b| waited(a.1).total_cmp(&waited(b.1))).map_or(0, |(index, _)| index);
            self.weigh(longest, now, total, inflation);
        }
    }

    /// Looks at every hypothesis.
    pub fn look_at_all(&mut self, now: u64, total: &Moments, inflation: f64) {
        (0..self.count).for_each(|index| self.weigh(index, now, total, inflation));
    }

    fn weigh(&mut self, index: usize, now: u64, total: &Moments, inflation: f64) {
        let hypothesis = &mut self.hypotheses[index];
        hypothesis.looked = now + 1;
        hypothesis.evidence = self.work.evidence(&hypothesis.before, total, inflation);
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
    pub fn cut(&self, switch: &Switch, total: &mut Moments) -> u64 {
        let hypothesis = &self.hypotheses[switch.place];
        total.merge(&hypothesis.before, -1.0);
        hypothesis.sample
    }
}

impl Work {
    /// The log Bayes factor of a change behind `before`.
    fn evidence(&mut self, before: &Moments, total: &Moments, inflation: f64) -> f64 {
        let n = self.law.len() - 1;
        let freedom = before.count - n as f64;
        if freedom < n as f64 {
            return f64::NEG_INFINITY;
        }
        self.solve(before);
        let least = floor(before.quadratic(&self.law), before.entry(n, n));
        self.since.copy_from(total);
        self.since.merge(before, -1.0);
        self.solve(total);
        self.marginalise();
        let squares = total.quadratic(&self.law).max(least);
        let rest = Rest { squares, power: 0.5 * (freedom + self.since.count) / inflation };
        self.mixture(before, rest, least / freedom * inflation)
    }

    /// The law of a record.
    fn solve(&mut self, record: &Moments) {
        record.load(self.law.len() - 1, &mut self.system);
        self.system.eliminate(ROUNDING);
        self.system.solve(&mut self.law);
    }

    /// Takes the law that both records share out of what those since tell: V and h, up to its sign. It needs no law of
    /// the record before, which may be anything where a term did nothing: differences of what that gives are rounding.
    fn marginalise(&mut self) {
        let Work { since, law, crossed, system, change } = self;
        let n = law.len() - 1;
        for (row, columns) in crossed.chunks_exact_mut(n.div_ceil(WIDTH)).enumerate() {
            let columns = columns.as_flattened_mut()[..n].iter_mut().enumerate();
            columns.for_each(|(column, entry)| *entry = since.entry(row, column));
        }
        system.forward(crossed);
        for row in 0..n {
            for column in row..n {
                change.row(row)[column] = since.entry(row, column) - system.product(crossed, [row, column]);
            }
        }
        change.set_right((0..n).map(|row| since.row_times(row, law)));
    }

    /// Even chances of a switch of all coefficients, and of one alone, any; `variance` is σ² with all that inflates it.
    /// Of a coefficient whose term had no force so far the law knows nothing: it is not seen to change.
    fn mixture(&mut self, before: &Moments, rest: Rest, variance: f64) -> f64 {
        let Work { since, law, change, .. } = self;
        let n = law.len() - 1;
        let (mut singles, mut widths) = (f64::NEG_INFINITY, 0.0);
        for row in 0..n {
            // T ÷ σ²
            let width = SWITCH_SIZE * SWITCH_SIZE * before.entry(n, n) / (before.entry(row, row) * variance);
            let entries = change.row(row);
            let (own, h) = (entries[row], entries[n]);
            if !(width.is_normal() && own > OWN * since.entry(row, row)) {
                change.isolate(row);
                singles = log_sum(singles, 0.0);
                continue;
            }
            entries[row] += width.recip();
            let single = rest.evidence(h * h / (own + width.recip())) - 0.5 * (own * width).ln_1p();
            (singles, widths) = (log_sum(singles, single), widths + width.ln());
        }
        change.eliminate(0.0);
        let all = rest.evidence(change.squares()) - 0.5 * (change.log_determinant() + widths);
        log_sum(all, singles - (n as f64).ln()) - std::f64::consts::LN_2
    }
}

impl Rest {
    /// What it is worth to explain so much of the squares.
    fn evidence(&self, gained: f64) -> f64 {
        self.power * (self.squares / (self.squares - gained).max(f64::MIN_POSITIVE)).ln()
    }
}

/// What a law leaves of that sum of squares, but no less than it loses to rounding.
fn floor(loss: f64, squares: f64) -> f64 {
    const ROUNDING: f64 = 1e-14;
    loss.max(ROUNDING * squares).max(f64::MIN_POSITIVE)
}
