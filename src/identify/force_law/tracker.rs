//! The identifier of a law whose force is the output, sample by sample.

use super::blocks::Blocks;
use super::changes::{Changes, Switch};
use super::features::expect;
use super::noise::{ChannelNoise, Smoothness};
use super::smoother::{Instant, LONGEST, Smoother};
use super::sums::{Sums, dot};
use crate::evidence::System;
use crate::identify::deviation::Deviation;
use crate::identify::identifier::{Coefficient, Output, Sample, Status};
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use serde::{Deserialize, Serialize};

/// Samples from which the sensors' noise and the motion's smoothness are estimated first; again whenever their number has doubled.
const FIRST: usize = 64;

/// Part by which a longer wait may still lower the variance of a residual.
const GAIN_OF_WAITING: f64 = 0.05;

/// Samples per unknown, at least, of a law in which a switch can be seen.
const RECORD: f64 = 8.0;

/// e of eq. (8) below which a law counts as known …
const SETTLED: f64 = 0.05 * 0.05;

/// … and the share of it that the stated covariance, an expectation, must stay below.
const MARGIN: f64 = 0.5;

/// Std of a residual beyond which a reading stands alone until others confirm it.
const FAR: f64 = 6.0;

/// Readings in a row that may stand alone; one more is no outlier.
const ALONE: usize = 2;

/// Least share of the residual's variance that is the force's own noise.
const OWN: f64 = 0.01;

/// Price of a term in twice the log-likelihood, ÷ ln of the number of samples (Schwarz's is 1; that of the tracker of motion).
const PRICE: f64 = 2.0;

/// Part of a term that another one must be for both to count as not told apart.
const TOUCHED: f64 = 1e-3;

/// Std by which neighbouring residuals may be correlated by chance: one in a thousand.
const SURPRISE: f64 = 3.1;

/// Largest correlation that is told from 1.
const MOST_ALIKE: f64 = 1.0 - 1e-6;

/// Samples over which mean squares are taken.
const MEMORY: f64 = 4000.0;

/// Samples for which a law is not renewed while a switch is suspected.
const SUSPENSE: u64 = 1000;

/// Std of a mean deviation by which it is out of the ordinary.
const UNUSUAL: f64 = 5.0;

/// The law of the present stage and what it stands on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceTracker {
    noises: [ChannelNoise; 2],
    smoothness: [Option<Smoothness>; 2],
    smoother: Smoother,
    /// The first samples, until the smoother can begin.
    first: Vec<Sample>,
    taken: usize,
    has_begun: bool,
    next_look: u64,
    lag: usize,
    /// Instants taken from the smoother.
    passed: u64,
    alone: [Instant; ALONE],
    waiting: usize,
    stage: Segment,
    changes: Changes,
    features: Vec<f64>,
    deviation: Deviation,
    suspected: Option<u64>,
    previous: f64,
}

/// The regression of one stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Segment {
    sums: Sums,
    blocks: Blocks,
    samples: u64,
    start: f64,
    system: System,
    /// Λ⁻¹ over the active terms.
    inverse: Vec<f64>,
    /// Free coefficients; all of them, with the known ones.
    free: Vec<f64>,
    all: Vec<f64>,
    active: Vec<bool>,
    every: Vec<bool>,
    /// Whether the record determines the coefficient.
    determined: Vec<bool>,
    /// Mean square of the residuals, their mean product with the one before, and what the motion's error makes of them.
    residual: f64,
    lagged: f64,
    of_motion: f64,
    means: f64,
    last_residual: f64,
    /// The force's own noise, variance; none before the first block.
    white: Option<f64>,
    established: bool,
}

impl ForceTracker {
    /// In its initial state.
    pub fn new(problem: &Problem, settings: &Settings) -> ForceTracker {
        let n = problem.n();
        ForceTracker {
            noises: [0, 1].map(|channel| ChannelNoise::new(channel, settings.sample_time)),
            smoothness: [None; 2],
            smoother: Smoother::new(),
            first: vec![Sample::default(); FIRST],
            taken: 0,
            has_begun: false,
            next_look: FIRST as u64,
            lag: LONGEST,
            passed: 0,
            alone: [Instant::default(); ALONE],
            waiting: 0,
            stage: Segment::new(problem),
            changes: Changes::new(n),
            features: vec![0.0; problem.terms.len()],
            deviation: Deviation::new(settings.deviation_interval, settings.sample_time),
            suspected: None,
            previous: 0.0,
        }
    }

