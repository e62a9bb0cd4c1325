//! Open-loop prediction: the law integrated from an estimated state, the excitation as its only input.
//!
//! The state at the start is sought by Gauss–Newton steps on the distance between motion and readings, first over a
//! stretch of a period or two, then over all. Shorter windows, each from the state that the readings give at its start,
//! show how fast a law errs.

use super::memory_run::MemoryRun;
use super::rows::Prepared;
use crate::estimation::Observation;
use crate::law::{Compiled, Expression, Motion, State};
use crate::limits::TURN;
use std::ops::Range;

/// Gauss–Newton steps at most.
const STEPS: usize = 12;

/// Relative improvement below which they end.
const SETTLED: f64 = 1e-6;

/// A motion this many times as large as any that was measured has diverged.
const DIVERGED: f64 = 100.0;

/// Sensitivity of a state to itself.
const IDENTITY: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

/// Squared distance of a prediction from the readings by channel, q and q̇.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distance {
    /// Σ (predicted − measured)².
    pub squares: [f64; 2],
    /// Number of readings.
    pub count: [f64; 2],
}

impl Distance {
    /// Both together.
    pub fn and(self, other: Distance) -> Distance {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Distance { squares: sum(self.squares, other.squares), count: sum(self.count, other.count) }
    }

    /// RMS distance in a channel; `None` where it is not measured.
    pub fn rms(self, channel: usize) -> Option<f64> {
        (self.count[channel] > 0.0).then(|| (self.squares[channel] / self.count[channel]).sqrt())
    }
}

/// A prediction that stayed within bounds, or the time at which it left them, s.
pub type Outcome = Result<Distance, f64>;

/// A law that runs over a piece.
pub struct FreeRun<'a> {
    prepared: &'a Prepared,
    law: Law<'a>,
    /// Largest readings of q and q̇.
    bounds: [f64; 2],
    /// 1 ÷ variance of the readings by channel, 0 where there are none.
    weight: [f64; 2],
}

/// How a law is integrated.
enum Law<'a> {
    /// By its state alone.
    OfState(Box<Compiled>),
    /// With what it remembers.
    WithMemory(MemoryRun<'a>),
}

/// Where a motion of a law without memory is.
struct Course {
    state: State,
    /// Its sensitivity to the state at the start.
    carried: [[f64; 2]; 2],
    rate: f64,
}

impl Course {
    fn advance(&mut self, law: &Compiled, observation: &Observation) {
        let parts = observation.drive.parts((self.rate.sqrt() / TURN).ceil().clamp(1.0, 8.0) as usize);
        self.rate = 0.0;
        for part in 0..parts {
            let excitation = observation.drive.part(part, parts);
            law.steps(self.state, observation.dt / parts as f64, excitation, &mut [], |step, _, _| {
                self.state = step.state;
                self.carried = product(step.transition, self.carried);
                self.rate = self.rate.max(step.rate * (parts * parts) as f64);
            });
        }
    }
}

/// Sums of a run: distance, and the normal equations of the initial state.
#[derive(Clone, Copy, Default)]
struct Sums {
    distance: Distance,
    information: [f64; 3],
    score: [f64; 2],
    cost: f64,
}

