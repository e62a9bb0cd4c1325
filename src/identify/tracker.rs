//! Our method: acquire → track → suspect → re-identify.

use super::deviation::Deviation;
use super::identifier::{Coefficient, Output, Status};
use super::problem::Problem;
use super::settings::Settings;
use super::stage::{Prior, Stage, TRUSTED};
use super::start::Start;
use super::usual::Usual;
use super::window::Window;
use crate::evidence::{Bank, Law, Noise, Observation, Pass, Suspect};
use crate::law::{Motion, State};
use serde::{Deserialize, Serialize};

/// Hypotheses of a switch that are kept.
const HYPOTHESES: usize = 20;

/// A hypothesis starts every so many samples.
const SPAWN_EVERY: u64 = 2;

/// Oldest start that is still considered, s ÷ `sample_time`: the record of a switch this old has long been decided on.
const OLDEST: f64 = 8.0;

/// Hypotheses looked at in a step.
const LOOKS: usize = 3;

/// Samples of refinement in a step, while tracking and while the law is not settled.
const BUDGET: [usize; 2] = [6, 40];

/// A stage with fewer samples than this is refined at the faster pace: its law is not yet linear within its std.
const YOUNG: u64 = 5000;

/// A switch moves a coefficient's force by this fraction of the acceleration's RMS, as a std.
const SWITCH_SIZE: f64 = 0.3;

/// For how many samples the sensor noise of the last stage counts in the next one.
const NOISE_MEMORY: f64 = 500.0;

/// The prior of a new law is this much wider than the switch that is looked for.
const PRIOR_WIDTH: f64 = 3.0;

/// Std of the logarithm of an inertia after a switch, or about a first guess.
const INERTIA_SPREAD: f64 = 0.5;

/// Passes after which a challenger that has not settled gives up.
const PATIENCE: u32 = 40;

/// Samples for which a suspicion keeps the law in use from being renewed: what comes may belong to another law.
const SUSPENSE: u64 = 1000;

/// A law from this many samples needs twice the evidence: its information is that of a linearisation, whose error falls as the
/// record grows.
const DOUBT: f64 = 2000.0;

/// A law that is not vouched for needs this many times the evidence.
const UNPROVEN: f64 = 10.0;

/// Samples from which on the kind of a record's error can be told.
const ENOUGH: u64 = 500;

/// A first law is tried when the weak start predicts its force this well.
const START_ERROR: f64 = 0.3;

/// The same where no displacement is measured: each weak row then has an offset of its own, which the filter does not need.
const START_ERROR_WITHOUT_Q: f64 = 1.0;

/// The law's own covariance counts this many times where it leaves the state open: it is that of a linearisation.
const DISTRUST: f64 = 10.0;

/// An error of the law acts one way for this many samples at most.
const LONGEST_ERROR: f64 = 1000.0;

/// Samples after which an unvouched law is contested by the latest record alone.
const FRESH_START: u64 = 12_000;

/// What the latest record must explain better than the whole one to replace it, nats per measurement.
const CLEARLY: f64 = 0.1;

/// e below this square vouches for a law.
pub const VOUCHED: f64 = 0.05 * 0.05;

/// The state of our method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tracker {
    window: Window,
    start: Start,
    stage: Stage,
    challenger: Stage,
    challenging: bool,
    challenged_from: u64,
    live: Live,
    bank: Bank,
    deviation: Deviation,
    usual_deviation: f64,
    usual: Usual,
    phase: Phase,
    next_guess: u64,
    suspected: u64,
    renewed: bool,
    next_noise_challenge: u64,
    spread: Vec<f64>,
    noise_weight: f64,
    all_active: Vec<bool>,
    change: Vec<f64>,
    centre: Vec<f64>,
}

/// Where the identification stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// Rows are gathered for the first law.
    Gathering,
    /// A stage is being refined.
    Refining,
}

