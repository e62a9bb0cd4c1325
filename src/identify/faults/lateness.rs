//! Whether F, or q and q̇, have begun to come late, or F to be held otherwise between samples.
//!
//! A switch leaves F alone; a channel that comes late leaves the law. Filters of the state under the law in use, with F
//! as it comes and shifted from some instant on, by whole samples or by the half that is a hold's, are scored on the
//! same readings as they come. At an alarm what a shifted one has gained is set against the others and another law.

use super::expected::{Expected, delay, is_held};
use super::price::delay_changes;
use crate::estimation::{Channel, Filter, TWENTY_TO_ONE, log_sum};
use crate::identify::window::Window;
use crate::law::State;
use serde::{Deserialize, Serialize};

/// Samples by which F, or q and q̇, may come later from one sample to the next.
const LATER: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

/// Samples by which F acts later once it is held that moved straight.
const HELD: f64 = 0.5;

/// All of them.
const SHIFTS: usize = LATER.len() + 1;

/// Samples after one until all of F is known that may act there.
const AHEAD: u64 = LATER[LATER.len() - 1] as u64;

/// Since when F acts at another time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lateness {
    /// By how many samples it acts later than before: half a one where it is held otherwise.
    pub later: f64,
    /// Number of the first sample whose F does.
    pub first: u64,
}

/// What the readings up to where all of F is known that may act say of channels that have begun to come late.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LateChannels {
    /// Number of the sample to come.
    next: u64,
    /// The state where nothing comes late; by how much a reading corrects it holds for the others too.
    nothing: Filter,
    shifted: [Shifted; SHIFTS],
}

/// A motion under which F acts at another time since a sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Shifted {
    since: Lateness,
    /// (q, q̇).
    mean: [f64; 2],
    /// Its log-odds against one in which nothing comes late.
    odds: f64,
}

impl LateChannels {
    /// Of a law in use that is at `state` after sample `number`, where F acts as is assumed.
    pub fn begin(law: &Expected, window: &Window, number: u64, state: &Filter) -> LateChannels {
        let held = if is_held(window.hold(), law.lag) { -HELD } else { HELD };
        let later: [f64; SHIFTS] = std::array::from_fn(|place| LATER.get(place).copied().unwrap_or(held));
        let none =
            |later| Shifted { since: Lateness { later, first: number }, mean: [0.0; 2], odds: f64::NEG_INFINITY };
        LateChannels { next: number + 1, nothing: *state, shifted: later.map(none) }
    }

    /// Takes what has come.
    pub fn follow(&mut self, law: &Expected, window: &Window) {
        self.go_on(law, window, window.ready().saturating_sub(AHEAD));
    }

    /// The likeliest and its log-odds against all others and another law, which has `odds` against none.
    pub fn weigh(mut self, law: &Expected, window: &Window, odds: f64) -> (Lateness, f64) {
        self.go_on(law, window, window.ready());
        self.shifted.sort_unstable_by(|a, b| b.odds.total_cmp(&a.odds));
        let [best, others @ ..] = &self.shifted;
        let rivals = others.iter().map(|other| other.odds).fold(odds, log_sum);
        (best.since, best.odds - rivals)
    }

    /// Takes the window's readings up to one before sample `end`.
    fn go_on(&mut self, law: &Expected, window: &Window, end: u64) {
        let rare = delay_changes(window.pace()).ln();
        for number in self.next..end {
            let LateChannels { nothing, shifted, .. } = self;
            // what has become unlikely is about to begin (Page 1954); before that it may have lost by chance, and one
            // that begins later than it did goes on from a state that is wrong already
            for own in shifted.iter_mut().filter(|own| own.odds <= rare - TWENTY_TO_ONE) {
                own.mean = delayed(law, window, number, own.since.later, nothing.state());
                (own.since.first, own.odds) = (number - 1, rare);
            }
            self.take(law, window, number);
        }
        self.next = end.max(self.next);
    }

