//! One hypothesis of what happened: a filter of (q, q̇) and two unknowns under the law in use.
//!
//! x = (q, q̇, u₀, u₁). Under "the law changed" q̈ is the law's + u₀ + u₁ F ÷ m: over the few readings that decide, a
//! change of any coefficient is one of these two; u₀ then moves as the motion does, as a random walk that is as large
//! as it is after a radian of the motion. Under "F is stuck" u₀ is what acts less what is read, ÷ m, and forgets where
//! it was as F did. Under "a channel has an offset" u₀ is the offset. Where no law is known q̈ is u₀ + u₁ F under all
//! of them (`motion_alone`).

use super::expected::{Expected, delay};
use super::kind::Kind;
use super::price::{Burst, SCATTER, event, faulty, working};
use crate::estimation::{Channel, Filter};
use crate::law::{Drive, State};
use serde::{Deserialize, Serialize};

/// A reading of a channel beside how rare it is.
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// What was read.
    pub value: f64,
    /// −ln of how often the channel repeats a value, where it does and that is rare; 0 where it may rest.
    pub repeats: Option<f64>,
}

impl Value {
    /// Whether a working sensor would hardly have repeated it.
    pub fn is_rare(&self) -> bool {
        self.repeats.is_some_and(|nats| nats > 0.0)
    }
}

/// (q, q̇) as a law leaves them, with nothing unknown beside it.
pub fn under_law(filter: &Filter) -> Filter<4> {
    let ([q, qd], [[qq, qv], [vq, vv]]) = (filter.mean, filter.covariance);
    Filter { mean: [q, qd, 0.0, 0.0], covariance: [[qq, qv, 0.0, 0.0], [vq, vv, 0.0, 0.0], [0.0; 4], [0.0; 4]] }
}

/// Samples for which a change of law goes unnoticed, at most: those that the evidence of a large one needs.
const UNNOTICED: f64 = 3.0;

/// Probability that what befalls one channel begins in the other too: a loose plug, a logger that fails.
const SHARED: f64 = 0.05;

/// A stuck channel that varies is none, nats.
const VARIES: f64 = -40.0;

/// The filter of a hypothesis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hypothesis {
    pub kind: Kind,
    /// Of x.
    believed: Filter<4>,
    /// Log-likelihood of the readings since it began, with its prior.
    pub log: f64,
    /// Its log-odds against nothing when it began.
    pub prior: f64,
    /// By channel.
    pub bursts: [Burst; 2],
    /// Which readings are a sensor's fault: one bit a sample held, by channel.
    faulty: [u64; 2],
    /// Which are one if the next is.
    doubtful: [u64; 2],
    /// The state at every sample held.
    path: Vec<State>,
    /// Samples since it began.
    age: u32,
    /// How q̈ changed, where that is known of a law that did.
    change: Option<Change>,
}

/// What is known of (u₀, u₁): mean and covariance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Change([f64; 2], [[f64; 2]; 2]);

impl Change {
    /// Mean square of the acceleration where these multiply them.
    fn square(&self, [first, second]: [f64; 2]) -> f64 {
        let Change([acceleration, gain], [[aa, ag], [_, gg]]) = *self;
        let mean = first * acceleration + second * gain;
        mean * mean + first * first * aa + 2.0 * first * second * ag + second * second * gg
    }
}

impl Hypothesis {
    /// Room for so many samples held.
    pub fn new(kind: Kind, room: usize) -> Hypothesis {
        Hypothesis {
            kind,
            believed: Filter::default(),
            log: 0.0,
            prior: 0.0,
            bursts: [Burst::default(); 2],
            faulty: [0; 2],
            doubtful: [0; 2],
            path: vec![State::default(); room],
            age: 0,
            change: None,
        }
    }

