//! What a term is at every sample of a given motion.

use super::effect::Effect;
use super::expression::Expression;
use super::history::Samples;
use super::hold::Hold;
use super::hysteresis_loop::{Loop, Place};
use super::memory::{LARGEST, lagged, parts};
use super::motion::State;
use super::term::Term;

/// Share of what a loop can store that no reading would show.
const FORGOTTEN: f64 = 0.01;

/// A motion at instants, measured or estimated; all slices are of one length.
#[derive(Clone, Copy, Debug)]
pub struct Trajectory<'a> {
    /// Time, s, increasing.
    pub t: &'a [f64],
    /// Displacement, m.
    pub q: &'a [f64],
    /// Velocity, m/s.
    pub qd: &'a [f64],
    /// Excitation, N.
    pub excitation: &'a [f64],
    /// What the excitation did between samples.
    pub hold: Hold,
}

impl<'a> Trajectory<'a> {
    /// The excitation alone.
    pub fn samples(&self) -> Samples<'a> {
        Samples { t: self.t, excitation: self.excitation, hold: self.hold }
    }

    /// The same from that sample on.
    pub fn after(&self, first: usize) -> Trajectory<'a> {
        let Trajectory { t, q, qd, excitation, hold } = *self;
        let first = first.min(t.len());
        Trajectory { t: &t[first..], q: &q[first..], qd: &qd[first..], excitation: &excitation[first..], hold }
    }

    pub(super) fn state(&self, index: usize) -> State {
        State { q: self.q[index], qd: self.qd[index] }
    }

    /// The state at a share of the way from a sample to the next: q by the cubic that has both displacements and
    /// velocities, q̇ on a straight line, so that noise of q does not enter it.
    fn between(&self, index: usize, share: f64) -> State {
        let (from, to) = (self.state(index), self.state(index + 1));
        let width = self.t[index + 1] - self.t[index];
        let bend = share * (1.0 - share);
        let slope = (to.q - from.q) / width;
        let turn = (1.0 - share) * (from.qd - slope) - share * (to.qd - slope);
        State { q: from.q + share * (to.q - from.q) + width * bend * turn, qd: from.qd + share * (to.qd - from.qd) }
    }
}

/// The force of a term, per unit of its coefficient, at every sample of a motion.
///
/// The part of a term that multiplies q̈ is left out, so that the inertia's series is 0. Internal states start with
/// nothing stored (z = 0; the hidden mass moving with the coordinate) and are integrated along the motion, of order 2
/// in the sample interval. The series of an actuator's lag takes the excitation on straight lines between samples, from
/// rest under the first; that of a delay of a held excitation is the mean over each sample's cell (half an interval to
/// either side), whose trapezoidal integral is that of the jumps. An expression that `expressions` do not have gives
/// NaN.
pub fn term_series(term: Term, expressions: &[Expression], trajectory: &Trajectory) -> Vec<f64> {
    let n = trajectory.t.len();
    match term {
        Term::Effect(Effect::ExcitationDelay { delay }) => {
            let samples = trajectory.samples();
            let at = |shift: f64| (0..n).map(move |k| centred(&samples, k, shift));
            at(0.0).zip(at(delay.value())).map(|(now, before)| now - before).collect()
        }
        Term::Effect(Effect::Relaxation { time }) => followed(trajectory.t, trajectory.qd, 0.0, time.value()),
        Term::Effect(Effect::ActuatorLag { time }) => {
            let force = trajectory.excitation;
            let acting = followed(trajectory.t, force, force.first().copied().unwrap_or(0.0), time.value());
            force.iter().zip(acting).map(|(now, acting)| now - acting).collect()
        }
        Term::Effect(effect) if effect.memory_length() > 0 => memory_series(effect, trajectory),
        Term::Expression(own) => match expressions.get(own.place()) {
            Some(expression) => {
                points(trajectory, |k, q, qd, force| expression.value_of(&own, q, qd, force, trajectory.t[k]))
            }
            None => vec![f64::NAN; n],
        },
        _ => points(trajectory, |_, q, qd, excitation| term.force(q, qd, excitation)),
    }
}

