//! The law in use, run along with the stream: its innovations, its prediction, and how far that deviates.

use super::loudness::Loudness;
use super::{Stage, Tracker};
use crate::evidence::{Innovation, Noise, Observation, Pass};
use crate::identify::identifier::Output;
use crate::identify::known::KnownLaw;
use crate::identify::problem::Problem;
use crate::identify::scales::Scales;
use crate::identify::settings::Settings;
use crate::identify::trials::Trials;
use crate::identify::window::Window;
use crate::law::{Motion, State};
use serde::{Deserialize, Serialize};

/// The law's own covariance counts this many times where it leaves the state open, as long as it is that of a linearisation …
const DISTRUST: f64 = 10.0;

/// … which it is over a record of so many samples. It falls with the fourth power of the length then: the hypotheses know it too.
const LINEAR: f64 = 4000.0;

/// An error of the law acts one way for this many samples at most.
const LONGEST_ERROR: f64 = 1000.0;

/// The law in use, run along with the stream.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Live {
    pub(super) pass: Pass,
    pub(super) all: Vec<f64>,
    pub(super) active: Vec<bool>,
    pub(super) noise: Noise,
    pub(super) loudness: Loudness,
    /// Of its record, as in [`Stage::overdispersion`].
    pub(super) overdispersion: f64,
    /// Number of the sample at which that was taken from the record.
    dispersed_at: u64,
    /// How many times the covariance counts.
    distrust: f64,
    /// Whether it explained its record but for the sensors' noise.
    pub(super) explains: bool,
    /// Whether it was vouched for, or had stood its trial and explained its record.
    pub(super) proven: bool,
    /// Covariance of the free coefficients, n × n.
    covariance: Vec<f64>,
    /// For how long an error of the law acts one way, s.
    lasting: f64,
    /// ∂q̈/∂θ by free coefficient, the inertia's as a mean over that time.
    slopes: Vec<f64>,
    pub(super) next: u64,
    pub(super) running: bool,
    prediction: State,
    predicted_since: f64,
}

impl Live {
    /// Room for the problem.
    pub(super) fn new(problem: &Problem) -> Live {
        let n = problem.n();
        Live {
            pass: Pass::new(n).guarded(),
            all: problem.known.clone(),
            active: vec![true; n],
            noise: Noise { sensor: [1.0; 2], process: 1.0 },
            loudness: Loudness::USUAL,
            overdispersion: 1.0,
            dispersed_at: 0,
            distrust: DISTRUST,
            explains: false,
            proven: false,
            covariance: vec![0.0; n * n],
            lasting: 0.0,
            slopes: vec![0.0; n],
            next: 0,
            running: false,
            prediction: State::default(),
            predicted_since: 0.0,
        }
    }

    /// Takes a sample; returns what it says of a switch, readings that do not count included.
    pub(super) fn step(&mut self, problem: &Problem, observation: &Observation) -> [Option<Innovation>; 2] {
        let motion = Motion { terms: &problem.terms, coefficients: &self.all };
        let sensor = [0, 1].map(|channel| self.noise.sensor[channel] * self.loudness.factor(channel));
        let noise = Noise { process: self.noise.process + self.doubt(), sensor };
        let innovations = self.pass.step(&motion, &problem.free_terms, &noise, observation);
        self.loudness.add(&innovations, &observation.measured);
        self.follow_slopes(observation.dt, problem.free_inertia());
        let [q, qd] = innovations;
        let [q_aside, qd_aside] = self.pass.set_aside;
        [q.or(q_aside), qd.or(qd_aside)]
    }

    /// Slopes after an interval. The inertia's goes with the acceleration, which a rough excitation turns around faster than the motion
    /// follows: such errors do not last.
    fn follow_slopes(&mut self, dt: f64, inertia: Option<usize>) {
        let share = dt / (self.lasting + dt);
        for (index, (slope, input)) in self.slopes.iter_mut().zip(&self.pass.map.input).enumerate() {
            let share = if inertia == Some(index) { share } else { 1.0 };
            *slope += share * (input[1] / dt - *slope);
        }
    }

    /// Intensity of the acceleration that the law's own uncertainty leaves open, (m/s²)² s: where the motion leaves what its record has
    /// seen, an uncertain law must not bind the state.
    fn doubt(&self) -> f64 {
        let slopes = &self.slopes;
        let rows = self.covariance.chunks_exact(slopes.len()).zip(slopes);
        let variance: f64 = rows
            .map(|(row, slope)| slope * row.iter().zip(slopes).map(|(entry, other)| entry * other).sum::<f64>())
            .sum();
        self.distrust * variance.max(0.0) * self.lasting
    }

