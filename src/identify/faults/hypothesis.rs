//! One hypothesis of what happened: a filter of (q, q̇) and two unknowns under the law in use.
//!
//! x = (q, q̇, u₀, u₁). Under "the law changed" q̈ is the law's + u₀ + u₁ F ÷ m: over the few readings that decide, a
//! change of any coefficient is one of these two; u₀ then moves as the motion does, as a random walk that is as large
//! as it is after a radian of the motion. Under "F is stuck" u₀ is what acts less what is read, ÷ m, and forgets where
//! it was as F did. Under "a channel has an offset" u₀ is the offset. Where no law is known q̈ is u₀ + u₁ F under all
//! of them (`motion_alone`).

use super::price::{Burst, SCATTER, event, faulty, working};
use crate::estimation::{Channel, Filter, Matrix, Noise, times, white_acceleration};
use crate::law::{Drive, Motion, State};
use crate::limits::SETTLED_ERROR;
use serde::{Deserialize, Serialize};

/// What may have happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// Nothing but readings that are wide draws, if any.
    Readings,
    /// Nothing but those, and the law in use is as wrong as a valid one may be.
    Misfit,
    /// The law changed so many samples before the first reading that is held, and q̈ by so many times what a switch
    /// usually adds.
    Law { before: u8, times: u8 },
    /// Something moved q̇, and q follows.
    Kick,
    /// What was read of F is not what acted: that was any force of its usual size.
    Glitch,
    /// F, which stands still, is not what acts: that goes on as F did before.
    ForceStuck,
    /// A channel has an offset.
    Offset(Channel),
    /// A channel repeats its value.
    Stuck(Channel),
    /// Both channels do.
    BothStuck,
    /// A channel scatters more than it did, and goes on to.
    Louder(Channel),
    /// Both channels do.
    BothLouder,
}

impl Kind {
    /// Every one of them, the least first.
    pub const ALL: [Kind; 16] = [
        Kind::Readings,
        Kind::Misfit,
        Kind::Law { before: 0, times: 1 },
        Kind::Law { before: 0, times: 10 },
        Kind::Law { before: 3, times: 1 },
        Kind::Kick,
        Kind::Glitch,
        Kind::ForceStuck,
        Kind::Offset(Channel::Q),
        Kind::Offset(Channel::Qd),
        Kind::Stuck(Channel::Q),
        Kind::Stuck(Channel::Qd),
        Kind::BothStuck,
        Kind::Louder(Channel::Q),
        Kind::Louder(Channel::Qd),
        Kind::BothLouder,
    ];

    /// Whether nothing has happened but readings that are wide draws.
    pub fn is_no_event(self) -> bool {
        matches!(self, Kind::Readings | Kind::Misfit)
    }

    /// Whether it can be told where no law is known: a change of law is one of q̈ there. An offset moves slowly in one
    /// channel, as its own course may, and a rest repeats both.
    pub fn can_be_told_by_motion(self) -> bool {
        !matches!(self, Kind::Misfit | Kind::ForceStuck | Kind::Offset(_) | Kind::BothStuck)
    }

    /// Whether it can be told apart where these channels are measured: a sensor that is not there does not fail.
    pub fn can_be_told(self, measured: [bool; 2]) -> bool {
        match self {
            Kind::Offset(channel) | Kind::Stuck(channel) | Kind::Louder(channel) => measured[channel as usize],
            Kind::BothStuck | Kind::BothLouder => measured == [true; 2],
            _ => true,
        }
    }

    /// Whether the channel repeats its value.
    pub fn sticks(self, channel: Channel) -> bool {
        self == Kind::BothStuck || self == Kind::Stuck(channel)
    }

    /// Whether the channel scatters more than it did.
    pub fn is_louder(self, channel: Channel) -> bool {
        self == Kind::BothLouder || self == Kind::Louder(channel)
    }

    /// Whether a channel does.
    pub fn is_loud(self) -> bool {
        matches!(self, Kind::Louder(_) | Kind::BothLouder)
    }

    /// Whether q̇ moved once by what no reading tells, and q follows.
    pub fn is_kick(self) -> bool {
        matches!(self, Kind::Kick | Kind::Glitch)
    }

