//! What a term does between the samples of a motion that is known at them: the straight line with its mean and its
//! first moment.
//!
//! The displacement follows the cubic that has the displacements and velocities of both ends (Hermite), the velocity
//! the parabola through those of both ends that has the change of acceleration which the law gives: noise of q does not
//! enter it. Internal states are integrated along it on a grid [`PANELS`] times finer than the samples, or finer yet
//! where they are fast. A force f(s), s from 0 to 1 over the interval, becomes the line whose mean is ∫ f ds and whose
//! moment about the middle is ∫ f (s − ½) ds: what acts on a coordinate that hardly moves within the interval is exact
//! to second order.

use super::effect::Effect;
use super::expression::Expression;
use super::hold::Hold;
use super::hysteresis_loop::Loop;
use super::motion::State;
use super::own::Own;
use super::quadrature::GAUSS;
use super::series::Trajectory;
use super::term::Term;

/// A force over an interval as a straight line: its values at the start and at the end.
pub type Line = [f64; 2];

/// Panels of the quadrature in an interval at least; even.
const PANELS: usize = 4;

/// Share of an interval that rounding of times may leave: a time of 1000 s is exact to 10⁻¹³ s, 10⁻¹⁰ of an interval of
/// 1 ms.
const ROUNDING: f64 = 1e-9;

impl Effect {
    /// Numbers that say where the effect's memory begins, as differences from nothing stored: its internal states, or
    /// the excitation before the first sample.
    pub fn beginning_length(self) -> usize {
        match self {
            Effect::ExcitationDelay { .. } => 1,
            _ => self.memory_length(),
        }
    }

    /// How large those numbers may be expected, given RMS values of the feature and of the excitation.
    pub fn beginning_spread(self, feature: f64, excitation: f64) -> Vec<f64> {
        match self {
            Effect::ExcitationDelay { .. } => vec![excitation],
            Effect::ActuatorLag { .. } => vec![excitation],
            Effect::Relaxation { .. } => vec![feature],
            Effect::HiddenResonator { frequency, .. } => {
                let omega = frequency.value();
                vec![feature / (omega * omega), feature / omega]
            }
            _ => self.largest_state().map(|largest| largest / f64::sqrt(3.0)).into_iter().collect(),
        }
    }

    /// The nearest numbers that the beginning can have.
    pub fn possible_beginning(self, beginning: f64) -> f64 {
        self.largest_state().map_or(beginning, |largest| beginning.clamp(-largest, largest))
    }
}

/// The force of a term with memory, a delay or a formula over every interval, per unit of its coefficient; NaN for an
/// expression that is not there, and for a term that has a pointwise force. `bends` is by how much q̈ changes over each
/// interval, m/s²; `beginning` has [`Effect::beginning_length`] numbers.
pub fn interval_forces(
    term: Term,
    expressions: &[Expression],
    trajectory: &Trajectory,
    bends: &[f64],
    beginning: &[f64],
) -> Vec<Line> {
    let count = trajectory.t.len().saturating_sub(1);
    let course = Course { trajectory, bends };
    match term {
        Term::Effect(Effect::ExcitationDelay { delay }) => {
            let offset = beginning.first().copied().unwrap_or_default();
            (0..count).map(|k| delayed(trajectory, k, delay.value(), offset)).collect()
        }
        Term::Effect(effect) if effect.memory_length() > 0 => remembered(effect, &course, beginning),
        Term::Expression(own) => match expressions.get(own.place()) {
            Some(expression) => (0..count).map(|k| expressed(expression, &own, &course, k)).collect(),
            None => vec![[f64::NAN; 2]; count],
        },
        _ => vec![[f64::NAN; 2]; count],
    }
}

/// Mean and first moment as a line.
fn line(mean: f64, moment: f64) -> Line {
    [mean - 6.0 * moment, mean + 6.0 * moment]
}

/// Sums of Simpson's rule.
#[derive(Default)]
struct Simpson {
    mean: f64,
    moment: f64,
}

impl Simpson {
    /// Takes the value at node `index` of `panels`.
    fn add(&mut self, index: usize, panels: usize, value: f64) {
        let weight = if index == 0 || index == panels {
            1.0
        } else if index % 2 == 1 {
            4.0
        } else {
            2.0
        } / (3.0 * panels as f64);
        self.mean += weight * value;
        self.moment += weight * value * (index as f64 / panels as f64 - 0.5);
    }

    fn line(&self) -> Line {
        line(self.mean, self.moment)
    }
}

