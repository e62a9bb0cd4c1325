//! The estimate of the present stage, refined pass by pass over its record.
//!
//! A pass runs the filter over all samples of the stage, a bounded number at a step, until it has caught up with the stream; then
//! the coefficients take a Gauss–Newton step, terms without evidence are dropped, the noise levels follow the innovations, and the
//! next pass begins. Begun with much process noise the fit is that of the equation error, which is nearly linear in the
//! coefficients; the likelihood then takes the process noise down, pass by pass, to where the data want it, and the fit
//! becomes the maximum likelihood of the trajectory without passing through its wrong minima.

mod constancy;
mod first_state;
mod levels;
mod prior;
mod trial;

use super::blocks::Blocks;
use super::forecast::Forecast;
use super::known::KnownLaw;
use super::problem::Problem;
use super::scales::Scales;
use super::settings::Settings;
use super::structure::Structure;
use super::window::Window;
use crate::evidence::{Information, Lack, Missing, Noise, Pass, Solution};
use crate::law::Motion;
use constancy::Constancy;
pub(super) use first_state::first_state;
use prior::InertiaPrior;
pub use prior::Prior;
use serde::{Deserialize, Serialize};
use trial::Trial;

/// A pass that has caught up is closed only when the record has grown by this fraction since the last one …
pub const GROWTH: f64 = 0.02;

/// … and by this many samples.
const FRESH: u64 = 8;

/// Largest Gauss–Newton decrement, in units of the number of coefficients, of an estimate that has settled.
const SETTLED: f64 = 1.0;

/// Largest gain in log-likelihood that another noise level may still promise, nats.
const GAIN: f64 = 3.0;

/// A stated e below this square vouches for a law: half of eq. (8)'s bound, since what is stated is an expectation.
pub const VOUCHED: f64 = 0.5 * 0.05 * 0.05;

/// e below this square makes a law good enough to weigh switches against.
pub const TRUSTED: f64 = 0.2 * 0.2;

/// Effects that the law lacks are looked for again when the record has grown by this factor: most passes are spared the work.
const LOOK_AGAIN: f64 = 1.4;

/// For how many samples the sensor noise of the last stage counts in the next one.
pub const NOISE_MEMORY: f64 = 500.0;

/// Passes in a row that may leave what can be integrated: each is repeated with a thousand times the process noise.
const LOST: u32 = 6;

/// The record of a stage is folded into a prior when it fills this fraction of the window.
const FULL: f64 = 0.9;

/// An estimate of one stage's law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Number of the sample at which the stage's record begins.
    pub start: u64,
    /// Free coefficients.
    pub coefficients: Vec<f64>,
    /// All coefficients.
    pub all: Vec<f64>,
    /// Which free terms the law has.
    pub active: Vec<bool>,
    /// Noise levels.
    pub noise: Noise,
    /// Covariance of the active coefficients.
    pub solution: Solution,
    /// What the closed pass, the prior included, says about `coefficients`.
    pub information: Information,
    /// The Gauss–Newton decrement of the last pass ÷ number of active coefficients.
    pub decrement: f64,
    /// How large accelerations and their slopes were in the last closed pass.
    pub scales: Scales,
    /// What another level of process noise would add to the log-likelihood of the last pass.
    pub gain: f64,
    /// Log-likelihood per measurement of the last pass.
    pub likelihood: f64,
    /// Whether the record speaks for process noise: the law does not explain it down to the sensors' noise.
    pub process_matters: bool,
    /// Whether the law carries the state through the whole record, with no error that lasts.
    pub explains: bool,
    /// Factor by which error that lasts makes the covariance larger than stated; 1 where the law explains its record.
    pub overdispersion: f64,
    /// Passes closed in this stage.
    pub passes: u32,
    /// Passes in a row that left what can be integrated.
    astray: u32,
    /// Passes in a row that changed little.
    calm: u32,
    /// Whether the law stood when the record had last grown as a trial asks.
    stood: bool,
    trial: Trial,
    /// What is known beside the record, about `coefficients`.
    prior: Information,
    /// The effect that the law lacks most, as of the last pass that looked for one.
    pub missing: Option<Missing>,
    lack: Lack,
    /// Whether the pass looks for effects that the law lacks.
    looking: bool,
    /// Length of the record from which the next pass looks.
    next_look: u64,
    pass: Pass,
    next: u64,
    closed_at: u64,
    checkpoint: Checkpoint,
    forecast: Forecast,
    structure: Structure,
    previous: Vec<f64>,
    largest: [f64; 2],
    running_scales: Scales,
    inertia_prior: Option<InertiaPrior>,
    blocks: Blocks,
    known_noise: [f64; 2],
    known_noise_weight: f64,
    known_scales: Scales,
    constancy: Constancy,
}

