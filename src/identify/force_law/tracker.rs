//! The identifier of a law whose force is the output, sample by sample.

use super::changes::{Changes, Switch};
use super::features::expect;
use super::noise::{ChannelNoise, Smoothness};
use super::segment::{COHERENT, Segment};
use super::smoother::{Instant, LONGEST, Smoother};
use crate::estimation::{Channel, OUTLYING, dot};
use crate::identify::change::SUSPENSE;
use crate::identify::deviation::Deviation;
use crate::identify::problem::Problem;
use crate::identify::report::{Coefficient, Output, Status};
use crate::identify::sample::Sample;
use crate::identify::settings::Settings;
use serde::{Deserialize, Serialize};

/// Samples from which the sensors' noise and the motion's smoothness are estimated first; again whenever there are a
/// quarter more.
const FIRST: usize = 64;

/// Part by which a longer wait may still lower the variance of a residual.
const GAIN_OF_WAITING: f64 = 0.05;

/// Numbers from which on sums of products of four overflow.
const LARGEST: f64 = 1e60;

/// Readings in a row that may stand alone; one more is no outlier.
const ALONE: usize = 2;

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

impl ForceTracker {
    /// In its initial state.
    pub fn new(problem: &Problem, settings: &Settings) -> ForceTracker {
        let n = problem.n();
        ForceTracker {
            noises: Channel::ALL.map(|channel| ChannelNoise::new(channel, settings.sample_time)),
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
            stage: Segment::new(problem).with_noise(settings.noise_excitation),
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
        if ![sample.q, sample.qd, sample.excitation].into_iter().all(is_weighable) {
            return;
        }
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
        self.stage.open(problem)
    }

    /// The sensors' noise learns from every sample.
    fn listen(&mut self, problem: &Problem, sample: Sample) {
        let channels = problem.channels;
        for (noise, (measured, value)) in self.noises.iter_mut().zip([(channels.q, sample.q), (channels.qd, sample.qd)])
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
        self.next_look += self.next_look.div_ceil(4);
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
        let by_motion = COHERENT * self.stage.of_motion / present;
        let enough =
            |lag: &usize| white + by_motion * variance(*lag) <= (1.0 + GAIN_OF_WAITING) * (white + by_motion * least);
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
        let of_motion = expect(problem, stage.known(), instant, &mut self.features);
        let residual = instant.force - dot(&self.features, &stage.all);
        residual * residual > OUTLYING * OUTLYING * (stage.variance() + of_motion)
    }

    fn use_instant(&mut self, problem: &Problem, settings: &Settings, instant: Instant, now: f64, output: &mut Output) {
        let stage = &mut self.stage;
        let of_motion = expect(problem, stage.known(), &instant, &mut self.features);
        if !(is_weighable(of_motion) && self.features.iter().copied().all(is_weighable)) {
            return;
        }
        self.changes.suppose(stage.samples, [self.previous.max(stage.start), instant.t], &stage.sums);
        self.previous = instant.t;
        let block_is_full = stage.add(problem, &self.features, &instant, of_motion);
        self.changes.look(stage.samples, &stage.sums, stage.inflation());
        let evidence = self.changes.evidence();
        let level = (settings.false_alarm_interval / settings.sample_time).ln().max(0.0);
        if stage.established && evidence > level {
            self.changes.look_at_all(stage.samples, &stage.sums, stage.inflation());
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
        // a switch at any instant of the record, each as likely, against none
        if evidence < (stage.samples as f64).ln() {
            stage.establish();
        }
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
        output.named_time = output.detection_time;
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
        output.noise.force = stage.white.filter(|_| !stage.is_coloured()).map(f64::sqrt);
        let [q, qd] = self.smoothness.map(|channel| channel.map(|channel| channel.variance.sqrt()));
        (output.noise.q, output.noise.qd) = (q, qd);
        self.predict(problem, settings, sample, output);
    }

    /// The force that the law gives for the last sample, and how far it is off on the mean.
    fn predict(&mut self, problem: &Problem, settings: &Settings, sample: Sample, output: &mut Output) {
        let Some(instant) = self.smoother.at(0).filter(|_| self.stage.white.is_some()) else { return };
        let of_motion = expect(problem, self.stage.known(), &instant, &mut self.features);
        let prediction = dot(&self.features, &self.stage.all);
        if !(is_weighable(prediction) && is_weighable(of_motion)) {
            return;
        }
        output.prediction.force = prediction;
        self.deviation.add(sample.t, (output.prediction.force - sample.excitation).abs());
        output.deviation = self.deviation.mean();
        output.threshold = match settings.deviation_threshold {
            0.0 => self.stage.unusual_deviation(of_motion, settings),
            threshold => threshold,
        };
    }
}

/// Whether products of the number with its like are numbers too.
fn is_weighable(number: f64) -> bool {
    number.abs() < LARGEST
}
