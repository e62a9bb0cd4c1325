//! Whether what speaks for a switch is a burst of readings none of which was far enough off to be held.
//!
//! At an alarm the readings since shortly before the suspected instant are weighed once more: by the hypothesis of
//! those that are held, under which any of them may be a wide draw, by the same with draws that lie to one side, and by
//! louder sensors. What the likeliest gains on the law in use alone is set against the evidence of a switch, on the
//! samples that speak for one. A burst that was told is weighed again at the next alarm, with what has come since.

use super::expected::Expected;
use super::hypothesis::{Hypothesis, Value, under_law};
use super::kind::Kind;
use super::price::{event, working};
use super::quarantine::ROOM;
use crate::estimation::{Channel, Filter, Observation, TWENTY_TO_ONE};
use crate::identify::sample::is_outage;
use crate::identify::window::Window;
use serde::{Deserialize, Serialize};

/// Samples before the suspected instant of a switch in which a burst may have begun that looks like one: starts of a
/// switch lie two samples apart, older ones more.
const BEFORE: u64 = 8;

/// Samples that the state before them is taken from: its std falls about as the root of their number, to 7 % of a
/// reading's.
const SETTLE: u64 = 3 * ROOM as u64;

/// What else may have begun then: another law, to which a switch of the usual size led or one of ten times that (what
/// linear evidence sets aside as far off speaks for these), or louder sensors.
const EVENTS: [Kind; 5] = [
    Kind::Law { times: 1, unnoticed: false },
    Kind::Law { times: 10, unnoticed: false },
    Kind::Louder(Channel::Q),
    Kind::Louder(Channel::Qd),
    Kind::BothLouder,
];

/// The readings since a suspected switch, once more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hindsight {
    bursts: [Hypothesis; 2],
    /// Which burst is the likelier.
    likelier: usize,
    events: [Hypothesis; EVENTS.len()],
    first: u64,
    /// The burst that was told last, as long as it may turn out to be none.
    told: Option<Told>,
}

/// A burst that was told.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Told {
    /// Numbers of the first sample that was weighed and of the first that was not.
    span: [u64; 2],
    /// Which readings were left out: one bit a sample from the first on, by channel.
    left_out: [u64; 2],
}

/// A fault of the sensors in the readings since a suspected switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Its log-odds against another law.
    pub odds: f64,
    /// Log-odds of another law against nothing.
    pub law: f64,
    /// Whether it is a burst, whose readings do not count, or louder sensors.
    pub is_burst: bool,
}

impl Hindsight {
    /// With nothing weighed.
    pub fn new() -> Hindsight {
        let new = |kind| Hypothesis::new(kind, ROOM);
        Hindsight {
            bursts: [Kind::Readings, Kind::OneSided].map(new),
            likelier: 0,
            events: EVENTS.map(new),
            first: 0,
            told: None,
        }
    }

    /// The likeliest fault against another law since sample `switch`, which has `evidence` nats, by the window's
    /// samples, the last of them where there is no room for all.
    pub fn weigh(&mut self, law: &Expected, window: &mut Window, (switch, evidence): (u64, f64)) -> Found {
        let oldest = (window.resumed() + 2).max(window.ready().saturating_sub(ROOM as u64));
        if oldest >= window.ready() {
            return Found { odds: f64::NEG_INFINITY, law: f64::INFINITY, is_burst: false };
        }
        self.first = switch.saturating_sub(BEFORE).max(oldest);
        self.doubt_told(window, oldest);
        let before = settled(law, window, self.first);
        self.take_all(law, window, before);
        // when in its first interval a law changed nobody knows, but what it did there is as large as what it did after
        self.events.iter_mut().for_each(Hypothesis::learn_change);
        let log = self.take_all(law, window, before);
        let rare = event(window.pace()).ln();
        let burst = self.likelier_burst(window, log);
        let likeliest = |is_law: bool| {
            let of = self.events.iter().filter(|other| other.kind.is_law() == is_law);
            of.map(|other| other.log).fold(f64::NEG_INFINITY, f64::max)
        };
        let (law, louder) = (likeliest(true).max(log + evidence + rare), likeliest(false));
        let odds = burst.max(louder) - law;
        self.told = self.told.filter(|_| odds > -TWENTY_TO_ONE);
        if let Some(told) = self.told {
            told.set_faulty(window, true);
        }
        Found { odds, law: law - log, is_burst: burst > louder }
    }

