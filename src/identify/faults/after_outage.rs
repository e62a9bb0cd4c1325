//! What an outage has brought, or a kick, which is one of no length: nothing, a sensor that is off from then on, or
//! another law.
//!
//! Each is a filter from the first sample after the outage on, scored on the same readings. What was said of the motion
//! before says nothing of it any more, so that of a channel that came back with an offset u the state is what was read
//! less u, and the motion under the law tells them apart.

use super::expected::Expected;
use super::hypothesis::{Hypothesis, Value, under_law};
use super::kind::Kind;
use super::price::{event, working};
use crate::estimation::{Channel, Filter, Innovation, Observation};
use serde::{Deserialize, Serialize};

/// An offset not found within this time after the outage is none that it brought, s.
const WITHIN: f64 = 5.0;

/// Log-odds at which what an outage has brought is told.
pub const DECISIVE: f64 = 6.0;

/// Where a channel that came back may really be, as a part of its size, and the std about it: what it reads beyond that
/// is its offset, however large that is, and a filter is linear about either.
const MOTIONS: [[f64; 2]; 6] = [[-0.3, 0.15], [0.3, 0.15], [-0.7, 0.25], [0.7, 0.25], [-1.3, 0.4], [1.3, 0.4]];

/// The std of an offset that is small beside the motion, as a part of its size: such ones are as likely.
const SMALL: f64 = 0.1;

/// Filters by channel: one about what was read, one about each of [`MOTIONS`].
const STARTS: usize = 1 + MOTIONS.len();

/// What the last outage may have brought.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AfterOutage {
    /// Log-likelihood of nothing, the law in use going on, nats.
    nothing: f64,
    law: Hypothesis,
    /// Whether the law has begun anew, so that the outage did not bring it.
    anew: bool,
    /// By channel and start.
    offsets: [[Hypothesis; STARTS]; 2],
    /// Time since the outage, s; `None` where there was none of late.
    since: Option<f64>,
    /// Time since the outage from which what is left of an offset that was found is taken off, s.
    due: f64,
    /// What has been taken off since the outage, and of which channel.
    taken: Option<(Channel, f64)>,
}

/// A channel that came back with an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Returned {
    /// The channel.
    pub channel: Channel,
    /// The offset, or what is left of it.
    pub offset: f64,
    /// The state without it.
    pub filter: Filter,
    /// Its log-odds against another law since the outage, nats …
    pub odds: f64,
    /// … and against an offset of the other channel.
    pub against_other: f64,
    /// Log-likelihood of it, of one that has been taken off what is left of it, against nothing.
    pub evidence: f64,
    /// Time since the outage, s.
    pub since: f64,
}

impl AfterOutage {
    /// Nothing is asked.
    pub fn new() -> AfterOutage {
        let new = |kind| Hypothesis::new(kind, 1);
        AfterOutage {
            nothing: 0.0,
            law: new(Kind::Law { times: 1, unnoticed: false }),
            anew: false,
            offsets: Channel::ALL.map(|channel| std::array::from_fn(|_| new(Kind::Offset(channel)))),
            since: None,
            due: f64::INFINITY,
            taken: None,
        }
    }

    /// An outage ends with a sample of these channels, after which the state is this one. An offset may be as large as
    /// the motion.
    pub fn begin(&mut self, law: &Expected, state: &Filter, measured: [bool; 2]) {
        let (start, sizes) = (under_law(state), law.size);
        self.nothing = 0.0;
        self.law.begin(&start, law, 0.0, 0.0, 0.0);
        for (index, starts) in self.offsets.iter_mut().enumerate() {
            let odds = if measured[index] { -(STARTS as f64).ln() } else { f64::NEG_INFINITY };
            let read = start.mean[index];
            let beyond = MOTIONS.map(|[motion, about]| [read - motion * sizes[index], about]);
            let offsets = std::iter::once([0.0, SMALL]).chain(beyond);
            for (hypothesis, [offset, about]) in starts.iter_mut().zip(offsets) {
                let law = &Expected { size: law.size.map(|size| about * size), ..*law };
                let (mut start, variance) = (start, law.size[index].powi(2));
                (start.mean[index], start.mean[2]) = (start.mean[index] - offset, offset);
                let covariance = &mut start.covariance;
                covariance[index][index] += variance;
                (covariance[index][2], covariance[2][index]) = (-variance, -variance);
                hypothesis.begin(&start, law, 0.0, 0.0, odds);
            }
        }
        (self.anew, self.since, self.due, self.taken) = (false, Some(0.0), f64::INFINITY, None);
    }

    /// An offset of the channel was found without an outage and taken off: this variance of it is left.
    pub fn follow(&mut self, law: &Expected, state: &Filter, (channel, variance): (Channel, f64)) {
        self.begin(law, state, [true; 2]);
        let law = &Expected { size: [variance.sqrt(); 2], ..*law };
        for (place, hypothesis) in self.offsets[channel as usize].iter_mut().enumerate() {
            let odds = if place == 0 { 0.0 } else { f64::NEG_INFINITY };
            hypothesis.begin(&under_law(state), law, 0.0, 0.0, odds);
        }
        (self.anew, self.due, self.taken) = (true, 0.0, Some((channel, 0.0)));
    }

    /// Nothing is asked any more.
    pub fn end(&mut self) {
        self.since = None;
        self.hypotheses().for_each(Hypothesis::clear);
    }

    fn hypotheses(&mut self) -> impl Iterator<Item = &mut Hypothesis> {
        std::iter::once(&mut self.law).chain(self.offsets.iter_mut().flatten())
    }

    /// The likeliest of the channel's offsets.
    fn offset(&self, channel: Channel) -> &Hypothesis {
        let [first, others @ ..] = &self.offsets[channel as usize];
        others.iter().fold(first, |best, other| if other.log > best.log { other } else { best })
    }

