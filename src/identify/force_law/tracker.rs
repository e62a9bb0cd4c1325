//! The identifier of a law whose force is the output, sample by sample.

use super::changes::{Changes, Switch};
use super::features::is_weighable;
use super::segment::{COHERENT, Segment};
use crate::estimation::{FixedLagSmoother, Instant, LONGEST, MotionNoise};
use crate::identify::change::SUSPENSE;
use crate::identify::deviation::Deviation;
use crate::identify::problem::Problem;
use crate::identify::report::{Coefficient, Output, Status};
use crate::identify::sample::Sample;
use crate::identify::settings::Settings;
use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};

/// Samples from which the sensors' noise and the motion's smoothness are estimated first; again whenever there are a
/// quarter more.
const FIRST: usize = 64;

/// So many of them, at least, are of a motion.
const MOVING: u32 = 32;

/// Part by which a longer wait may still lower the variance of a residual.
const GAIN_OF_WAITING: f64 = 0.05;

/// Readings in a row that may stand alone; one more is no outlier.
const ALONE: usize = 2;

/// The law of the present stage and what it stands on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceTracker {
    noise: MotionNoise,
    smoother: FixedLagSmoother,
    /// The first samples, until the smoother can begin.
    first: ArrayVec<Sample, FIRST>,
    next_look: u64,
    lag: usize,
    /// Instants taken from the smoother.
    passed: u64,
    /// Instants that may be outliers.
    alone: ArrayVec<Instant, ALONE>,
    stage: Segment,
    changes: Changes,
    deviation: Deviation,
    /// Sample of the stage since which a switch is suspected.
    suspected: Option<u64>,
    /// Time of the last instant used.
    previous: f64,
}

/// What a step is taken with, and where it tells of a switch.
struct Step<'a> {
    problem: &'a Problem,
    settings: &'a Settings,
    now: f64,
    output: &'a mut Output,
}

