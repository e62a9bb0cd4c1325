//! The published procedure: capture, identify, compare without pause, and on a switch begin anew.
//!
//! 1. Capture q, q̇, F for a fixed time (1 s).
//! 2. Identify the integral-variational equation (1) from it by ordinary least squares over all terms: see
//!    [`Equations`].
//! 3. Integrate the law freely from that instant on and compare with what is observed. When the deviation of eq. (4)
//!    over the last T = 0.5 s passes the threshold of 0.05, the law has switched: the old data are thrown away, and 1.
//!    follows.
//!
//! It is kept as published, with its weaknesses: sensor noise biases the coefficients, the first state of a prediction
//! is a single noisy sample, the data between switch and alarm are not used, and a threshold that noise or a poor law
//! passes on its own begins the loop of switch and re-identification anew each time. Where a record leaves the inertia
//! open there is no law to predict with, and the next record is captured.

use super::capture::{Capture, complete};
use super::equations::Equations;
use crate::estimation::Observation;
use crate::identify::deviation::Deviation;
use crate::identify::problem::Problem;
use crate::identify::report::{Coefficient, Output, Status};
use crate::identify::sample::Sample;
use crate::identify::settings::Settings;
use crate::identify::window::Window;
use crate::law::{Motion, REACH, State};
use serde::{Deserialize, Serialize};

/// Record that a law is identified from where the settings name none, s.
const CAPTURE: f64 = 1.0;

/// Deviation that means a switch where the settings name none.
const THRESHOLD: f64 = 0.05;

/// Steps of the integration between two samples.
const PARTS: usize = 4;

/// What a prediction without bounds counts as in the deviation: a number beyond any, whose square still is one.
const UNBOUNDED: f64 = 1e12;

/// The state of the published procedure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Publication {
    phase: Phase,
    capture: Capture,
    equations: Equations,
    /// Whether the present stage's data have been solved for a law.
    solved: bool,
    /// Samples that the excitation between two of them is taken from.
    recent: Window,
    /// The law: one coefficient for each term.
    law: Vec<f64>,
    prediction: State,
    next: u64,
    deviation: Deviation,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    Capturing,
    Identifying,
    Comparing,
}

impl Publication {
    /// Room for everything.
    pub fn new(problem: &Problem, settings: &Settings) -> Publication {
        let wanted = if settings.initial_window > 0.0 { settings.initial_window } else { CAPTURE };
        Publication {
            phase: Phase::Capturing,
            capture: Capture::new(wanted.min(settings.max_window), settings.sample_time),
            equations: Equations::new(problem),
            solved: false,
            recent: Window::new(4 * REACH, problem.channels, problem.timing.hold),
            law: problem.known.clone(),
            prediction: State::default(),
            next: 0,
            deviation: Deviation::new(settings.deviation_interval, settings.sample_time),
        }
    }

    /// Takes an accepted sample.
    pub fn step(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        sample: Sample,
        published: &mut [Coefficient],
        output: &mut Output,
    ) {
        if self.recent.end() == 0 {
            output.switch_time = sample.t;
        }
        output.threshold = threshold(settings);
        self.recent.push(complete(sample, self.newest(), problem.channels));
        match self.phase {
            Phase::Capturing => self.capture(problem, published, output),
            Phase::Identifying => self.identify(problem, published, output),
            Phase::Comparing => self.compare(problem, settings, published, output),
        }
    }

    /// One text for each direction that the present stage's data leave open.
    pub fn unidentifiable(&self, problem: &Problem) -> Vec<String> {
        let directions = if self.solved { self.equations.fit().open_directions() } else { Vec::new() };
        directions.iter().map(|direction| problem.together(direction)).collect()
    }

    fn newest(&self) -> Option<&Sample> {
        self.recent.end().checked_sub(1).map(|number| self.recent.sample(number))
    }

    fn capture(&mut self, problem: &Problem, published: &mut [Coefficient], output: &mut Output) {
        output.deviation = 0.0;
        if let Some(sample) = self.newest().copied() {
            self.capture.push(sample, problem.channels);
        }
        if self.capture.is_complete() {
            self.equations.begin();
            self.phase = Phase::Identifying;
            self.identify(problem, published, output);
        }
    }

