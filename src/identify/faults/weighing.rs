//! All hypotheses on the same readings: whether the law or a sensor is the likelier, and by how much.

use super::hypothesis::{Expected, Hypothesis, Kind, Value};
use crate::estimation::{Channel, Filter, TWENTY_TO_ONE, log_sum};
use crate::law::Drive;
use serde::{Deserialize, Serialize};

/// The hypotheses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weighing {
    hypotheses: Vec<Hypothesis>,
}

impl Weighing {
    /// Room for so many samples held.
    pub fn new(room: usize) -> Weighing {
        Weighing { hypotheses: Kind::ALL.map(|kind| Hypothesis::new(kind, room)).into() }
    }

    /// The hypothesis of that place.
    pub fn hypothesis(&self, place: usize) -> &Hypothesis {
        &self.hypotheses[place]
    }

    /// Every hypothesis begins at the state before the first reading held, `event` the probability that a sample begins
    /// one of them, `runs` what repetitions before it have cost by channel, nats.
    pub fn begin(&mut self, filter: &Filter, law: &Expected, dt: f64, event: f64, runs: [f64; 2]) {
        let changes = self.hypotheses.iter().filter(|hypothesis| hypothesis.kind.is_law()).count() as f64;
        for hypothesis in &mut self.hypotheses {
            let log = match hypothesis.kind {
                Kind::Readings => 0.0,
                Kind::Law { .. } => (event / changes).ln(),
                _ => event.ln(),
            };
            let varies = |channel: &Channel| !hypothesis.kind.sticks(*channel);
            let run: f64 = Channel::ALL.into_iter().filter(varies).map(|channel| runs[channel as usize]).sum();
            hypothesis.begin(filter, law, dt, log - run);
        }
    }

    /// Whether the readings have made nothing likelier than it was: were it to begin now, it would lose nothing.
    pub fn is_idle(&self) -> bool {
        let gained = |hypothesis: &Hypothesis| hypothesis.log - hypothesis.prior;
        self.hypotheses.iter().all(|other| gained(other) <= gained(&self.hypotheses[0]))
    }

    /// There is nothing to weigh any more.
    pub fn clear(&mut self) {
        self.hypotheses.iter_mut().for_each(Hypothesis::clear);
    }

    /// Takes a sample.
    pub fn take(&mut self, law: &Expected, dt: f64, drive: &Drive, values: [Option<Value>; 2], place: usize) {
        self.hypotheses.iter_mut().for_each(|hypothesis| hypothesis.take(law, dt, drive, values, place));
    }

    /// The samples held have been let through.
    pub fn forget_held(&mut self) {
        self.hypotheses.iter_mut().for_each(Hypothesis::forget_held);
    }

    /// ln(law changed ÷ law unchanged).
    pub fn law_against_fault(&self) -> f64 {
        let sum = |law: bool| {
            let of = self.hypotheses.iter().filter(|hypothesis| hypothesis.kind.is_law() == law);
            of.map(|hypothesis| hypothesis.log).fold(f64::NEG_INFINITY, log_sum)
        };
        sum(true) - sum(false)
    }

    /// The place of what is named: the law against all faults, or one fault against the law and all others. A force
    /// that was not read and one that was misread leave the same record: neither has to be told from the other.
    pub fn named(&self) -> Option<usize> {
        let odds = self.law_against_fault();
        if odds.is_nan() || odds.abs() < TWENTY_TO_ONE {
            return None;
        }
        let best = self.likeliest(odds > 0.0);
        let own = &self.hypotheses[best];
        let same = |other: Kind| other == own.kind || other.is_kick() && own.kind.is_kick();
        let others = self.hypotheses.iter().filter(|other| !other.kind.is_law() && !same(other.kind));
        let rival = others.map(|other| other.log).fold(f64::NEG_INFINITY, log_sum);
        (odds > 0.0 || own.log - rival > TWENTY_TO_ONE).then_some(best)
    }

    /// Log-odds of the hypothesis of this place against all others.
    pub fn odds(&self, place: usize) -> f64 {
        let others = self.hypotheses.iter().enumerate().filter(|(other, _)| *other != place);
        self.hypotheses[place].log - others.map(|(_, other)| other.log).fold(f64::NEG_INFINITY, log_sum)
    }

    /// The likeliest of all.
    pub fn best(&self) -> usize {
        self.likeliest(self.law_against_fault() > 0.0)
    }

    /// The likeliest of the hypotheses of another law, or of those of a fault.
    fn likeliest(&self, law: bool) -> usize {
        let of = self.hypotheses.iter().enumerate().filter(|(_, hypothesis)| hypothesis.kind.is_law() == law);
        of.max_by(|a, b| a.1.log.total_cmp(&b.1.log)).map_or(0, |(place, _)| place)
    }
}