/// The law in use, run along with the stream.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Live {
    pass: Pass,
    all: Vec<f64>,
    active: Vec<bool>,
    noise: Noise,
    /// Covariance of the free coefficients, n × n.
    covariance: Vec<f64>,
    /// For how long an error of the law acts one way, s.
    lasting: f64,
    next: u64,
    running: bool,
    prediction: State,
    predicted_since: f64,
}

impl Tracker {
    /// Room for everything.
    pub fn new(problem: &Problem, settings: &Settings) -> Tracker {
        let n = problem.n();
        let capacity = (settings.max_window / settings.sample_time).ceil() as usize;
        Tracker {
            window: Window::new(capacity, problem.channels, problem.hold),
            start: Start::new(problem, capacity),
            stage: Stage::new(problem),
            challenger: Stage::new(problem),
            challenging: false,
            challenged_from: 0,
            live: Live {
                pass: Pass::new(n),
                all: problem.known.clone(),
                active: vec![true; n],
                noise: Noise { sensor: [1.0; 2], process: 1.0 },
                covariance: vec![0.0; n * n],
                lasting: 0.0,
                next: 0,
                running: false,
                prediction: State::default(),
                predicted_since: 0.0,
            },
            bank: Bank::new(n, HYPOTHESES),
            deviation: Deviation::new(settings.deviation_interval, settings.sample_time),
            usual_deviation: 0.0,
            usual: Usual::default(),
            phase: Phase::Gathering,
            next_guess: 0,
            suspected: 0,
            renewed: true,
            next_noise_challenge: 0,
            spread: vec![1.0; n],
            noise_weight: 0.0,
            all_active: vec![true; n],
            change: vec![0.0; n],
            centre: vec![0.0; n],
        }
    }

    /// Log-likelihood per measurement of the present stage; none before its first pass.
    pub fn likelihood(&self) -> Option<f64> {
        let known = self.phase == Phase::Refining && self.stage.likelihood.is_finite();
        known.then_some(self.stage.likelihood)
    }

    /// What the record since the stage's start leaves open: combinations of terms while the weak rows of a first law are
    /// gathered, then single terms whose std is larger than anything plausible.
    pub fn unidentifiable(&self, problem: &Problem) -> Vec<String> {
        let name = |free: &usize| problem.free_terms[*free].name();
        let shown = self.stage.settled() && self.stage.stated_error() < TRUSTED;
        if self.phase == Phase::Refining && shown {
            let open =
                (0..problem.n()).filter(|free| self.stage.active[*free] && self.stage.std(*free) >= self.spread[*free]);
            return open.map(|free| name(&free)).collect();
        }
        let directions = self.start.open_directions();
        directions.iter().map(|direction| problem.together(direction)).collect()
    }

    /// Takes an accepted sample.
    pub fn step(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        sample: super::Sample,
        published: &mut [Coefficient],
        output: &mut Output,
    ) {
        if self.window.end() == 0 {
            output.switch_time = sample.t;
            self.start.begin(0);
        }
        self.window.push(sample);
        self.follow(problem, settings, output);
        if !output.valid {
            self.begin_afresh();
            self.challenge(problem, settings);
        }
        self.challenge_noise(problem, settings);
        self.refine_challenger(problem, settings);
        if self.phase == Phase::Refining {
            self.refine(problem, settings, published, output);
        }
    }

    fn now(&self) -> f64 {
        self.window.sample(self.window.end() - 1).t
    }

    /// A record that has grown long without a law to vouch for may hold a switch that nobody saw: the weak rows begin anew, so that
    /// the next challenger knows the latest record alone.
    fn begin_afresh(&mut self) {
        let (end, since) = (self.window.end(), self.challenged_from);
        let patience = FRESH_START + 2 * (since - self.stage.start.min(since));
        if self.challenging || self.phase == Phase::Gathering || end - since < patience {
            return;
        }
        self.start.begin(end);
        (self.challenged_from, self.next_guess) = (end, 0);
    }

