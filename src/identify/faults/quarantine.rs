//! Readings held until what happened has a name, and those that are let through.

use super::arrival::{Arrival, Arrivals, Course};
use super::expected::Expected;
use super::hypothesis::{Hypothesis, under_law};
use super::kind::Kind;
use super::motion_alone::{MotionAlone, Surroundings};
use super::queue::Queue;
use super::states::States;
use super::weighing::{CERTAIN, Weighing};
use crate::estimation::{Channel, Filter, OUTLYING, UNLIKELY};
use crate::identify::packed_readings;
use crate::identify::reading::Reading;
use crate::identify::report::SensorState;
use crate::identify::sample::{GAP, Sample, is_outage};
use crate::law::{Hold, State};
use serde::{Deserialize, Serialize};

/// Samples held at most: what has no name by then has the likeliest one. Three bursts of 20 fit in, and the record
/// catches up with them in 16 steps.
pub const ROOM: usize = 64;

/// Samples for which nothing is held after the law was named: the evidence of a switch decides, which in the
/// standard scenarios takes 8 to 28 samples (medians at σ = 0.01).
const DECIDED: u32 = 200;

/// An offset is taken off once its std is below this part of the sensor's noise, so that what is left of it widens a
/// reading's scatter by an eighth at most.
const OFFSET_KNOWN: f64 = 0.5;

/// Samples that the size of the motion is known from: some periods of most motions.
const MEMORY: f64 = 10_000.0;

/// What is believed of the last readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Stance {
    /// They were as expected.
    Calm,
    /// What they say has no name yet.
    Doubt,
    /// The hypothesis of this place was named.
    Named(usize),
}

impl Stance {
    /// The hypothesis that was named.
    fn named(self, weighing: &Weighing) -> Option<&Hypothesis> {
        if let Stance::Named(place) = self { Some(weighing.hypothesis(place)) } else { None }
    }
}

/// The readings of a stream on their way into the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quarantine {
    /// Which of q and q̇ are measured.
    measured: [bool; 2],
    weighing: Weighing,
    stance: Stance,
    /// Readings held, and how many.
    #[serde(with = "packed_readings")]
    held: Vec<Reading>,
    count: usize,
    /// Readings let through and not taken yet.
    through: Queue,
    /// What is expected without a law, and whether that is what readings are held against.
    motion: MotionAlone,
    is_alone: bool,
    arrivals: Arrivals,
    /// Time since samples were last missing, s.
    whole: f64,
    /// Time of the last sample let through of which a reading counts, s.
    counted: f64,
    samples: f64,
    /// Mean squares of q and q̇ let through.
    squares: [f64; 2],
    /// Samples that are let through because the law was named.
    decided: u32,
    /// What is taken off the readings of q and q̇.
    offset: [f64; 2],
    /// The channel of one that has just been found, and the variance that is left of it.
    found: Option<(Channel, f64)>,
    /// Whether F has just been found stuck.
    force_stuck: bool,
    /// Whether something has just been found to have moved q̇ that was not read of F.
    kicked: bool,
    /// By how many samples F has just been found to act later than it did, and since how many samples.
    late: Option<(i8, usize)>,
    states: States,
}

/// What readings are held against.
pub enum Against<'a> {
    /// A law that explains its record, from the state after the last reading let through.
    Law(&'a Expected<'a>, Filter),
    /// The motion itself: variances of the sensors' noise and RMS of F.
    Motion([f64; 2], f64),
    /// Nothing: they are let through.
    Nothing,
}

impl Quarantine {
    /// Nothing held of these channels.
    pub fn new(measured: [bool; 2]) -> Quarantine {
        Quarantine {
            measured,
            weighing: Weighing::new(ROOM, measured),
            stance: Stance::Calm,
            held: vec![Reading::default(); ROOM],
            count: 0,
            through: Queue::new(2 * ROOM),
            motion: MotionAlone::new(),
            is_alone: false,
            arrivals: Arrivals::default(),
            whole: 0.0,
            counted: f64::INFINITY,
            samples: 0.0,
            squares: [0.0; 2],
            decided: 0,
            offset: [0.0; 2],
            found: None,
            force_stuck: false,
            kicked: false,
            late: None,
            states: States::default(),
        }
    }

