//! The law in use, run along with the stream: its innovations, and how uncertain they are by what is not known of the
//! law.

use super::adaptive_noise::AdaptiveNoise;
use crate::estimation::{
    AddedEffect, Information, Innovation, Lacked, LagTest, LawWithEffect, Noise, Observation, OwnTerms, Pass,
    ScoreTest, ToldLag, WithAndWithout,
};
use crate::evidence::Law;
use crate::identify::library::{KnownLaw, Trials};
use crate::identify::problem::Problem;
use crate::identify::segment::{MotionScales, Segment};
use crate::identify::window::Window;
use crate::law::Term;
use crate::limits::SETTLED_ERROR;
use serde::{Deserialize, Serialize};

/// The law's own covariance counts this many times where it leaves the state open, as long as it is that of a
/// linearisation …
const CAUTION: f64 = 10.0;

/// … which it is over a record of so many samples. It falls with the fourth power of the length then: the hypotheses
/// know it too.
const LINEAR: f64 = 4000.0;

/// An error of the law acts one way for this many samples at most.
pub const LONGEST_ERROR: f64 = 1000.0;

/// The law in use, run along with the stream.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawInUse {
    /// Its filter run, at the head of the stream.
    pub run: Pass,
    /// When F acted, by that run.
    lag: LagTest,
    /// Effects that it lacks, by that run.
    effects: ScoreTest,
    /// What it says of the law's own terms, as last asked, with the effect that it has and without.
    own: OwnTerms,
    laws: WithAndWithout,
    /// That effect, by that run.
    beside: AddedEffect,
    /// What is told of the own terms and of that.
    whole: Information,
    /// What its run said of the coefficients when the last outage ended.
    kept: Information,
    /// When F acted by all of its record, as last told.
    pub told: ToldLag,
    /// Its terms: the model's and, last, an effect that the model lacks.
    pub terms: Vec<Term>,
    /// All coefficients, that of the effect which the model lacks the last.
    pub all: Vec<f64>,
    /// Which free terms it has.
    pub active: Vec<bool>,
    /// Noise levels under it, as its record knows them.
    pub noise: Noise,
    /// How loud the sensors are now.
    pub adaptive: AdaptiveNoise,
    /// Of its record, as in [`crate::identify::segment::Segment::fit`].
    pub overdispersion: f64,
    /// Number of the sample at which that was taken from the record.
    dispersed_at: u64,
    /// How many times the covariance counts.
    caution: f64,
    /// Whether it explained its record but for the sensors' noise.
    pub explains: bool,
    /// Whether it was validated, or had stood its stability check and explained its record.
    pub proven: bool,
    /// Covariance of the free coefficients, n × n.
    covariance: Vec<f64>,
    /// For how long an error of the law acts one way, s.
    lasting: f64,
    /// ∂q̈/∂θ by free coefficient, the inertia's as a mean over that time.
    slopes: Vec<f64>,
    /// Number of the sample that comes next.
    pub next: u64,
    /// Whether there is one.
    pub running: bool,
}

impl LawInUse {
    /// Room for the problem.
    pub fn new(problem: &Problem) -> LawInUse {
        let n = problem.n();
        LawInUse {
            run: Pass::new(n).gated(),
            lag: LagTest::new(n),
            effects: ScoreTest::new(&problem.terms, n),
            own: OwnTerms::none(n),
            laws: WithAndWithout::none(n),
            beside: AddedEffect::new(n),
            whole: Information::none(n + 1),
            kept: Information::none(n),
            told: ToldLag::none(n),
            terms: problem.terms_and_effect(),
            all: problem.known.clone(),
            active: vec![true; n],
            noise: Noise { sensor: [1.0; 2], process: 1.0 },
            adaptive: AdaptiveNoise::USUAL,
            overdispersion: 1.0,
            dispersed_at: 0,
            caution: CAUTION,
            explains: false,
            proven: false,
            covariance: vec![0.0; n * n],
            lasting: 0.0,
            slopes: vec![0.0; n],
            next: 0,
            running: false,
        }
    }