    /// What was a burst until now may have been how a switch began: as long as there is room for its readings and the
    /// suspected switch goes on from them they count once more.
    fn doubt_told(&mut self, window: &mut Window, oldest: u64) {
        self.told = self.told.filter(|told| told.span[0] >= oldest && told.span[1] >= self.first);
        if let Some(told) = self.told {
            self.first = told.span[0];
            told.set_faulty(window, false);
        }
    }

    /// Finds the likelier burst; returns its log-density of the readings, less the share of what has no burst, `log`
    /// being that of the law in use. None lasts for as long as an outage.
    fn likelier_burst(&mut self, window: &Window, log: f64) -> f64 {
        self.likelier = usize::from(self.bursts[1].log > self.bursts[0].log);
        let burst = self.bursts[self.likelier].log;
        if lasts(window, self.first) { f64::NEG_INFINITY } else { burst + (-(log - burst).min(0.0).exp()).ln_1p() }
    }

    /// The burst is what has happened: its readings do not count. Returns which channels have any.
    pub fn leave_out(&mut self, window: &mut Window) -> [bool; 2] {
        if let Some(before) = self.told {
            before.set_faulty(window, false);
        }
        let told = Told { span: [self.first, window.ready()], left_out: self.bursts[self.likelier].left_out() };
        told.set_faulty(window, true);
        self.told = Some(told);
        told.left_out.map(|readings| readings != 0)
    }

    /// Takes the samples from the first on, `nothing` being the state before it; returns the log-density of their
    /// readings under the law in use alone.
    fn take_all(&mut self, law: &Expected, window: &Window, mut nothing: Filter) -> f64 {
        let rare = event(window.pace()).ln();
        let mut log = 0.0;
        self.bursts.iter_mut().for_each(|burst| burst.begin(&under_law(&nothing), law, 0.0, 0.0, 0.0));
        let first = self.first;
        for (place, number) in (first..window.ready()).enumerate() {
            let observation = window.observation(number);
            let law = Expected { noise: law.noise_with(observation.unseen, nothing.mean[0]), ..*law };
            let values = observation.measured.map(|value| value.map(|value| Value { value, repeats: None }));
            let Observation { dt, drive, .. } = observation;
            let start = under_law(&nothing);
            // what has not become likelier than it was is about to begin (Page 1954)
            for event in self.events.iter_mut().filter(|event| number == first || event.log - log <= event.prior) {
                event.begin(&start, &law, dt, log, rare - event.kind.rarity());
            }
            log += take(&law, &observation, &mut nothing);
            self.bursts.iter_mut().for_each(|burst| burst.take(&law, dt, &drive, values, place));
            self.events.iter_mut().for_each(|event| event.take(&law, dt, &drive, values, place));
        }
        log
    }

    /// The state after the last sample, and what is known of it.
    pub fn filter(&self) -> Filter {
        self.bursts[self.likelier].filter()
    }

    /// Forgets all of it.
    pub fn clear(&mut self) {
        self.bursts.iter_mut().for_each(Hypothesis::clear);
        self.events.iter_mut().for_each(Hypothesis::clear);
    }
}

impl Told {
    /// The readings that were left out do not count, or do after all.
    fn set_faulty(&self, window: &mut Window, are_faulty: bool) {
        let [first, next] = self.span;
        for number in first..next {
            let left_out = self.left_out.map(|readings| readings >> (number - first) & 1 == 1);
            window.set_faulty(number, left_out, are_faulty);
        }
    }
}