    /// Takes a reading, `pace` being the usual time between two samples, s.
    pub fn take(&mut self, mut reading: Reading, hold: Hold, pace: f64, against: Against) {
        reading.sample.q -= self.offset[0];
        reading.sample.qd -= self.offset[1];
        self.change_measure(matches!(against, Against::Motion(..)));
        self.samples += 1.0;
        // what is held has no name yet
        if self.count == 0 {
            self.states.last(self.offset, self.stance.named(&self.weighing));
        }
        let law = if let Against::Law(law, filter) = against { Some((law, self.believed(filter))) } else { None };
        let course =
            |before: &Sample| law.map_or(Course::UNKNOWN, |(law, filter)| course(law, &filter, before, &reading));
        let arrival = self.arrivals.take(reading, self.measured, hold, course);
        let is_whole = |arrival: &Arrival| arrival.dt < GAP * pace;
        self.whole =
            arrival.as_ref().filter(|arrival| is_whole(arrival)).map_or(0.0, |arrival| self.whole + arrival.dt);
        let read = arrival.as_ref().map_or(reading, |arrival| arrival.reading);
        // what is usually not read is not missed
        self.counted += arrival.as_ref().filter(|_| !read.counts(self.measured)).map_or(0.0, |arrival| arrival.dt);
        match (against, arrival) {
            // what brings the readings back may have brought another law as well; no burst lasts for so long
            (_, Some(arrival)) if self.may_count(&arrival) && is_outage(reading.sample.t - self.counted, pace) => {
                self.settle();
                self.let_through(arrival.reading);
            }
            (Against::Law(law, filter), Some(arrival)) if is_whole(&arrival) => {
                // what has been followed for a radian since would have been noticed
                let unnoticed = if self.whole * law.rate < 1.0 { self.whole } else { 0.0 };
                let law = Expected { noise: law.noise_with(reading.unseen, filter.mean[0]), unnoticed, ..*law };
                self.weigh(&arrival, &law, &filter);
            }
            (Against::Motion(noise, force), Some(arrival)) if is_whole(&arrival) => {
                let around = Surroundings { noise, measured: self.measured, size: self.size(), force };
                self.weigh_alone(arrival, &around);
            }
            _ => {
                self.settle();
                self.motion.restart();
                self.let_through(read);
            }
        }
    }

    /// A law has been found, or lost: what was held against the one says nothing of the other.
    fn change_measure(&mut self, is_alone: bool) {
        if self.is_alone != is_alone {
            self.is_alone = is_alone;
            self.settle();
            self.motion.restart();
        }
    }

    /// The next reading for the record.
    pub fn next(&mut self) -> Option<Reading> {
        self.through.pop()
    }

    /// Samples that are not in the record yet.
    pub fn behind(&self) -> usize {
        self.count + self.through.count()
    }

    /// Changes the last `count` readings, as far as they are not in the record yet; returns how many are.
    pub fn amend(&mut self, count: u64, mut change: impl FnMut(&mut Reading)) -> u64 {
        let behind = self.behind();
        let own = behind.min(usize::try_from(count).unwrap_or(behind));
        for place in behind - own..behind {
            match place.checked_sub(self.through.count()) {
                Some(held) => change(&mut self.held[held]),
                None => change(self.through.at(place)),
            }
        }
        count - own as u64
    }

    /// Whether readings are held of which nothing is known yet.
    pub fn is_in_doubt(&self) -> bool {
        self.stance == Stance::Doubt
    }

    /// Whether what is held speaks for another law more than for any fault.
    pub fn suspects_law(&self) -> bool {
        !self.is_alone && self.count > 0 && self.weighing.law_against_fault() > 0.0
    }

    /// Whether readings are held against the motion itself, and that is known.
    pub fn knows_motion(&self) -> bool {
        self.is_alone && self.motion.is_known()
    }

    /// What has been let through so far says nothing of how large the motion is.
    pub fn forget_size(&mut self) {
        (self.squares, self.samples) = ([0.0; 2], 0.0);
    }