impl<'a> FreeRun<'a> {
    /// The law with these numbers over a piece; none where it cannot be integrated.
    pub fn new(prepared: &'a Prepared, motion: Motion<'a>, expressions: &'a [Expression]) -> Option<FreeRun<'a>> {
        let measured = prepared.piece.measured();
        let largest = [&prepared.motion.q, &prepared.motion.qd]
            .map(|values| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs())));
        let law = match motion.terms.iter().all(|term| term.is_pointwise()) {
            true => {
                let mut law = Compiled::default();
                law.compile(&motion);
                Law::OfState(Box::new(law))
            }
            false => Law::WithMemory(MemoryRun::new(prepared, motion, expressions, largest)?),
        };
        let weight = measured.map(|signal| signal.map_or(0.0, |values| variance(values).recip()));
        Some(FreeRun { prepared, law, bounds: largest.map(|value| DIVERGED * value), weight })
    }

    /// The prediction of the whole piece from the best initial state; `stretch` samples give the first guess of it.
    pub fn whole(&self, stretch: usize) -> Outcome {
        let last = self.prepared.piece.len() - 1;
        let first = self.settle(self.smoothed(0), 0..stretch.clamp(4, last).min(last));
        let all = self.settle(first, 0..last);
        self.run(all, 0..last).map(|sums| sums.distance)
    }

    /// Predictions over windows of `samples`, one after the other, each from the smoothed state at its start.
    pub fn windows(&self, samples: usize) -> Outcome {
        let last = self.prepared.piece.len() - 1;
        let starts = (0..last).step_by(samples.max(1)).filter(|start| *start + samples <= last);
        starts
            .map(|start| self.run(self.smoothed(start), start..start + samples))
            .try_fold(Distance::default(), |total, sums| Ok(total.and(sums?.distance)))
    }

    fn smoothed(&self, index: usize) -> State {
        State { q: self.prepared.motion.q[index], qd: self.prepared.motion.qd[index] }
    }

    /// The initial state that brings the motion nearest to the readings; as it was where no step improves it.
    fn settle(&self, mut state: State, intervals: Range<usize>) -> State {
        let Ok(mut present) = self.run(state, intervals.clone()) else { return state };
        for _ in 0..STEPS {
            let Some((next, sums)) = self.improved(state, &present, intervals.clone()) else { break };
            let gain = present.cost - sums.cost;
            (state, present) = (next, sums);
            if gain < SETTLED * present.cost {
                break;
            }
        }
        state
    }

    /// The Gauss–Newton step, halved until it improves.
    fn improved(&self, state: State, present: &Sums, intervals: Range<usize>) -> Option<(State, Sums)> {
        let [a, b, c] = present.information;
        let determinant = a * c - b * b;
        if determinant <= 1e-12 * a * c {
            return None;
        }
        let [x, y] = present.score;
        let step = [(c * x - b * y) / determinant, (a * y - b * x) / determinant];
        (0..5).find_map(|halvings| {
            let share = 0.5_f64.powi(halvings);
            let next = State { q: state.q + share * step[0], qd: state.qd + share * step[1] };
            let sums = self.run(next, intervals.clone()).ok()?;
            (sums.cost < present.cost).then_some((next, sums))
        })
    }

    /// Integrates over intervals of samples.
    fn run(&self, start: State, intervals: Range<usize>) -> Result<Sums, f64> {
        match &self.law {
            Law::OfState(law) => {
                let mut course = Course { state: start, carried: IDENTITY, rate: 1.0 };
                self.follow(start, intervals, |interval| {
                    course.advance(law, &self.prepared.piece.observations[interval]);
                    (course.state, course.carried)
                })
            }
            Law::WithMemory(law) => {
                let mut course = law.begin(start, intervals.start);
                self.follow(start, intervals, |interval| {
                    law.advance(&mut course, interval);
                    course.state()
                })
            }
        }
    }

    /// Compares a motion from `start` on; `advance` gives the state after an interval, and its sensitivity to the one
    /// at the start.
    fn follow(
        &self,
        start: State,
        intervals: Range<usize>,
        mut advance: impl FnMut(usize) -> (State, [[f64; 2]; 2]),
    ) -> Result<Sums, f64> {
        let mut sums = Sums::default();
        self.compare(start, IDENTITY, intervals.start, &mut sums);
        for interval in intervals {
            let (state, carried) = advance(interval);
            if !(state.q.abs() <= self.bounds[0] && state.qd.abs() <= self.bounds[1]) {
                return Err(self.prepared.piece.t[interval + 1]);
            }
            self.compare(state, carried, interval + 1, &mut sums);
        }
        Ok(sums)
    }

    fn compare(&self, state: State, carried: [[f64; 2]; 2], index: usize, sums: &mut Sums) {
        let signals = self.prepared.piece.measured();
        for (channel, (signal, predicted)) in signals.into_iter().zip([state.q, state.qd]).enumerate() {
            let Some(signal) = signal else { continue };
            let (residual, weight, slope) = (signal[index] - predicted, self.weight[channel], carried[channel]);
            sums.distance.squares[channel] += residual * residual;
            sums.distance.count[channel] += 1.0;
            sums.cost += weight * residual * residual;
            sums.information[0] += weight * slope[0] * slope[0];
            sums.information[1] += weight * slope[0] * slope[1];
            sums.information[2] += weight * slope[1] * slope[1];
            sums.score[0] += weight * slope[0] * residual;
            sums.score[1] += weight * slope[1] * residual;
        }
    }
}

fn product(a: [[f64; 2]; 2], b: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let entry = |row: usize, column: usize| a[row][0] * b[0][column] + a[row][1] * b[1][column];
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}

/// Variance of values about their mean.
pub(super) fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64
}