/// Whether no reading before sample `first` has counted for as long as an outage.
fn lasts(window: &Window, first: u64) -> bool {
    let counts = |number: &u64| window.observation(*number).measured != [None; 2];
    let last = (window.resumed() + 1..first).rev().find(counts).unwrap_or(window.resumed());
    is_outage(window.sample(first).t - window.sample(last).t, window.pace())
}

/// The state before sample `first`.
pub fn settled(law: &Expected, window: &Window, first: u64) -> Filter {
    let begin = first.saturating_sub(SETTLE).max(window.resumed());
    let sample = window.sample(begin);
    let known = window.observation(begin + 1).measured;
    // as far as the restoring acceleration takes it in a radian
    let velocity = law.switch[0] / law.rate;
    let (mut mean, mut variances) = ([0.0; 2], [velocity / law.rate, velocity].map(|size| size * size));
    for (channel, value) in [sample.q, sample.qd].into_iter().enumerate() {
        if known[channel].is_some() {
            (mean[channel], variances[channel]) = (value, law.noise.sensor[channel]);
        }
    }
    let mut filter = Filter::begin(mean, variances);
    for number in begin + 1..first {
        let observation = window.observation(number);
        let law = Expected { noise: law.noise_with(observation.unseen, filter.mean[0]), ..*law };
        take(&law, &observation, &mut filter);
    }
    filter
}