    fn identify(&mut self, problem: &Problem, published: &mut [Coefficient], output: &mut Output) {
        if !self.equations.advance(problem, &self.capture) {
            return;
        }
        self.capture.clear();
        self.solved = true;
        self.publish(problem, published);
        self.phase = match self.equations.gives_a_law(problem) {
            true => Phase::Comparing,
            false => Phase::Capturing,
        };
        if self.phase == Phase::Comparing {
            self.begin_prediction(problem, output);
        }
    }

    fn publish(&self, problem: &Problem, published: &mut [Coefficient]) {
        for (coefficient, known) in published.iter_mut().zip(&problem.known) {
            (coefficient.value, coefficient.std) = (*known, Some(0.0));
        }
        for (free, index) in problem.free.iter().enumerate() {
            let coefficient = &mut published[*index];
            coefficient.std = self.equations.std(free);
            if coefficient.std.is_some() {
                coefficient.value = self.equations.fit().coefficients[free];
            }
        }
        published.iter_mut().for_each(|coefficient| coefficient.needed = coefficient.std.map(|_| 0.0));
    }

    fn begin_prediction(&mut self, problem: &Problem, output: &mut Output) {
        problem.scatter(&self.equations.fit().coefficients, &mut self.law);
        self.next = self.recent.ready();
        let Sample { q, qd, .. } = *self.recent.sample(self.next - 1);
        self.prediction = State { q, qd };
        (output.prediction.q, output.prediction.qd) = (q, qd);
        output.status = Status::Tracking;
        output.valid = true;
        output.identified_time = self.newest().map(|sample| sample.t);
    }

    fn compare(&mut self, problem: &Problem, settings: &Settings, published: &mut [Coefficient], output: &mut Output) {
        while self.next < self.recent.ready() {
            self.predict(problem, settings);
            self.next += 1;
        }
        (output.prediction.q, output.prediction.qd) = (self.prediction.q, self.prediction.qd);
        let deviation = self.deviation.mean();
        output.deviation = deviation;
        let compared = self.recent.sample(self.next - 1).t;
        if self.deviation.is_full(compared) && deviation > threshold(settings) {
            self.switch(problem, published, output);
        }
    }

    /// Carries the prediction to the next sample and takes its deviation there.
    fn predict(&mut self, problem: &Problem, settings: &Settings) {
        let observation = self.recent.observation(self.next);
        let moved = moved(problem.motion(&problem.terms, &self.law), self.prediction, &observation);
        if moved.is_finite() {
            self.prediction = moved;
        }
        let [q, qd] = observation.measured;
        let apart = |weight: f64, predicted: f64, observed: Option<f64>| match observed {
            Some(observed) => weight * (predicted - observed).abs(),
            None => 0.0,
        };
        let difference = apart(settings.weight_q, moved.q, q) + apart(settings.weight_qd, moved.qd, qd);
        self.deviation.add(self.recent.sample(self.next).t, difference.min(UNBOUNDED));
    }

    /// Throws the old data away and captures anew from the alarm's sample on.
    fn switch(&mut self, problem: &Problem, published: &mut [Coefficient], output: &mut Output) {
        let Some(now) = self.newest().copied() else { return };
        self.deviation.clear();
        self.capture.push(now, problem.channels);
        self.solved = false;
        self.phase = Phase::Capturing;
        problem.free.iter().for_each(|index| (published[*index].std, published[*index].needed) = (None, None));
        output.switch_count += 1;
        output.switch_time = now.t;
        output.detection_time = Some(now.t);
        output.named_time = output.detection_time;
        output.identified_time = None;
        output.valid = false;
        output.status = Status::ReIdentifying;
    }
}

fn threshold(settings: &Settings) -> f64 {
    if settings.deviation_threshold > 0.0 { settings.deviation_threshold } else { THRESHOLD }
}

/// The state one sample later.
fn moved(motion: Motion, from: State, observation: &Observation) -> State {
    let parts = observation.drive.parts(PARTS);
    let dt = observation.dt / parts as f64;
    (0..parts).fold(from, |state, part| {
        let [before, _, after] = observation.drive.part(part, parts);
        motion.step_linear(state, dt, before, after)
    })
}
