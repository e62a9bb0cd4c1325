//! How the estimate of the present segment is refined, filter run by filter run over its record.
//!
//! A run takes the filter over all samples of the segment, a bounded number at a step, until it has caught up with the
//! stream; then the coefficients take a Gauss–Newton step, terms without evidence are dropped, the noise levels follow
//! the innovations, and the next run begins. Begun with much process noise the fit is that of the equation error, which
//! is nearly linear in the coefficients; the likelihood then takes the process noise down, run by run, to where the
//! data want it, and the fit becomes the maximum likelihood of the trajectory without passing through its wrong minima.

use super::judgement::SETTLED;
use super::motion_scales::MotionScales;
use super::noise_covariance::UNEXPLAINED;
use super::prior::{InertiaPrior, Prior};
use super::state::{Checkpoint, InTheSensors, MissingEffects, NOISE_MEMORY, Runs, Segment};
use crate::estimation::{
    AddedEffect, EffectPosterior, Filter, Lag, LagTest, Noise, Observation, Pass, ScoreTest, TWENTY_TO_ONE,
};
use crate::identify::library::KnownLaw;
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use crate::identify::window::Window;
use crate::law::{Motion, Term};

/// A run that has caught up is closed only when the record has grown by this fraction since the last one: what it adds
/// to the information is then about as small …
pub const GROWTH: f64 = 0.02;

/// … and by this many samples.
const FRESH: u64 = 8;

/// The record of a segment is folded into a prior when it fills this fraction of the window: the run that folds still
/// has a tenth of it to catch up in.
const FULL: f64 = 0.9;

/// Process noise of a run with all error in the sensors, relative to that of the segment.
pub const IN_THE_SENSORS: f64 = 1e-6;

impl InTheSensors {
    /// Begins beside a run, where one is asked for.
    fn begin(&mut self, filter: Filter, noise: &Noise, running: bool) {
        self.running = running;
        if running {
            self.noise = Noise { process: IN_THE_SENSORS * noise.process, ..*noise };
            self.filter_run.begin(filter);
            self.lag.begin();
        }
    }

    /// Takes the sample that the run has taken.
    fn take(&mut self, motion: &Motion, free: &[Term], observation: &Observation, shifts: [f64; 2]) {
        if self.running {
            let innovations = self.filter_run.step(motion, free, &self.noise, observation);
            self.lag.step(motion, &self.filter_run, shifts, &innovations, [0.0; 2]);
        }
    }
}

impl Segment {
    /// Begins a stage at sample `start` from the coefficients `from` and these noise levels; before any data the
    /// coefficients lie about `centre` with the std `spread`.
    pub fn begin(&mut self, problem: &Problem, window: &Window, start: u64, from: &[f64], prior: Prior, noise: Noise) {
        self.start = start;
        self.coefficients.copy_from_slice(from);
        problem.scatter(from, &mut self.all);
        self.add_effect(prior.effect);
        self.active.fill(true);
        self.noise = noise;
        match prior.structure {
            Some(active) => self.selection.remember(active),
            None => self.selection.forget(),
        }
        self.known.noise = noise.sensor;
        (self.known.weight, self.known.folded) = (prior.noise_weight, 0);
        self.known.scales.remember(prior.scales, prior.noise_weight);
        self.runs = Runs::default();
        self.stability.clear();
        self.constancy.clear();
        self.fit.decrement = f64::INFINITY;
        self.run.closed_at = start;
        self.known.information.clear();
        let n = problem.n();
        for (index, ((std, centre), from)) in prior.std.iter().zip(prior.centre).zip(from).enumerate() {
            let precision = (std * std).recip();
            self.known.information.matrix[index * n + index] = precision;
            self.known.information.score[index] = precision * (centre - from);
        }
        self.known.inertia = None;
        if let Some(index) = problem.free_inertia() {
            (self.known.information.matrix[index * n + index], self.known.information.score[index]) = (0.0, 0.0);
            self.known.inertia = Some(InertiaPrior { centre: prior.centre[index], log_std: prior.log_inertia });
        }
        self.fit.gain = f64::INFINITY;
        (self.missing, self.untried) = (None, None);
        self.timing.clear();
        (self.score_test.likeliest, self.score_test.posterior) = (None, EffectPosterior::default());
        (self.score_test.next_try, self.score_test.next_look) = (0, 0);
        self.convergence.clear();
        self.run.largest = [0.0; 2];
        self.begin_run(window);
    }

