//! Integration in time of a law with any terms: effects with memory, delayed excitation, expressions.
//!
//! The coordinate's (q, q̇) and the internal states of the effects are integrated jointly by the classical Runge–Kutta
//! method (order 4). A step within which an internal state changes much is cut into parts, and one within which the
//! velocity reverses under dry friction is cut there. Laws without such terms are faster by [`Motion`].

use super::effect::Effect;
use super::history::History;
use super::memory::{LARGEST, parts};
use super::motion::{Motion, State};
use super::reversal::{MOST_CUTS, NEGLIGIBLE, REFINEMENTS, direction_from_rest, release, rest_within};
use super::term::Term;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The most internal states of a law.
pub const MAX_MEMORY: usize = 8;

/// Where a law with memory is: the coordinate and the internal states of its effects, in the order of its terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// Displacement and velocity.
    pub state: State,
    /// Internal states; those that no effect uses are 0.
    pub memory: [f64; MAX_MEMORY],
}

impl Phase {
    /// Whether all values are finite numbers.
    pub fn is_finite(&self) -> bool {
        self.state.is_finite() && self.memory.iter().all(|value| value.is_finite())
    }

    fn at_rest(self) -> Phase {
        Phase { state: State { qd: 0.0, ..self.state }, ..self }
    }

    fn moved(&self, slope: &Phase, dt: f64) -> Phase {
        let state = State { q: self.state.q + dt * slope.state.q, qd: self.state.qd + dt * slope.state.qd };
        Phase { state, memory: std::array::from_fn(|index| self.memory[index] + dt * slope.memory[index]) }
    }
}

/// Why a law cannot be integrated.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DynamicsError {
    /// More internal states than there is room for.
    #[error("the effects of the law have {count} internal states; at most {MAX_MEMORY} are supported")]
    Memory {
        /// How many they have.
        count: usize,
    },
    /// A term names an expression that is not there.
    #[error("{term} has no formula: the model has {count} expressions")]
    Expression {
        /// The term.
        term: Term,
        /// How many expressions there are.
        count: usize,
    },
}

/// A law with numbers whose terms may be any.
#[derive(Clone, Copy, Debug)]
pub struct Dynamics<'a> {
    motion: Motion<'a>,
}

/// The instant of a stage of a step: time, present excitation, and which of start, middle and end it is.
#[derive(Clone, Copy)]
struct Instant<'h, H> {
    history: &'h H,
    from: f64,
    to: f64,
    which: usize,
    excitation: f64,
}