fn points(trajectory: &Trajectory, value: impl Fn(usize, f64, f64, f64) -> f64) -> Vec<f64> {
    let Trajectory { t, q, qd, excitation, .. } = trajectory;
    (0..t.len()).map(|k| value(k, q[k], qd[k], excitation[k])).collect()
}

/// F(t_k − shift); of a held excitation its mean over the sample's cell.
fn centred(samples: &Samples, k: usize, shift: f64) -> f64 {
    let t = samples.t;
    let (before, after) = (k.saturating_sub(1), (k + 1).min(t.len() - 1));
    let (from, to) = (0.5 * (t[before] + t[k]), 0.5 * (t[k] + t[after]));
    match samples.hold {
        Hold::Zero if to > from => samples.held_mean(from - shift, to - shift),
        _ => samples.at(t[k] - shift),
    }
}

fn memory_series(effect: Effect, trajectory: &Trajectory) -> Vec<f64> {
    let n = trajectory.t.len();
    let Some(last) = n.checked_sub(1) else { return Vec::new() };
    if let Some(shape) = Loop::of(effect) {
        return looped(&shape, trajectory);
    }
    let mut memory = effect.rest(trajectory.state(0), trajectory.excitation[0]);
    let mut series = Vec::with_capacity(n);
    for k in 0..last {
        series.push(effect.feature(trajectory.state(k), trajectory.excitation[k], &memory));
        memory = follow(effect, trajectory, k, memory);
    }
    series.push(effect.feature(trajectory.state(last), trajectory.excitation[last], &memory));
    series
}

/// y with τ ẏ = u − y where u runs straight between samples, from y at the first.
fn followed(t: &[f64], u: &[f64], first: f64, time: f64) -> Vec<f64> {
    let mut y = first;
    let next = |k: usize| {
        let dt = t[k + 1] - t[k];
        y = lagged(y, time, [u[k], (u[k + 1] - u[k]) / dt, 0.0], dt);
        y
    };
    let others: Vec<f64> = (0..t.len().saturating_sub(1)).map(next).collect();
    u.first().map(|_| first).into_iter().chain(others).collect()
}

/// From which sample on the series of a term is the same, within a hundredth, whatever was stored in it when the motion
/// began: two loops that began with nearly the most either way are then alike, what fades has faded. None where that is
/// never; 0 for a term without a memory.
pub fn forgets(term: Term, trajectory: &Trajectory) -> Option<usize> {
    if let Some(time) = term.effect().and_then(Effect::fading_time) {
        let from = trajectory.t.first()? - time * FORGOTTEN.ln();
        return trajectory.t.iter().position(|t| *t >= from);
    }
    let shape = term.effect().and_then(|effect| Some((Loop::of(effect)?, effect.largest_state()?)));
    let Some((shape, most)) = shape.filter(|_| !trajectory.t.is_empty()) else { return Some(0) };
    let nearly = (1.0 - FORGOTTEN) * most;
    let [low, high] = [-nearly, nearly].map(|state| places(&shape, trajectory, state));
    let apart = |(low, high): (&Place, &Place)| shape.state(*high) - shape.state(*low) > FORGOTTEN * most;
    let last = low.iter().zip(&high).rposition(apart);
    last.map_or(Some(0), |last| Some(last + 1).filter(|first| *first < low.len()))
}

/// The feature of a loop that begins with nothing stored.
fn looped(shape: &Loop, trajectory: &Trajectory) -> Vec<f64> {
    places(shape, trajectory, 0.0).into_iter().map(|place| shape.feature(place)).collect()
}

/// Where on a loop a motion is that begins with this stored in it.
fn places(shape: &Loop, trajectory: &Trajectory, state: f64) -> Vec<Place> {
    let mut places = vec![shape.place(state, trajectory.qd[0])];
    for k in 0..trajectory.t.len() - 1 {
        let states = [trajectory.state(k), trajectory.state(k + 1)];
        places.push(shape.followed(places[k], states, |share| trajectory.between(k, share).q));
    }
    places
}