/// Goes on to a sample; returns the log-density of its readings.
pub(super) fn take(law: &Expected, observation: &Observation, filter: &mut Filter) -> f64 {
    *filter = law.carry(filter, observation.dt, &observation.drive);
    let mut log = 0.0;
    for channel in Channel::ALL {
        let index = channel as usize;
        if let Some(measured) = observation.measured[index] {
            let innovation = filter.update(channel, measured, law.noise.sensor[index]);
            log += working(innovation.residual, innovation.variance);
        }
    }
    log
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::sample::Sample;
    use crate::identify::settings::Channels;
    use crate::law::{Hold, Motion, State, Term};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const NOISE: f64 = 0.01;

    /// Number of the last sample before it happens.
    const BEFORE_IT: u64 = 299;

    const TERMS: [Term; 3] = [Term::Inertia, Term::power(0, 1), Term::power(1, 0)];

    /// A free oscillator at 1 kHz, whose stiffness becomes this, and to the readings of whose velocity those are added.
    fn window(stiffness: f64, added: &[f64]) -> Window {
        window_of(stiffness, added, 20)
    }

    /// The same with so many samples since it happened.
    fn window_of(stiffness: f64, added: &[f64], since: u64) -> Window {
        let mut window = Window::new(1000, Channels::ALL, Hold::Zero);
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        let mut state = State { q: 1.0, qd: 0.0 };
        for number in 0..=BEFORE_IT + since {
            let own = if number > BEFORE_IT { [1.0, 0.3, stiffness] } else { [1.0, 0.3, 4.0] };
            state = Motion::new(&TERMS, &own).step_linear(state, 1e-3, 0.0, 0.0);
            let place = number.checked_sub(BEFORE_IT + 1);
            let added = place.and_then(|place| added.get(place as usize)).unwrap_or(&0.0);
            let mut noise = || NOISE * generator.sample::<f64, _>(StandardNormal);
            let (q, qd) = (state.q + noise(), state.qd + noise() + NOISE * added);
            window.push(Sample { t: 1e-3 * number as f64, q, qd, ..Sample::default() });
        }
        window
    }

    fn odds(hindsight: &mut Hindsight, window: &mut Window, evidence: f64) -> f64 {
        found(hindsight, window, evidence).odds
    }

    fn found(hindsight: &mut Hindsight, window: &mut Window, evidence: f64) -> Found {
        let law = Expected::of_oscillator(Motion::new(&TERMS, &[1.0, 0.3, 4.0]), NOISE);
        hindsight.weigh(&law, window, (BEFORE_IT, evidence))
    }

    #[test]
    fn readings_of_which_none_is_far_off_are_a_burst_and_are_left_out() {
        let burst: Vec<f64> = (0..20).map(|k| [3.4, -3.2, -3.6][k % 3]).collect();
        let (mut hindsight, mut window) = (Hindsight::new(), window(4.0, &burst));
        assert!(odds(&mut hindsight, &mut window, 17.0) > 3.0);
        assert_eq!(hindsight.leave_out(&mut window), [false, true]);
        let of_burst: Vec<u64> = (0..20).filter(|number| left_out(&window, BEFORE_IT + 1 + number)).collect();
        assert!(of_burst.len() > 12 && !left_out(&window, BEFORE_IT), "{of_burst:?}");
    }

    fn left_out(window: &Window, number: u64) -> bool {
        window.observation(number).measured[1].is_none()
    }

    /// A law that bends q̇ does not step it: a ramp leaves a quarter of what they say, and it is ten times too steep.
    #[test]
    fn readings_to_one_side_are_a_burst_also_where_none_is_far_off() {
        for added in
            [[3.0; 15].as_slice(), &[1.5, 4.0, 3.0, 2.0, 3.8, 2.5, 1.6, 3.9, 3.5, 2.2, 2.9, 3.4, 2.4, 3.1, 2.7]]
        {
            let found = found(&mut Hindsight::new(), &mut window(4.0, added), 17.0);
            assert!(found.odds > 3.0 && found.is_burst, "{added:?}: {found:?}");
        }
    }

    /// Chance makes the first readings after a switch look like a step.
    #[test]
    fn a_burst_after_which_the_motion_does_not_return_was_none() {
        let mut hindsight = Hindsight::new();
        let added: Vec<f64> = (0..40).map(|k| if k < 8 { 4.3 } else { 4.3 + 0.6 * f64::from(k - 8) }).collect();
        let mut at_first = window_of(4.0, &added, 8);
        assert!(odds(&mut hindsight, &mut at_first, 17.0) > 3.0);
        hindsight.leave_out(&mut at_first);
        let mut window = window_of(4.0, &added, 30);
        (0..8).for_each(|number| window.set_faulty(BEFORE_IT + 1 + number, [false, true], true));
        let law = Expected::of_oscillator(Motion::new(&TERMS, &[1.0, 0.3, 4.0]), NOISE);
        let found = hindsight.weigh(&law, &mut window, (BEFORE_IT + 12, 17.0));
        assert!(found.odds < -3.0, "{found:?}");
        assert!((0..8).all(|number| !left_out(&window, BEFORE_IT + 1 + number)));
    }

    /// What was left out before was so under the same law.
    #[test]
    fn no_burst_lasts_for_as_long_as_an_outage() {
        for (left_out, is_burst) in [(40, true), (60, false)] {
            let mut window = window(4.0, &[8.0, -8.0, 7.0, -9.0, 8.0]);
            (BEFORE_IT - left_out..=BEFORE_IT).for_each(|number| window.set_faulty(number, [true; 2], true));
            let found = found(&mut Hindsight::new(), &mut window, 17.0);
            assert_eq!(found.is_burst, is_burst, "{left_out}: {found:?}");
        }
    }

    #[test]
    fn a_switch_of_law_is_no_burst_whatever_linear_evidence_says() {
        let mut hindsight = Hindsight::new();
        assert!(odds(&mut hindsight, &mut window(16.0, &[]), 0.0) < -3.0);
    }

    #[test]
    fn what_nothing_speaks_for_is_none() {
        let mut hindsight = Hindsight::new();
        assert!(odds(&mut hindsight, &mut window(4.0, &[]), 17.0) < -3.0);
    }
}
