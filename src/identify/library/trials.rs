//! Known laws on trial: the filter of each runs over the record since a stage's start.
//!
//! The state is marginalised by the filter, the law's own uncertainty by its covariance (`evidence::BayesFactor`). A
//! few samples are run at a step, shared among the laws, until all have caught up with the stream; then they are
//! weighed against each other and each against "a law that a switch may lead to".

use super::known_laws::{KnownLaws, ROOM};
use super::mixture::Mixture;
use crate::estimation::{KnownEffect, Noise, Pass, TWENTY_TO_ONE};
use crate::identify::problem::Problem;
use crate::identify::window::Window;
use crate::law::{Motion, Term};
use serde::{Deserialize, Serialize};

/// The laws are weighed anew when the record has grown by this factor: 14 times in every doubling.
const GROWTH: f64 = 1.05;

/// Samples without which nothing is weighed: two of them only say where the motion begins.
const FEWEST: u64 = 4;

/// Samples after which the trial is over: the stage's own estimate takes over.
const LONGEST: u64 = 8000;

/// A law this far behind "any law" is out of the trial, nats: nothing that comes makes good so much.
const HOPELESS: f64 = 1000.0;

/// What the record says on one known law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Trial {
    pass: Pass,
    noise: Noise,
    next: u64,
    out: bool,
    /// Log-evidence of the record under the law, its uncertainty counted, nats.
    evidence: f64,
    /// The same against any law, nats.
    against_any: f64,
    /// Variance of the innovations ÷ what the filter states, at least 1.
    scale: f64,
}

/// What the record says on one known law against the others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Its place among the known laws.
    pub place: usize,
    /// Log-evidence against any law, nats.
    pub against_any: f64,
    /// The place of the best other known law, and the log-evidence against it, nats.
    pub rival: Option<(usize, f64)>,
}

impl Verdict {
    /// Log-evidence against the best other known law, nats.
    fn against_known(&self) -> f64 {
        self.rival.map_or(f64::INFINITY, |(_, against)| against)
    }

    /// Whether the law stands out from every other known one, and by that many nats from any.
    pub fn stands_out(&self, level: f64) -> bool {
        self.against_any > level && self.against_known() > TWENTY_TO_ONE
    }

    /// Whether another law does, a known one or any.
    pub fn is_against(&self) -> bool {
        self.against_any.min(self.against_known()) < -TWENTY_TO_ONE
    }

    /// What the law may be instead.
    pub fn doubt(&self) -> Mixture {
        Mixture::of(self.against_any, self.rival)
    }
}

/// Every known law's trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trials {
    trials: Vec<Trial>,
    terms: Vec<Term>,
    all: Vec<f64>,
    /// What is known of the effect that they all have.
    pub effect: Option<KnownEffect>,
    start: u64,
    /// The place of the law that a switch at the start has left.
    pub left: Option<usize>,
    running: bool,
    next_weighing: u64,
}

impl Trials {
    /// Room for every known law.
    pub fn new(problem: &Problem) -> Trials {
        let trial = Trial {
            pass: Pass::new(problem.n()),
            noise: Noise { sensor: [1.0; 2], process: 1.0 },
            next: 0,
            out: true,
            evidence: 0.0,
            against_any: 0.0,
            scale: 1.0,
        };
        Trials {
            trials: vec![trial; ROOM],
            terms: problem.terms_and_effect(),
            all: problem.known.clone(),
            effect: None,
            start: 0,
            left: None,
            running: false,
            next_weighing: 0,
        }
    }

    /// Puts all known laws on trial over the record from sample `start`, of which there are two at least. The sensors'
    /// noise is theirs where `sensor` does not say.
    pub fn begin(&mut self, known: &KnownLaws, window: &Window, start: u64, sensor: [Option<f64>; 2]) {
        (self.start, self.next_weighing) = (start, start + FEWEST);
        self.running = !known.laws().is_empty();
        for (trial, law) in self.trials.iter_mut().zip(known.laws()) {
            let own = law.noise.sensor;
            let sensor = [0, 1].map(|channel| sensor[channel].unwrap_or(own[channel]));
            trial.noise = Noise { sensor, process: law.noise.process };
            trial.begin(window, start);
        }
    }

    /// All laws on trial have this effect, which the model lacks.
    pub fn set_effect(&mut self, effect: Option<KnownEffect>) {
        let place = self.all.len() - 1;
        self.all[place] = effect.map_or(0.0, |effect| effect.coefficient);
        effect.into_iter().for_each(|effect| self.terms[place] = effect.term);
        self.effect = effect;
    }

    /// Ends the trial.
    pub fn end(&mut self) {
        self.running = false;
    }