/// Information from the first half of a long record, to be folded into the prior.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Checkpoint {
    at: Option<u64>,
    information: Information,
}

impl Stage {
    /// Room for the problem.
    pub fn new(problem: &Problem) -> Stage {
        let n = problem.n();
        Stage {
            start: 0,
            coefficients: vec![0.0; n],
            all: problem.known.clone(),
            active: vec![true; n],
            noise: Noise { sensor: [1.0; 2], process: 1.0 },
            solution: Solution::none(n),
            information: Information::none(n),
            decrement: f64::INFINITY,
            gain: f64::INFINITY,
            likelihood: f64::NEG_INFINITY,
            process_matters: false,
            explains: false,
            overdispersion: 1.0,
            blocks: Blocks::new(n),
            passes: 0,
            astray: 0,
            calm: 0,
            stood: false,
            trial: Trial { length: 0, all: vec![0.0; problem.terms.len()], stood_from: 0 },
            prior: Information::none(n),
            missing: None,
            lack: Lack::new(&problem.terms, n),
            looking: false,
            next_look: 0,
            pass: Pass::new(n).guarded(),
            next: 0,
            closed_at: 0,
            checkpoint: Checkpoint { at: None, information: Information::none(n) },
            forecast: Forecast::new(n),
            structure: Structure::new(n),
            previous: vec![0.0; n],
            largest: [0.0; 2],
            scales: Scales::new(n),
            running_scales: Scales::new(n),
            inertia_prior: None,
            known_noise: [0.0; 2],
            known_noise_weight: 0.0,
            known_scales: Scales::new(n),
            constancy: Constancy::new(n),
        }
    }

    /// Begins a stage at sample `start` from the coefficients `from` and these noise levels; before any data the coefficients
    /// lie about `centre` with the std `spread`.
    pub fn begin(&mut self, problem: &Problem, window: &Window, start: u64, from: &[f64], prior: Prior, noise: Noise) {
        self.start = start;
        self.coefficients.copy_from_slice(from);
        problem.scatter(from, &mut self.all);
        self.active.fill(true);
        self.noise = noise;
        match prior.structure {
            Some(active) => self.structure.remember(active),
            None => self.structure.forget(),
        }
        self.known_noise = noise.sensor;
        self.known_noise_weight = prior.noise_weight;
        self.known_scales.remember(prior.scales, prior.noise_weight);
        (self.passes, self.astray, self.calm) = (0, 0, 0);
        (self.stood, self.trial.length) = (false, 0);
        self.constancy.clear();
        self.decrement = f64::INFINITY;
        self.closed_at = start;
        self.prior.clear();
        let n = problem.n();
        for (index, ((std, centre), from)) in prior.std.iter().zip(prior.centre).zip(from).enumerate() {
            let precision = (std * std).recip();
            self.prior.matrix[index * n + index] = precision;
            self.prior.score[index] = precision * (centre - from);
        }
        self.inertia_prior = None;
        if let Some(index) = problem.free_inertia() {
            (self.prior.matrix[index * n + index], self.prior.score[index]) = (0.0, 0.0);
            self.inertia_prior = Some(InertiaPrior { centre: prior.centre[index], log_std: prior.log_inertia });
        }
        self.gain = f64::INFINITY;
        self.missing = None;
        self.next_look = 0;
        self.forecast.clear();
        self.largest = [0.0; 2];
        self.begin_pass(problem, window);
    }

    /// Begins a stage at sample `start` with a law that is known: its coefficients, and its information beside the record's.
    pub fn begin_known(
        &mut self,
        problem: &Problem,
        window: &Window,
        start: u64,
        law: &KnownLaw,
        noise: Noise,
        scales: &Scales,
    ) {
        let prior = Prior {
            centre: &law.coefficients,
            std: &law.spread,
            log_inertia: 1.0,
            structure: Some(&law.active),
            noise_weight: NOISE_MEMORY,
            scales,
        };
        self.begin(problem, window, start, &law.coefficients, prior, noise);
        self.active.copy_from_slice(&law.active);
        self.prior.clone_from_slices(&law.information);
        self.inertia_prior = None;
    }