    /// Takes one sample.
    pub fn step(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        sample: Sample,
        coefficients: &mut [Coefficient],
        output: &mut Output,
    ) {
        self.listen(problem, sample);
        if self.has_begun {
            self.advance(problem, settings, sample, output);
        } else {
            self.wait(problem, settings, sample, output);
        }
        self.publish(problem, settings, sample, coefficients, output);
    }

    /// Keeps the first samples until they tell what the sensors are; of a machine that stands still the last ones.
    fn wait(&mut self, problem: &Problem, settings: &Settings, sample: Sample, output: &mut Output) {
        if self.taken == FIRST {
            self.first.rotate_left(1);
            self.taken -= 1;
        }
        self.first[self.taken] = sample;
        self.taken += 1;
        let measured = [problem.channels.q, problem.channels.qd];
        let is_known = |(noise, measured): (&ChannelNoise, bool)| !measured || noise.count() >= FIRST / 2;
        if self.taken == FIRST && self.noises.iter().zip(measured).all(is_known) {
            self.has_begun = true;
            self.previous = self.first[0].t;
            self.stage.start = self.previous;
            self.believe(problem, settings);
            (0..FIRST).for_each(|index| self.advance(problem, settings, self.first[index], output));
        }
    }

    /// What the present stage cannot determine.
    pub fn unidentifiable(&self, problem: &Problem) -> Vec<String> {
        if self.stage.sums.count < RECORD * problem.n() as f64 { Vec::new() } else { self.stage.open(problem) }
    }

    /// The sensors' noise learns from every sample.
    fn listen(&mut self, problem: &Problem, sample: Sample) {
        let channels = problem.channels;
        for (noise, (measured, value)) in
            self.noises.iter_mut().zip([(channels.q, sample.q), (channels.qd, sample.qd)])
        {
            if measured {
                noise.add(sample.t, value);
            }
        }
    }

    /// Renews what is believed of the sensors and of how long it pays to wait.
    fn believe(&mut self, problem: &Problem, settings: &Settings) {
        let given = [settings.noise_q, settings.noise_qd];
        let measured = [problem.channels.q, problem.channels.qd];
        self.smoothness = [0, 1].map(|channel| {
            let found = self.noises[channel].likeliest().filter(|_| measured[channel])?;
            let given = Some(given[channel] * given[channel]).filter(|variance| *variance > 0.0);
            Some(Smoothness { variance: given.unwrap_or(found.variance), ..found })
        });
        self.smoother.believe(self.smoothness);
        self.next_look *= 2;
    }

    fn advance(&mut self, problem: &Problem, settings: &Settings, sample: Sample, output: &mut Output) {
        if self.smoother.count() >= self.next_look {
            self.believe(problem, settings);
            self.lag = self.worthwhile_lag();
        }
        self.smoother.add(sample.t, [sample.q, sample.qd], sample.excitation);
        while self.smoother.count() > self.passed + self.lag as u64 {
            let behind = (self.smoother.count() - 1 - self.passed) as usize;
            self.passed += 1;
            if let Some(instant) = self.smoother.at(behind) {
                self.take(problem, settings, instant, sample.t, output);
            }
        }
    }

    /// The shortest lag whose residual has hardly more variance than the longest one's.
    fn worthwhile_lag(&self) -> usize {
        let variance = |lag: usize| self.smoother.at(lag).map_or(0.0, |instant| instant.covariance[2]);
        let (least, present) = (variance(LONGEST), variance(self.lag));
        let Some(white) = self.stage.white.filter(|_| present > 0.0) else { return LONGEST };
        let by_motion = self.stage.of_motion / present;
        let enough = |lag: &usize| white + by_motion * variance(*lag) <= (1.0 + GAIN_OF_WAITING) * (white + by_motion * least);
        (0..LONGEST).find(enough).unwrap_or(LONGEST)
    }