    /// Begins at that state before a reading, with those log-odds against nothing, which is of that log-likelihood;
    /// `dt` is the time between two samples.
    pub fn begin(&mut self, believed: &Filter<4>, law: &Expected, dt: f64, nothing: f64, odds: f64) {
        self.believed = *believed;
        (self.log, self.prior, self.age) = (nothing + odds, odds, 0);
        self.bursts = [Burst::default(); 2];
        self.forget_held();
        let covariance = &mut self.believed.covariance;
        let [acceleration, gain] = law.switch;
        match self.kind {
            kind if law.alone.is_some() && !kind.can_be_told_by_motion() => self.log = f64::NEG_INFINITY,
            Kind::Law { times, unnoticed } => {
                let acceleration = f64::from(times) * acceleration;
                let since = if unnoticed { law.unnoticed.max(UNNOTICED * dt) } else { 0.0 };
                let square = acceleration * acceleration;
                covariance[0][0] += 0.25 * square * since.powi(4);
                covariance[1][1] += square * since * since;
                covariance[1][2] += square * since;
                covariance[2][1] += square * since;
                covariance[2][2] += square;
                covariance[3][3] += gain * gain;
            }
            Kind::Misfit => covariance[2][2] = law.misfit(),
            Kind::ForceStuck => self.suppose_stuck(law),
            Kind::Late(later) => {
                // a motion that begins to come late has stood still
                let [q, qd, ..] = &mut self.believed.mean;
                *q -= delay(law.lag, f64::from(later)) * dt * *qd;
            }
            Kind::Offset(channel) => covariance[2][2] = law.size[channel as usize].powi(2),
            _ => {}
        }
    }

    /// The law has changed by what is known now, should it begin once more.
    pub fn learn_change(&mut self) {
        let Filter { mean: [.., acceleration, gain], covariance: [.., of_acceleration, of_gain] } = self.believed;
        let tail = |[.., acceleration, gain]: [f64; 4]| [acceleration, gain];
        self.change = Some(Change([acceleration, gain], [tail(of_acceleration), tail(of_gain)]));
    }

    /// What the first reading of an offset costs: it tells how large that is, not that there is one, nats.
    pub fn learns(&self, channel: Channel, law: &Expected) -> f64 {
        let index = channel as usize;
        0.5 * (law.size[index].powi(2) / law.noise.sensor[index]).ln().max(0.0)
    }

    /// What acts has left F as it is read for as long as that stands still; what that did within the noise went unseen.
    fn suppose_stuck(&mut self, law: &Expected) {
        let Some(standing) = law.stuck else { return self.log += VARIES };
        let covariance = &mut self.believed.covariance;
        for (channel, variance) in law.noise.sensor.into_iter().enumerate() {
            covariance[channel][channel] = covariance[channel][channel].max(variance);
        }
        covariance[2][2] = law.drive * law.drive * (1.0 - standing.kept(standing.since).powi(2));
    }

    /// Forgets all of it: what says nothing any more takes no room in a saved state.
    pub fn clear(&mut self) {
        (self.believed, self.log, self.prior, self.age) = (Filter::default(), 0.0, 0.0, 0);
        self.change = None;
        self.bursts = [Burst::default(); 2];
        self.path.fill(State::default());
        self.forget_held();
    }

    /// Samples since it began.
    pub fn age(&self) -> usize {
        self.age as usize
    }

    /// The samples held have been let through.
    pub fn forget_held(&mut self) {
        (self.faulty, self.doubtful) = ([0; 2], [0; 2]);
    }

    /// Goes over an interval and takes the readings at its end, number `place` of those held.
    pub fn take(&mut self, law: &Expected, dt: f64, drive: &Drive, values: [Option<Value>; 2], place: usize) {
        self.predict(law, dt, drive);
        for channel in Channel::ALL {
            if let Some(value) = values[channel as usize] {
                let counts = self.read(channel, &value, law, event(dt));
                self.mark(channel, counts, event(dt), place);
            }
        }
        self.path[place] = self.state();
        self.age += 1;
        if !self.state().is_finite() || self.log.is_nan() {
            self.log = f64::NEG_INFINITY;
        }
    }

    /// Marks a reading, and where it is one of a burst those before that were too.
    fn mark(&mut self, channel: Channel, counts: bool, start: f64, place: usize) {
        let (index, burst) = (channel as usize, self.bursts[channel as usize]);
        self.faulty[index] |= u64::from(!counts) << place;
        self.doubtful[index] |= u64::from(burst.may_have_begun(start)) << place;
        let before = (0..place).rev().take_while(|place| self.doubtful[index] >> place & 1 == 1);
        if burst.is_on() {
            self.faulty[index] |= before.fold(0, |bits, place| bits | 1 << place);
        }
    }

    /// The state after the last reading.
    pub fn state(&self) -> State {
        self.believed.state()
    }

    /// The filter of (q, q̇) after the last reading.
    pub fn filter(&self) -> Filter {
        let ([q, qd, ..], [first, second, ..]) = (self.believed.mean, self.believed.covariance);
        Filter { mean: [q, qd], covariance: [[first[0], first[1]], [second[0], second[1]]] }
    }