/// A motion between its samples.
struct Course<'a> {
    trajectory: &'a Trajectory<'a>,
    bends: &'a [f64],
}

impl Course<'_> {
    /// The state at a share of the way from a sample to the next.
    fn between(&self, index: usize, share: f64) -> State {
        let (from, to) = (self.trajectory.state(index), self.trajectory.state(index + 1));
        let width = self.trajectory.t[index + 1] - self.trajectory.t[index];
        let slope = (to.q - from.q) / width;
        let inside = share * (1.0 - share);
        let turn = (1.0 - share) * (from.qd - slope) - share * (to.qd - slope);
        let bend = self.bends.get(index).copied().unwrap_or_default();
        State {
            q: from.q + width * (share * slope + inside * turn),
            qd: from.qd + share * (to.qd - from.qd) - 0.5 * inside * width * bend,
        }
    }
}

fn expressed(expression: &Expression, own: &Own, course: &Course, k: usize) -> Line {
    let trajectory = course.trajectory;
    let (from, to) = (trajectory.t[k], trajectory.t[k + 1]);
    let samples = trajectory.samples();
    let mut sums = Simpson::default();
    for node in 0..=PANELS {
        let share = node as f64 / PANELS as f64;
        let (t, State { q, qd }) = (from + share * (to - from), course.between(k, share));
        let excitation = if trajectory.hold == Hold::Zero { trajectory.excitation[k] } else { samples.at(t) };
        sums.add(node, PANELS, expression.value_of(own, q, qd, excitation, t));
    }
    sums.line()
}

fn remembered(effect: Effect, course: &Course, beginning: &[f64]) -> Vec<Line> {
    let trajectory = course.trajectory;
    if trajectory.t.is_empty() {
        return Vec::new();
    }
    let mut memory = effect.rest(trajectory.state(0), trajectory.excitation[0]);
    memory.iter_mut().zip(beginning).for_each(|(value, offset)| *value += offset);
    if let Some(shape) = Loop::of(effect) {
        return looped(&shape, course, memory[0]);
    }
    let moments = effect.linear_moments(trajectory, course.bends, memory);
    let lines = moments.map(|moments| moments.into_iter().map(|[mean, moment]| line(mean, moment)).collect());
    lines.unwrap_or_else(|| vec![[f64::NAN; 2]; trajectory.t.len() - 1])
}

/// A loop along a motion that begins with this internal state.
fn looped(shape: &Loop, course: &Course, state: f64) -> Vec<Line> {
    let mut place = shape.place(state, course.trajectory.qd[0]);
    let interval = |k: usize| {
        let mut sums = Simpson::default();
        sums.add(0, PANELS, shape.feature(place));
        for panel in 0..PANELS {
            let share = |part: f64| (panel as f64 + part) / PANELS as f64;
            let states = [0.0, 1.0].map(|part| course.between(k, share(part)));
            place = shape.followed(place, states, |part| course.between(k, share(part)).q);
            sums.add(panel + 1, PANELS, shape.feature(place));
        }
        sums.line()
    };
    (0..course.trajectory.t.len() - 1).map(interval).collect()
}

/// F(t) − F(t − τ); before the first sample F was the first value and `offset` beside.
fn delayed(trajectory: &Trajectory, k: usize, delay: f64, offset: f64) -> Line {
    let (from, to) = (trajectory.t[k], trajectory.t[k + 1]);
    let now = integrated(trajectory, [from, to], 0.0, 0.0);
    let before = integrated(trajectory, [from, to], delay, offset);
    line(now[0] - before[0], now[1] - before[1])
}