    /// Takes a sample; returns what it says of a switch, readings that do not count included. `shifts` is what F was a
    /// sample before and will be a sample later, less what it is.
    pub fn step(&mut self, problem: &Problem, observation: &Observation, shifts: [f64; 2]) -> [Option<Innovation>; 2] {
        let motion = problem.motion(&self.terms, &self.all);
        let noise = self.noise_now();
        let innovations = self.run.step(&motion, &problem.free_terms, &noise, observation);
        let beside = match self.effect() {
            0.0 => [0.0; 2],
            _ => self.beside.step(self.terms[self.terms.len() - 1], &motion, &self.run, observation, &innovations),
        };
        self.lag.step(&motion, &self.run, shifts, &innovations, beside);
        self.effects.step(&motion, &self.run, observation, &innovations, beside);
        self.adaptive.add(&innovations, &observation.measured);
        self.follow_slopes(observation.dt, problem.free_inertia());
        let [q, qd] = innovations;
        let [q_aside, qd_aside] = self.run.set_aside;
        [q.or(q_aside), qd.or(qd_aside)]
    }

    /// An outage ends: what comes may have to be forgotten.
    pub fn keep(&mut self) {
        self.kept.clone_from_slices(&self.run.information);
    }

    /// What has come since the last outage was misread.
    pub fn forget_since_outage(&mut self) {
        self.run.information.clone_from_slices(&self.kept);
        self.run.sensitivity.fill([0.0; 2]);
        self.lag.begin();
        self.effects.end();
    }

    /// The sensors' noise as it is now, and what the law leaves open.
    pub fn noise_now(&self) -> Noise {
        let sensor = [0, 1].map(|channel| self.noise.sensor[channel] * self.adaptive.factor(channel));
        Noise { process: self.noise.process + self.uncertainty(), sensor }
    }

    /// Slopes after an interval. The inertia's goes with the acceleration, which a rough excitation turns around faster
    /// than the motion follows: such errors do not last.
    fn follow_slopes(&mut self, dt: f64, inertia: Option<usize>) {
        let share = dt / (self.lasting + dt);
        for (index, (slope, input)) in self.slopes.iter_mut().zip(&self.run.map.input).enumerate() {
            let share = if inertia == Some(index) { share } else { 1.0 };
            *slope += share * (input[1] / dt - *slope);
        }
    }

    /// Intensity of the acceleration that the law's own uncertainty leaves open, (m/s²)² s: where the motion leaves
    /// what its record has seen, an uncertain law must not bind the state.
    fn uncertainty(&self) -> f64 {
        let slopes = &self.slopes;
        let rows = self.covariance.chunks_exact(slopes.len()).zip(slopes);
        let variance: f64 = rows
            .map(|(row, slope)| slope * row.iter().zip(slopes).map(|(entry, other)| entry * other).sum::<f64>())
            .sum();
        self.caution * variance.max(0.0) * self.lasting
    }

    /// The coefficient of the effect that the model lacks; 0 where it does not have it.
    pub fn effect(&self) -> f64 {
        self.all[self.all.len() - 1]
    }

    /// What a coefficient of 1 of its effect has done to (q, q̇) over the last interval; nothing where it has none.
    pub fn effect_input(&self) -> [f64; 2] {
        if self.effect() == 0.0 { [0.0; 2] } else { self.beside.input }
    }

    /// It as hypotheses of a switch begin from it, with `every` term that it may have or its own alone.
    pub fn as_law<'a>(&'a mut self, every: Option<&'a [bool]>, explains: bool) -> Law<'a> {
        let value = self.effect();
        let LawInUse { run, beside, whole, active: own, .. } = self;
        // what went beside the run of an effect that was dropped at its end is nobody's
        let effect = if value == 0.0 { [0.0; 2] } else { beside.sensitivity() };
        match value {
            0.0 => run.information.widen(whole),
            _ => beside.widen(value, &run.information, whole),
        }
        let open = every.unwrap_or(own);
        Law { information: whole, sensitivity: &run.sensitivity, effect, open, own, explains }
    }

    /// What was told of when F acted was of another time.
    pub fn forget_lag(&mut self) {
        self.lag.begin();
        self.effects.end();
    }

    /// Tells when F acted, by all of its record up to now.
    pub fn tell_lag(&mut self) {
        let has_effect = self.effect() != 0.0;
        let LawInUse { run, lag, own, told, active, overdispersion, beside, .. } = self;
        own.solve(&run.information, active, has_effect.then_some(beside));
        lag.tell(own, &run.track, *overdispersion, told);
        own.clear();
    }