impl<'h, H: History> Instant<'h, H> {
    fn at(t: f64, history: &'h H) -> Instant<'h, H> {
        Instant { history, from: t, to: t, which: 0, excitation: history.over(t, t)[0] }
    }

    fn t(&self) -> f64 {
        [self.from, 0.5 * (self.from + self.to), self.to][self.which]
    }

    fn delayed(&self, delay: f64) -> f64 {
        self.history.over(self.from - delay, self.to - delay)[self.which]
    }
}

impl<'a> Dynamics<'a> {
    /// The law of that motion.
    ///
    /// # Errors
    /// [`DynamicsError`] for too many internal states or an expression that is not there.
    pub fn new(motion: Motion<'a>) -> Result<Dynamics<'a>, DynamicsError> {
        let count = motion.terms.iter().filter_map(|term| term.effect()).map(Effect::memory_length).sum();
        if count > MAX_MEMORY {
            return Err(DynamicsError::Memory { count });
        }
        let absent = |term: &&Term| matches!(term, Term::Expression(own) if own.place() >= motion.own.len());
        match motion.terms.iter().find(absent) {
            Some(term) => Err(DynamicsError::Expression { term: *term, count: motion.own.len() }),
            None => Ok(Dynamics { motion }),
        }
    }

    /// The law at this state with nothing stored in its effects.
    pub fn rest(&self, state: State) -> Phase {
        let mut phase = Phase { state, ..Phase::default() };
        for (effect, first) in self.memories() {
            let length = effect.memory_length();
            phase.memory[first..first + length].copy_from_slice(&effect.rest(state, 0.0)[..length]);
        }
        phase
    }

    /// Moves from time `t` to `t + dt`, s, under that excitation.
    pub fn step<H: History>(&self, phase: &Phase, t: f64, dt: f64, excitation: &H) -> Phase {
        let rate = self.memories().map(|(effect, _)| effect.memory_rate(phase.state.qd)).fold(0.0, f64::max);
        let parts = parts(rate, dt);
        let width = dt / parts as f64;
        let start = |part: usize| t + width * part as f64;
        let dry = self.is_dry();
        (0..parts).fold(*phase, |phase, part| match dry {
            true => self.slide_through(phase, start(part), start(part + 1), excitation),
            false => self.runge_kutta(&phase, [start(part), start(part + 1)], excitation, None),
        })
    }

    /// q̈ at time `t`, s, under that excitation; 0 where dry friction holds it.
    pub fn acceleration<H: History>(&self, phase: &Phase, t: f64, history: &H) -> f64 {
        let direction = self.is_dry().then(|| match phase.state.qd {
            0.0 => self.direction(phase, t, history),
            qd => qd.signum(),
        });
        self.slope(phase, Instant::at(t, history), direction).state.qd
    }

    fn is_dry(&self) -> bool {
        let mut acting = self.motion.terms.iter().zip(self.motion.coefficients).filter(|(_, value)| **value != 0.0);
        acting.any(|(term, _)| term.effect().is_some_and(Effect::is_dry))
    }

    /// A step under dry friction, cut where the velocity comes to rest and where friction lets go.
    fn slide_through<H: History>(&self, mut phase: Phase, mut from: f64, to: f64, history: &H) -> Phase {
        let mut direction = match phase.state.qd {
            0.0 => self.direction(&phase, from, history),
            qd => qd.signum(),
        };
        for _ in 1..MOST_CUTS {
            let until = |share: f64| from + share * (to - from);
            let go = |share: f64| self.runge_kutta(&phase, [from, until(share)], history, Some(direction));
            if direction == 0.0 {
                let pulls = |share: f64| self.pulls(&go(share), until(share), history);
                let Some((share, slides)) = release(0.0, pulls) else { return go(1.0) };
                (phase, from, direction) = (go(share), until(share), slides);
                continue;
            }
            let end = go(1.0);
            let Some(share) = self.rest_within(&phase, &end, [from, to], history, direction) else { return end };
            let share = refined(share, |share| {
                let (end, t) = (go(share), until(share));
                end.state.qd / (self.sliding(&end, t, history, direction) * (to - from))
            });
            (phase, from) = (go(share).at_rest(), until(share));
            direction = self.direction(&phase, from, history);
        }
        self.runge_kutta(&phase, [from, to], history, Some(direction))
    }

    fn rest_within<H: History>(
        &self,
        start: &Phase,
        end: &Phase,
        times: [f64; 2],
        history: &H,
        direction: f64,
    ) -> Option<f64> {
        let rate = |phase: &Phase, t: f64| (times[1] - times[0]) * self.sliding(phase, t, history, direction);
        rest_within(direction, [start.state.qd, end.state.qd], [rate(start, times[0]), rate(end, times[1])])
    }

    /// q̈ of a motion that slides in a direction.
    fn sliding<H: History>(&self, phase: &Phase, t: f64, history: &H, direction: f64) -> f64 {
        self.slope(phase, Instant::at(t, history), Some(direction)).state.qd
    }

    /// q̈ from rest if it slid forward and if it slid backward.
    fn pulls<H: History>(&self, phase: &Phase, t: f64, history: &H) -> [f64; 2] {
        [1.0, -1.0].map(|direction| self.sliding(&phase.at_rest(), t, history, direction))
    }

    fn direction<H: History>(&self, phase: &Phase, t: f64, history: &H) -> f64 {
        let [forward, backward] = self.pulls(phase, t, history);
        direction_from_rest(forward, backward)
    }

    /// `direction`: none where dry friction follows the velocity; +1 or −1 where it slides that way; 0 where it sticks.
    fn runge_kutta<H: History>(
        &self,
        phase: &Phase,
        [from, to]: [f64; 2],
        history: &H,
        direction: Option<f64>,
    ) -> Phase {
        let values = history.over(from, to);
        let at = |which: usize| Instant { history, from, to, which, excitation: values[which] };
        let dt = to - from;
        let first = self.slope(phase, at(0), direction);
        let second = self.slope(&phase.moved(&first, 0.5 * dt), at(1), direction);
        let third = self.slope(&phase.moved(&second, 0.5 * dt), at(1), direction);
        let fourth = self.slope(&phase.moved(&third, dt), at(2), direction);
        let outer = phase.moved(&first, dt / 6.0).moved(&fourth, dt / 6.0);
        outer.moved(&second, dt / 3.0).moved(&third, dt / 3.0)
    }

    fn slope<H: History>(&self, phase: &Phase, instant: Instant<H>, direction: Option<f64>) -> Phase {
        let mut slope = Phase::default();
        let mut force = 0.0;
        let mut first = 0;
        for (term, coefficient) in self.motion.terms.iter().zip(self.motion.coefficients) {
            let memory = &phase.memory[first..];
            let sliding =
                direction.and_then(|direction| term.effect()?.sliding(phase.state, instant.excitation, direction));
            let own = sliding.unwrap_or_else(|| self.force(*term, phase.state, memory, &instant));
            force += coefficient * own;
            if let Some(effect) = term.effect().filter(|effect| effect.memory_length() > 0) {
                let length = effect.memory_length();
                let rates: [f64; LARGEST] = effect.memory_slope(phase.state, instant.excitation, memory);
                slope.memory[first..first + length].copy_from_slice(&rates[..length]);
                first += length;
            }
        }
        if direction == Some(0.0) {
            return slope;
        }
        let acceleration = (instant.excitation - force) / self.motion.mass(phase.state.q);
        slope.state = State { q: phase.state.qd, qd: acceleration };
        slope
    }

    /// The feature of a term without its part that multiplies q̈; `memory` begins with the term's own states.
    fn force<H: History>(&self, term: Term, state: State, memory: &[f64], instant: &Instant<H>) -> f64 {
        match term {
            Term::Effect(Effect::ExcitationDelay { delay }) => instant.excitation - instant.delayed(delay.value()),
            Term::Effect(effect) if effect.memory_length() > 0 => effect.feature(state, instant.excitation, memory),
            Term::Expression(own) => {
                self.motion.own[own.place()].value_of(&own, state.q, state.qd, instant.excitation, instant.t())
            }
            _ => term.force(state.q, state.qd, instant.excitation),
        }
    }

    /// The effects with internal states, and where those begin.
    fn memories(&self) -> impl Iterator<Item = (Effect, usize)> {
        let effects = self.motion.terms.iter().filter_map(|term| term.effect());
        effects.filter(|effect| effect.memory_length() > 0).scan(0, |next, effect| {
            let first = *next;
            *next += effect.memory_length();
            Some((effect, first))
        })
    }
}

/// A share of a step after Newton's steps `by` of it.
fn refined(mut share: f64, by: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..REFINEMENTS {
        let step = by(share);
        if step.is_nan() || step.abs() < NEGLIGIBLE {
            break;
        }
        share = (share - step).clamp(NEGLIGIBLE, 1.0);
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::expression::Expression;
    use crate::law::history::Samples;
    use crate::law::hold::Hold;
    use crate::law::own::Own;

    fn effect(id: &str, inner: &[f64]) -> Term {
        Term::Effect(Effect::prototype(id).unwrap().with_inner(inner).unwrap())
    }

    fn terms(more: &[Term]) -> Vec<Term> {
        [&[Term::Inertia, Term::power(0, 1), Term::power(1, 0), Term::power(3, 0)], more].concat()
    }

    fn end(terms: &[Term], coefficients: &[f64], steps: usize) -> Phase {
        let drag = Expression::parse("drag", "tanh(3*qd) + 0.2*sin(t)*F").unwrap();
        let expressions = [drag];
        let dynamics = Dynamics::new(Motion::new(terms, coefficients).with(&expressions)).unwrap();
        let dt = 2.0 / steps as f64;
        let excitation = |t: f64| 1.5 * (1.3 * t).sin() + 0.2;
        let start = dynamics.rest(State { q: 0.8, qd: -0.3 });
        (0..steps).fold(start, |phase, step| dynamics.step(&phase, step as f64 * dt, dt, &excitation))
    }

    #[test]
    fn converges_with_order_four() {
        let resonator = effect("hidden_resonator", &[3.0, 0.05]);
        let smooth = [resonator, effect("excitation_delay", &[0.23]), Term::Expression(Own::new(0, "x", false, &[]))];
        let terms = terms(&smooth);
        let coefficients = [1.3, 0.3, 4.0, 0.7, 0.4, 0.6, 0.3];
        let exact = end(&terms, &coefficients, 8192);
        let error = |steps| {
            let phase = end(&terms, &coefficients, steps);
            (phase.state.q - exact.state.q).abs() + (phase.memory[1] - exact.memory[1]).abs()
        };
        for steps in [64, 128, 256] {
            let order = (error(steps) / error(2 * steps)).log2();
            assert!((3.7..4.4).contains(&order), "order {order} from {steps} steps");
        }
    }

    #[test]
    fn a_law_without_memory_moves_as_motion_does() {
        let terms = terms(&[effect("dead_zone_stiffness", &[0.2])]);
        let motion = Motion::new(&terms, &[1.3, 0.3, 4.0, 0.7, 2.0]);
        let dynamics = Dynamics::new(motion).unwrap();
        let state = State { q: 0.8, qd: -0.3 };
        let moved = dynamics.step(&dynamics.rest(state), 0.0, 0.01, &|t: f64| 0.4 + 3.0 * t).state;
        let expected = motion.step_linear(state, 0.01, 0.4, 0.43);
        assert!((moved.q - expected.q).abs() < 1e-15 && (moved.qd - expected.qd).abs() < 1e-14);
    }

    #[test]
    fn reversals_under_dry_friction_are_met_with_order_four_and_sticking_is_seen() {
        let friction = [Term::Effect(Effect::CoulombFriction), effect("hidden_resonator", &[3.0, 0.05])];
        let terms = terms(&friction);
        for (force, sticks) in [(0.15, false), (1.4, true)] {
            let coefficients = [1.3, 0.3, 4.0, 0.7, force, 0.2];
            let exact = end(&terms, &coefficients, 4096);
            let error = |steps| {
                let phase = end(&terms, &coefficients, steps);
                (phase.state.q - exact.state.q).abs() + (phase.memory[1] - exact.memory[1]).abs()
            };
            let [coarse, fine] = [64, 256].map(error);
            assert!(coarse < 1e-5 && fine < coarse / 100.0, "sticks: {sticks}; {coarse:e}, {fine:e}");
        }
    }

    #[test]
    fn a_hidden_mass_moves_as_two_coupled_masses_do() {
        let (mass, stiffness, hidden, omega) = (2.0, 5.0, 0.5, 3.0);
        let terms = [Term::Inertia, Term::power(1, 0), effect("hidden_resonator", &[omega, 0.0])];
        let coefficients = [mass, stiffness, hidden];
        let motion = Motion::new(&terms, &coefficients);
        let dynamics = Dynamics::new(motion).unwrap();
        let mut phase = dynamics.rest(State { q: 0.3, qd: 0.0 });
        let energy = |phase: &Phase| {
            let ([y, yd, ..], State { q, qd }) = (phase.memory, phase.state);
            0.5 * (mass * qd * qd + stiffness * q * q + hidden * (yd * yd + omega * omega * (q - y).powi(2)))
        };
        let before = energy(&phase);
        (0..4000).for_each(|step| phase = dynamics.step(&phase, step as f64 * 5e-3, 5e-3, &|_: f64| 0.0));
        assert!((energy(&phase) / before - 1.0).abs() < 1e-7);
        assert!((phase.memory[0] - phase.state.q).abs() > 1e-3, "the hidden mass moves on its own");
    }

    #[test]
    fn a_delay_with_coefficient_one_is_a_later_excitation() {
        let (base, delay) = (terms(&[]), 0.0435);
        let late = terms(&[effect("excitation_delay", &[delay])]);
        let coefficients = [1.3, 0.3, 4.0, 0.7, 1.0];
        let excitation = |t: f64| (2.0 * t).sin() + t;
        let here = Dynamics::new(Motion::new(&late, &coefficients)).unwrap();
        let there = Dynamics::new(Motion::new(&base, &coefficients[..4])).unwrap();
        let phase = here.rest(State { q: 0.8, qd: -0.3 });
        let a = here.step(&phase, 1.0, 0.01, &excitation);
        let b = there.step(&phase, 1.0, 0.01, &|t: f64| excitation(t - delay));
        assert!((a.state.q - b.state.q).abs() < 1e-15 && (a.state.qd - b.state.qd).abs() < 1e-14);
    }

    #[test]
    fn hysteresis_saturates_at_its_yield_displacement() {
        let terms = [Term::Inertia, effect("hysteresis", &[0.05, 0.7, 1.6])];
        let dynamics = Dynamics::new(Motion::new(&terms, &[1.0, 0.0])).unwrap();
        let start = dynamics.rest(State { q: 0.0, qd: 2.0 });
        let there = (0..100).fold(start, |phase, step| dynamics.step(&phase, step as f64 * 0.01, 0.01, &|_: f64| 0.0));
        assert!((there.memory[0] - 0.05).abs() < 1e-9, "{}", there.memory[0]);
    }

    #[test]
    fn a_held_excitation_that_jumps_within_the_delayed_step_keeps_its_impulse() {
        let times: Vec<f64> = (0..20).map(|index| f64::from(index) * 0.01).collect();
        let force: Vec<f64> = (0..20).map(|index| f64::from(index * index % 7)).collect();
        let samples = Samples { t: &times, excitation: &force, hold: Hold::Zero };
        let terms = [Term::Inertia, effect("excitation_delay", &[0.013])];
        let dynamics = Dynamics::new(Motion::new(&terms, &[1.0, 1.0])).unwrap();
        let step = |phase, step: usize| dynamics.step(&phase, times[step], 0.01, &samples);
        let velocity = (0..19).fold(dynamics.rest(State::default()), step).state.qd;
        let expected = force[0] * 0.013 + force[..17].iter().sum::<f64>() * 0.01 + force[17] * 0.007;
        assert!((velocity - expected).abs() < 1e-12, "{velocity} against {expected}");
    }

    #[test]
    fn what_cannot_be_integrated_is_refused() {
        let many: Vec<Term> = (1..6).map(|n| effect("hidden_resonator", &[f64::from(n), 0.0])).collect();
        let motion = Motion::new(&many, &[1.0; 5]);
        assert_eq!(Dynamics::new(motion).unwrap_err(), DynamicsError::Memory { count: 10 });
        let absent = [Term::Expression(Own::new(1, "x", false, &[]))];
        let motion = Motion::new(&absent, &[1.0]);
        assert!(matches!(Dynamics::new(motion), Err(DynamicsError::Expression { .. })));
    }
}
