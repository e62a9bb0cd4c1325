//! Faults of sensors, clocks and masters, put into readings.

use crate::{NOISE, SWITCH};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ops::Range;
use switchid::simulate::{Builtin, Reading, Scenario, Stage};

/// Sizes of a burst's readings, in σ.
const SIZES: [f64; 6] = [3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];

/// Samples of a short burst.
const SHORT: [usize; 5] = [2, 3, 5, 10, 20];

/// Readings of a burst to one side, at most.
const LONG: usize = 50;

/// An offset that a sensor returns with, m.
const OFFSET: f64 = 0.05;

/// One of any size, in σ, below the motion's own; the gap before it, s, where there is one.
const OFFSETS: [f64; 2] = [6.0, 200.0];
const GAPS: [f64; 2] = [0.1, 4.0];

/// Where a channel is cut off, as a part of its largest value.
const CUT: [f64; 2] = [0.6, 0.97];

/// How far a stamp is ahead, s.
const AHEAD: [f64; 2] = [0.01, 0.2];

/// What F reads that is far beyond its range, in its largest value.
const BEYOND: f64 = -10.0;

/// A glitch of F, in amplitudes.
const GLITCH: f64 = 2.5;

/// How long coefficients move, and how long q and q̇ are dead over a switch, s.
const DRIFT: f64 = 5.0;
const DEAD: f64 = 5.0;

/// By how much each coefficient moves at most, as the logarithm of a factor.
const MOVES: f64 = 0.35;

/// Parts of a second in which a law that moves stands still.
const STEPS: f64 = 20.0;

/// Share of the samples for which a sender has nothing new.
const REPEATED: f64 = 0.1;

/// Share of a flaky sensor's readings that are wide draws.
const FLAKY: f64 = 0.01;

/// A channel, both of the motion, or every one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    Q,
    Qd,
    Both,
    F,
    All,
}

/// What happens to a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Nothing.
    Clean,
    /// 2 to 20 readings are wide draws of 3 to 1000 σ.
    Burst(Of),
    /// 50 readings of both channels are.
    LongBurst,
    /// Up to 50 readings are off by as much, all to one side.
    OneSided(Of),
    /// One reading in a hundred of either channel is, to the record's end.
    Flaky,
    /// The reading stays as it is for 1 s.
    Stuck(Of),
    /// F stays as it is for so many ms, and varies again.
    StuckFor(u32),
    /// The reading is 0 for 1 s.
    Zero(Of),
    /// q and q̇ are 0 for 5 s, in the midst of which the law switches.
    Dead,
    /// The reading stays within a part of its range for 1 s.
    Cut(Of),
    /// F is ten times its largest value for 1 s.
    Far,
    /// One F is 2.5 amplitudes off.
    Glitch,
    /// 2 to 20 of them are, each by its own.
    GlitchBurst,
    /// One F is 1e100.
    HugeForce,
    /// Ten q are 1e300.
    HugeDisplacement,
    /// Every channel is NaN for 5 s.
    NotANumber,
    /// No samples for this many s.
    Gap(u32),
    /// No samples for this many ms, in the midst of which the law switches.
    Hidden(u32),
    /// No samples in the first fifth of every second.
    Gaps,
    /// One reading in ten repeats the last one.
    Repeated(Of),
    /// One reading in so many is read, throughout: the last one stands for the others.
    Seldom(Of, usize),
    /// The displacement is off by 0.05 from a gap of 1 s on.
    Offset,
    /// The displacement is off by 0.05 from a sample on.
    Jump,
    /// The readings are off by 6 to 200 σ from a sample on, before which 0.1 to 4 s may be missing.
    Off(Of, bool),
    /// One time stamp is 1e6.
    Stamp,
    /// One time stamp is 10 to 200 ms ahead.
    Ahead,
    /// The sender starts again after so many ms, its clock at 0.
    Restarts(u32),
    /// q and q̇ come one sample late against F, throughout.
    Late,
    /// Channels come so many samples late from a sample on.
    ComesLate(Of, usize),
    /// One sample in so many is kept: F moves within the step, and is not held.
    Coarse(usize),
    /// The plant has this effect throughout, and the law lacks it.
    Lacks(&'static str),
    /// All coefficients move for 5 s, by up to 35 %, and rest.
    Drifts,
}