    /// Number of samples in the stage's record up to `end`.
    pub fn length(&self, end: u64) -> u64 {
        end.saturating_sub(self.start)
    }

    /// Advances the pass by up to `budget` samples; returns whether a pass was closed.
    pub fn refine(&mut self, problem: &Problem, settings: &Settings, window: &Window, budget: usize) -> bool {
        let end = window.ready();
        if self.next <= window.oldest() {
            self.start = window.oldest();
            self.begin_pass(problem, window);
        }
        let motion = Motion { terms: &problem.terms, coefficients: &self.all };
        let stop = end.min(self.next + budget as u64);
        while self.next < stop {
            let observation = window.observation(self.next);
            let innovations = self.pass.step(&motion, &problem.free_terms, &self.noise, &observation);
            if self.looking {
                self.lack.step(&motion, &self.pass, &observation, &innovations);
            }
            self.running_scales.add(problem, &self.all, &self.pass, &observation);
            self.blocks.step(&self.pass.information);
            for channel in (0..2).filter(|channel| innovations[*channel].is_some()) {
                self.largest[channel] = self.largest[channel].max(observation.measured[channel].unwrap_or(0.0).abs());
            }
            self.next += 1;
            self.forecast.step(self.next, &self.pass.information);
            if Some(self.next) == self.checkpoint.at {
                self.checkpoint.information.clone_from_slices(&self.pass.information);
            }
        }
        let fresh = self.closed_at + FRESH.max((GROWTH * self.length(end) as f64) as u64);
        if self.next < end || (self.next < fresh && self.decrement < SETTLED) || self.length(end) < 4 {
            return false;
        }
        self.close(problem, settings, window);
        true
    }

    /// What the record of the pass just closed says about `coefficients`, without the prior; until the next one begins.
    pub fn record(&self) -> &Information {
        &self.pass.information
    }

    /// Whether the last passes agree: the estimate is at the likelihood's maximum, to within a fraction of its std.
    pub fn settled(&self) -> bool {
        self.calm >= 2
    }

    /// Whether the last pass changed little, by its own standard.
    pub fn is_calm(&self) -> bool {
        self.passes >= 2 && self.decrement.abs() < SETTLED * self.overdispersion && self.gain < GAIN
    }

    /// Std of the free coefficient; infinite where the data do not determine it.
    pub fn std(&self, free: usize) -> f64 {
        self.solution.std(free, self.overdispersion)
    }

    /// The variance that the estimate states for e of eq. (8), relative: tr Cov ÷ Σθ².
    pub fn stated_error(&self) -> f64 {
        let squares: f64 = self.all.iter().map(|value| value * value).sum();
        let active = (0..self.active.len()).filter(|index| self.active[*index]);
        let trace: f64 = active
            .map(|index| if self.solution.determined[index] { self.solution.variance(index) } else { f64::INFINITY })
            .sum();
        self.overdispersion * trace / squares
    }

    /// The run that was just closed, at the head of the stream and linear about the new coefficients; the caller gets it in
    /// exchange for another one's room. The next pass begins.
    pub fn hand_over(&mut self, problem: &Problem, window: &Window, live: &mut Pass) {
        std::mem::swap(&mut self.pass, live);
        live.information.clone_from_slices(&self.information);
        self.begin_pass(problem, window);
    }