    /// Begins a stage, or a challenger of the one there is, from what the weak rows of its record say.
    fn challenge(&mut self, problem: &Problem, settings: &Settings) {
        if self.start.feed(problem, &self.window, 1) {
            return;
        }
        let (window, since) = (&self.window, self.challenged_from);
        let long_enough = !self.challenging && self.now() - window.sample(window.oldest()).t >= settings.initial_window;
        if !long_enough || window.end() < self.next_guess || since < window.oldest() {
            return;
        }
        self.next_guess = window.end() + (window.end() - since) / 8 + 4;
        let sensor = match self.phase {
            Phase::Gathering => first_noise(settings, window),
            Phase::Refining if self.noise_weight > 0.0 => self.live.noise.sensor,
            Phase::Refining => self.stage.noise.sensor,
        };
        let Some(guess) = self.start.guess(problem, sensor) else { return };
        let inertia =
            problem.free_inertia().map_or(problem.known[problem.inertia], |index| guess.fit.coefficients[index]);
        let allowed = if problem.channels.q { START_ERROR } else { START_ERROR_WITHOUT_Q };
        if guess.relative_error > allowed || !(inertia.is_finite() && inertia != 0.0) {
            return;
        }
        let process = guess.force_intensity / (inertia * inertia) + f64::MIN_POSITIVE;
        let noise = Noise { sensor, process };
        let fit = guess.fit;
        for index in 0..problem.n() {
            self.spread[index] = fit.reach[index].max(10.0 * guess.std[index]).min(1e9);
            self.centre[index] = if problem.maybe[index] { 0.0 } else { fit.coefficients[index] };
        }
        let challenger = match self.phase {
            Phase::Gathering => &mut self.stage,
            Phase::Refining => &mut self.challenger,
        };
        let structure = (self.noise_weight > 0.0).then_some(self.live.active.as_slice());
        let prior = Prior {
            centre: &self.centre,
            std: &self.spread,
            log_inertia: INERTIA_SPREAD,
            structure,
            noise_weight: self.noise_weight,
        };
        challenger.begin(problem, window, since, &fit.coefficients, prior, noise);
        self.challenging = self.phase == Phase::Refining;
        self.phase = Phase::Refining;
    }

    /// A fit with much process noise may be a maximum of the likelihood without being the largest: the other kind, all error in
    /// the sensors, is tried from the same coefficients each time the record has doubled.
    fn challenge_noise(&mut self, problem: &Problem, settings: &Settings) {
        let end = self.window.ready();
        let due = end >= self.next_noise_challenge && self.phase == Phase::Refining && !self.challenging;
        if !due || !self.stage.process_matters || !self.stage.settled() || self.stage.length(end) < ENOUGH {
            return;
        }
        self.next_noise_challenge = end + self.stage.length(end);
        let sensor = first_noise(settings, &self.window);
        let noise = Noise { sensor, process: 1e-6 * self.stage.noise.process };
        self.set_spread(problem);
        self.spread.iter_mut().for_each(|spread| *spread *= PRIOR_WIDTH);
        let prior = Prior {
            centre: &self.stage.coefficients,
            std: &self.spread,
            log_inertia: INERTIA_SPREAD,
            structure: (self.noise_weight > 0.0).then_some(self.live.active.as_slice()),
            noise_weight: 0.0,
        };
        self.challenger.begin(problem, &self.window, self.stage.start, &self.stage.coefficients, prior, noise);
        self.challenging = true;
    }

    /// Refines the challenger; it takes the stage's place when it explains the record better.
    fn refine_challenger(&mut self, problem: &Problem, settings: &Settings) {
        if !self.challenging || !self.challenger.refine(problem, settings, &self.window, BUDGET[1]) {
            return;
        }
        if self.challenger.settled() {
            self.challenging = false;
            if self.challenger.agrees_with(&self.stage) {
                self.next_guess = self.window.end() + self.stage.length(self.window.end());
            }
            let measurements = 2.0 * self.challenger.length(self.window.ready()) as f64;
            let later = self.challenger.start > self.stage.start;
            let margin = if later { CLEARLY } else { 3.0 / measurements };
            if self.challenger.likelihood > self.stage.likelihood + margin {
                std::mem::swap(&mut self.challenger, &mut self.stage);
            }
        } else if self.challenger.passes > PATIENCE {
            self.challenging = false;
        }
        self.challenger.begin_pass(problem, &self.window);
    }

