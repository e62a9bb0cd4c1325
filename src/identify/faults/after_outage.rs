//! Whether a sensor came back from an outage with an offset: the law with one unknown beside the state, against the law
//! as it is, both from an unknown state.

use super::hypothesis::{Expected, Hypothesis, Kind, Value};
use crate::estimation::{Channel, Filter};
use crate::law::Drive;
use serde::{Deserialize, Serialize};

/// An offset not found within this time after the outage is none that it brought, s.
const WITHIN: f64 = 5.0;

/// Probability that a burst begins with a reading: one in a false-alarm interval.
const SELDOM: f64 = 1e-9;

/// The hypotheses since the last outage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AfterOutage {
    hypotheses: Vec<Hypothesis>,
    /// Time since the outage, s; `None` where there was none of late.
    since: Option<f64>,
}

/// A channel that came back with an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Returned {
    /// The channel.
    pub channel: Channel,
    /// The offset.
    pub offset: f64,
    /// State and covariance without it.
    pub filter: Filter,
    /// Log-likelihood against no offset, nats.
    pub evidence: f64,
    /// Time since the outage, s.
    pub since: f64,
}

impl AfterOutage {
    /// No outage yet.
    pub fn new() -> AfterOutage {
        let kinds = [Kind::Readings, Kind::Offset(Channel::Q), Kind::Offset(Channel::Qd)];
        AfterOutage { hypotheses: kinds.map(|kind| Hypothesis::new(kind, 1)).into(), since: None }
    }

    /// An outage ends with these readings: the state is what they say, but for an offset.
    pub fn begin(&mut self, law: &Expected, measured: [Option<f64>; 2]) {
        let [q, qd] = measured;
        let spread = |channel: usize| match measured[channel] {
            Some(_) => law.noise.sensor[channel],
            None => law.size[channel].powi(2),
        };
        let filter = Filter::begin([q.unwrap_or(0.0), qd.unwrap_or(0.0)], [spread(0), spread(1)]);
        for hypothesis in &mut self.hypotheses {
            hypothesis.begin(&filter, law, 0.0, 0.0);
            hypothesis.return_with_offset();
        }
        self.since = Some(0.0);
    }

    /// Nothing is asked any more.
    pub fn end(&mut self) {
        self.since = None;
    }

    /// Whether it is asked.
    pub fn is_open(&self) -> bool {
        self.since.is_some()
    }

    /// Takes a sample.
    pub fn take(&mut self, law: &Expected, dt: f64, drive: &Drive, measured: [Option<f64>; 2]) {
        let Some(since) = self.since else { return };
        let value = |value: f64| Value { value, repeats: None, start: SELDOM };
        let values = measured.map(|measured| measured.map(value));
        self.hypotheses.iter_mut().for_each(|hypothesis| hypothesis.take(law, dt, drive, values, 0));
        self.since = Some(since + dt).filter(|since| *since < WITHIN);
    }

    /// The likelier of the offsets.
    pub fn likeliest(&self) -> Option<Returned> {
        let (since, none) = (self.since?, self.hypotheses[0].log);
        let offsets = Channel::ALL.into_iter().zip(&self.hypotheses[1..]);
        let (channel, best) = offsets.max_by(|a, b| a.1.log.total_cmp(&b.1.log))?;
        let offset = best.offset().0;
        Some(Returned { channel, offset, filter: best.filter(), evidence: best.log - none, since })
    }
}