    fn close(&mut self, problem: &Problem, settings: &Settings, window: &Window) {
        let track = self.pass.track;
        self.closed_at = self.next;
        if self.looking {
            self.missing = self.lack.missing(&self.active, self.overdispersion);
            self.next_look = (LOOK_AGAIN * self.length(self.next) as f64) as u64;
        }
        std::mem::swap(&mut self.scales, &mut self.running_scales);
        self.scales.merge(&self.known_scales, 1.0);
        self.passes += 1;
        self.information.clone_from_slices(&self.pass.information);
        self.information.merge(&self.prior);
        if let (Some(index), Some(prior)) = (problem.free_inertia(), self.inertia_prior) {
            let (information, score) = prior.about(self.coefficients[index]);
            self.information.matrix[index * problem.n() + index] += information;
            self.information.score[index] += score;
        }
        self.previous.copy_from_slice(&self.coefficients);
        self.structure.select(
            &self.information,
            &problem.maybe,
            track.total(),
            &mut self.coefficients,
            &mut self.active,
            &mut self.solution,
        );
        if !self.coefficients.iter().all(|value| value.is_finite()) {
            return self.recover(problem, window);
        }
        self.astray = 0;
        self.limit_step(problem);
        problem.scatter(&self.coefficients, &mut self.all);
        for (step, value) in self.previous.iter_mut().zip(&self.coefficients) {
            *step = value - *step;
        }
        self.move_to_new_coefficients();
        let active = self.active.iter().filter(|active| **active).count().max(1);
        self.decrement = self.information.quadratic(&self.previous) / active as f64;
        self.tell_error(problem, settings, &track, window);
        self.follow_noise(problem, settings, &track, window);
        self.calm = if self.is_calm() { self.calm + 1 } else { 0 };
        self.confirm();
        self.compare();
        self.foretell();
        self.fold(window);
    }

    /// Number of the sample that the last pass ended with.
    pub fn closed_at(&self) -> u64 {
        self.closed_at
    }

    /// The pass has left what can be integrated: it is repeated from the last coefficients with the filter closer to the data.
    fn recover(&mut self, problem: &Problem, window: &Window) {
        self.coefficients.copy_from_slice(&self.previous);
        self.noise.process = if self.noise.process.is_finite() { 1e3 * self.noise.process } else { 1.0 };
        (self.decrement, self.gain) = (f64::INFINITY, f64::INFINITY);
        (self.passes, self.calm) = (0, 0);
        self.astray += 1;
        self.begin_pass(problem, window);
    }

    /// Whether no process noise keeps the run where it can be integrated: the coefficients are beyond repair.
    pub fn is_lost(&self) -> bool {
        self.astray >= LOST
    }

    /// Keeps the inertia from losing more than half of itself in one step.
    fn limit_step(&mut self, problem: &Problem) {
        let Some(inertia) = problem.free_inertia() else { return };
        let (old, new) = (self.previous[inertia], self.coefficients[inertia]);
        let change = new - old;
        let allowed = 0.6 * old.abs();
        let against = change * old < 0.0 && change.abs() > allowed;
        if against {
            let fraction = allowed / change.abs();
            for (new, old) in self.coefficients.iter_mut().zip(&self.previous) {
                *new = old + fraction * (*new - old);
            }
        }
    }

    /// `previous` holds the step: scores are taken about the new coefficients, the filtered state follows them.
    fn move_to_new_coefficients(&mut self) {
        self.information.shift(&self.previous);
        self.prior.shift(&self.previous);
        self.pass.information.shift(&self.previous);
        if self.checkpoint.at.is_some() {
            self.checkpoint.information.shift(&self.previous);
        }
        for (step, sensitivity) in self.previous.iter().zip(&self.pass.sensitivity) {
            self.pass.filter.state.q += step * sensitivity[0];
            self.pass.filter.state.qd += step * sensitivity[1];
        }
    }

    /// When the record outgrows the window, its first half becomes prior knowledge.
    fn fold(&mut self, window: &Window) {
        let full = self.length(self.next) as f64 > FULL * window.capacity() as f64;
        if let Some(at) = self.checkpoint.at.take().filter(|_| full) {
            self.prior.merge(&self.checkpoint.information);
            self.start = at;
        }
    }

    /// Begins the next pass.
    pub fn begin_pass(&mut self, problem: &Problem, window: &Window) {
        let length = self.length(window.ready());
        let long = length as f64 > 0.6 * FULL * window.capacity() as f64;
        self.checkpoint.at = long.then_some(self.start + length / 2);
        self.pass.begin(first_state(problem, window, self.start, &self.noise));
        self.next = self.start + 1;
        self.looking = self.settled() && length >= self.next_look;
        if self.looking {
            self.lack.begin(self.pass.filter.state, self.largest);
        }
        self.running_scales.clear();
        self.forecast.begin(self.start, length);
        self.blocks.begin(length);
    }
}