    /// Begins a stage at sample `start` with a law that is known: its coefficients, and its information beside the
    /// record's.
    pub fn begin_known(
        &mut self,
        problem: &Problem,
        window: &Window,
        start: u64,
        law: &KnownLaw,
        noise: Noise,
        scales: &MotionScales,
    ) {
        let prior = Prior {
            centre: &law.coefficients,
            std: &law.spread,
            log_inertia: 1.0,
            structure: Some(&law.active),
            noise_weight: NOISE_MEMORY,
            effect: None,
            scales,
        };
        self.begin(problem, window, start, &law.coefficients, prior, noise);
        self.active.copy_from_slice(&law.active);
        self.known.information.clone_from_slices(&law.information);
        self.known.inertia = None;
    }

    /// Advances the run by up to `budget` samples; returns whether it was closed.
    pub fn refine(&mut self, problem: &Problem, settings: &Settings, window: &Window, budget: usize) -> bool {
        let end = window.ready();
        if self.run.next <= window.oldest() {
            self.start = window.oldest();
            self.begin_run(window);
        }
        let stop = end.min(self.run.next + budget as u64);
        while self.run.next < stop {
            self.take(problem, window, self.run.next);
        }
        let fresh = self.run.closed_at + FRESH.max((GROWTH * self.length(end) as f64) as u64);
        if self.run.next < end || (self.run.next < fresh && self.fit.decrement < SETTLED) || self.length(end) < 4 {
            return false;
        }
        self.close(problem, settings, window);
        true
    }

    /// The run takes a sample, and so does all that is summed up beside it.
    fn take(&mut self, problem: &Problem, window: &Window, number: u64) {
        let observation = &window.observation(number);
        let Segment { run, score_test, convergence, terms, all, noise, .. } = self;
        let motion = problem.motion(terms, all);
        let innovations = run.filter_run.step(&motion, &problem.free_terms, noise, observation);
        let (shifts, effect) = (window.shifts(number), terms[terms.len() - 1]);
        let beside = match all[all.len() - 1] {
            0.0 => [0.0; 2],
            _ => run.effect.step(effect, &motion, &run.filter_run, observation, &innovations),
        };
        run.lag.step(&motion, &run.filter_run, shifts, &innovations, beside);
        score_test.candidates.step(&motion, &run.filter_run, observation, &innovations, beside);
        score_test.in_the_sensors.take(&motion, &problem.free_terms, observation, shifts);
        run.scales.add(&motion, &run.filter_run, observation);
        run.sandwich.step(&run.filter_run.information);
        for channel in (0..2).filter(|channel| innovations[*channel].is_some()) {
            run.largest[channel] = run.largest[channel].max(observation.measured[channel].unwrap_or(0.0).abs());
        }
        run.next += 1;
        convergence.step(run.next, &run.filter_run.information);
        if Some(run.next) == run.checkpoint.at {
            run.checkpoint.information.clone_from_slices(&run.filter_run.information);
            run.checkpoint.effect.copy_from(&run.effect);
        }
    }

    /// The run that was just closed, at the head of the stream and linear about the new coefficients; the caller gets
    /// it in exchange for another one's room. The next run begins.
    pub fn hand_over(
        &mut self,
        window: &Window,
        live: &mut Pass,
        lag: &mut LagTest,
        effects: &mut ScoreTest,
        beside: &mut AddedEffect,
    ) {
        self.run.effect.hand_over(beside);
        std::mem::swap(&mut self.run.filter_run, live);
        std::mem::swap(&mut self.run.lag, lag);
        std::mem::swap(&mut self.score_test.candidates, effects);
        live.information.clone_from_slices(&self.information);
        if self.effect() != 0.0 {
            beside.hold(self.effect(), &mut live.information);
        }
        self.begin_run(window);
    }