    fn take(&mut self, law: &Expected, window: &Window, number: u64) {
        let LateChannels { nothing, shifted, .. } = self;
        let observation = window.observation(number);
        let noise = law.noise_with(observation.unseen, nothing.mean[0]);
        *nothing = Expected { noise, ..*law }.carry(nothing, observation.dt, &observation.drive);
        for Shifted { since, mean: [q, qd], .. } in &mut *shifted {
            let drive = window.drive_with(number, since.later);
            let moved = law.carry_state(State { q: *q, qd: *qd }, observation.dt, &drive);
            (*q, *qd) = (moved.q, moved.qd);
        }
        for channel in Channel::ALL {
            let index = channel as usize;
            let Some(measured) = observation.measured[index] else { continue };
            let own = nothing.update(channel, measured, noise.sensor[index]);
            for Shifted { mean, odds, .. } in &mut *shifted {
                let residual = measured - mean[index];
                *odds += 0.5 * own.precision * (own.residual * own.residual - residual * residual);
                mean.iter_mut().zip(own.gain).for_each(|(mean, gain)| *mean += gain * residual);
            }
        }
    }
}

/// (q, q̇) before sample `number` of a motion that begins to come late with it: where that was so long before.
fn delayed(law: &Expected, window: &Window, number: u64, later: f64, state: State) -> [f64; 2] {
    let time = delay(law.lag, later) * window.pace();
    let qdd = law.motion.acceleration(state, window.sample(number - 1).excitation);
    [state.q - time * state.qd, state.qd - time * qdd]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::faults::hindsight::settled;
    use crate::identify::faults::weighing::CERTAIN;
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

    /// An oscillator under white noise, from a sample on with F that comes so many samples late, or that moves straight
    /// until the next where it was held, and so many after it.
    fn window(later: f64, after: usize) -> Window {
        let mut window = Window::new(1000, Channels::ALL, Hold::Zero);
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        let mut noise = || generator.sample::<f64, _>(StandardNormal);
        let (mut state, mut forces) = (State { q: 1.0, qd: 0.0 }, vec![0.0, 20.0 * noise()]);
        for number in 0..BEGINS + after {
            let [from, next] = [forces[number], forces[number + 1]];
            let to = if later == -HELD && number > BEGINS { next } else { from };
            state = Motion::new(&TERMS, &LAW).step_linear(state, 1e-3, from, to);
            let (q, qd) = (state.q + NOISE * noise(), state.qd + NOISE * noise());
            forces.push(20.0 * noise());
            let late = if number > BEGINS { -later.trunc() as usize } else { 0 };
            window.push(Sample { t: 1e-3 * number as f64, q, qd, excitation: forces[number + 1 - late] });
        }
        window
    }

    /// What is found after `window` where it is taken so many samples at a time.
    fn found(later: f64, after: usize, at_a_time: usize) -> (Lateness, f64) {
        let law = Expected::of_oscillator(Motion::new(&TERMS, &LAW), NOISE);
        let before = window(later, 0);
        let state = settled(&law, &before, before.ready());
        let mut channels = LateChannels::begin(&law, &before, before.ready() - 1, &state);
        (at_a_time..=after).step_by(at_a_time).for_each(|after| channels.follow(&law, &window(later, after)));
        channels.weigh(&law, &window(later, after), 0.0)
    }

    #[test]
    fn what_begins_to_come_late_or_to_be_held_otherwise_is_found_where_it_does() {
        for (later, within) in [(-1.0, 4), (-2.0, 4), (-HELD, 30)] {
            let (own, odds) = found(later, 100, 1);
            assert!(own.later == later && own.first.abs_diff(BEGINS as u64) < within, "{own:?}");
            assert!(odds > CERTAIN, "{later}: {odds}");
        }
    }

    #[test]
    fn readings_that_come_one_by_one_say_what_they_say_together() {
        for later in [-1.0, -2.0, -HELD] {
            assert_eq!(found(later, 100, 1), found(later, 100, 20));
        }
    }

    /// A force that is held otherwise leaves the motion where it is; one whose readings come late stands still in them.
    #[test]
    fn a_hold_moves_no_motion() {
        let moved = [(0.0, HELD), (0.0, -HELD), (1.0, HELD), (0.0, 1.0), (1.0, -1.0), (0.0, -1.0), (-1.0, 2.0)];
        assert_eq!(moved.map(|(lag, later)| delay(lag, later)), [0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 1.0]);
    }

    #[test]
    fn nothing_comes_late_where_nothing_happens() {
        let (own, odds) = found(0.0, 100, 1);
        assert!(odds < -10.0, "{own:?} {odds}");
    }
}
