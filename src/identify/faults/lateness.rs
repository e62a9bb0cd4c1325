//! Whether F, or q and q̇, have begun to come late: the readings around a suspected switch once more, with what F did
//! some samples before or after.
//!
//! A switch leaves F alone; a channel that comes late leaves the law. Filters of the state under the law in use, with F
//! as it comes and shifted by whole samples from some instant on, are scored on the same readings, and what the shifted
//! ones gain is set against the log-odds of another law.

use super::expected::{Expected, delay};
use super::hindsight::{settled, take};
use super::price::delay_changes;
use crate::estimation::{Filter, Observation};
use crate::identify::window::Window;
use crate::law::State;
use serde::{Deserialize, Serialize};

/// Samples by which F may act later from one sample to the next.
const LATER: [i64; 4] = [-2, -1, 1, 2];

/// Samples after one until all of F is known that may act there.
const AHEAD: u64 = LATER[LATER.len() - 1] as u64;

/// Samples before the suspected instant in which a channel may have begun to come late, at least.
const BEFORE: u64 = 8;

/// Since when F acts at another time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lateness {
    /// By how many samples it acts later than before.
    pub later: i64,
    /// Number of the first sample whose F does.
    pub first: u64,
}

/// Whether a channel has begun to come late while a switch is suspected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LateChannels {
    /// Since when a switch is suspected.
    suspected: Option<u64>,
    /// What the readings say up to where all of F is known that may act.
    weighed: Option<Weighed>,
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
        let ready = window.ready();
        // what came later than it began may be what speaks for another law most
        let since = ready.saturating_sub(switch).max(BEFORE);
        let first = switch.saturating_sub(since).max(window.resumed() + 1);
        let goes_on = self.weighed.filter(|weighed| self.suspected == suspected && weighed.may_begin_in(first, switch));
        let mut weighed = goes_on.unwrap_or_else(|| Weighed::begin(law, window, first));
        weighed.go_on(law, window, ready.saturating_sub(AHEAD));
        *self = LateChannels { suspected, weighed: Some(weighed) };
        weighed.go_on(law, window, ready);
        weighed.likeliest().map(|(late, gain)| (late, gain - odds))
    }
}

/// What readings say of channels that have begun to come late in them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Weighed {
    /// Numbers of the first of them, and of the one to come.
    numbers: [u64; 2],
    /// Under a law in which nothing comes late.
    nothing: Filter,
    log: f64,
    shifted: [Shifted; LATER.len()],
}

/// A filter under which F acts at another time since a sample, and its log-likelihood.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Shifted {
    since: Lateness,
    filter: Filter,
    log: f64,
}

impl Weighed {
    fn begin(law: &Expected, window: &Window, first: u64) -> Weighed {
        let nothing = settled(law, window, first);
        let log = delay_changes(window.pace()).ln();
        let shifted = LATER.map(|later| Shifted { since: Lateness { later, first }, filter: nothing, log });
        Weighed { numbers: [first; 2], nothing, log: 0.0, shifted }
    }

    /// Whether a channel that begins to come late from sample `first` on is weighed, or before a switch at the latest,
    /// in readings that go on.
    fn may_begin_in(&self, first: u64, switch: u64) -> bool {
        let [begun, next] = self.numbers;
        begun <= switch && first <= next
    }

    /// Takes the window's readings up to one before sample `end`.
    fn go_on(&mut self, law: &Expected, window: &Window, end: u64) {
        let Weighed { numbers: [_, next], nothing, log, shifted } = self;
        let rare = delay_changes(window.pace()).ln();
        for number in *next..end {
            // what has not become likelier than it was is about to begin (Page 1954)
            for own in shifted.iter_mut().filter(|own| own.log <= *log + rare) {
                let filter = delayed(law, window, number, own.since.later, nothing);
                (own.since.first, own.filter, own.log) = (number - 1, filter, *log + rare);
            }
            *log += step(law, &window.observation(number), nothing);
            for Shifted { since, filter, log } in &mut *shifted {
                *log += step(law, &window.observation_with(number, since.later), filter);
            }
        }
        *next = end.max(*next);
    }

