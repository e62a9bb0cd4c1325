//! What is to be said of the stream of samples that a host feeds: one warning when a condition begins, with its time,
//! and the condition as an output as long as it lasts.

use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};
use switchid::identify::{Sample, Skipped};
use switchid_fmu_slave::{Log, seconds};

/// A condition lasts until this many samples came without it; what shows only by its absence (motion, a connection) has
/// to be absent for as many: at the publication's step its interval T.
const SPAN: u64 = 500;

/// Samples below which a mean says nothing of a period.
const FEW: f64 = 8.0;

/// Samples over which means are taken.
const MEMORY: f64 = 4000.0;

/// ω dt at six samples a natural period: a cubic law answers with the third harmonic, which needs two samples a period.
const COARSE: f64 = PI / 3.0;

/// A condition of the stream, in the order in which the worst is shown; numbered from 2 in the FMU, 1 being none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Condition {
    NotANumber,
    NotConnected,
    NoMotion,
    NotFresh,
    Thinned,
    TooFarApart,
    TooCoarse,
}

/// As many as there are.
const COUNT: usize = 7;

/// What has been seen of the stream.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Watch {
    number: u64,
    last: Option<Sample>,
    /// The sample that the identifier keeps until the next one tells whether its time is right.
    waiting: Option<Sample>,
    connected: bool,
    /// Number of the last sample at which q or qd had changed.
    moved: u64,
    motion: Motion,
    /// Number of the last sample that each condition held at, where it lasts.
    lasting: [Option<u64>; COUNT],
}

/// Means over the accepted samples, with forgetting.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Motion {
    count: f64,
    mean: f64,
    variance: f64,
    velocity: f64,
    dt: f64,
}

impl Motion {
    fn take(&mut self, before: &Sample, sample: &Sample) {
        self.count = (self.count + 1.0).min(MEMORY);
        let share = 1.0 / self.count;
        let distance = sample.q - self.mean;
        self.mean += share * distance;
        self.variance += share * (distance * (sample.q - self.mean) - self.variance);
        self.velocity += share * (sample.qd * sample.qd - self.velocity);
        self.dt += share * (sample.t - before.t - self.dt);
    }

    /// rms q̇ ÷ rms q, rad/s: right whatever the step is, and noise moves it little; `None` before there is a motion.
    fn frequency(&self) -> Option<f64> {
        let known = self.count >= FEW && self.variance > 0.0;
        known.then(|| (self.velocity / self.variance).sqrt()).filter(|omega| omega.is_finite())
    }
}

impl Watch {
    /// Takes a sample as the host gave it, with what the identifier said of it, and the time of the one that waits.
    pub fn take(&mut self, sample: &Sample, outcome: &Result<(), Skipped>, waiting: Option<f64>, log: &mut Log) {
        if let Some(waited) = self.waiting.filter(|waited| Some(waited.t) != waiting) {
            self.waiting = None;
            if !matches!(outcome, Err(Skipped::Ahead { .. })) {
                self.take_after_gap(&waited, log);
            }
        }
        if waiting == Some(sample.t) {
            self.waiting = Some(*sample);
        } else {
            self.follow(sample, outcome, log);
        }
    }

    fn follow(&mut self, sample: &Sample, outcome: &Result<(), Skipped>, log: &mut Log) {
        self.number += 1;
        self.forget();
        match outcome {
            Err(Skipped::NotFinite { .. }) => return self.raise(Condition::NotANumber, sample.t, log, String::new),
            Err(Skipped::NotLater { .. }) => return,
            Err(Skipped::TooSoon { .. }) => self.raise(Condition::Thinned, sample.t, log, || THINNED.into()),
            // what it repeats is looked for below
            Err(Skipped::Repeated { .. }) => {}
            Err(Skipped::Interpolated { .. }) => {
                self.raise(Condition::NotFresh, sample.t, log, || INTERPOLATED.into());
                self.take_accepted(sample, log);
            }
            // of the sample before, which this one shows to have a wrong time
            Ok(()) | Err(Skipped::Ahead { .. }) => self.take_accepted(sample, log),
        }
        self.look_for_change(sample, log);
        self.last = Some(*sample);
    }