    /// Intensity of the white acceleration that it adds in its own interval, the `first`, for when in it that was
    /// nobody knows, and what u₀ moves by in a second, as a variance.
    fn unknown(self, law: &Expected, inputs: [f64; 2], dt: f64, first: bool) -> [f64; 2] {
        let [acceleration, gain] = law.switch;
        match self {
            Kind::Law { times, .. } => {
                let acceleration = f64::from(times) * acceleration;
                let event = (acceleration * acceleration + (gain * inputs[1]).powi(2)) * dt;
                [if first { event } else { 0.0 }, acceleration * acceleration * law.rate]
            }
            Kind::Misfit => [0.0, law.misfit() * law.rate],
            Kind::Kick if first => [law.size[1] * law.size[1] / dt, 0.0],
            Kind::Glitch if first => [law.drive * law.drive * dt, 0.0],
            _ => [0.0; 2],
        }
    }

    /// Whether the law is another one.
    pub fn is_law(self) -> bool {
        matches!(self, Kind::Law { .. })
    }
}

/// What the readings are held against.
#[derive(Clone, Copy, Debug)]
pub struct Expected<'a> {
    /// The law in use.
    pub motion: Motion<'a>,
    /// The sensors' noise, and what the law leaves unexplained.
    pub noise: Noise,
    /// How many times the evidence is asked of a reading that a law known for sure would need.
    pub caution: f64,
    /// Std of what a switch adds to q̈, and of the part of F ÷ m that it does.
    pub switch: [f64; 2],
    /// Radians of the motion in a second.
    pub rate: f64,
    /// RMS of q and q̇: what an offset or a kick may be.
    pub size: [f64; 2],
    /// RMS of F ÷ m.
    pub drive: f64,
    /// F, where it may be stuck.
    pub stuck: Option<Standing>,
    /// Parts of an interval between two samples.
    pub parts: usize,
    /// Where no law is known: `motion` is a free mass of 1 kg then, whose acceleration the unknowns are.
    pub alone: Option<Roughness>,
}

/// How rough a motion is of which no law is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Variance that q̈ gains in a second, (m/s²)²/s.
    pub acceleration: f64,
    /// Variance of what q gains in a second beside the integral of q̇, m²/s.
    pub slip: f64,
    /// What F moves, kg, where that is known.
    pub inertia: Option<f64>,
}

/// An F that stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// For how long, s.
    pub since: f64,
    /// Time in which F, when it moves, goes as far as it is from 0, s.
    pub pace: f64,
}

impl Standing {
    /// What is left of a force, as its correlation, after so long, s.
    fn kept(&self, time: f64) -> f64 {
        (-time / self.pace).exp()
    }
}