    /// Holds back what stands alone.
    fn take(&mut self, problem: &Problem, settings: &Settings, instant: Instant, now: f64, output: &mut Output) {
        if self.is_far(problem, &instant) && self.waiting < ALONE {
            self.alone[self.waiting] = instant;
            self.waiting += 1;
            return;
        }
        let confirmed = self.is_far(problem, &instant);
        let waiting = std::mem::take(&mut self.waiting);
        if confirmed {
            (0..waiting).for_each(|index| self.use_instant(problem, settings, self.alone[index], now, output));
        }
        self.use_instant(problem, settings, instant, now, output);
    }

    fn is_far(&mut self, problem: &Problem, instant: &Instant) -> bool {
        let stage = &self.stage;
        if stage.white.is_none() || !stage.established {
            return false;
        }
        let of_motion = expect(&problem.terms, &stage.all, instant, &mut self.features);
        let residual = instant.force - dot(&self.features, &stage.all);
        residual * residual > FAR * FAR * (stage.variance() + of_motion)
    }

    fn use_instant(&mut self, problem: &Problem, settings: &Settings, instant: Instant, now: f64, output: &mut Output) {
        let stage = &mut self.stage;
        let of_motion = expect(&problem.terms, &stage.all, &instant, &mut self.features);
        self.changes.suppose(stage.samples, [self.previous.max(stage.start), instant.t], &stage.sums);
        self.previous = instant.t;
        let block_is_full = stage.add(problem, &mut self.features, &instant, of_motion);
        self.changes.look(stage.samples, &stage.sums, &stage.every, stage.inflation());
        let evidence = self.changes.evidence();
        let level = (settings.false_alarm_interval / settings.sample_time).ln().max(0.0);
        if stage.established && evidence > level {
            if let Some(switch) = self.changes.switch() {
                self.switch(switch, now, problem, output);
                return;
            }
        }
        self.suspected = match self.suspected {
            since if stage.established && evidence > 0.5 * level => since.or(Some(stage.samples)),
            _ => None,
        };
        let suspended = self.suspected.is_some_and(|since| stage.samples < since + SUSPENSE);
        if block_is_full || !suspended {
            stage.solve(problem, block_is_full);
        }
        let enough = stage.sums.count >= RECORD * problem.n() as f64 && stage.blocks.verdict().is_known;
        stage.established |= enough && self.changes.largest() < 0.0;
    }

    /// A new stage, of what came since.
    fn switch(&mut self, switch: Switch, now: f64, problem: &Problem, output: &mut Output) {
        let first = self.changes.cut(&switch, &mut self.stage.sums);
        self.changes.clear();
        self.suspected = None;
        self.stage.begin_anew(switch.time, first, problem);
        output.switch_count += 1;
        output.switch_time = switch.time;
        output.switch_time_std = Some(switch.std);
        output.detection_time = Some(now);
        output.identified_time = None;
    }

    fn publish(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        sample: Sample,
        coefficients: &mut [Coefficient],
        output: &mut Output,
    ) {
        let stage = &self.stage;
        let is_valid = stage.is_valid();
        stage.publish(problem, coefficients, is_valid);
        output.valid = is_valid && self.suspected.is_none();
        if output.valid && output.identified_time.is_none() {
            output.identified_time = Some(sample.t);
        }
        output.explained = stage.explained(problem);
        output.status = match (self.suspected, stage.established, output.switch_count) {
            (Some(_), ..) => Status::SwitchSuspected,
            (None, true, _) => Status::Tracking,
            (None, false, 0) => Status::Acquiring,
            (None, false, _) => Status::ReIdentifying,
        };
        output.noise_force = stage.white.filter(|_| !stage.is_coloured()).map(f64::sqrt);
        let [q, qd] = self.smoothness.map(|channel| channel.map(|channel| channel.variance.sqrt()));
        (output.noise_q, output.noise_qd) = (q, qd);
        self.predict(problem, settings, sample, output);
    }

    /// The force that the law gives for the last sample, and how far it is off on the mean.
    fn predict(&mut self, problem: &Problem, settings: &Settings, sample: Sample, output: &mut Output) {
        let Some(instant) = self.smoother.at(0).filter(|_| self.stage.white.is_some()) else { return };
        let of_motion = expect(&problem.terms, &self.stage.all, &instant, &mut self.features);
        output.prediction_force = dot(&self.features, &self.stage.all);
        self.deviation.add(sample.t, (output.prediction_force - sample.excitation).abs());
        output.deviation = self.deviation.mean();
        output.threshold = match settings.deviation_threshold {
            0.0 => self.stage.unusual_deviation(of_motion, settings),
            threshold => threshold,
        };
    }
}