    /// An offset of the channel has been found in readings that were let through.
    pub fn take_off(&mut self, channel: Channel, offset: f64) {
        self.offset[channel as usize] += offset;
    }

    /// Time of the last sample of the stream, s.
    pub fn now(&self) -> f64 {
        self.arrivals.last.map_or(0.0, |sample| sample.t)
    }

    /// Time for which no reading has counted, s.
    pub fn silence(&self) -> f64 {
        self.now() - self.counted
    }

    /// RMS of q and q̇.
    pub fn size(&self) -> [f64; 2] {
        self.squares.map(f64::sqrt)
    }

    /// What the sensors of q, q̇ and F do.
    pub fn sensors(&self) -> [SensorState; 3] {
        self.states.said()
    }

    /// The state after the last reading: the law's own, or where readings are held that in which nothing happened.
    fn believed(&self, filter: Filter) -> Filter {
        if self.stance == Stance::Calm { filter } else { self.weighing.nothing().filter() }
    }

    fn weigh(&mut self, arrival: &Arrival, law: &Expected, filter: &Filter) {
        self.calm_down(law);
        // while readings wait the law in use is behind them
        let waits = self.decided > 0 || self.through.count() > 0;
        if self.stance == Stance::Calm && (waits || self.is_expected(arrival, law, filter)) {
            self.decided = self.decided.saturating_sub(1);
            return self.let_through(arrival.reading);
        }
        self.doubt(arrival, law, &under_law(filter));
    }

    /// Where no law is known readings are held against the motion itself, once that is known.
    fn weigh_alone(&mut self, mut arrival: Arrival, around: &Surroundings) {
        let law = self.motion.expected(around, arrival.dt, arrival.reading.unseen);
        self.calm_down(&law);
        let filter = match self.stance {
            Stance::Calm => self.motion.filter(),
            _ => self.weighing.nothing().start(&law),
        };
        let foreseen = law.foresee(&filter, arrival.dt, &arrival.drive);
        let values = arrival.measured();
        self.motion.learn(&law, &foreseen, values);
        arrival.allow_rest(&law);
        let calm = self.stance == Stance::Calm;
        if calm && (!self.motion.is_known() || self.decided > 0 || arrival.is_near(&law, &foreseen)) {
            self.decided = self.decided.saturating_sub(1);
            self.motion.take(around, arrival.dt, &arrival.drive, arrival.reading.unseen, values);
            return self.let_through(arrival.reading);
        }
        self.doubt(&arrival, &law, &filter);
    }

    /// What a reading is has no name yet, or is told by what has just had one; where nothing has been held it begins
    /// from `start`.
    fn doubt(&mut self, arrival: &Arrival, law: &Expected, start: &Filter<4>) {
        match self.stance {
            Stance::Calm => self.begin(arrival, law, start),
            Stance::Named(place) if self.is_released(arrival) => {
                let start = self.weighing.hypothesis(place).start(law);
                self.begin(arrival, law, &start);
            }
            Stance::Named(place) if self.count == 0 && self.weighing.hypothesis(place).kind.is_no_event() => {
                self.weighing.renew(law, arrival.dt, ROOM);
                self.hold(arrival, law);
            }
            Stance::Doubt | Stance::Named(_) => self.hold(arrival, law),
        }
    }

    /// Once no burst goes on and everything is in the record, the law in use says again what is expected; not while the
    /// readings speak for anything else: five stds are chance in one reading, and an offset in three.
    fn calm_down(&mut self, law: &Expected) {
        if let Stance::Named(place) = self.stance
            && (self.is_alone || self.behind() == 0)
            && self.count == 0
        {
            let kind = self.weighing.hypothesis(place).kind;
            let forgotten = kind.is_no_event() && self.weighing.is_idle();
            if self.is_over(place) && (forgotten || kind.is_kick()) {
                if self.is_alone {
                    let named = if kind.is_kick() { self.weighing.hypothesis(place) } else { self.weighing.nothing() };
                    self.motion.put(&named.start(law));
                }
                self.stance = Stance::Calm;
                self.weighing.clear();
            }
        }
    }