    /// Runs the law in use over what is new, and weighs the evidence of a switch.
    fn follow(&mut self, problem: &Problem, settings: &Settings, output: &mut Output) {
        while self.live.running && self.live.next < self.window.ready() {
            let number = self.live.next;
            let observation = self.window.observation(number);
            let innovations = self.live.step(problem, &observation);
            if !self.live.pass.filter.state.is_finite() {
                self.lose(output);
                return;
            }
            self.bank.step(&self.live.pass.map, &innovations);
            self.predict(problem, settings, number, &observation, output);
            if number.is_multiple_of(SPAWN_EVERY) {
                let law = Law { information: &self.live.pass.information, active: &self.all_active };
                self.bank.spawn(number, &law);
            }
            let oldest = number.saturating_sub((OLDEST / settings.sample_time) as u64);
            self.bank.forget_before(oldest.max(self.stage.start));
            self.bank.look(LOOKS);
            self.live.next += 1;
            if let Some(suspect) = self.bank.suspect() {
                self.judge(problem, settings, &suspect, output);
            }
        }
    }

    /// The law in use has left what can be computed: everything begins anew with the next samples.
    fn lose(&mut self, output: &mut Output) {
        let end = self.window.end();
        self.live.running = false;
        self.bank.clear();
        self.deviation.clear();
        self.start.begin(end);
        (self.phase, self.challenging, self.challenged_from) = (Phase::Gathering, false, end);
        (self.next_guess, self.next_noise_challenge) = (0, 0);
        (output.status, output.valid, output.identified_time) = (Status::Acquiring, false, None);
    }

    /// Alarm, suspicion, or neither.
    fn judge(&mut self, problem: &Problem, settings: &Settings, suspect: &Suspect, output: &mut Output) {
        let doubt = self.stage.overdispersion * (1.0 + DOUBT / self.stage.length(self.window.ready()).max(1) as f64);
        let doubt = if output.valid { doubt } else { UNPROVEN * doubt };
        let level = doubt * (settings.false_alarm_interval / settings.sample_time).ln().max(3.0);
        let level = level.max(self.usual.level());
        if output.valid {
            self.usual.add(suspect.evidence);
        }
        let given = settings.deviation_threshold;
        let deviates = given > 0.0 && self.deviation.is_full(self.now()) && output.deviation > given;
        if suspect.evidence > level || deviates {
            self.switch(problem, suspect, level, output);
        } else if output.status == Status::Tracking && suspect.evidence > 0.5 * level {
            output.status = Status::SwitchSuspected;
            if self.renewed {
                (self.suspected, self.renewed) = (self.window.end(), false);
            }
        } else if output.status == Status::SwitchSuspected && suspect.evidence <= 0.5 * level {
            output.status = Status::Tracking;
        }
    }