impl Segment {
    fn new(problem: &Problem) -> Segment {
        let n = problem.n();
        Segment {
            sums: Sums::none(n),
            blocks: Blocks::new(n),
            samples: 0,
            start: 0.0,
            system: System::new(n),
            inverse: vec![0.0; n * n],
            free: vec![0.0; n],
            all: problem.known.clone(),
            active: vec![true; n],
            every: vec![true; n],
            determined: vec![false; n],
            residual: 0.0,
            lagged: 0.0,
            last_residual: 0.0,
            of_motion: 0.0,
            means: 0.0,
            white: None,
            established: false,
        }
    }

    /// Goes on with the sums as they are, since sample `first`; what is known of the sensors stays.
    fn begin_anew(&mut self, start: f64, first: u64, problem: &Problem) {
        self.samples -= first;
        self.start = start;
        self.blocks.begin(&self.sums);
        self.active.fill(true);
        (self.established, self.means) = (false, 0.0);
        self.solve(problem, false);
    }

    /// Takes one instant, whose features stand in `features`; true where that filled a block.
    fn add(&mut self, problem: &Problem, features: &mut [f64], instant: &Instant, of_motion: f64) -> bool {
        let residual = instant.force - dot(features, &self.all);
        let held: f64 = dot(features, &problem.known);
        for (place, index) in problem.free.iter().enumerate() {
            features[place] = features[*index];
        }
        let (features, force) = (&features[..problem.n()], instant.force - held);
        let weight = self.white.map_or(1.0, |white| white / (white + of_motion));
        self.sums.add(features, force, weight);
        self.samples += 1;
        let last = std::mem::replace(&mut self.last_residual, residual);
        if self.samples as f64 > RECORD * features.len() as f64 {
            self.means = (self.means + 1.0).min(MEMORY);
            self.residual += (residual * residual - self.residual) / self.means;
            self.lagged += (residual * last - self.lagged) / self.means;
            self.of_motion += (of_motion - self.of_motion) / self.means;
        }
        let is_full = self.blocks.add(features, force, weight);
        if is_full && self.means > 0.0 {
            self.white = Some((self.residual - self.of_motion).max(OWN * self.residual)).filter(|white| *white > 0.0);
        }
        is_full
    }