/// The internal states at sample `k + 1`.
fn follow(effect: Effect, trajectory: &Trajectory, k: usize, memory: [f64; LARGEST]) -> [f64; LARGEST] {
    let dt = trajectory.t[k + 1] - trajectory.t[k];
    let speed = trajectory.qd[k].abs().max(trajectory.qd[k + 1].abs());
    let parts = parts(effect.memory_rate(speed), dt);
    let (share, width) = (1.0 / parts as f64, dt / parts as f64);
    (0..parts).fold(memory, |memory, part| {
        let state = |half: usize| trajectory.between(k, share * (part as f64 + 0.5 * half as f64));
        runge_kutta(effect, [state(0), state(1), state(2)], memory, width)
    })
}

fn runge_kutta(effect: Effect, states: [State; 3], memory: [f64; LARGEST], dt: f64) -> [f64; LARGEST] {
    let moved = |slope: &[f64; LARGEST], dt: f64| std::array::from_fn(|index| memory[index] + dt * slope[index]);
    let at = |state: usize, memory: [f64; LARGEST]| effect.memory_slope(states[state], 0.0, &memory);
    let first = at(0, memory);
    let second = at(1, moved(&first, 0.5 * dt));
    let third = at(1, moved(&second, 0.5 * dt));
    let fourth = at(2, moved(&third, dt));
    let mean = |index: usize| (first[index] + 2.0 * (second[index] + third[index]) + fourth[index]) / 6.0;
    std::array::from_fn(|index| memory[index] + dt * mean(index))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::dynamics::{Dynamics, Phase};
    use crate::law::motion::Motion;

    struct Record {
        t: Vec<f64>,
        phases: Vec<Phase>,
        excitation: Vec<f64>,
    }

    fn drive(t: f64) -> f64 {
        2.0 * (1.1 * t).sin() + 0.8 * (3.7 * t + 0.4).cos()
    }

    fn simulated(effect: Term, dt: f64) -> Record {
        let terms = [Term::Inertia, Term::power(0, 1), Term::power(1, 0), effect];
        let motion = Motion::new(&terms, &[1.0, 0.2, 3.0, 0.3]);
        let dynamics = Dynamics::new(motion).unwrap();
        let t: Vec<f64> = (0..(8.0 / dt) as usize).map(|k| k as f64 * dt).collect();
        let mut phases = vec![dynamics.rest(State { q: 0.2, qd: 0.0 })];
        t.windows(2).for_each(|pair| {
            let fine = 8;
            let width = (pair[1] - pair[0]) / f64::from(fine);
            let start = phases[phases.len() - 1];
            let step = |phase, part| dynamics.step(&phase, pair[0] + width * f64::from(part), width, &drive);
            phases.push((0..fine).fold(start, step));
        });
        let excitation = t.iter().map(|t| drive(*t)).collect();
        Record { t, phases, excitation }
    }

    fn along(record: &Record, term: Term, hold: Hold) -> Vec<f64> {
        let q: Vec<f64> = record.phases.iter().map(|phase| phase.state.q).collect();
        let qd: Vec<f64> = record.phases.iter().map(|phase| phase.state.qd).collect();
        term_series(term, &[], &Trajectory { t: &record.t, q: &q, qd: &qd, excitation: &record.excitation, hold })
    }

    fn effect(id: &str, inner: &[f64]) -> Effect {
        Effect::prototype(id).unwrap().with_inner(inner).unwrap()
    }

    /// RMS difference between the series and the simulated feature.
    fn error(effect: Effect, dt: f64) -> f64 {
        let term = Term::Effect(effect);
        let record = simulated(term, dt);
        let series = along(&record, term, Hold::Linear);
        let squares = series.iter().zip(&record.phases).enumerate().map(|(index, (found, phase))| {
            assert!(found.is_finite());
            (found - effect.feature(phase.state, drive(record.t[index]), &phase.memory)).powi(2)
        });
        (squares.sum::<f64>() / series.len() as f64).sqrt()
    }

    #[test]
    fn along_a_simulated_motion_the_simulated_memory_is_found() {
        let errors = [0.02, 0.01, 0.005].map(|dt| error(effect("hidden_resonator", &[6.0, 0.03]), dt));
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!(order > 1.7, "order {order}, {errors:?}");
        }
        let [coarse, fine] = [0.02, 0.01].map(|dt| error(effect("relaxation", &[0.2]), dt));
        assert!(coarse < 2e-3 && coarse / fine > 3.3, "{coarse:e}, {fine:e}");
        for play in [0.0, 0.1] {
            let tabulated = error(effect("friction_with_backlash", &[0.15, play]), 0.01);
            assert!(tabulated < 1e-5, "play {play}: {tabulated:e}");
        }
        let tabulated = [0.02, 0.005].map(|dt| error(effect("hysteresis", &[0.15, 0.8, 1.4]), dt));
        assert!(tabulated.iter().all(|error| *error < 1e-6), "{tabulated:?}");
    }

    #[test]
    fn fast_internal_states_stay_bounded() {
        assert!(error(effect("hidden_resonator", &[400.0, 0.3]), 0.01) < 0.05);
        assert!(error(effect("hysteresis", &[0.002, 1.0, 1.0]), 0.01) < 2e-4);
    }

    #[test]
    fn a_delay_is_the_difference_of_two_excitations() {
        let delay = Term::Effect(effect("excitation_delay", &[0.25]));
        let record = simulated(delay, 0.01);
        let series = along(&record, delay, Hold::Linear);
        for (k, found) in series.iter().enumerate().skip(26) {
            let expected = drive(record.t[k]) - drive(record.t[k] - 0.25);
            assert!((found - expected).abs() < 2e-4, "{found} against {expected}");
        }
        let held = along(&record, delay, Hold::Zero);
        let cell = |k: usize| 0.5 * (record.excitation[k - 1] + record.excitation[k]);
        assert!((held[300] - (cell(300) - cell(275))).abs() < 1e-9);
    }

    #[test]
    fn pointwise_terms_and_expressions_are_evaluated_at_each_sample() {
        let (t, q, qd, excitation) = ([0.0, 0.1], [1.0, 2.0], [-3.0, 4.0], [5.0, 6.0]);
        let trajectory = Trajectory { t: &t, q: &q, qd: &qd, excitation: &excitation, hold: Hold::Zero };
        assert_eq!(term_series(Term::power(2, 1), &[], &trajectory), [-3.0, 16.0]);
        let expression = Expression::parse("x", "q*qd + F - t").unwrap();
        assert_eq!(term_series(expression.term(0), std::slice::from_ref(&expression), &trajectory), [2.0, 13.9]);
        assert!(term_series(expression.term(3), &[], &trajectory)[0].is_nan());
        let empty = Trajectory { t: &[], q: &[], qd: &[], excitation: &[], hold: Hold::Zero };
        assert!(term_series(Term::Effect(effect("hysteresis", &[0.1, 1.0, 1.0])), &[], &empty).is_empty());
    }

    #[test]
    fn a_loop_forgets_what_it_had_stored_once_it_has_slid_and_never_where_it_does_not() {
        let t: Vec<f64> = (0..4000).map(|k| 0.01 * f64::from(k)).collect();
        let qd: Vec<f64> = t.iter().map(|t| t.cos()).collect();
        let q: Vec<f64> = t.iter().map(|t| t.sin()).collect();
        let trajectory = Trajectory { t: &t, q: &q, qd: &qd, excitation: &t, hold: Hold::Linear };
        let of = |id: &str, inner: &[f64]| forgets(Term::Effect(effect(id, inner)), &trajectory);
        let soon = of("presliding_friction", &[0.05]).unwrap();
        assert!((10..100).contains(&soon), "{soon}");
        let later = of("friction_with_backlash", &[0.05, 0.4]).unwrap();
        assert!(later > soon && later < 400, "{later}");
        assert_eq!(of("friction_with_backlash", &[0.05, 1.5]), None, "a play wider than the motion");
        assert_eq!(forgets(Term::Effect(Effect::CoulombFriction), &trajectory), Some(0));
    }
}