    /// The effect that it lacks most by all of its record up to now, of more evidence than that; `step` becomes by how
    /// much the free coefficients, n, are others with it. Of a law that has one, the likeliest in its place, of the
    /// evidence that it or another beside the law's own has.
    pub fn likeliest_effect(&mut self, evidence: f64, step: &mut [f64]) -> Option<Lacked> {
        let (term, coefficient) = (self.terms[self.terms.len() - 1], self.effect());
        let squares = self.all.iter().take(self.all.len() - 1).map(|value| value * value).sum();
        let LawInUse { run, effects, own, laws, beside, active, overdispersion, .. } = self;
        let overdispersion = *overdispersion;
        let is_enough = |lacked: &Lacked| lacked.missing.evidence > evidence;
        if coefficient != 0.0 {
            let effect = Some((&*beside, term, coefficient));
            let law = LawWithEffect { effect, active, overdispersion, squares, bound: SETTLED_ERROR };
            let told = effects.weigh(&law, laws, &[&run.information], step);
            let mut likelier = told.likelier?;
            likelier.missing.evidence = likelier.missing.evidence.max(told.beside);
            return Some(likelier).filter(is_enough);
        }
        own.solve(&run.information, active, None);
        let lacked = effects.likeliest(own, overdispersion).filter(is_enough);
        lacked.iter().for_each(|lacked| effects.moved(own, lacked, step));
        own.clear();
        lacked
    }

    /// F acts so many samples later than was assumed, each of which makes that of the free coefficients.
    pub fn begin_later(&mut self, problem: &Problem, slope: &[f64], samples: f64) {
        for (index, slope) in problem.free.iter().zip(slope) {
            self.all[*index] += samples * slope;
        }
    }

    /// Takes over the segment's estimate and the run that led to it.
    pub fn adopt(&mut self, segment: &mut Segment, window: &Window) {
        segment.hand_over(window, &mut self.run, &mut self.lag, &mut self.effects, &mut self.beside);
        self.terms.copy_from_slice(&segment.terms);
        self.all.copy_from_slice(&segment.all);
        self.active.copy_from_slice(&segment.active);
        self.adaptive.refer(&self.noise, &segment.noise);
        self.noise = segment.noise;
        self.follow_overdispersion(segment, window.ready());
        self.caution = caution(segment.length(window.ready()));
        self.explains = !segment.fit.process_matters;
        self.covariance.copy_from_slice(&segment.solution.covariance);
        self.follow_scales(&segment.scales, window);
        if !self.running {
            self.adaptive = AdaptiveNoise::USUAL;
        } else if !self.proven {
            self.adaptive.forget_lately();
        }
        self.next = window.ready();
        self.running = true;
    }

    /// Where the motion has no scale yet, an error acts for the longest time.
    fn follow_scales(&mut self, scales: &MotionScales, window: &Window) {
        let [before, last] = [window.ready() - 2, window.ready() - 1].map(|number| window.sample(number).t);
        self.lasting = scales.natural_time().min(LONGEST_ERROR * (last - before));
    }

    /// Error that has come since the record was half as long may be a switch's: it does not count until it has lasted.
    fn follow_overdispersion(&mut self, segment: &Segment, now: u64) {
        let then = segment.length(self.dispersed_at);
        let lasts = then == 0 || segment.length(now) >= 2 * then;
        if !self.running || lasts || segment.fit.overdispersion <= self.overdispersion {
            (self.overdispersion, self.dispersed_at) = (segment.fit.overdispersion, now);
        }
    }

    /// Takes over a known law and the run of its trial.
    pub fn adopt_known(
        &mut self,
        problem: &Problem,
        law: &KnownLaw,
        trials: &mut Trials,
        place: usize,
        scales: &MotionScales,
        window: &Window,
    ) {
        self.noise = trials.noise(place);
        self.adaptive = AdaptiveNoise::USUAL;
        self.caution = caution(law.samples);
        self.follow_scales(scales, window);
        (self.overdispersion, self.dispersed_at) = (1.0, window.ready());
        (self.explains, self.proven) = (true, true);
        trials.hand_over(place, window, &mut self.run);
        self.lag.begin();
        self.effects.end();
        self.run.information.merge(&law.information);
        self.all.copy_from_slice(&problem.known);
        problem.scatter(&law.coefficients, &mut self.all);
        let place = self.all.len() - 1;
        self.all[place] = trials.effect.map_or(0.0, |effect| effect.coefficient);
        self.beside.begin(self.run.filter.state());
        if let Some(effect) = trials.effect {
            self.terms[place] = effect.term;
            self.beside.suppose(&effect);
        }
        self.active.copy_from_slice(&law.active);
        self.covariance.copy_from_slice(&law.covariance);
        self.next = window.ready();
        self.running = true;
    }
}

/// How many times the covariance of a law counts that is known from so many samples.
fn caution(samples: u64) -> f64 {
    CAUTION * (LINEAR / samples.max(1) as f64).min(1.0).powi(4)
}