impl Fault {
    /// All of them, in the order of the table.
    pub const ALL: [Fault; 61] = [
        Fault::Clean,
        Fault::Burst(Of::Q),
        Fault::Burst(Of::Qd),
        Fault::Burst(Of::Both),
        Fault::LongBurst,
        Fault::OneSided(Of::Q),
        Fault::OneSided(Of::Qd),
        Fault::Flaky,
        Fault::Stuck(Of::Q),
        Fault::Stuck(Of::Qd),
        Fault::Stuck(Of::F),
        Fault::Stuck(Of::All),
        Fault::StuckFor(50),
        Fault::StuckFor(200),
        Fault::Zero(Of::Q),
        Fault::Zero(Of::Qd),
        Fault::Zero(Of::Both),
        Fault::Zero(Of::F),
        Fault::Dead,
        Fault::Cut(Of::Q),
        Fault::Cut(Of::Qd),
        Fault::Far,
        Fault::Glitch,
        Fault::GlitchBurst,
        Fault::HugeForce,
        Fault::HugeDisplacement,
        Fault::NotANumber,
        Fault::Gap(1),
        Fault::Gap(5),
        Fault::Hidden(200),
        Fault::Hidden(1000),
        Fault::Hidden(5000),
        Fault::Gaps,
        Fault::Repeated(Of::F),
        Fault::Repeated(Of::All),
        Fault::Repeated(Of::Qd),
        Fault::Seldom(Of::Qd, 5),
        Fault::Seldom(Of::Both, 5),
        Fault::Offset,
        Fault::Jump,
        Fault::Off(Of::Q, true),
        Fault::Off(Of::Qd, true),
        Fault::Off(Of::Q, false),
        Fault::Off(Of::Qd, false),
        Fault::Stamp,
        Fault::Ahead,
        Fault::Restarts(300),
        Fault::Late,
        Fault::ComesLate(Of::F, 1),
        Fault::ComesLate(Of::F, 2),
        Fault::ComesLate(Of::Both, 1),
        Fault::Coarse(2),
        Fault::Coarse(5),
        Fault::Coarse(10),
        Fault::Coarse(20),
        Fault::Coarse(50),
        Fault::Lacks("coulomb_friction"),
        Fault::Lacks("quadratic_damping"),
        Fault::Lacks("bilinear_stiffness"),
        Fault::Lacks("signed_quadratic_stiffness"),
        Fault::Drifts,
    ];

    /// Its name in the table.
    pub fn id(self) -> String {
        match self {
            Fault::Clean => "clean".into(),
            Fault::Burst(of) => format!("burst of 2 to 20, {}", of.id()),
            Fault::LongBurst => "burst of 50, q and qd".into(),
            Fault::OneSided(of) => format!("1 to 50 to one side, {}", of.id()),
            Fault::Flaky => "one in 100 of q and qd".into(),
            Fault::Stuck(of) => format!("stuck 1 s, {}", of.id()),
            Fault::StuckFor(ms) => format!("stuck {} s, F", f64::from(ms) / 1000.0),
            Fault::Zero(of) => format!("zero 1 s, {}", of.id()),
            Fault::Dead => "zero 5 s over the switch, q and qd".into(),
            Fault::Cut(of) => format!("cut off 1 s, {}", of.id()),
            Fault::Far => "far beyond its range 1 s, F".into(),
            Fault::Glitch => "glitch of F".into(),
            Fault::GlitchBurst => "burst of 2 to 20, F".into(),
            Fault::HugeForce => "one F = 1e100".into(),
            Fault::HugeDisplacement => "ten q = 1e300".into(),
            Fault::NotANumber => "NaN 5 s".into(),
            Fault::Gap(seconds) => format!("gap {seconds} s"),
            Fault::Hidden(ms) => format!("gap {} s over the switch", f64::from(ms) / 1000.0),
            Fault::Gaps => "gap 0.2 s every second".into(),
            Fault::Repeated(of) => format!("one in 10 repeats the last, {}", of.id()),
            Fault::Seldom(of, every) => format!("read every {every} samples, {}", of.id()),
            Fault::Offset => "offset 0.05 of q after a gap".into(),
            Fault::Jump => "offset 0.05 of q".into(),
            Fault::Off(of, true) => format!("offset of 6 to 200 std after a gap, {}", of.id()),
            Fault::Off(of, false) => format!("offset of 6 to 200 std, {}", of.id()),
            Fault::Stamp => "one time stamp 1e6".into(),
            Fault::Ahead => "one time stamp ahead".into(),
            Fault::Restarts(ms) => format!("sender starts again after {} s", f64::from(ms) / 1000.0),
            Fault::Late => "q, qd one sample late".into(),
            Fault::ComesLate(of, by) => format!("{} {by} late from then on", of.id()),
            Fault::Coarse(step) => format!("steps of {step} ms, hold wrong"),
            Fault::Lacks(effect) => format!("lacks {effect}"),
            Fault::Drifts => "drifts 5 s and rests".into(),
        }
    }