    /// The likeliest, and what it gains on a law under which nothing comes late, nats.
    fn likeliest(&self) -> Option<(Lateness, f64)> {
        let best = self.shifted.iter().max_by(|a, b| a.log.total_cmp(&b.log));
        best.map(|best| (best.since, best.log - self.log))
    }
}

/// The filter before sample `number` of a motion that begins to come late with it: where that was so long before.
fn delayed(law: &Expected, window: &Window, number: u64, later: i64, filter: &Filter) -> Filter {
    let time = delay(law.lag, later as f64) * window.pace();
    let State { q, qd } = filter.state();
    let qdd = law.motion.acceleration(State { q, qd }, window.sample(number - 1).excitation);
    Filter { mean: [q - time * qd, qd - time * qdd], ..*filter }
}

fn step(law: &Expected, observation: &Observation, filter: &mut Filter) -> f64 {
    let law = Expected { noise: law.noise_with(observation.unseen, filter.mean[0]), ..*law };
    take(&law, observation, filter)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::sample::Sample;
    use crate::identify::settings::Channels;
    use crate::law::{Hold, Motion, Term};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const TERMS: [Term; 3] = [Term::Inertia, Term::power(0, 1), Term::power(1, 0)];
    const LAW: [f64; 3] = [1.0, 0.3, 4.0];
    const NOISE: f64 = 0.01;
    const BEGINS: usize = 300;

    /// An oscillator under white noise, from a sample on with F that comes so many samples late, and so many after it.
    fn window(late: usize, after: usize) -> Window {
        let mut window = Window::new(1000, Channels::ALL, Hold::Zero);
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        let (mut state, mut forces) = (State { q: 1.0, qd: 0.0 }, vec![0.0]);
        for number in 0..BEGINS + after {
            state = Motion::new(&TERMS, &LAW).step_linear(state, 1e-3, forces[number], forces[number]);
            let mut noise = || generator.sample::<f64, _>(StandardNormal);
            let (q, qd) = (state.q + NOISE * noise(), state.qd + NOISE * noise());
            forces.push(20.0 * noise());
            let read = if number > BEGINS { number + 1 - late } else { number + 1 };
            window.push(Sample { t: 1e-3 * number as f64, q, qd, excitation: forces[read] });
        }
        window
    }

    fn found(window: &Window) -> (Lateness, f64) {
        let law = Expected::of_oscillator(Motion::new(&TERMS, &LAW), NOISE);
        LateChannels::default().weigh(&law, window, (BEGINS as u64, 0.0), None).unwrap()
    }

    #[test]
    fn a_force_that_begins_to_come_late_is_found_with_the_sample_at_which_it_does() {
        for late in [1, 2] {
            let (own, odds) = found(&window(late, 100));
            assert!(own.later == -(late as i64) && own.first.abs_diff(BEGINS as u64) < 4, "{own:?}");
            assert!(odds > 20.0, "{odds}");
        }
    }

    #[test]
    fn readings_that_come_one_by_one_say_what_they_say_together() {
        let law = Expected::of_oscillator(Motion::new(&TERMS, &LAW), NOISE);
        for late in [1, 2] {
            let last = |afters: &[usize]| {
                let mut channels = LateChannels::default();
                let mut weigh = |after| channels.weigh(&law, &window(late, after), (BEGINS as u64, 0.0), Some(0));
                afters.iter().map(|after| weigh(*after).unwrap()).last().unwrap()
            };
            let each: Vec<usize> = (20..=100).collect();
            assert_eq!(last(&each), last(&[20, 100]));
        }
    }

    #[test]
    fn nothing_comes_late_where_nothing_happens() {
        let (own, odds) = found(&window(0, 100));
        assert!(odds < -10.0, "{own:?} {odds}");
    }
}