    /// Whether it is asked.
    pub fn is_open(&self) -> bool {
        self.since.is_some()
    }

    /// Takes a sample, which led the law in use to this state with these innovations.
    pub fn take(
        &mut self,
        law: &Expected,
        observation: &Observation,
        state: &Filter,
        innovations: &[Option<Innovation>; 2],
    ) {
        let Observation { dt, drive, mut measured, .. } = *observation;
        if let Some((channel, taken)) = self.taken {
            measured[channel as usize].iter_mut().for_each(|value| *value += taken);
        }
        let values = measured.map(|value| value.map(|value| Value { value, repeats: None }));
        for hypothesis in self.hypotheses() {
            hypothesis.take(law, dt, &drive, values, 0);
            hypothesis.forget_held();
        }
        let densities = innovations.iter().flatten().map(|said| working(said.residual, said.precision.recip()));
        self.nothing += densities.sum::<f64>();
        // what has not made another law likelier than it was says that it may be about to come, which no outage brings
        let rare = event(dt).ln();
        if self.law.log < self.nothing + rare {
            self.law.begin(&under_law(state), law, dt, self.nothing, rare);
            self.anew = true;
        }
        match self.since.map(|since| since + dt).filter(|since| *since < WITHIN) {
            None => self.end(),
            since => self.since = since,
        }
    }

    /// Log-odds of an offset that has not been found against nothing; −∞ where none is asked for. Where it is likelier
    /// the law in use has followed what was read, and says little.
    pub fn lead(&self) -> f64 {
        if self.is_open() && !self.is_found() {
            let [q, qd] = Channel::ALL.map(|channel| self.offset(channel).log);
            q.max(qd) - self.nothing
        } else {
            f64::NEG_INFINITY
        }
    }

    /// Whether it is time to take off what is left of an offset.
    pub fn is_due(&self) -> bool {
        self.since.is_some_and(|since| since >= self.due)
    }

    /// Whether an offset has been taken off since the outage.
    pub fn is_found(&self) -> bool {
        self.taken.is_some()
    }

    /// An offset that was taken off, and the time since the outage, s, where another law since then is as likely now.
    pub fn in_doubt(&self) -> Option<(Channel, f64, f64)> {
        let ((channel, taken), since) = self.taken.zip(self.since)?;
        let odds = self.offset(channel).log - self.law.log;
        (!self.anew && odds < DECISIVE).then_some((channel, taken, since))
    }

    /// The offset has been taken off the readings since the outage, and the law goes on without it.
    pub fn correct(&mut self, returned: &Returned) {
        let before = self.taken.map_or(0.0, |(_, taken)| taken);
        (self.taken, self.due) = (Some((returned.channel, before + returned.offset)), 2.0 * returned.since);
    }

    /// The likelier of the offsets; what is left of one that has been taken off.
    pub fn likeliest(&self) -> Option<Returned> {
        let since = self.since?;
        let [q, qd] = Channel::ALL.map(|channel| self.offset(channel).log);
        let likelier = if q > qd { Channel::Q } else { Channel::Qd };
        let (channel, taken) = self.taken.unwrap_or((likelier, 0.0));
        let found = self.offset(channel);
        let (offset, std) = found.offset();
        let offset = offset - taken;
        let (odds, against_other) = (found.log - self.law.log, (q - qd).abs());
        let evidence = match self.taken {
            Some(_) => 0.5 * (offset / std).powi(2),
            None => found.log - self.nothing,
        };
        Some(Returned { channel, offset, filter: found.filter(), odds, against_other, evidence, since })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::Noise;
    use crate::law::{Drive, Motion, Term};

    /// A particle at rest on a spring, read with std 1 in both channels, whose q comes back off by `off`.
    fn returned(off: f64) -> AfterOutage {
        let terms = [Term::Inertia, Term::parse("q").unwrap()];
        let law = Expected {
            motion: Motion::new(&terms, &[1.0, 1.0]),
            noise: Noise { sensor: [1.0; 2], process: 1e-6 },
            caution: 1.0,
            switch: [10.0, 0.5],
            rate: 1.0,
            size: [30.0; 2],
            drive: 0.0,
            unnoticed: 0.0,
            stuck: None,
            parts: 1,
            lag: 0.0,
            alone: None,
        };
        let mut after = AfterOutage::new();
        let mut state = Filter::begin([off + 1.0, -1.0], [1.0; 2]);
        after.begin(&law, &state, [true; 2]);
        for index in 1..300 {
            let noise = if index % 2 == 0 { 1.0 } else { -1.0 };
            let read = [off + noise, -noise];
            let observation = Observation { dt: 0.01, drive: Drive::Held(0.0), measured: read.map(Some), unseen: 0.0 };
            state = law.carry(&state, observation.dt, &observation.drive);
            let innovations = Channel::ALL.map(|channel| Some(state.update(channel, read[channel as usize], 1.0)));
            after.take(&law, &observation, &state, &innovations);
        }
        after
    }

    #[test]
    fn an_offset_of_one_channel_is_found_and_none_is_not() {
        let found = returned(8.0).likeliest().unwrap();
        assert_eq!(found.channel, Channel::Q);
        assert!((found.offset - 8.0).abs() < 1.0 && found.odds > 3.0, "{found:?}");
        assert!(returned(0.0).likeliest().unwrap().evidence < 0.0);
    }

    #[test]
    fn what_has_been_taken_off_is_not_found_again() {
        let mut after = returned(8.0);
        let found = after.likeliest().unwrap();
        after.correct(&found);
        let left = after.likeliest().unwrap();
        assert!(left.offset.abs() < 1e-9 && left.evidence < 1e-9, "{left:?}");
    }
}
