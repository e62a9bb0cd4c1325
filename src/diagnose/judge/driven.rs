//! The motion that a law makes of the recorded excitation, drawn along the recorded one.
//!
//! A law that is right makes every reversal, stop and step of the force that its record has, where a smoothed motion
//! has none. What it lacks is added as a force that changes slowly and is known: an observer (Luenberger, IEEE Trans.
//! Aut. Control 16 (1971), 596) whose eigenvalues are those of one critically damped oscillator of the motion's own
//! period.

use super::equation::delay_of;
use super::record::{Column, Record, Timing};
use crate::diagnose::motion::Motion;
use crate::diagnose::piece::Piece;
use crate::law::{self, Dynamics, Effect, History, Hold, Samples, State, Term, Trajectory, term_series};
use std::f64::consts::TAU;

/// Steps of integration in an interval between two samples: 50 of these make a period of the fastest motion that
/// samples show.
const STEPS: usize = 4;

/// A record whose motion a law has made.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    /// Its readings without noise.
    pub(super) truth: Record,
    /// ∫ φ u dt of the force that draws it along.
    pub(super) pull: Column,
}

/// The excitation, and beside it the force that draws the motion along.
struct Pulled<'a> {
    samples: Samples<'a>,
    /// Where the interval begins and ends, s, and the force there.
    times: [f64; 2],
    force: [f64; 2],
}

impl History for Pulled<'_> {
    fn over(&self, from: f64, to: f64) -> [f64; 3] {
        let excitation = self.samples.over(from, to);
        let [start, end] = self.times;
        let pull = |t: f64| self.force[0] + (self.force[1] - self.force[0]) * (t - start) / (end - start);
        let own = [pull(from), pull(0.5 * (from + to)), pull(to)];
        std::array::from_fn(|index| excitation[index] + own[index])
    }
}

impl Driven {
    /// By a law of these terms and coefficients. None where it does not follow the record, or has no inertia.
    pub(super) fn new(record: &Record, terms: &[Term], coefficients: &[f64], timing: Timing) -> Option<Driven> {
        // a delay among the terms is in the timing
        let acts = |(term, value): (&Term, &f64)| if delay_of(*term).is_some() { 0.0 } else { *value };
        let coefficients: Vec<f64> = terms.iter().zip(coefficients).map(acts).collect();
        let law = law::Motion::new(terms, &coefficients);
        let mut motions = record.motions.clone();
        let mut pulls = Vec::new();
        for (driven, motion) in motions.iter_mut().zip(&record.motions) {
            for (piece, followed) in driven.pieces.iter_mut().zip(motion.states()) {
                let led = led(law, record, timing, piece, &followed)?;
                read(motion, piece, &led.states);
                pulls.push((piece.t.iter().map(|t| t - piece.t[0]).collect::<Vec<f64>>(), led.forces));
            }
        }
        let pull = record.acting(|number, elapsed| line(&pulls[number].0, &pulls[number].1, elapsed));
        Some(Driven { truth: record.moved(motions)?, pull })
    }
}

/// A motion at every sample, and the force there that has drawn it along.
struct Led {
    states: Vec<State>,
    forces: Vec<f64>,
}

fn led(law: law::Motion, record: &Record, timing: Timing, piece: &Piece, followed: &[State]) -> Option<Led> {
    let dynamics = Dynamics::new(law.with(&record.expressions)).ok()?;
    let rate = TAU / record.period;
    let acts: Vec<f64> = piece.t.iter().map(|t| t + timing.delay).collect();
    let acting = acting(piece, &acts, timing);
    let samples = Samples { t: &acts, excitation: &acting.0, hold: acting.1 };
    let mut phase = dynamics.rest(followed[0]);
    let mut led = Led { states: vec![phase.state], forces: vec![0.0] };
    for (times, goal) in piece.t.windows(2).zip(followed) {
        let behind = State { q: goal.q - phase.state.q, qd: goal.qd - phase.state.qd };
        let force = law.mass(phase.state.q) * rate * (rate * behind.q + 2.0 * behind.qd);
        let before = led.forces[led.forces.len() - 1];
        let pulled = Pulled { samples, times: [times[0], times[1]], force: [before, force] };
        let width = (times[1] - times[0]) / STEPS as f64;
        for step in 0..STEPS {
            phase = dynamics.step(&phase, times[0] + step as f64 * width, width, &pulled);
        }
        if !phase.is_finite() {
            return None;
        }
        led.states.push(phase.state);
        led.forces.push(force);
    }
    Some(led)
}

/// The excitation behind an actuator's lag at the instants at which it acts, which then runs straight between them;
/// without lag as recorded.
fn acting(piece: &Piece, t: &[f64], timing: Timing) -> (Vec<f64>, Hold) {
    let force = &piece.excitation;
    let Some(lag) = Effect::lag(timing.lag) else { return (force.clone(), timing.hold) };
    let still = vec![0.0; t.len()];
    let trajectory = Trajectory { t, q: &still, qd: &still, excitation: force, hold: timing.hold };
    let behind = term_series(Term::Effect(lag), &[], &trajectory);
    (force.iter().zip(behind).map(|(force, behind)| force - behind).collect(), Hold::Linear)
}

/// What the sensors of a motion read of these states, where they read.
fn read(motion: &Motion, piece: &mut Piece, states: &[State]) {
    let sensors = motion.sensors;
    if let Some(values) = &mut piece.q {
        values.iter_mut().zip(states).for_each(|(value, state)| *value = state.q);
    }
    let velocities: Vec<f64> = states.iter().map(|state| state.qd).collect();
    let late = |t: &f64| sensors.scale * line(&piece.t, &velocities, t - sensors.lag);
    piece.qd = piece.qd.as_ref().map(|_| piece.t.iter().map(late).collect());
}

/// The straight line between values at instants; beyond them the nearest.
fn line(t: &[f64], values: &[f64], at: f64) -> f64 {
    let next = t.partition_point(|time| *time <= at).clamp(1, t.len() - 1);
    let share = ((at - t[next - 1]) / (t[next] - t[next - 1])).clamp(0.0, 1.0);
    values[next - 1] + share * (values[next] - values[next - 1])
}