    /// Number of the condition that is to be shown; 1 where all is well.
    pub fn shown(&self) -> i32 {
        let worst = self.lasting.iter().position(Option::is_some);
        worst.map_or(1, |place| place as i32 + 2)
    }

    fn take_accepted(&mut self, sample: &Sample, log: &mut Log) {
        let Some(before) = self.last else { return };
        let usual = self.motion.dt;
        self.motion.take(&before, sample);
        self.judge_distance(sample.t, sample.t - before.t, usual, log);
    }

    /// A gap says nothing of the steps that the host takes.
    fn take_after_gap(&mut self, sample: &Sample, log: &mut Log) {
        self.number += 1;
        if let Some(before) = self.last {
            self.judge_distance(sample.t, sample.t - before.t, self.motion.dt, log);
        }
        self.look_for_change(sample, log);
        self.last = Some(*sample);
    }

    /// Whether the usual step, or this one, is too long for the motion.
    fn judge_distance(&mut self, t: f64, dt: f64, usual: f64, log: &mut Log) {
        let Some(omega) = self.motion.frequency() else { return };
        let (period, mean) = (TAU / omega, self.motion.dt);
        if omega * mean > COARSE {
            let samples = period / mean;
            self.raise(Condition::TooCoarse, t, log, || {
                format!(
                    "the motion has only {samples:.1} samples in a natural period of {period:.3} s: the law needs six or more, take \
                     shorter communication steps"
                )
            });
        } else if omega * dt > COARSE && dt > usual {
            let text = || format!("no sample for {} s, in a motion of natural period {period:.3} s", seconds(dt));
            self.raise(Condition::TooFarApart, t, log, text);
        }
    }

    fn look_for_change(&mut self, sample: &Sample, log: &mut Log) {
        let inputs = |sample: &Sample| [sample.q, sample.qd, sample.excitation];
        self.connected |= inputs(sample).iter().any(|value| *value != 0.0);
        let Some(before) = self.last else { return };
        let still = before.q == sample.q && before.qd == sample.qd;
        if !still {
            self.moved = self.number;
        }
        let waited = self.number - self.moved > SPAN;
        if waited && !self.connected {
            self.raise(Condition::NotConnected, sample.t, log, || NOT_CONNECTED.into());
        } else if waited {
            self.raise(Condition::NoMotion, sample.t, log, || NO_MOTION.into());
        } else if still && sample.qd != 0.0 && inputs(&before) == inputs(sample) {
            self.raise(Condition::NotFresh, sample.t, log, || NOT_FRESH.into());
        }
    }

    fn raise(&mut self, condition: Condition, t: f64, log: &mut Log, text: impl FnOnce() -> String) {
        let begins = self.lasting[condition as usize].replace(self.number).is_none();
        // the identifier's own words tell of a sample that is no number, by channel
        if begins && condition != Condition::NotANumber {
            log.warn_of_onset(condition.key(), || format!("t = {} s: {}", seconds(t), text()));
        }
    }

    /// Lets go of conditions that are over.
    fn forget(&mut self) {
        for seen in &mut self.lasting {
            *seen = seen.filter(|seen| self.number - seen <= SPAN);
        }
    }
}

impl Condition {
    fn key(self) -> &'static str {
        match self {
            Condition::NotANumber => "stream: not a number",
            Condition::NotConnected => "stream: not connected",
            Condition::NoMotion => "stream: no motion",
            Condition::NotFresh => "stream: not fresh",
            Condition::Thinned => "stream: thinned",
            Condition::TooFarApart => "stream: too far apart",
            Condition::TooCoarse => "stream: too coarse",
        }
    }
}

const THINNED: &str = "samples come closer than half of sample_time and are left out: set sample_time to the step of the simulation to use all of them";
const NOT_CONNECTED: &str = "q, qd and F have been 0 since the start: are they connected?";
const NO_MOTION: &str = "q and qd have not changed for 500 samples: without motion there is nothing to identify";
const INTERPOLATED: &str = "q, qd and F lie on the line between the steps before and after: they are interpolated, and what was sent \
                            between two readings is left out; take the communication step of what sends them";
const NOT_FRESH: &str = "q, qd and F are bit by bit those of the step before, though the velocity is not 0: they are held or stuck; take the \
                         communication step of what sends them";