    /// Ends the stage; only data from after the switch enters the new law.
    fn switch(&mut self, problem: &Problem, suspect: &Suspect, level: f64, output: &mut Output) {
        self.bank.look_at_all();
        let suspect = self.bank.suspect().unwrap_or(*suspect);
        let last = self.window.ready() - 1;
        let instant = self.bank.likeliest_start(&suspect, level);
        let start = (self.bank.after(&suspect, level) + 1).min(last);
        self.bank.change(&suspect, &mut self.change);
        self.set_spread(problem);
        let plausible = self.change.iter().zip(&self.spread).all(|(change, spread)| change.abs() < 2.0 * spread);
        for (index, (change, centre)) in self.change.iter_mut().zip(&mut self.centre).enumerate() {
            *centre = self.live.all[problem.free[index]];
            *change = if plausible { *centre + *change } else { *centre };
        }
        let acceleration = self.stage.scales.acceleration();
        let process = (SWITCH_SIZE * acceleration).powi(2) * 0.1;
        let noise = Noise { sensor: self.live.noise.sensor, process: process.max(self.live.noise.process) };
        self.spread.iter_mut().for_each(|spread| *spread *= PRIOR_WIDTH);
        keep_inertia(problem, &self.live.all, &mut self.change);
        self.noise_weight = NOISE_MEMORY;
        let prior = Prior {
            centre: &self.centre,
            std: &self.spread,
            log_inertia: INERTIA_SPREAD,
            structure: Some(&self.live.active),
            noise_weight: self.noise_weight,
        };
        self.stage.begin(problem, &self.window, start, &self.change, prior, noise);
        self.start.begin(start);
        (self.challenging, self.challenged_from) = (false, start);
        (self.next_guess, self.next_noise_challenge) = (0, 0);
        self.live.running = false;
        self.bank.clear();
        self.deviation.clear();
        self.usual_deviation = 0.0;
        self.usual.clear();
        output.switch_count += 1;
        output.switch_time = self.window.sample(instant).t;
        output.detection_time = Some(self.now());
        output.identified_time = None;
        output.missing = None;
        output.valid = false;
        output.status = Status::ReIdentifying;
    }

    fn refine(&mut self, problem: &Problem, settings: &Settings, published: &mut [Coefficient], output: &mut Output) {
        let young = !output.valid || self.stage.length(self.window.ready()) < YOUNG;
        let budget = BUDGET[usize::from(young)];
        let suspense = output.status == Status::SwitchSuspected && self.window.end() < self.suspected + SUSPENSE;
        if suspense || !self.stage.refine(problem, settings, &self.window, budget) {
            return;
        }
        output.missing = self.stage.missing;
        let worth_showing = self.stage.settled() && self.stage.stated_error() < TRUSTED;
        let worth_monitoring = worth_showing && self.stage.stands();
        if worth_showing {
            self.set_spread(problem);
            self.publish(problem, published, output);
        }
        if worth_monitoring || (self.live.running && self.stage.is_calm()) {
            self.monitor_new_law(problem, output.valid);
        } else {
            self.stage.begin_pass(problem, &self.window);
        }
    }

    /// From now on switches are weighed against the stage's new estimate. Hypotheses are linear about the old one: they are carried over
    /// only between laws as near to each other as those that are vouched for.
    fn monitor_new_law(&mut self, problem: &Problem, vouched: bool) {
        self.renewed = true;
        if self.live.running {
            for (index, change) in self.change.iter_mut().enumerate() {
                *change = self.stage.coefficients[index] - self.live.all[problem.free[index]];
            }
            match vouched && self.live.noise.is_near(&self.stage.noise) {
                true => self.bank.shift(&self.change),
                false => self.bank.clear(),
            }
        }
        self.live.adopt(problem, &mut self.stage, &self.window);
        self.set_spread(problem);
        self.bank.set_spread(&self.spread);
    }

    fn publish(&mut self, problem: &Problem, published: &mut [Coefficient], output: &mut Output) {
        for (index, coefficient) in published.iter_mut().enumerate() {
            match problem.free.iter().position(|free| *free == index) {
                None => (coefficient.value, coefficient.std) = (problem.known[index], Some(0.0)),
                Some(free) => self.publish_free(free, coefficient),
            }
        }
        output.noise_q = problem.channels.q.then(|| self.stage.noise.sensor[0].sqrt());
        output.noise_qd = problem.channels.qd.then(|| self.stage.noise.sensor[1].sqrt());
        if self.stage.stands() && self.stage.stated_error() < VOUCHED {
            output.valid = true;
            output.identified_time.get_or_insert(self.now());
            if output.status != Status::SwitchSuspected {
                output.status = Status::Tracking;
            }
        }
    }