    /// The run has caught up: the coefficients take a step, the structure and the noise levels follow, and the law is
    /// judged.
    fn close(&mut self, problem: &Problem, settings: &Settings, window: &Window) {
        let track = self.run.filter_run.track;
        self.run.closed_at = self.run.next;
        self.end_score_test(problem);
        std::mem::swap(&mut self.scales, &mut self.run.scales);
        self.scales.merge(&self.known.scales, 1.0);
        self.runs.closed += 1;
        self.gather_information(problem);
        self.step.copy_from_slice(&self.coefficients);
        let Segment { selection, information, coefficients, active, solution, .. } = self;
        selection.select(information, &problem.maybe, track.total(), coefficients, active, solution);
        if !self.coefficients.iter().all(|value| value.is_finite()) {
            return self.recover(window);
        }
        self.runs.astray = 0;
        self.take_step(problem);
        self.tell_error(problem, settings, &track, window);
        self.follow_noise(problem, settings, &track, window);
        self.timing.open = problem.timing.left_open(&self.timing.told.lag);
        self.runs.calm = if self.is_calm() { self.runs.calm + 1 } else { 0 };
        self.runs.restless = if self.settled() { 0 } else { self.runs.restless + 1 };
        self.confirm();
        self.compare();
        self.forecast_convergence();
        self.say_effect();
        self.fold(window);
        self.drop_effect(problem);
    }

    /// What run and prior say together about the coefficients.
    fn gather_information(&mut self, problem: &Problem) {
        self.information.clone_from_slices(&self.run.filter_run.information);
        self.information.merge(&self.known.information);
        if let (Some(index), Some(prior)) = (problem.free_inertia(), self.known.inertia) {
            let (information, score) = prior.about(self.coefficients[index]);
            self.information.matrix[index * problem.n() + index] += information;
            self.information.score[index] += score;
        }
        if self.effect() != 0.0 {
            let Segment { score_test: MissingEffects { own, beside_another, .. }, run, information, active, .. } = self;
            *beside_another = run.effect.variance_beside_another(information, active, own);
            own.clear();
            run.effect.leave_open(self.all[self.all.len() - 1], information);
        }
    }

    /// Goes to the new coefficients as far as one step may go; `step` becomes the step from those before.
    fn take_step(&mut self, problem: &Problem) {
        self.limit_step(problem);
        problem.scatter(&self.coefficients, &mut self.all);
        for (step, value) in self.step.iter_mut().zip(&self.coefficients) {
            *step = value - *step;
        }
        self.move_to_new_coefficients();
        self.move_effect();
        let active = self.active.iter().filter(|active| **active).count().max(1);
        self.fit.decrement = self.information.quadratic(&self.step) / active as f64;
    }

    /// The run has left what can be integrated: it is repeated from the last coefficients with the filter closer to the
    /// data.
    fn recover(&mut self, window: &Window) {
        self.coefficients.copy_from_slice(&self.step);
        self.noise.process = if self.noise.process.is_finite() { 1e3 * self.noise.process } else { 1.0 };
        (self.fit.decrement, self.fit.gain) = (f64::INFINITY, f64::INFINITY);
        (self.runs.closed, self.runs.calm) = (0, 0);
        self.runs.astray += 1;
        self.begin_run(window);
    }

    /// Keeps the inertia from losing more than half of itself in one step.
    fn limit_step(&mut self, problem: &Problem) {
        let Some(inertia) = problem.free_inertia() else { return };
        let (old, new) = (self.step[inertia], self.coefficients[inertia]);
        let change = new - old;
        let allowed = 0.6 * old.abs();
        let against = change * old < 0.0 && change.abs() > allowed;
        if against {
            let fraction = allowed / change.abs();
            for (new, old) in self.coefficients.iter_mut().zip(&self.step) {
                *new = old + fraction * (*new - old);
            }
        }
    }

