//! Our method: acquire → track → suspect → re-identify.

mod contest;
mod doubt;
mod drifting;
mod live;
mod loudness;
mod moving;
mod published;
mod recognition;
mod switch;

use super::deviation::Deviation;
use super::drift::Drift;
use super::functional::WeakForm;
use super::identifier::{Coefficient, Output, Status};
use super::known::KnownLaws;
use super::moving::Moving;
use super::problem::Problem;
use super::roughness::Roughness;
use super::scales::Scales;
use super::settings::Settings;
use super::stage::{Stage, TRUSTED};
use super::start::Start;
use super::trials::Trials;
use super::usual::Usual;
use super::window::Window;
use crate::evidence::{Bank, Law};
use doubt::Doubt;
use live::Live;
use recognition::{Lingering, Sight};
use serde::{Deserialize, Serialize};

/// Hypotheses of a switch that are kept.
const HYPOTHESES: usize = 20;

/// A hypothesis starts every so many samples.
const SPAWN_EVERY: u64 = 2;

/// Oldest start that is still considered, s ÷ `sample_time`: the record of a switch this old has long been decided on.
const OLDEST: f64 = 8.0;

/// Hypotheses looked at in a step.
const LOOKS: usize = 3;

/// Samples of refinement in a step, while tracking and while the fit has yet to converge: what a law that does not explain its record
/// still gains by more passes is no better law.
const BUDGET: [usize; 2] = [6, 40];

/// A stage with fewer samples than this is refined at the faster pace: its law is not yet linear within its std.
const YOUNG: u64 = 5000;

/// A switch moves a coefficient's force by this fraction of the acceleration's RMS, as a std.
const SWITCH_SIZE: f64 = 0.3;

/// The prior of a new law is this much wider than the switch that is looked for.
const PRIOR_WIDTH: f64 = 3.0;

/// Std of the logarithm of an inertia after a switch, or about a first guess.
const INERTIA_SPREAD: f64 = 0.5;

/// Samples for which a suspicion keeps the law in use from being renewed: what comes may belong to another law.
const SUSPENSE: u64 = 1000;

/// Once in so many samples it is asked which lengths of variation are too short for the motion.
const REST_EVERY: u64 = 256;

/// After so many passes in a row what a law leaves unexplained is no matter of a fit that has not settled.
const LASTS: u32 = 3;

/// Samples from which on differences tell the sensors' noise to a tenth.
const ROUGHLY: u64 = 500;

/// The state of our method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tracker {
    window: Window,
    start: Start,
    drift: Drift,
    moving: Moving,
    /// Whether coefficients that moved are being tried for a constant law.
    resting: bool,
    /// Whether coefficients have moved in this record.
    drifted: bool,
    stage: Stage,
    challenger: Stage,
    challenging: bool,
    challenged_from: u64,
    /// How often the weak rows have begun anew since.
    afresh: u32,
    live: Live,
    bank: Bank,
    weak_form: WeakForm,
    roughness: Roughness,
    /// Whether a law's residuals have told the sensors' noise.
    noise_known: bool,
    deviation: Deviation,
    usual_deviation: f64,
    usual: Usual,
    phase: Phase,
    next_guess: u64,
    suspected: u64,
    renewed: bool,
    /// Since which sample the evidence of a switch is more than chance brings now and then.
    unusual_since: Option<u64>,
    next_noise_challenge: u64,
    spread: Vec<f64>,
    noise_weight: f64,
    /// How large the motion was before the last switch.
    scales: Scales,
    all_active: Vec<bool>,
    change: Vec<f64>,
    centre: Vec<f64>,
    known: KnownLaws,
    trials: Trials,
    /// Place of the known law that the stage was recognised as.
    recognised: Option<usize>,
    /// Whether that law's trial has confirmed it.
    confirmed: bool,
    /// What speaks against it until then.
    doubt: Doubt,
    /// Whether a recognised law was taken back in this step.
    retracted: bool,
    /// The known law that is to be recognised in this step.
    in_sight: Option<Sight>,
    lingering: Option<Lingering>,
    /// Start of a record on which the known laws are to be tried as soon as it has begun.
    trial_due: Option<u64>,
    /// Samples that the recognised law is known from.
    experience: u64,
    /// Whether the last law that was vouched for over a long record explained it.
    explained: bool,
    /// Samples that laws of late took to be vouched for.
    acquaintance: u64,
    /// Since which sample a law that was vouched for is contested again.
    doubted_from: u64,
    /// Passes in a row after which the stage seemed to hold several laws.
    unexplained_passes: u32,
    /// Since which sample the stage's record has been explained by another law than the one in use, pass by pass.
    contradicted_since: Option<u64>,
}