    /// Whether no burst goes on, and there is no offset.
    fn is_over(&self, place: usize) -> bool {
        let named = self.weighing.hypothesis(place);
        let over = Channel::ALL.into_iter().all(|channel| named.burst(channel) < UNLIKELY);
        over && !matches!(named.kind, Kind::Offset(_))
    }

    fn is_expected(&self, arrival: &Arrival, law: &Expected, filter: &Filter) -> bool {
        arrival.is_near(law, &law.carry(filter, arrival.dt, &arrival.drive))
    }

    /// Whether a sensor that was stuck varies again.
    fn is_released(&self, arrival: &Arrival) -> bool {
        let Some(named) = self.stance.named(&self.weighing) else { return false };
        Channel::ALL.into_iter().any(|channel| {
            let varies = arrival.values[channel as usize].is_none_or(|value| value.repeats.is_none());
            named.kind.sticks(channel) && varies
        })
    }

    /// Whether a reading is set aside by nothing but what is expected of it.
    fn may_count(&self, arrival: &Arrival) -> bool {
        self.is_released(arrival) || self.stance.named(&self.weighing).is_some_and(|named| named.kind.is_no_event())
    }

    fn begin(&mut self, arrival: &Arrival, law: &Expected, start: &Filter<4>) {
        self.weighing.begin(start, law, arrival.dt, arrival.runs);
        self.stance = Stance::Doubt;
        self.hold(arrival, law);
    }

    fn hold(&mut self, arrival: &Arrival, law: &Expected) {
        self.held[self.count] = arrival.reading;
        self.weighing.take(law, arrival, self.count);
        self.count += 1;
        let full = self.count == ROOM;
        // louder sensors are told from a burst of small readings by their going on alone
        let named = self.weighing.named().filter(|place| !self.weighing.hypothesis(*place).kind.is_loud());
        let named = named.or_else(|| full.then(|| self.weighing.best()));
        let is_told =
            named.is_some_and(|place| !self.is_alone || self.has_returned(place) && !self.may_rest(place, arrival));
        match named {
            Some(place) if is_told => self.name(place, law),
            Some(_) if full => {
                self.settle();
                self.motion.refute();
            }
            _ => {}
        }
    }

    /// Whether the motion may be at rest where a sensor would be called stuck for the first time.
    fn may_rest(&self, place: usize, arrival: &Arrival) -> bool {
        let kind = self.weighing.hypothesis(place).kind;
        let mut stuck = Channel::ALL.into_iter().filter(|channel| kind.sticks(*channel));
        self.stance == Stance::Doubt
            && stuck.any(|channel| !arrival.values[channel as usize].is_some_and(|value| value.is_rare()))
    }

    /// Where only the motion says what a reading may be, a fault is one that it has returned from to where it was
    /// expected: what does not within all there is room for is its own course.
    fn has_returned(&self, place: usize) -> bool {
        let named = self.weighing.hypothesis(place);
        let mut others = Channel::ALL.into_iter().filter(|channel| !named.kind.sticks(*channel));
        others.all(|channel| named.burst(channel) < UNLIKELY)
    }

