//! All hypotheses on the same readings: whether the law or a sensor is the likelier, and by how much.

use super::arrival::Arrival;
use super::expected::Expected;
use super::hypothesis::Hypothesis;
use super::kind::Kind;
use super::price::{delay_changes, event};
use crate::estimation::{Channel, Filter, TWENTY_TO_ONE, log_sum};
use serde::{Deserialize, Serialize};

/// What is told for good needs these log-odds: an offset that is taken off, from a motion that was kicked, and a
/// channel that comes late, from a burst that looks like it for two readings.
pub const CERTAIN: f64 = 10.0;

/// Log-odds of what begins in an interval of `dt` s against either of those by which nothing happens. Those share what
/// is likely of nothing, and the changes of a law what is of one.
fn odds(kind: Kind, dt: f64) -> f64 {
    let many = |of: fn(Kind) -> bool| Kind::ALL.into_iter().filter(|kind| of(*kind)).count() as f64;
    match kind {
        kind if kind.is_no_event() => 0.0,
        Kind::Law { .. } => (event(dt) * many(Kind::is_no_event) / many(Kind::is_law)).ln() - kind.rarity(),
        Kind::Late(_) => (delay_changes(dt) * many(Kind::is_no_event)).ln(),
        _ => (event(dt) * many(Kind::is_no_event)).ln(),
    }
}

/// The hypotheses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Weighing {
    hypotheses: Vec<Hypothesis>,
}

impl Weighing {
    /// What can be told apart where these channels are measured, with room for so many samples held.
    pub fn new(room: usize, measured: [bool; 2]) -> Weighing {
        let kinds = Kind::ALL.into_iter().filter(|kind| kind.can_be_told(measured));
        Weighing { hypotheses: kinds.map(|kind| Hypothesis::new(kind, room)).collect() }
    }

    /// The hypothesis of that place.
    pub fn hypothesis(&self, place: usize) -> &Hypothesis {
        &self.hypotheses[place]
    }

    /// Every hypothesis begins at the state before the first reading held, `dt` s ago, `runs` being what repetitions
    /// before it have cost by channel, nats: one that sticks has not repeated itself by chance.
    pub fn begin(&mut self, start: &Filter<4>, law: &Expected, dt: f64, runs: [f64; 2]) {
        for hypothesis in &mut self.hypotheses {
            let sticks = Channel::ALL.into_iter().filter(|channel| hypothesis.kind.sticks(*channel));
            let run = sticks.map(|channel| runs[channel as usize]).sum::<f64>();
            hypothesis.begin(start, law, dt, 0.0, odds(hypothesis.kind, dt) + run);
        }
    }

    /// What the readings have not made likelier than it was begins anew: it may be about to happen (Page 1954).
    /// So does what they have not told in that many samples.
    pub fn renew(&mut self, law: &Expected, dt: f64, samples: usize) {
        let nothing = self.nothing();
        let (own, log, start, bursts) = (nothing.kind, nothing.log, nothing.start(law), nothing.bursts);
        for hypothesis in self.hypotheses.iter_mut().filter(|hypothesis| hypothesis.kind != own) {
            let learns = match hypothesis.kind {
                // each reading of a burst is as cheap as the next, the first of an offset is not
                Kind::Offset(channel) if bursts[channel as usize].is_on() => hypothesis.learns(channel, law),
                _ => 0.0,
            };
            if hypothesis.log - log <= hypothesis.prior - learns || hypothesis.age() >= samples {
                hypothesis.begin(&start, law, dt, log, odds(hypothesis.kind, dt));
                // a burst that goes on beside what explains its readings would tell that nothing
                for channel in Channel::ALL.into_iter().filter(|channel| !hypothesis.kind.explains(*channel)) {
                    hypothesis.bursts[channel as usize] = bursts[channel as usize];
                }
            }
        }
    }

    /// Whether the readings have made nothing likelier than it was.
    pub fn is_idle(&self) -> bool {
        let log = self.nothing().log;
        let mut events = self.hypotheses.iter().filter(|hypothesis| !hypothesis.kind.is_no_event());
        events.all(|event| event.log - log <= event.prior)
    }

    /// The likeliest of those by which nothing has happened.
    pub fn nothing(&self) -> &Hypothesis {
        let of = self.hypotheses.iter().filter(|hypothesis| hypothesis.kind.is_no_event());
        of.max_by(|a, b| a.log.total_cmp(&b.log)).unwrap_or(&self.hypotheses[0])
    }

    /// There is nothing to weigh any more.
    pub fn clear(&mut self) {
        self.hypotheses.iter_mut().for_each(Hypothesis::clear);
    }

    /// Takes a sample.
    pub fn take(&mut self, law: &Expected, arrival: &Arrival, place: usize) {
        for hypothesis in &mut self.hypotheses {
            hypothesis.take(law, arrival.dt, arrival.drive_by(hypothesis.kind), arrival.values, place);
        }
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
    /// that was not read and one that was misread leave the same record: neither has to be told from the other, nor
    /// from a channel that begins to come late, which has to be told from them.
    pub fn named(&self) -> Option<usize> {
        let odds = self.law_against_fault();
        if odds.is_nan() || odds.abs() < TWENTY_TO_ONE {
            return None;
        }
        let best = self.unless_kicked(self.likeliest(odds > 0.0));
        let own = &self.hypotheses[best];
        let begins_alike = |other: Kind| own.kind.is_kick() && other.is_late();
        let alike = [Kind::is_kick, Kind::is_no_event];
        let same =
            |other: Kind| other == own.kind || begins_alike(other) || alike.iter().any(|is| is(other) && is(own.kind));
        let others = self.hypotheses.iter().filter(|other| !other.kind.is_law() && !same(other.kind));
        let rival = others.map(|other| other.log).fold(f64::NEG_INFINITY, log_sum);
        let least = if own.kind.is_late() { CERTAIN } else { TWENTY_TO_ONE };
        (odds > 0.0 || own.log - rival > least).then_some(best)
    }

    /// What begins as a force that was not read is that until it is told from it.
    fn unless_kicked(&self, best: usize) -> usize {
        let kicks = self.hypotheses.iter().enumerate().filter(|(_, other)| other.kind.is_kick());
        let kick = kicks.max_by(|a, b| a.1.log.total_cmp(&b.1.log));
        let own = &self.hypotheses[best];
        let is_kick = |kick: &Hypothesis| own.kind.is_late() && own.log - kick.log < TWENTY_TO_ONE;
        kick.filter(|(_, kick)| is_kick(kick)).map_or(best, |(place, _)| place)
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