/// Where the identification stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    /// Rows are gathered for the first law.
    Gathering,
    /// A stage is being refined.
    Refining,
}

impl Tracker {
    /// Room for everything.
    pub fn new(problem: &Problem, settings: &Settings) -> Tracker {
        let n = problem.n();
        let capacity = (settings.max_window / settings.sample_time).ceil() as usize;
        Tracker {
            window: Window::new(capacity, problem.channels, problem.hold),
            start: Start::new(problem, capacity),
            drift: Drift::new(problem, capacity),
            moving: Moving::new(problem),
            resting: false,
            drifted: false,
            stage: Stage::new(problem),
            challenger: Stage::new(problem),
            challenging: false,
            challenged_from: 0,
            afresh: 0,
            live: Live::new(problem),
            bank: Bank::new(n, HYPOTHESES),
            weak_form: WeakForm::new(problem),
            roughness: Roughness::default(),
            noise_known: false,
            deviation: Deviation::new(settings.deviation_interval, settings.sample_time),
            usual_deviation: 0.0,
            usual: Usual::default(),
            phase: Phase::Gathering,
            next_guess: 0,
            suspected: 0,
            renewed: true,
            unusual_since: None,
            next_noise_challenge: 0,
            spread: vec![1.0; n],
            noise_weight: 0.0,
            scales: Scales::new(n),
            all_active: vec![true; n],
            change: vec![0.0; n],
            centre: vec![0.0; n],
            known: KnownLaws::new(n),
            trials: Trials::new(problem),
            recognised: None,
            confirmed: false,
            doubt: Doubt::default(),
            retracted: false,
            in_sight: None,
            lingering: None,
            trial_due: Some(0),
            experience: 0,
            explained: false,
            acquaintance: 0,
            doubted_from: 0,
            unexplained_passes: 0,
            contradicted_since: None,
        }
    }

    /// Log-likelihood per measurement of the present stage; none before its first pass.
    pub fn likelihood(&self) -> Option<f64> {
        let known = self.phase == Phase::Refining && self.stage.likelihood.is_finite();
        known.then_some(self.stage.likelihood)
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
        let switches = output.switch_count;
        self.window.push(sample);
        self.weak_form.step(problem, sample);
        if self.window.end().is_multiple_of(REST_EVERY) {
            self.weak_form.rest(problem, self.first_noise(settings));
        }
        self.measure_roughness(problem, output);
        self.follow(problem, settings, output);
        if !output.drifting || self.resting {
            self.seek_constant_law(problem, settings, published, output);
        }
        self.track_moving(problem, published, output);
        self.track_drift(problem, settings, published, output);
        self.foretell(problem, published, output);
        if output.switch_count != switches {
            self.weak_form.restart();
        }
    }

    /// What a caller is to see: of a record whose law cannot state an honest std, the coefficients of the weak form in place of its own. They
    /// are not validated; nor is a law at rest of which some std is not known.
    pub fn show(&mut self, problem: &Problem, settings: &Settings, shown: &mut [Coefficient], output: &mut Output) {
        if output.drifting {
            return;
        }
        let stated = problem.free.iter().filter(|index| shown[**index].std.is_some()).count();
        // a law whose innovations are white is on its way to state an std of its own
        let consistent = self.phase == Phase::Refining && self.stage.explains;
        if stated == 0 && !consistent {
            output.explained = self.weak_form.publish(problem, self.first_noise(settings), shown);
        }
        output.valid &= stated == problem.n();
    }

    fn seek_constant_law(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        published: &mut [Coefficient],
        output: &mut Output,
    ) {
        self.begin_trial(problem, settings);
        let used = self.try_known(problem, settings, published, output);
        if !output.valid || output.drifting {
            self.begin_afresh();
            self.challenge(problem, settings);
        }
        self.challenge_noise(problem, settings);
        self.refine_challenger(problem, settings, BUDGET[1] - used, output.valid);
        if self.phase == Phase::Refining {
            self.refine(problem, settings, published, output);
        }
        self.retract(problem, published);
    }

    /// Before any law the sensors' noise is known from differences.
    fn measure_roughness(&mut self, problem: &Problem, output: &mut Output) {
        let end = self.window.end();
        if end < 4 {
            return;
        }
        self.roughness.add([4, 3, 2, 1].map(|back| self.window.sample(end - back)));
        if let Some([q, qd]) = self.roughness.variance().filter(|_| !self.noise_known && end >= ROUGHLY) {
            output.noise_q = problem.channels.q.then(|| q.sqrt());
            output.noise_qd = problem.channels.qd.then(|| qd.sqrt());
        }
    }