    /// Whether it can happen to the plant: white noise that is sampled too seldom is not known at all.
    pub fn suits(self, plant: Builtin) -> bool {
        let white = matches!(plant, Builtin::DuffingWhite | Builtin::VanDerPolWhite);
        !(white && matches!(self, Fault::Coarse(_)))
    }

    /// How long it lasts, s; nothing where it is not a matter of time.
    fn lasts(self) -> f64 {
        match self {
            Fault::Stuck(_) | Fault::Zero(_) | Fault::Cut(_) | Fault::Far | Fault::Offset => 1.0,
            Fault::NotANumber => 5.0,
            Fault::Drifts => DRIFT,
            Fault::StuckFor(ms) | Fault::Restarts(ms) => 1e-3 * f64::from(ms),
            Fault::Gap(seconds) => f64::from(seconds),
            _ => 0.0,
        }
    }

    /// Lets the first law move from time `at` on where that is the fault.
    pub fn change(self, scenario: &mut Scenario, at: f64, seed: u64) {
        if self != Fault::Drifts {
            return;
        }
        let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0xd21f);
        let before = scenario.stages[0].clone();
        let factors: Vec<f64> =
            before.coefficients.iter().map(|_| generator.random_range(-MOVES..MOVES).exp()).collect();
        let steps = (STEPS * DRIFT) as usize;
        let moving = (1..=steps).map(|step| {
            let part = step as f64 / steps as f64;
            let mut stage = Stage { start: at + DRIFT * (part - 0.5 / steps as f64), ..before.clone() };
            stage
                .coefficients
                .iter_mut()
                .zip(&factors)
                .for_each(|(value, factor)| *value *= 1.0 + part * (factor - 1.0));
            stage
        });
        scenario.stages.splice(1..1, moving);
    }

    /// What the sender stamps at this time, where the fault begins at time `at`.
    pub fn stamp(self, t: f64, at: f64) -> f64 {
        match self {
            Fault::Restarts(_) if t >= at + self.lasts() => t - at - self.lasts(),
            _ => t,
        }
    }

    /// Puts it into the readings, from time `at` on; returns that of the last faulty one, s.
    pub fn apply(self, readings: &mut Vec<Reading>, at: f64, seed: u64) -> f64 {
        let mut generator = ChaCha8Rng::seed_from_u64(seed ^ 0xfa17);
        let first = readings.partition_point(|reading| reading.t < at);
        let last = readings.partition_point(|reading| reading.t < at + self.lasts());
        let in_a_row = self.spoil_some(readings, first, &mut generator);
        self.spoil_for_a_while(readings, first..last, &mut generator);
        self.lose(readings, at, first..last, &mut generator);
        self.spoil_for_good(readings, first, &mut generator);
        self.change_times(readings, first, &mut generator);
        match self {
            Fault::Stamp | Fault::Ahead | Fault::Dead | Fault::Hidden(_) | Fault::Gaps | Fault::Repeated(_) => at,
            Fault::Flaky
            | Fault::Late
            | Fault::Seldom(..)
            | Fault::ComesLate(..)
            | Fault::Coarse(_)
            | Fault::Lacks(_) => at,
            Fault::Offset | Fault::Jump | Fault::Off(..) => readings[first].t,
            _ => {
                let end = in_a_row.map_or(last, |count| first + count);
                readings[end.clamp(first + 1, readings.len()) - 1].t.min(at + self.lasts().max(0.05))
            }
        }
    }

    /// Some readings in a row; returns how many.
    fn spoil_some(self, readings: &mut [Reading], first: usize, generator: &mut ChaCha8Rng) -> Option<usize> {
        let count = match self {
            Fault::Burst(_) | Fault::GlitchBurst => SHORT[generator.random_range(0..SHORT.len())],
            Fault::OneSided(_) => generator.random_range(1..=LONG),
            Fault::LongBurst => LONG,
            Fault::HugeDisplacement => 10,
            Fault::Glitch | Fault::HugeForce => 1,
            _ => return None,
        };
        let most = Of::F.most(readings);
        let some = &mut readings[first..first + count];
        match self {
            Fault::Burst(of) => burst(some, of, generator),
            Fault::OneSided(of) => to_one_side(some, of, generator),
            Fault::LongBurst => burst(some, Of::Both, generator),
            Fault::HugeDisplacement => some.iter_mut().for_each(|reading| reading.q = 1e300),
            Fault::HugeForce => some[0].excitation = 1e100,
            _ => {
                for reading in some {
                    let size = if count > 1 { generator.random_range(0.5..1.5) } else { 1.0 };
                    reading.excitation += size * GLITCH * most * sign(generator);
                }
            }
        }
        Some(count)
    }

    /// All readings of a while.
    fn spoil_for_a_while(self, readings: &mut [Reading], of_it: Range<usize>, generator: &mut ChaCha8Rng) {
        let before = readings[of_it.start - 1];
        let zero = Reading { t: 0.0, q: 0.0, qd: 0.0, excitation: 0.0 };
        let most = match self {
            Fault::Cut(of) => of.most(readings) * generator.random_range(CUT[0]..CUT[1]),
            _ => Of::F.most(readings),
        };
        readings[of_it].iter_mut().for_each(|reading| match self {
            Fault::Stuck(of) => of.set(reading, &before),
            Fault::StuckFor(_) => Of::F.set(reading, &before),
            Fault::Zero(of) => of.set(reading, &zero),
            Fault::Cut(of) => of.change(reading, |value| value.clamp(-most, most)),
            Fault::Far => reading.excitation = BEYOND * most,
            Fault::NotANumber => Of::All.change(reading, |_| f64::NAN),
            _ => {}
        });
    }

    /// Samples that do not come.
    fn lose(self, readings: &mut Vec<Reading>, at: f64, of_it: Range<usize>, generator: &mut ChaCha8Rng) {
        match self {
            Fault::Gap(_) | Fault::Restarts(_) | Fault::Offset | Fault::Jump => drop(readings.drain(of_it)),
            Fault::Hidden(ms) => {
                let half = 0.5e-3 * f64::from(ms);
                readings.retain(|reading| (reading.t - SWITCH).abs() > half);
            }
            Fault::Gaps => readings.retain(|reading| reading.t < at || reading.t.fract() > 0.2),
            Fault::Off(_, true) => {
                let missing = log_uniform(GAPS, generator);
                readings.retain(|reading| !(at..at + missing).contains(&reading.t));
            }
            Fault::Coarse(step) => *readings = readings.iter().step_by(step).copied().collect(),
            _ => {}
        }
    }

    /// Readings to the record's end.
    fn spoil_for_good(self, readings: &mut [Reading], first: usize, generator: &mut ChaCha8Rng) {
        match self {
            Fault::Dead => {
                let is_dead = |reading: &&mut Reading| (reading.t - SWITCH).abs() < 0.5 * DEAD;
                readings.iter_mut().filter(is_dead).for_each(|reading| (reading.q, reading.qd) = (0.0, 0.0));
            }
            Fault::Flaky => {
                for reading in &mut readings[first..] {
                    for of in [Of::Q, Of::Qd] {
                        if generator.random_bool(FLAKY) {
                            burst(std::slice::from_mut(reading), of, generator);
                        }
                    }
                }
            }
            Fault::Repeated(of) => {
                for index in first..readings.len() {
                    let before = readings[index - 1];
                    if generator.random_bool(REPEATED) {
                        of.set(&mut readings[index], &before);
                    }
                }
            }
            Fault::Seldom(of, every) => {
                for index in 0..readings.len() {
                    let read = readings[index - index % every];
                    of.set(&mut readings[index], &read);
                }
            }
            Fault::Offset | Fault::Jump => readings[first..].iter_mut().for_each(|reading| reading.q += OFFSET),
            Fault::Off(of, _) => {
                let size = (NOISE * log_uniform(OFFSETS, generator)).min(of.most(readings));
                let offset = size * sign(generator);
                readings[first..].iter_mut().for_each(|reading| of.change(reading, |value| value + offset));
            }
            _ => {}
        }
    }

    /// Stamps, and channels that come late.
    fn change_times(self, readings: &mut [Reading], first: usize, generator: &mut ChaCha8Rng) {
        match self {
            Fault::Stamp => readings[first].t = 1e6,
            Fault::Ahead => readings[first].t += log_uniform(AHEAD, generator),
            Fault::Late => come_late(readings, 1, Of::Both, 1),
            Fault::ComesLate(of, by) => come_late(readings, first, of, by),
            _ => {}
        }
    }
}

