//! Whether F, or q and q̇, have begun to come late: the readings around a suspected switch once more, with what F did
//! some samples before or after.
//!
//! A switch leaves F alone; a channel that comes late leaves the law. Filters of the state under the law in use, with F
//! as it comes and shifted by whole samples from some instant on, are scored on the same readings, and what the shifted
//! ones gain is set against the log-odds of another law.

use super::expected::Expected;
use super::hindsight::{settled, take};
use super::price::event;
use crate::estimation::{Filter, Observation};
use crate::identify::window::Window;
use serde::{Deserialize, Serialize};

/// Samples by which F may act later from one sample to the next.
const LATER: [i64; 4] = [-2, -1, 1, 2];

/// Samples before the suspected instant in which a channel may have begun to come late, at least.
const BEFORE: u64 = 8;

/// A suspicion that lasts is weighed again once it is longer by this part of itself.
const AGAIN: u64 = 8;

/// Since when F acts at another time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lateness {
    /// By how many samples it acts later than before.
    pub later: i64,
    /// Number of the first sample whose F does.
    pub first: u64,
}

/// Whether a channel has begun to come late, as last weighed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LateChannels {
    /// The likeliest, and its log-odds against another law.
    found: Option<(Lateness, f64)>,
    /// Since when a switch was suspected then.
    suspected: Option<u64>,
    /// Number of the sample at which that is weighed again.
    again: u64,
}

impl LateChannels {
    /// The likeliest and its log-odds against another law, which has `odds` against none since sample `switch`; a
    /// switch has been suspected since sample `suspected`.
    pub fn weigh(
        &mut self,
        law: &Expected,
        window: &Window,
        (switch, odds): (u64, f64),
        suspected: Option<u64>,
    ) -> Option<(Lateness, f64)> {
        if self.suspected != suspected || window.end() >= self.again {
            // what came later than it began may be what speaks for another law most
            let since = window.ready().saturating_sub(switch).max(BEFORE);
            let found = likeliest(law, window, switch.saturating_sub(since));
            self.found = found.map(|(late, gain)| (late, gain - odds));
            (self.suspected, self.again) = (suspected, window.end() + since / AGAIN);
        }
        self.found
    }
}

/// The likeliest from sample `first` on, and what it gains on a law under which nothing comes late, nats.
fn likeliest(law: &Expected, window: &Window, first: u64) -> Option<(Lateness, f64)> {
    let first = first.max(window.resumed() + 1);
    let rare = event(window.pace()).ln();
    let (mut nothing, mut log) = (settled(law, window, first), 0.0);
    let mut shifted = LATER.map(|later| Shifted { since: Lateness { later, first }, filter: nothing, log: rare });
    for number in first..window.ready() {
        // what has not become likelier than it was is about to begin (Page 1954)
        for own in shifted.iter_mut().filter(|own| own.log <= log + rare) {
            (own.since.first, own.filter, own.log) = (number - 1, nothing, log + rare);
        }
        log += step(law, &window.observation(number), &mut nothing);
        for Shifted { since, filter, log } in &mut shifted {
            *log += step(law, &window.observation_with(number, since.later), filter);
        }
    }
    let best = shifted.into_iter().max_by(|a, b| a.log.total_cmp(&b.log));
    best.map(|best| (best.since, best.log - log))
}

/// A filter under which F acts at another time since a sample, and its log-likelihood.
struct Shifted {
    since: Lateness,
    filter: Filter,
    log: f64,
}

fn step(law: &Expected, observation: &Observation, filter: &mut Filter) -> f64 {
    let law = Expected { noise: law.noise_with(observation.unseen, filter.mean[0]), ..*law };
    take(&law, observation, filter)
}