    /// Solves for the coefficients; where `choose`, for the terms that the law has, and what the blocks say of it.
    fn solve(&mut self, problem: &Problem, choose: bool) {
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
            self.blocks.judge(&self.free, &self.inverse, &self.active, variance);
        }
        problem.scatter(&self.free, &mut self.all);
    }

    fn regress(&mut self) {
        self.sums.eliminate(&self.active, &mut self.system);
        self.system.solve(&mut self.free);
        self.system.invert(&mut self.inverse);
    }

    /// Drops the "maybe" term that is worth least, where it is not worth its price.
    fn drop_one(&mut self, problem: &Problem) -> bool {
        let n = self.free.len();
        let scale = self.variance() * self.inflation();
        let price = PRICE * self.sums.count.max(2.0).ln();
        let worth = |row: &usize| self.free[*row].powi(2) / (scale * self.inverse[row * n + row]);
        let candidates = (0..n).filter(|row| self.active[*row] && problem.maybe[*row]);
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
    fn variance(&self) -> f64 {
        let unknowns = self.active.iter().filter(|active| **active).count() as f64;
        let freedom = (self.sums.count - unknowns).max(1.0);
        let rounding = 1e-14 * self.sums.squares;
        (self.sums.loss(&self.free).max(rounding) / freedom).max(f64::MIN_POSITIVE)
    }

    /// Terms that nothing tells apart from others have no value of their own.
    fn find_determined(&mut self) {
        let n = self.free.len();
        self.determined.fill(true);
        let information = &self.sums.information;
        for unknown in (0..n).filter(|unknown| self.active[*unknown] && !self.system.is_solved(*unknown)) {
            let column = &information[unknown * n..(unknown + 1) * n];
            for other in (0..n).filter(|other| self.active[*other]) {
                // what the other solved term takes of this one, in units of their features
                let share = dot(&self.inverse[other * n..(other + 1) * n], column);
                let touched = share * share * information[other * n + other] > TOUCHED * TOUCHED * column[unknown];
                self.determined[other] &= other != unknown && !touched;
            }
        }
    }

    /// Combinations of terms that the record does not tell apart.
    fn open(&self, problem: &Problem) -> Vec<String> {
        let open = (0..self.free.len()).filter(|row| self.active[*row] && !self.determined[*row]);
        let open: Vec<usize> = open.collect();
        if open.is_empty() { Vec::new() } else { vec![problem.together(&open)] }
    }

    /// Std of a free coefficient: the sandwich where the rest is not white.
    fn std(&self, row: usize) -> Option<f64> {
        let n = self.free.len();
        let verdict = self.blocks.verdict();
        if !(verdict.is_known && self.determined[row]) {
            return None;
        }
        if !self.active[row] {
            return Some(0.0);
        }
        let white = self.variance() * self.inverse[row * n + row];
        let variance = if self.is_coloured() { verdict.covariance[row * n + row].max(white) } else { white };
        Some(variance.sqrt()).filter(|std| std.is_finite())
    }

    /// e of eq. (8) by the stated covariance.
    fn error(&self) -> Option<f64> {
        let squares = (0..self.free.len()).map(|row| self.std(row).map(|std| std * std)).sum::<Option<f64>>()?;
        let size: f64 = self.all.iter().map(|value| value * value).sum();
        (size > 0.0).then_some(squares / size)
    }

    /// Correlation of neighbouring residuals, where it is no chance.
    fn correlation(&self) -> f64 {
        let found = if self.residual > 0.0 { self.lagged / self.residual } else { 0.0 };
        if found * found * self.means > SURPRISE * SURPRISE { found.clamp(0.0, MOST_ALIKE) } else { 0.0 }
    }

    /// Samples that say as much as one independent sample: residuals that follow from one another say less, as those of an autoregression do
    /// (Bartlett, J. Royal Statistical Society 8 Suppl., 1946).
    fn inflation(&self) -> f64 {
        let correlation = self.correlation();
        self.blocks.verdict().inflation.max((1.0 + correlation) / (1.0 - correlation))
    }

    fn is_coloured(&self) -> bool {
        self.blocks.verdict().is_coloured || self.correlation() > 0.0
    }

    /// Whether the law explains its record down to white noise, holds throughout it, and is known.
    fn is_valid(&self) -> bool {
        let is_known = self.error().is_some_and(|error| error < MARGIN * SETTLED);
        self.established && self.blocks.verdict().is_known && !self.is_coloured() && is_known
    }

    /// Share of the force's variance that the law explains.
    fn explained(&self, problem: &Problem) -> Option<f64> {
        let spread = self.sums.spread();
        let is_known = self.blocks.verdict().is_known && problem.n() > 0 && spread > 0.0;
        is_known.then(|| (1.0 - self.sums.loss(&self.free) / spread).max(0.0))
    }

    fn publish(&self, problem: &Problem, coefficients: &mut [Coefficient], is_valid: bool) {
        for (row, index) in problem.free.iter().enumerate() {
            let std = self.std(row).filter(|std| is_valid || *std < self.free[row].abs() || !self.active[row]);
            let coefficient = &mut coefficients[*index];
            if std.is_some() {
                coefficient.value = self.free[row];
            }
            coefficient.std = std;
            coefficient.needed = if is_valid { Some(0.0) } else { None };
        }
        for index in (0..coefficients.len()).filter(|index| !problem.free.contains(index)) {
            coefficients[index].value = problem.known[index];
            coefficients[index].std = Some(0.0);
        }
    }

    /// A mean deviation that noise alone hardly gives.
    fn unusual_deviation(&self, of_motion: f64, settings: &Settings) -> f64 {
        let std = (self.variance() + of_motion).sqrt();
        let samples = (settings.deviation_interval / settings.sample_time / self.inflation()).max(1.0);
        let [mean, spread] = [std::f64::consts::FRAC_2_PI.sqrt(), (1.0 - std::f64::consts::FRAC_2_PI).sqrt()];
        std * (mean + UNUSUAL * spread / samples.sqrt())
    }
}