impl Of {
    fn id(self) -> &'static str {
        match self {
            Of::Q => "q",
            Of::Qd => "qd",
            Of::Both => "q and qd",
            Of::F => "F",
            Of::All => "q, qd and F",
        }
    }

    fn set(self, reading: &mut Reading, from: &Reading) {
        match self {
            Of::Q => reading.q = from.q,
            Of::Qd => reading.qd = from.qd,
            Of::Both => (reading.q, reading.qd) = (from.q, from.qd),
            Of::F => reading.excitation = from.excitation,
            Of::All => *reading = Reading { t: reading.t, ..*from },
        }
    }

    /// Changes what is read of one channel, or of each.
    fn change(self, reading: &mut Reading, change: impl Fn(f64) -> f64) {
        if matches!(self, Of::Q | Of::Both | Of::All) {
            reading.q = change(reading.q);
        }
        if matches!(self, Of::Qd | Of::Both | Of::All) {
            reading.qd = change(reading.qd);
        }
        if matches!(self, Of::F | Of::All) {
            reading.excitation = change(reading.excitation);
        }
    }

    /// The largest value of one channel.
    fn most(self, readings: &[Reading]) -> f64 {
        let value = |reading: &Reading| match self {
            Of::Qd => reading.qd,
            Of::F => reading.excitation,
            _ => reading.q,
        };
        readings.iter().map(|reading| value(reading).abs()).fold(0.0, f64::max)
    }
}