    /// What was held enters the record as the named hypothesis has it.
    fn name(&mut self, place: usize, law: &Expected) {
        let named = self.weighing.hypothesis(place);
        let (kind, offset, age) = (named.kind, named.offset(), named.age());
        // under a law the reading before those held may have passed for chance
        let before = usize::from(!self.is_alone);
        let begins = named.age() <= self.count + before && self.stance != Stance::Named(place);
        let mut any = [false; 2];
        for number in 0..self.count {
            let mut reading = self.held[number];
            let state = self.weighing.hypothesis(place).state_at(number);
            let faulty = Channel::ALL.map(|channel| !self.weighing.hypothesis(place).counts(channel, number));
            let Sample { q, qd, .. } = reading.sample;
            (reading.sample.q, reading.sample.qd) =
                (if faulty[0] { state.q } else { q }, if faulty[1] { state.qd } else { qd });
            reading.faulty = [0, 1].map(|index| reading.faulty[index] || faulty[index]);
            // what has moved q̇ may have been its sensor: it is asked as after an outage
            if kind.is_kick() && begins && number == 0 && !self.is_alone {
                reading.unseen = f64::INFINITY;
            }
            any = [any[0] || faulty[0], any[1] || faulty[1]];
            self.let_through(reading);
        }
        self.held[..self.count].fill(Reading::default());
        self.count = 0;
        self.weighing.forget_held();
        self.stance = Stance::Named(place);
        if self.is_alone {
            self.motion.put(&self.weighing.hypothesis(place).start(law));
        }
        match kind {
            // the law in use follows how loud the sensors are
            Kind::Law { .. } | Kind::Louder(_) | Kind::BothLouder => {
                (self.stance, self.decided) = (Stance::Calm, DECIDED)
            }
            Kind::Late(later) => {
                (self.stance, self.decided) = (Stance::Calm, DECIDED);
                self.late = Some((later, age));
            }
            Kind::ForceStuck => (self.stance, self.force_stuck) = (Stance::Calm, true),
            Kind::Kick | Kind::Glitch => self.kicked = begins,
            Kind::Offset(channel) if self.weighing.odds(place) > CERTAIN => self.know_offset(channel, offset, law),
            _ => {}
        }
        self.states.say(kind, any, begins && !self.is_alone);
    }

    /// An offset that is known well is taken off.
    fn know_offset(&mut self, channel: Channel, (offset, std): (f64, f64), law: &Expected) {
        let index = channel as usize;
        let noise = law.noise.sensor[index].sqrt();
        if std > OFFSET_KNOWN * noise {
            return;
        }
        self.offset[index] += offset;
        if self.offset[index].abs() < noise {
            self.offset[index] = 0.0;
        }
        self.stance = Stance::Calm;
        self.found = Some((channel, std * std));
    }

    /// The channel of an offset that has just been taken off, and the variance that is left of it.
    pub fn found_offset(&mut self) -> Option<(Channel, f64)> {
        self.found.take()
    }

    /// Whether F has just been found stuck.
    pub fn found_stuck_force(&mut self) -> bool {
        std::mem::take(&mut self.force_stuck)
    }

    /// By how many samples F has just been found to act later than it did, and since how many samples.
    pub fn found_late(&mut self) -> Option<(i8, usize)> {
        self.late.take()
    }

    /// The channels of which it has just been found that they are not read anew for every sample.
    pub fn found_unread(&mut self) -> [bool; 2] {
        self.arrivals.found_unread()
    }

    /// Whether something has just been found to have moved q̇ that was not read of F.
    pub fn found_kick(&mut self) -> bool {
        std::mem::take(&mut self.kicked)
    }

    /// Readings of these channels that were let through have been found a burst.
    pub fn blame(&mut self, channels: [bool; 2]) {
        self.states.blame(channels);
    }

    /// Everything held enters the record as it is: there is no law to hold it against any more, or none that says why.
    pub fn settle(&mut self) {
        for number in 0..self.count {
            self.let_through(self.held[number]);
        }
        (self.count, self.stance, self.decided) = (0, Stance::Calm, 0);
        self.weighing.forget_held();
    }

    fn let_through(&mut self, reading: Reading) {
        for (square, value) in self.squares.iter_mut().zip([reading.sample.q, reading.sample.qd]) {
            *square += (value * value - *square) / self.samples.min(MEMORY);
        }
        self.counted = if reading.counts(self.measured) { reading.sample.t } else { self.counted };
        self.through.push(reading);
    }
}

/// What q and q̇ have moved by at least since the sample `before`, by the law.
fn course(law: &Expected, filter: &Filter, before: &Sample, reading: &Reading) -> Course {
    let dt = reading.sample.t - before.t;
    let qdd = law.motion.acceleration(State { q: filter.mean[0], qd: filter.mean[1] }, before.excitation);
    let speed = filter.mean[1].abs() - OUTLYING * filter.covariance[1][1].sqrt();
    let moved = [speed * dt, qdd.abs() * dt - OUTLYING * (law.noise.process * dt).sqrt()];
    Course { moved, scatter: law.noise.sensor.map(f64::sqrt) }
}