    /// Whether laws are on trial.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Runs up to `budget` samples, those of the law at `first` before the others'; returns how many.
    pub fn advance(
        &mut self,
        known: &KnownLaws,
        problem: &Problem,
        window: &Window,
        first: Option<usize>,
        budget: usize,
    ) -> usize {
        if !self.running {
            return 0;
        }
        if self.start < window.oldest() || window.ready() > self.start + LONGEST {
            self.running = false;
            return 0;
        }
        let places = first.into_iter().chain((0..known.laws().len()).filter(|place| Some(*place) != first));
        let mut left = budget;
        for place in places {
            let law = &known.laws()[place];
            problem.scatter(&law.coefficients, &mut self.all);
            left -= self.trials[place].advance(problem, &problem.motion(&self.terms, &self.all), window, left);
        }
        budget - left
    }

    /// Whether the law at `place` has seen the whole record.
    pub fn has_caught_up(&self, place: usize, window: &Window) -> bool {
        let trial = &self.trials[place];
        self.running && !trial.out && trial.next == window.ready()
    }

    /// Weighs the laws once all of them have seen the same record, if it is due.
    pub fn weigh(&mut self, known: &mut KnownLaws, window: &Window) -> Option<Verdict> {
        let (end, count) = (window.ready(), known.laws().len());
        let behind = self.trials[..count].iter().any(|trial| !trial.out && trial.next < end);
        if !self.running || behind || end < self.next_weighing {
            return None;
        }
        self.next_weighing = self.start + (GROWTH * (end - self.start) as f64) as u64 + 1;
        for (place, trial) in self.trials[..count].iter_mut().enumerate().filter(|(_, trial)| !trial.out) {
            trial.weigh(place, known, self.left == Some(place));
        }
        self.verdict(count)
    }

    /// On the law that stands out.
    fn verdict(&self, count: usize) -> Option<Verdict> {
        let (place, _) = self.best(count, None)?;
        self.verdict_on(place, count)
    }

    fn verdict_on(&self, place: usize, count: usize) -> Option<Verdict> {
        let own = self.trials.get(place).filter(|trial| !trial.out)?;
        let rival = self.best(count, Some(place)).map(|(rival, best)| (rival, (own.evidence - best) / own.scale));
        Some(Verdict { place, against_any: own.against_any, rival })
    }

    /// The place and the evidence of the likeliest law but one.
    fn best(&self, count: usize, but: Option<usize>) -> Option<(usize, f64)> {
        let left = self.trials[..count].iter().enumerate();
        let left = left.filter(|(place, trial)| !trial.out && Some(*place) != but);
        left.map(|(place, trial)| (place, trial.evidence)).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Gives away the run of the law at `place` for another one's room; it begins anew.
    pub fn hand_over(&mut self, place: usize, window: &Window, live: &mut Pass) {
        std::mem::swap(&mut self.trials[place].pass, live);
        self.trials[place].begin(window, self.start);
    }

    /// What the record says on the law at `place`, as last weighed; nothing where it rules it out.
    pub fn on(&self, place: usize, known: &KnownLaws) -> Option<Verdict> {
        self.verdict_on(place, known.laws().len())
    }

    /// The law at `place` is none that the record may have.
    pub fn rule_out(&mut self, place: usize) {
        self.trials[place].out = true;
    }

    /// The noise levels under which the law at `place` is on trial.
    pub fn noise(&self, place: usize) -> Noise {
        self.trials[place].noise
    }
}

impl Trial {
    fn begin(&mut self, window: &Window, start: u64) {
        self.pass.begin(window.initial_state(start, &self.noise));
        self.next = start + 1;
        self.out = false;
        (self.evidence, self.against_any) = (0.0, 0.0);
    }

    /// Runs up to `budget` samples; returns how many.
    fn advance(&mut self, problem: &Problem, motion: &Motion, window: &Window, budget: usize) -> usize {
        let from = self.next;
        let stop = window.ready().min(from + budget as u64);
        while self.next < stop && !self.out {
            self.pass.step(motion, &problem.free_terms, &self.noise, &window.observation(self.next));
            self.out = !self.pass.filter.state().is_finite();
            self.next += 1;
        }
        (self.next - from) as usize
    }

    /// Error beyond what is stated, and that no other coefficients explain, makes all evidence smaller.
    fn weigh(&mut self, place: usize, known: &mut KnownLaws, left: bool) {
        let weighed = match left {
            true => known.weigh_left(place, &self.pass.information),
            false => known.weigh(place, None, &self.pass.information),
        };
        let track = &self.pass.track;
        let unexplained = (track.squares[0] + track.squares[1] - 2.0 * weighed.any.max(0.0)) / track.total().max(1.0);
        self.scale = unexplained.max(1.0);
        self.evidence = track.stated_log_likelihood() + weighed.known;
        self.against_any = (weighed.known - weighed.any) / self.scale;
        self.out = self.against_any < -HOPELESS || self.against_any.is_nan();
    }
}