/// Mean and first moment of F(t − shift), exact between the instants at which it jumps or bends.
fn integrated(trajectory: &Trajectory, [from, to]: [f64; 2], shift: f64, offset: f64) -> [f64; 2] {
    let samples = trajectory.samples();
    let (first, dt) = (trajectory.t[0], to - from);
    let mut sums = [0.0; 2];
    let mut start = from;
    let mut next = trajectory.t.partition_point(|t| *t + shift <= from + ROUNDING * dt);
    while start < to {
        let end = trajectory.t.get(next).map_or(to, |t| (t + shift).min(to)).max(start);
        let end = if to - end < ROUNDING * dt { to } else { end };
        for (point, weight) in GAUSS {
            let t = start + point * (end - start);
            let past = t - shift;
            let value = samples.after(next.checked_sub(1), past) + if past < first { offset } else { 0.0 };
            let share = weight * (end - start) / dt;
            sums[0] += share * value;
            sums[1] += share * value * ((t - from) / dt - 0.5);
        }
        (start, next) = (end, next + 1);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::dynamics::{Dynamics, Phase};
    use crate::law::motion::Motion;
    use crate::law::series::term_series;

    struct Record {
        t: Vec<f64>,
        phases: Vec<Phase>,
        excitation: Vec<f64>,
    }

    fn drive(t: f64) -> f64 {
        2.0 * (1.1 * t).sin() + 0.8 * (3.7 * t + 0.4).cos()
    }

    /// The motion under a law with the effect, from a memory in mid-motion.
    fn simulated(effect: Effect, beginning: &[f64], dt: f64) -> Record {
        let terms = [Term::Inertia, Term::power(0, 1), Term::power(1, 0), Term::Effect(effect)];
        let motion = Motion::new(&terms, &[1.0, 0.2, 3.0, 0.3]);
        let dynamics = Dynamics::new(motion).unwrap();
        let t: Vec<f64> = (0..=(8.0 / dt) as usize).map(|k| k as f64 * dt).collect();
        let mut start = dynamics.rest(State { q: 0.2, qd: 0.1 });
        start.memory.iter_mut().zip(beginning).for_each(|(value, offset)| *value += offset);
        let mut phases = vec![start];
        for pair in t.windows(2) {
            let width = (pair[1] - pair[0]) / 32.0;
            let step = |phase, part| dynamics.step(&phase, pair[0] + width * f64::from(part), width, &drive);
            phases.push((0..32).fold(phases[phases.len() - 1], step));
        }
        let excitation = t.iter().map(|t| drive(*t)).collect();
        Record { t, phases, excitation }
    }

    fn lines(record: &Record, term: Term, hold: Hold, beginning: &[f64]) -> Vec<Line> {
        let q: Vec<f64> = record.phases.iter().map(|phase| phase.state.q).collect();
        let qd: Vec<f64> = record.phases.iter().map(|phase| phase.state.qd).collect();
        let trajectory = Trajectory { t: &record.t, q: &q, qd: &qd, excitation: &record.excitation, hold };
        let at = |k: usize| {
            let State { q, qd } = record.phases[k].state;
            let feature = term.effect().filter(|effect| effect.memory_length() > 0);
            let phase = &record.phases[k];
            let own = feature.map_or(0.0, |effect| effect.feature(phase.state, record.excitation[k], &phase.memory));
            record.excitation[k] - 0.2 * qd - 3.0 * q - 0.3 * own
        };
        let bends: Vec<f64> = (0..record.t.len() - 1).map(|k| at(k + 1) - at(k)).collect();
        interval_forces(term, &[], &trajectory, &bends, beginning)
    }

    fn effect(id: &str, inner: &[f64]) -> Effect {
        Effect::prototype(id).unwrap().with_inner(inner).unwrap()
    }

    /// Largest error of the velocity that the lines' impulses give, which is that of all means before.
    fn error(effect: Effect, beginning: &[f64], dt: f64) -> f64 {
        let record = simulated(effect, beginning, dt);
        let lines = lines(&record, Term::Effect(effect), Hold::Linear, beginning);
        let fine = simulated(effect, beginning, dt / 8.0);
        let pairs = fine.phases.iter().zip(&fine.excitation);
        let features: Vec<f64> =
            pairs.map(|(phase, force)| effect.feature(phase.state, *force, &phase.memory)).collect();
        let mean = |k: usize| {
            let nodes = &features[8 * k..8 * k + 9];
            let inner: f64 = (1..8).map(|n| if n % 2 == 1 { 4.0 } else { 2.0 } * nodes[n]).sum();
            (nodes[0] + nodes[8] + inner) / 24.0
        };
        let errors = lines.iter().enumerate().map(|(k, line)| (0.5 * (line[0] + line[1]) - mean(k)).abs());
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn a_memory_in_mid_motion_is_followed_between_samples() {
        let resonator = effect("hidden_resonator", &[6.0, 0.03]);
        let [coarse, fine] = [0.04, 0.02].map(|dt| error(resonator, &[0.3, -0.8], dt));
        assert!(coarse < 2e-4 && fine < coarse / 10.0, "{coarse:e}, {fine:e}");
        let [coarse, fine] = [0.04, 0.02].map(|dt| error(effect("relaxation", &[0.2]), &[0.4], dt));
        assert!(coarse < 1e-4 && fine < coarse / 4.0, "{coarse:e}, {fine:e}");
        let presliding = error(effect("presliding_friction", &[0.15]), &[0.1], 0.04);
        assert!(presliding < 1e-4, "{presliding:e}");
        // where contact begins or ends within an interval its force has a kink
        let [coarse, fine] = [0.04, 0.01].map(|dt| error(effect("friction_with_backlash", &[0.15, 0.1]), &[0.1], dt));
        assert!(coarse < 3e-3 && fine < coarse / 2.0, "{coarse:e}, {fine:e}");
        let hysteresis = effect("hysteresis", &[0.15, 0.8, 1.4]);
        let [coarse, fine] = [0.04, 0.02].map(|dt| error(hysteresis, &[0.1], dt));
        assert!(coarse < 1e-4 && fine < coarse / 4.0, "{coarse:e}, {fine:e}");
    }

    /// Behind a lag τ a ramp of slope a is followed by a τ (1 − e^(−t/τ)): its mean and moment over the interval from
    /// 0.1 s to 0.2 s.
    #[test]
    fn a_lag_follows_a_ramp_gradually() {
        let (t, still) = ([0.0, 0.1, 0.2], [0.0; 3]);
        let (slope, time) = (3.0, 0.07_f64);
        let excitation = t.map(|t| slope * t);
        let trajectory = Trajectory { t: &t, q: &still, qd: &still, excitation: &excitation, hold: Hold::Linear };
        let lag = Term::Effect(effect("actuator_lag", &[time]));
        let [from, to] = interval_forces(lag, &[], &trajectory, &[0.0; 2], &[0.0])[1];
        let behind = |t: f64| slope * time * (1.0 - (-t / time).exp());
        let nodes: Vec<f64> = (0..1000).map(|k| 0.1 + (f64::from(k) + 0.5) * 1e-4).collect();
        let mean = nodes.iter().map(|t| behind(*t)).sum::<f64>() / 1000.0;
        let moment = nodes.iter().map(|t| behind(*t) * (t - 0.15) / 0.1).sum::<f64>() / 1000.0;
        assert!((0.5 * (from + to) - mean).abs() < 1e-8, "{from}, {to}: {mean}");
        assert!(((to - from) / 12.0 - moment).abs() < 1e-8, "{from}, {to}: {moment}");
        let series = term_series(lag, &[], &trajectory);
        assert!(series.iter().zip(t).all(|(found, t)| (found - behind(t)).abs() < 1e-12), "{series:?}");
    }

    #[test]
    fn a_line_has_mean_and_moment_of_what_it_stands_for() {
        let record = simulated(effect("excitation_delay", &[0.013]), &[], 0.01);
        let delay = Term::Effect(effect("excitation_delay", &[0.013]));
        let held = lines(&record, delay, Hold::Zero, &[0.5]);
        let force = |k: usize| record.excitation[k];
        let k = 40;
        let jump = force(k - 1) - force(k - 2);
        let mean = force(k) - (force(k - 2) * 0.3 + force(k - 1) * 0.7);
        let moment = -jump * 0.5 * (0.25 - 0.04);
        let expected = [mean - 6.0 * moment, mean + 6.0 * moment];
        assert!(held[k].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-10), "{:?}, {expected:?}", held[k]);
        let first = held[0];
        assert!((0.5 * (first[0] + first[1]) + 0.5).abs() < 1e-10, "before the record {first:?}");
        let second = 0.5 * (held[1][0] + held[1][1]);
        assert!((second - (force(1) - force(0) - 0.3 * 0.5)).abs() < 1e-10, "{second}");
    }

    #[test]
    fn a_formula_is_integrated_along_the_motion() {
        let (t, q, qd, excitation) = ([0.0, 0.1], [1.0, 1.2], [1.0, 3.0], [5.0, 6.0]);
        let trajectory = Trajectory { t: &t, q: &q, qd: &qd, excitation: &excitation, hold: Hold::Zero };
        let expression = Expression::parse("x", "qd + F + t").unwrap();
        let [line] =
            interval_forces(expression.term(0), std::slice::from_ref(&expression), &trajectory, &[0.0], &[])[..]
        else {
            panic!()
        };
        let mean = 2.0 + 5.0 + 0.05;
        assert!((0.5 * (line[0] + line[1]) - mean).abs() < 1e-12, "{line:?}");
        assert!((line[1] - line[0] - 2.1).abs() < 1e-12, "{line:?}");
    }
}