    fn publish_free(&self, free: usize, coefficient: &mut Coefficient) {
        let std = self.stage.std(free);
        if !self.stage.active[free] {
            (coefficient.value, coefficient.std) = (0.0, Some(0.0));
        } else if std < self.spread[free] {
            (coefficient.value, coefficient.std) = (self.stage.coefficients[free], Some(std));
        } else {
            coefficient.std = None;
        }
    }

    /// τ of each coefficient: a change whose force moves the acceleration by [`SWITCH_SIZE`] of its RMS.
    fn set_spread(&mut self, problem: &Problem) {
        let acceleration = self.stage.scales.acceleration();
        for index in 0..problem.n() {
            let slope = self.stage.scales.slope(index);
            self.spread[index] = if slope > 0.0 { SWITCH_SIZE * acceleration / slope } else { 1e9 };
        }
    }

    fn predict(
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

impl Live {
    fn step(&mut self, problem: &Problem, observation: &Observation) -> [Option<crate::evidence::Innovation>; 2] {
        let motion = Motion { terms: &problem.terms, coefficients: &self.all };
        let noise = Noise { process: self.noise.process + self.doubt(observation.dt), ..self.noise };
        self.pass.step(&motion, &problem.free_terms, &noise, observation)
    }

    /// Intensity of the acceleration that the law's own uncertainty leaves open over an interval like the last one, (m/s²)² s: where the
    /// motion leaves what its record has seen, an uncertain law must not bind the state.
    fn doubt(&self, dt: f64) -> f64 {
        let inputs = &self.pass.map.input;
        let rows = self.covariance.chunks_exact(inputs.len()).zip(inputs);
        let variance: f64 = rows
            .map(|(row, input)| input[1] * row.iter().zip(inputs).map(|(entry, other)| entry * other[1]).sum::<f64>())
            .sum();
        DISTRUST * variance.max(0.0) / (dt * dt) * self.lasting
    }

    /// Takes over the stage's estimate and the run that led to it.
    fn adopt(&mut self, problem: &Problem, stage: &mut Stage, window: &Window) {
        stage.hand_over(problem, window, &mut self.pass);
        self.all.copy_from_slice(&stage.all);
        self.active.copy_from_slice(&stage.active);
        self.noise = stage.noise;
        self.covariance.copy_from_slice(&stage.solution.covariance);
        let [before, last] = [window.ready() - 2, window.ready() - 1].map(|number| window.sample(number).t);
        self.lasting = stage.scales.natural_time().min(LONGEST_ERROR * (last - before));
        if !self.running {
            self.restart_prediction(last);
        }
        self.next = window.ready();
        self.running = true;
    }

    fn restart_prediction(&mut self, t: f64) {
        self.prediction = self.pass.filter.state;
        self.predicted_since = t;
    }
}

/// A linear estimate of the change may turn the inertia around: it then stays what it was.
fn keep_inertia(problem: &Problem, old: &[f64], new: &mut [f64]) {
    if let Some(index) = problem.free_inertia() {
        let ratio = new[index] / old[problem.inertia];
        if !(0.3..3.0).contains(&ratio) {
            new[index] = old[problem.inertia];
        }
    }
}

/// Sensor variances from third differences, which a smooth motion leaves small; an upper bound that passes then lower.
fn first_noise(settings: &Settings, window: &Window) -> [f64; 2] {
    let given = [settings.noise_q, settings.noise_qd];
    let channel = |index: usize, value: fn(&super::Sample) -> f64| {
        if given[index] > 0.0 {
            return given[index] * given[index];
        }
        let first = window.end().saturating_sub(1024).max(window.oldest());
        let differences = (first..window.end().saturating_sub(3)).map(|number| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|offset| value(window.sample(number + offset)));
            (d - 3.0 * c + 3.0 * b - a).powi(2)
        });
        let count = window.end().saturating_sub(3).saturating_sub(first).max(1);
        differences.sum::<f64>() / (20.0 * count as f64) + f64::MIN_POSITIVE
    };
    [channel(0, |sample| sample.q), channel(1, |sample| sample.qd)]
}