    /// What others begin from: of a law the unknowns are the hypothesis's own, of a motion without one they are q̈.
    pub fn start(&self, law: &Expected) -> Filter<4> {
        if law.alone.is_some() { self.believed } else { under_law(&self.filter()) }
    }

    /// The state at a sample held.
    pub fn state_at(&self, place: usize) -> State {
        self.path[place]
    }

    /// Which readings are a sensor's fault: one bit a sample held, by channel.
    pub fn left_out(&self) -> [u64; 2] {
        self.faulty
    }

    /// Whether the channel's reading at a sample held is no fault of the sensor's.
    pub fn counts(&self, channel: Channel, place: usize) -> bool {
        self.faulty[channel as usize] >> place & 1 == 0
    }

    /// Probability that the channel is in a burst.
    pub fn burst(&self, channel: Channel) -> f64 {
        self.bursts[channel as usize].probability
    }

    /// The offset and its std.
    pub fn offset(&self) -> (f64, f64) {
        (self.believed.mean[2], self.believed.covariance[2][2].max(0.0).sqrt())
    }

    /// Goes over an interval.
    pub fn predict(&mut self, law: &Expected, dt: f64, drive: &Drive) {
        let drive = if self.kind.is_unread() && self.age == 0 { &Drive::Held(0.0) } else { drive };
        let act = match self.kind {
            _ if law.alone.is_some() => [true; 2],
            Kind::Law { .. } => [true; 2],
            Kind::Misfit | Kind::ForceStuck => [true, false],
            _ => [false; 2],
        };
        let (kind, first) = (self.kind, self.age == 0);
        let unknown =
            |inputs: [f64; 2]| kind.unknown(law, inputs, dt, first, self.change.map(|change| change.square(inputs)));
        law.advance(&mut self.believed, dt, drive, act, unknown);
        if self.kind == Kind::ForceStuck {
            self.follow_force(law, dt);
        }
    }

    /// What acts goes on as F did before it stood still.
    fn follow_force(&mut self, law: &Expected, dt: f64) {
        let Some(standing) = law.stuck else { return self.log += VARIES };
        let kept = standing.kept(dt);
        let Filter { mean, covariance } = &mut self.believed;
        mean[2] *= kept;
        covariance[2].iter_mut().for_each(|entry| *entry *= kept);
        covariance.iter_mut().for_each(|row| row[2] *= kept);
        covariance[2][2] += law.drive * law.drive * (1.0 - kept * kept);
    }

    /// Takes a reading, with which a burst begins at that probability; returns whether it is no fault of the sensor's.
    fn read(&mut self, channel: Channel, value: &Value, law: &Expected, start: f64) -> bool {
        let index = channel as usize;
        let offset = if self.kind == Kind::Offset(channel) { 1.0 } else { 0.0 };
        let Filter { mean, covariance } = &self.believed;
        let column: [f64; 4] = std::array::from_fn(|row| covariance[row][index] + offset * covariance[row][2]);
        let louder = if self.kind.is_louder(channel) { SCATTER * SCATTER } else { 1.0 };
        let variance = column[index] + offset * column[2] + louder * law.noise.sensor[index];
        let residual = value.value - mean[index] - offset * mean[2];
        let std = law.noise.sensor[index].sqrt();
        if self.kind.sticks(channel) {
            let faulty = faulty(residual, std);
            self.log += match value.repeats {
                // at rest it reads what a working one does
                Some(0.0) => working(0.0, law.noise.sensor[index]),
                Some(_) => 0.0,
                None if self.age == 0 => faulty,
                None => faulty + VARIES,
            };
            return false;
        }
        let repeats = value.repeats.unwrap_or(0.0);
        let to_one_side = self.kind == Kind::OneSided;
        let start = start.max(SHARED * self.bursts[1 - index].begun());
        self.log += self.bursts[index].take(working(residual, variance), residual, std, start, to_one_side) - repeats;
        if self.bursts[index].is_on() {
            return false;
        }
        self.update(column, residual, variance);
        // a reading with an offset tells the state by what it knows of the offset
        offset == 0.0
    }

    fn update(&mut self, column: [f64; 4], residual: f64, variance: f64) {
        let gain = column.map(|entry| entry / variance);
        let Filter { mean, covariance } = &mut self.believed;
        for ((mean, row), gain) in mean.iter_mut().zip(covariance).zip(gain) {
            *mean += gain * residual;
            row.iter_mut().zip(&column).for_each(|(entry, other)| *entry -= gain * other);
        }
    }
}