impl ForceTracker {
    /// In its initial state.
    pub fn new(problem: &Problem, settings: &Settings) -> ForceTracker {
        ForceTracker {
            noise: MotionNoise::new(settings.channels.of_motion(), settings.sample_time),
            smoother: FixedLagSmoother::new(),
            first: ArrayVec::new(),
            next_look: FIRST as u64,
            lag: LONGEST,
            passed: 0,
            alone: ArrayVec::new(),
            stage: Segment::new(problem, settings.noise_excitation),
            changes: Changes::new(problem.n()),
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
        if ![sample.q, sample.qd, sample.excitation].into_iter().all(is_weighable) {
            return;
        }
        self.noise.add(sample.t, [sample.q, sample.qd]);
        let mut step = Step { problem, settings, now: sample.t, output };
        if self.smoother.count() > 0 {
            self.advance(&mut step, sample);
        } else {
            self.wait(&mut step, sample);
        }
        self.stage.publish(problem, coefficients);
        self.publish(sample.t, output);
        self.predict(problem, settings, sample, output);
    }

    /// What the present stage cannot determine.
    pub fn unidentifiable(&self, problem: &Problem) -> Vec<String> {
        self.stage.open(problem)
    }

    /// Keeps the first samples until they tell what the sensors are; of a machine that stands still the last ones.
    fn wait(&mut self, step: &mut Step, sample: Sample) {
        if self.first.is_full() {
            self.first.remove(0);
        }
        self.first.push(sample);
        if self.first.is_full() && self.noise.has_seen(MOVING) {
            self.previous = self.first[0].t;
            self.stage.start = self.previous;
            self.believe(step.settings);
            std::mem::take(&mut self.first).into_iter().for_each(|sample| self.advance(step, sample));
        }
    }

    /// Renews what is believed of the sensors.
    fn believe(&mut self, settings: &Settings) {
        self.noise.likeliest(settings.given_noise()).into_iter().for_each(|channels| self.smoother.believe(channels));
        self.next_look += self.next_look.div_ceil(4);
    }

    fn advance(&mut self, step: &mut Step, sample: Sample) {
        if self.smoother.count() >= self.next_look {
            self.believe(step.settings);
            self.lag = self.worthwhile_lag();
        }
        self.smoother.add(sample.t, [sample.q, sample.qd], sample.excitation);
        while self.smoother.count() > self.passed + self.lag as u64 {
            let behind = (self.smoother.count() - 1 - self.passed) as usize;
            self.passed += 1;
            self.smoother.at(behind).into_iter().for_each(|instant| self.take(step, instant));
        }
    }

    /// The shortest lag whose residual has hardly more variance than the longest one's.
    fn worthwhile_lag(&self) -> usize {
        let variance = |lag: usize| self.smoother.at(lag).map_or(0.0, |instant| instant.covariance[2]);
        let (least, present) = (variance(LONGEST), variance(self.lag));
        let Some(white) = self.stage.white.filter(|_| present > 0.0) else { return LONGEST };
        let by_motion = COHERENT * self.stage.of_motion / present;
        let enough =
            |lag: &usize| white + by_motion * variance(*lag) <= (1.0 + GAIN_OF_WAITING) * (white + by_motion * least);
        (0..LONGEST).find(enough).unwrap_or(LONGEST)
    }

    /// Holds back what stands alone.
    fn take(&mut self, step: &mut Step, instant: Instant) {
        let expected = self.stage.expected(step.problem, &instant);
        let is_far = expected.is_some_and(|expected| self.stage.is_outlier(&instant, &expected));
        if is_far && !self.alone.is_full() {
            self.alone.push(instant);
            return;
        }
        let alone = std::mem::take(&mut self.alone);
        alone.into_iter().filter(|_| is_far).for_each(|instant| self.use_instant(step, instant));
        self.use_instant(step, instant);
    }

    fn use_instant(&mut self, step: &mut Step, instant: Instant) {
        let stage = &mut self.stage;
        let Some(expected) = stage.expected(step.problem, &instant) else { return };
        self.changes.suppose(stage.samples, [self.previous.max(stage.start), instant.t], &stage.sums);
        self.previous = instant.t;
        let block_is_full = stage.add(step.problem, &instant, &expected);
        self.changes.look(stage.samples, &stage.sums, stage.inflation());
        let evidence = self.changes.evidence();
        let level = (step.settings.false_alarm_interval / step.settings.sample_time).ln().max(0.0);
        if stage.established && evidence > level {
            self.changes.look_at_all(stage.samples, &stage.sums, stage.inflation());
            if let Some(switch) = self.changes.switch() {
                self.switch(step, switch);
                return;
            }
        }
        self.suspected = match self.suspected {
            since if stage.established && evidence > 0.5 * level => since.or(Some(stage.samples)),
            _ => None,
        };
        let suspended = self.suspected.is_some_and(|since| stage.samples < since + SUSPENSE);
        if block_is_full || !suspended {
            stage.solve(step.problem, block_is_full);
        }
        // a switch at any instant of the record, each as likely, against none
        if evidence < (stage.samples as f64).ln() {
            stage.establish();
        }
    }

    /// A new stage, of what came since.
    fn switch(&mut self, step: &mut Step, switch: Switch) {
        let first = self.changes.cut(&switch, &mut self.stage.sums);
        self.changes.clear();
        self.suspected = None;
        self.stage.begin_anew(switch.time, first, step.problem);
        let output = &mut step.output;
        output.switch_count += 1;
        output.switch_time = switch.time;
        output.switch_time_std = Some(switch.std);
        output.detection_time = Some(step.now);
        output.named_time = output.detection_time;
        output.identified_time = None;
    }

    fn publish(&self, now: f64, output: &mut Output) {
        let stage = &self.stage;
        output.valid = stage.is_valid() && self.suspected.is_none();
        if output.valid && output.identified_time.is_none() {
            output.identified_time = Some(now);
        }
        output.explained = stage.explained();
        output.status = match (self.suspected, stage.established, output.switch_count) {
            (Some(_), ..) => Status::SwitchSuspected,
            (None, true, _) => Status::Tracking,
            (None, false, 0) => Status::Acquiring,
            (None, false, _) => Status::ReIdentifying,
        };
        output.noise.force = stage.white.filter(|_| !stage.is_coloured()).map(f64::sqrt);
        [output.noise.q, output.noise.qd] = self.smoother.noise();
    }

    /// The force that the law gives for the last sample, and how far it is off on the mean.
    fn predict(&mut self, problem: &Problem, settings: &Settings, sample: Sample, output: &mut Output) {
        let Some(instant) = self.smoother.at(0).filter(|_| self.stage.white.is_some()) else { return };
        let expected = self.stage.expected(problem, &instant).filter(|expected| is_weighable(expected.force));
        let Some(expected) = expected else { return };
        output.prediction.force = expected.force;
        self.deviation.add(sample.t, (expected.force - sample.excitation).abs());
        output.deviation = self.deviation.mean();
        output.threshold = match settings.deviation_threshold {
            0.0 => self.stage.unusual_deviation(expected.of_motion, settings),
            threshold => threshold,
        };
    }
}