fn log_uniform([from, to]: [f64; 2], generator: &mut ChaCha8Rng) -> f64 {
    generator.random_range(from.ln()..to.ln()).exp()
}

fn to_one_side(readings: &mut [Reading], of: Of, generator: &mut ChaCha8Rng) {
    let size = NOISE * SIZES[generator.random_range(0..SIZES.len())] * sign(generator);
    for reading in readings {
        let off = size * generator.random_range(0.5..1.5);
        of.change(reading, |value| value + off);
    }
}

fn burst(readings: &mut [Reading], of: Of, generator: &mut ChaCha8Rng) {
    let size = NOISE * SIZES[generator.random_range(0..SIZES.len())];
    for reading in readings {
        let off = [0, 1].map(|_| size * generator.random_range(0.5..1.5) * sign(generator));
        if of != Of::Qd {
            reading.q += off[0];
        }
        if of != Of::Q {
            reading.qd += off[1];
        }
    }
}

fn come_late(readings: &mut [Reading], first: usize, of: Of, by: usize) {
    for index in (first..readings.len()).rev() {
        let from = readings[index - by];
        of.set(&mut readings[index], &from);
    }
}

fn sign(generator: &mut ChaCha8Rng) -> f64 {
    if generator.random_bool(0.5) { 1.0 } else { -1.0 }
}