    /// Takes over the stage's estimate and the run that led to it.
    pub(super) fn adopt(&mut self, problem: &Problem, stage: &mut Stage, window: &Window) {
        stage.hand_over(problem, window, &mut self.pass);
        self.all.copy_from_slice(&stage.all);
        self.active.copy_from_slice(&stage.active);
        self.loudness.refer(&self.noise, &stage.noise);
        self.noise = stage.noise;
        self.follow_overdispersion(stage, window.ready());
        self.distrust = distrust(stage.length(window.ready()));
        self.explains = !stage.process_matters;
        self.covariance.copy_from_slice(&stage.solution.covariance);
        self.follow_scales(&stage.scales, window);
        if !self.running {
            self.loudness = Loudness::USUAL;
            self.restart_prediction(window.sample(window.ready() - 1).t);
        } else if !self.proven {
            self.loudness.forget_lately();
        }
        self.next = window.ready();
        self.running = true;
    }

    /// Where the motion has no scale yet, an error acts for the longest time.
    fn follow_scales(&mut self, scales: &Scales, window: &Window) {
        let [before, last] = [window.ready() - 2, window.ready() - 1].map(|number| window.sample(number).t);
        self.lasting = scales.natural_time().min(LONGEST_ERROR * (last - before));
    }

    /// Error that has come since the record was half as long may be a switch's: it does not count until it has lasted.
    fn follow_overdispersion(&mut self, stage: &Stage, now: u64) {
        let then = stage.length(self.dispersed_at);
        let lasts = then == 0 || stage.length(now) >= 2 * then;
        if !self.running || lasts || stage.overdispersion <= self.overdispersion {
            (self.overdispersion, self.dispersed_at) = (stage.overdispersion, now);
        }
    }

    /// Takes over a known law and the run of its trial.
    pub(super) fn adopt_known(
        &mut self,
        problem: &Problem,
        law: &KnownLaw,
        trials: &mut Trials,
        place: usize,
        scales: &Scales,
        window: &Window,
    ) {
        self.noise = trials.noise(place);
        self.loudness = Loudness::USUAL;
        self.distrust = distrust(law.samples);
        self.follow_scales(scales, window);
        (self.overdispersion, self.dispersed_at) = (1.0, window.ready());
        (self.explains, self.proven) = (true, true);
        trials.hand_over(place, problem, window, &mut self.pass);
        self.pass.information.merge(&law.information);
        self.all.copy_from_slice(&problem.known);
        problem.scatter(&law.coefficients, &mut self.all);
        self.active.copy_from_slice(&law.active);
        self.covariance.copy_from_slice(&law.covariance);
        self.restart_prediction(window.sample(window.ready() - 1).t);
        self.next = window.ready();
        self.running = true;
    }

    fn restart_prediction(&mut self, t: f64) {
        self.prediction = self.pass.filter.state;
        self.predicted_since = t;
    }
}

/// How many times the covariance of a law counts that is known from so many samples.
fn distrust(samples: u64) -> f64 {
    DISTRUST * (LINEAR / samples.max(1) as f64).min(1.0).powi(4)
}

impl Tracker {
    pub(super) fn predict(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        number: u64,
        observation: &Observation,
        output: &mut Output,
    ) {
        let sample = *self.window.sample(number);
        let motion = Motion { terms: &problem.terms, coefficients: &self.live.all };
        let [from, _, to] = observation.drive.part(0, 1);
        self.live.prediction = motion.step_linear(self.live.prediction, observation.dt, from, to);
        if !self.live.prediction.is_finite() {
            self.live.restart_prediction(sample.t);
        }
        let prediction = self.live.prediction;
        let weight = |measured: bool, weight: f64| if measured { weight } else { 0.0 };
        let difference = weight(problem.channels.q, settings.weight_q) * (prediction.q - sample.q).abs()
            + weight(problem.channels.qd, settings.weight_qd) * (prediction.qd - sample.qd).abs();
        if difference.is_finite() {
            self.deviation.add(sample.t, difference);
        }
        (output.prediction_q, output.prediction_qd) = (prediction.q, prediction.qd);
        output.deviation = self.deviation.mean();
        output.threshold = self.threshold(settings);
        if sample.t - self.live.predicted_since > settings.deviation_interval {
            self.live.restart_prediction(sample.t);
            self.usual_deviation += 0.2 * (output.deviation - self.usual_deviation);
        }
    }

    /// The given threshold, or four times the usual deviation under this law and what its noise alone would give.
    fn threshold(&self, settings: &Settings) -> f64 {
        if settings.deviation_threshold > 0.0 {
            return settings.deviation_threshold;
        }
        let [q, qd] = self.live.noise.sensor.map(f64::sqrt);
        4.0 * self.usual_deviation.max(settings.weight_q * q + settings.weight_qd * qd)
    }
}