    /// F has acted so many samples later than was assumed: the law that would have been found, and the record once more
    /// under it.
    pub fn begin_later(&mut self, problem: &Problem, window: &Window, samples: f64) {
        for (value, slope) in self.coefficients.iter_mut().zip(&self.timing.told.slope) {
            *value += samples * slope;
        }
        problem.scatter(&self.coefficients, &mut self.all);
        for lag in [&mut self.timing.told.lag, &mut self.timing.whole.lag] {
            *lag = Lag::of(lag.samples - samples, lag.std);
        }
        self.timing.open = problem.timing.left_open(&self.timing.told.lag);
        self.constancy.clear();
        self.begin_run(window);
    }

    /// `step` holds the step: scores are taken about the new coefficients, the filtered state follows them.
    fn move_to_new_coefficients(&mut self) {
        self.information.shift(&self.step);
        self.known.information.shift(&self.step);
        self.run.filter_run.information.shift(&self.step);
        self.run.lag.shift(&self.step);
        if self.run.checkpoint.at.is_some() {
            self.run.checkpoint.information.shift(&self.step);
        }
        for (step, sensitivity) in self.step.iter().zip(&self.run.filter_run.sensitivity) {
            self.run.filter_run.filter.mean[0] += step * sensitivity[0];
            self.run.filter_run.filter.mean[1] += step * sensitivity[1];
        }
        self.score_test.candidates.shift(&self.step, self.run.filter_run.filter.state());
    }

    /// The effect that the model lacks follows the law's own terms, which have taken their step.
    fn move_effect(&mut self) {
        let place = self.all.len() - 1;
        if self.all[place] != 0.0 {
            let (step, moved) = self.run.effect.step_from(self.all[place], &self.step);
            self.all[place] += step;
            self.run.checkpoint.effect.shift(&self.step, step, &mut self.run.checkpoint.information);
            self.run.effect.shift(&self.step, step, &mut self.run.filter_run.information);
            self.run.lag.shift_beside(step);
            self.score_test.candidates.shift_beside(step);
            let mean = &mut self.run.filter_run.filter.mean;
            mean.iter_mut().zip(moved).for_each(|(mean, moved)| *mean += moved);
        }
    }

    /// An effect that the record does not speak for any more is none; where the error lasts nothing is in nats.
    fn drop_effect(&mut self, problem: &Problem) {
        let in_nats = self.settled() && self.fit.overdispersion < UNEXPLAINED;
        if !(in_nats && self.effect_gain().is_some_and(|gain| gain < TWENTY_TO_ONE)) {
            return;
        }
        self.run.effect.likeness(&self.solution, &self.active, &mut self.step);
        let effect = self.effect();
        for (value, step) in self.coefficients.iter_mut().zip(&mut self.step) {
            *step *= effect;
            *value += *step;
        }
        problem.scatter(&self.coefficients, &mut self.all);
        self.add_effect(None);
        self.move_to_new_coefficients();
        self.runs.calm = 0;
    }

    /// When the record outgrows the window, its first half becomes prior knowledge.
    fn fold(&mut self, window: &Window) {
        let full = self.length(self.run.next) as f64 > FULL * window.capacity() as f64;
        if let Some(at) = self.run.checkpoint.at.take().filter(|_| full) {
            if self.effect() != 0.0 {
                let Checkpoint { effect, information, .. } = &mut self.run.checkpoint;
                effect.leave_open(self.all[self.all.len() - 1], information);
            }
            self.known.information.merge(&self.run.checkpoint.information);
            self.known.folded += at - self.start;
            self.start = at;
        }
    }

    /// Begins the next run.
    pub fn begin_run(&mut self, window: &Window) {
        let length = self.length(window.ready());
        let long = length as f64 > 0.6 * FULL * window.capacity() as f64;
        self.run.checkpoint.at = long.then_some(self.start + length / 2);
        self.run.filter_run.begin(window.initial_state(self.start, &self.noise));
        self.run.lag.begin();
        self.run.effect.begin(self.run.filter_run.filter.state());
        self.run.next = self.start + 1;
        let filter = self.run.filter_run.filter;
        self.score_test.candidates.begin(filter.state(), self.run.largest);
        let due = self.settled() && !self.fit.explains && length >= self.score_test.next_look;
        self.score_test.in_the_sensors.begin(filter, &self.noise, due);
        self.run.scales.clear();
        self.convergence.begin(self.start, length);
        self.run.sandwich.begin(length);
    }
}