    fn now(&self) -> f64 {
        self.window.sample(self.window.end() - 1).t
    }

    /// Time between the last two samples, s: it hides when in it a law switched.
    fn last_interval(&self) -> f64 {
        self.now() - self.window.sample(self.window.end().max(2) - 2).t
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
                // of a law that came back only its own terms are known from before: to seek the others too would make it look unlikely
                let own = &self.live.active;
                let open = if self.recognised.is_some() { own } else { &self.all_active };
                let law = Law { information: &self.live.pass.information, open, own, explains: self.explains() };
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

    /// Whether the law in use explains its record down to the sensors' noise, and the record is long enough to tell.
    fn explains(&self) -> bool {
        !self.stage.process_matters && self.stage.length(self.window.ready()) + self.experience >= YOUNG
    }

    fn refine(&mut self, problem: &Problem, settings: &Settings, published: &mut [Coefficient], output: &mut Output) {
        let young = !output.valid || self.stage.length(self.window.ready()) < YOUNG;
        let converging = self.stage.explains && !self.stage.settled();
        let budget = BUDGET[usize::from(young || converging)];
        let suspense = output.status == Status::SwitchSuspected && self.window.end() < self.suspected + SUSPENSE;
        if suspense || !self.stage.refine(problem, settings, &self.window, budget) {
            return;
        }
        if self.give_up_guess() || self.leave(problem, settings, output) {
            return;
        }
        output.missing = self.stage.missing;
        let contradicted = self.live.running && self.stage.contradicts(&self.live.all);
        self.contradicted_since = contradicted.then(|| self.contradicted_since.unwrap_or(self.stage.closed_at()));
        let mixed = self.is_mixed();
        let trusted = self.stage.settled() && self.stage.stated_error() < TRUSTED && !mixed;
        let worth_monitoring = trusted && self.stage.stands();
        if trusted {
            self.set_spread(problem);
            self.publish(problem, settings, published, output);
        } else if !output.valid && !output.drifting {
            // the last law's std are none of this one's
            problem.free.iter().for_each(|index| published[*index].std = None);
        }
        let waits = self.unusual_since.is_some_and(|since| self.window.end() < since + SUSPENSE);
        self.unexplained_passes = if mixed { self.unexplained_passes + 1 } else { 0 };
        if self.unexplained_passes >= LASTS && output.valid && !waits && !output.drifting {
            self.doubt_law(output);
        }
        let proven = output.valid || self.stage.explains && self.stage.stands();
        // a law that has stood its trial is not left for one that has not: what happened to it may be a switch
        let later = self.live.running && self.live.proven && !proven;
        if !waits && !later && (worth_monitoring || (self.live.running && self.stage.is_calm() && !mixed)) {
            self.monitor_new_law(problem, proven);
        } else {
            self.stage.begin_pass(problem, &self.window);
        }
    }

    /// From now on switches are weighed against the stage's new estimate. Hypotheses are linear about the old one: they are carried over
    /// only between laws as near to each other as those that have stood their trial.
    fn monitor_new_law(&mut self, problem: &Problem, proven: bool) {
        self.renewed = true;
        if self.live.running {
            for (index, change) in self.change.iter_mut().enumerate() {
                *change = self.stage.coefficients[index] - self.live.all[problem.free[index]];
            }
            match proven && self.live.noise.is_near(&self.stage.noise) {
                true => self.bank.shift(&self.change),
                false => self.bank.clear(),
            }
        } else {
            self.end_lingering();
        }
        self.live.adopt(problem, &mut self.stage, &self.window);
        self.live.proven = proven;
        self.set_spread(problem);
        self.bank.set_spread(&self.spread);
    }

    /// τ of each coefficient: a change whose force moves the acceleration by [`SWITCH_SIZE`] of its RMS.
    fn set_spread(&mut self, problem: &Problem) {
        let scales = &self.stage.scales;
        for index in 0..problem.n() {
            let slope = scales.slope(index);
            let acceleration = match problem.free_inertia() == Some(index) {
                true => scales.acceleration(),
                false => scales.restoring_acceleration(),
            };
            self.spread[index] = if slope > 0.0 { SWITCH_SIZE * acceleration / slope } else { 1e9 };
        }
    }
}

/// Evidence that chance reaches once in the false-alarm interval, nats.
fn alarm_level(settings: &Settings) -> f64 {
    (settings.false_alarm_interval / settings.sample_time).ln().max(3.0)
}