impl Expected<'_> {
    /// Intensity of the white force, N² s, that moves q̇ by its own RMS within an interval of `dt` s.
    pub fn kick(&self, q: f64, dt: f64) -> f64 {
        (self.size[1] * self.motion.mass(q)).powi(2) / dt
    }

    /// What F moves at q, kg; infinite where F is not known to move anything.
    fn mass(&self, q: f64) -> f64 {
        self.alone.map_or_else(|| self.motion.mass(q), |alone| alone.inertia.unwrap_or(f64::INFINITY))
    }

    /// Variance of what a valid law may leave out of q̈.
    fn misfit(&self) -> f64 {
        let [acceleration, _] = self.switch;
        SETTLED_ERROR * acceleration * acceleration
    }

    /// The filter of (q, q̇) after an interval of the law in use.
    pub fn carry(&self, filter: &Filter, dt: f64, drive: &Drive) -> Filter {
        let mut filter = *filter;
        let parts = drive.parts(self.parts);
        let dt = dt / parts as f64;
        let noise = white_acceleration(self.noise.process, dt);
        for part in 0..parts {
            let [from, middle, to] = drive.part(part, parts);
            let state = filter.state();
            let transition = transition(self.motion.acceleration_gradient(state, middle), dt);
            filter.set_state(self.motion.step_linear(state, dt, from, to));
            filter.predict(|change| times(&transition, change), &noise);
        }
        filter
    }

    /// Goes over an interval in which q̈ is the law's, u₀ and u₁ F ÷ m as far as they act. `added`, by what multiplies
    /// them, is the intensity of a white acceleration and what u₀ gains in a second, as variances.
    pub fn advance(
        &self,
        filter: &mut Filter<4>,
        dt: f64,
        drive: &Drive,
        act: [bool; 2],
        added: impl Fn([f64; 2]) -> [f64; 2],
    ) {
        let parts = drive.parts(self.parts);
        let part_dt = dt / parts as f64;
        let half = 0.5 * part_dt * part_dt;
        let [rough, slip] = self.alone.map_or([0.0; 2], |alone| [alone.acceleration, alone.slip]);
        for part in 0..parts {
            let [from, middle, to] = drive.part(part, parts);
            let state = filter.state();
            let gradient = self.motion.acceleration_gradient(state, middle);
            let [first, second] = act.map(|acts| if acts { 1.0 } else { 0.0 });
            let inputs = [first, second * middle / self.motion.mass(state.q)];
            let moved = self.motion.step_linear(state, part_dt, from, to);
            let extra = inputs[0] * filter.mean[2] + inputs[1] * filter.mean[3];
            filter.set_state(State { q: moved.q + half * extra, qd: moved.qd + part_dt * extra });
            let [process, wander] = added(inputs);
            let [[qq, qv], [_, vv]] = white_acceleration(self.noise.process + process, part_dt);
            let noise = [
                [qq + slip * part_dt, qv, 0.0, 0.0],
                [qv, vv, 0.0, 0.0],
                [0.0, 0.0, (wander + rough) * part_dt, 0.0],
                [0.0; 4],
            ];
            let [by_q, by_qd] = transition(gradient, part_dt);
            let map = |[q, qd, acceleration, gain]: [f64; 4]| {
                let input = inputs[0] * acceleration + inputs[1] * gain;
                let [moved, faster] = times(&[by_q, by_qd], [q, qd]);
                [moved + half * input, faster + part_dt * input, acceleration, gain]
            };
            filter.predict(map, &noise);
        }
    }

    /// What is expected of (q, q̇) after an interval of a motion of which no law is known.
    pub fn foresee(&self, filter: &Filter<4>, dt: f64, drive: &Drive) -> Filter<4> {
        let mut filter = *filter;
        self.advance(&mut filter, dt, drive, [true; 2], |_| [0.0; 2]);
        filter
    }

    /// The noise, and a white force of intensity `unseen`, N² s, that acts on the mass at `q`.
    pub fn noise_with(&self, unseen: f64, q: f64) -> Noise {
        let mass = self.mass(q);
        Noise { process: self.noise.process + unseen / (mass * mass), ..self.noise }
    }
}

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

/// What an interval makes of a small change of (q, q̇), where q̈ changes so by them.
fn transition([by_q, by_qd]: [f64; 2], dt: f64) -> Matrix<2> {
    let half = 0.5 * dt * dt;
    [[1.0 + half * by_q, dt + half * by_qd], [dt * by_q, 1.0 + dt * by_qd]]
}

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
            Kind::Law { before, times } => {
                let acceleration = f64::from(times) * acceleration;
                let since = f64::from(before) * dt;
                let square = acceleration * acceleration;
                covariance[1][1] += square * since * since;
                covariance[1][2] += square * since;
                covariance[2][1] += square * since;
                covariance[2][2] += square;
                covariance[3][3] += gain * gain;
            }
            Kind::Misfit => covariance[2][2] = law.misfit(),
            Kind::ForceStuck => self.suppose_stuck(law),
            Kind::Offset(channel) => covariance[2][2] = law.size[channel as usize].powi(2),
            _ => {}
        }
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
        let drive = if self.kind == Kind::Glitch && self.age == 0 { &Drive::Held(0.0) } else { drive };
        let act = match self.kind {
            _ if law.alone.is_some() => [true; 2],
            Kind::Law { .. } => [true; 2],
            Kind::Misfit | Kind::ForceStuck => [true, false],
            _ => [false; 2],
        };
        let (kind, first) = (self.kind, self.age == 0);
        law.advance(&mut self.believed, dt, drive, act, |inputs| kind.unknown(law, inputs, dt, first));
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
        let start = start.max(SHARED * self.bursts[1 - index].begun());
        self.log += self.bursts[index].take(working(residual, variance), residual, std, start) - repeats;
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
