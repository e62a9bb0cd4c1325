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
    AddedEffect, EffectPosterior, Filter, FreeTerms, Lacked, Lag, LagTest, LawWithEffect, Missing, Noise, Observation,
    Pass, ScoreTest, TWENTY_TO_ONE,
};
use crate::identify::library::KnownLaw;
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use crate::identify::window::Window;
use crate::law::{Model, Motion, Term};
use crate::limits::SETTLED_ERROR;

/// A run that has caught up is closed only when the record has grown by this fraction since the last one: what it adds
/// to the information is then about as small …
pub const GROWTH: f64 = 0.02;

/// … and by this many samples.
const FRESH: u64 = 8;

/// A law is tried with what it lacks, and one that does not explain its record with all error in the sensors, when the
/// record has grown by this factor, twice in every doubling: most runs are spared the work.
const LOOK_AGAIN: f64 = 1.4;

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

    fn end_score_test(&mut self, problem: &Problem) {
        let settled = self.settled();
        // where the error lasts no candidate's evidence is in nats, and what was known before stands
        if settled && self.fit.overdispersion < UNEXPLAINED {
            self.weigh_effects();
        }
        self.ask_for_effect(problem, settled);
        if self.score_test.in_the_sensors.running {
            self.score_test.next_look = looks_again(self.length(self.run.next));
        }
        if settled && (self.score_test.in_the_sensors.running || self.fit.explains) {
            self.tell_lag();
        }
        self.score_test.own.clear();
    }

    /// Which effect the law lacks most, by the run that has ended; one that it names is to be tried, in the place of
    /// that which the law may have. A run that has not settled does not follow the motion yet.
    fn ask_for_effect(&mut self, problem: &Problem, settled: bool) {
        let (length, has_effect) = (self.length(self.run.next), self.effect() != 0.0);
        let lacked = self.lacked_beside_own().filter(|_| settled);
        self.score_test.likeliest = lacked;
        if !settled || length < self.score_test.next_try {
            return;
        }
        let named = |lacked: &Lacked| lacked.missing.is_named();
        let asked = match has_effect {
            true => self.likelier_effect(),
            false => lacked.filter(named).or_else(|| self.lacked_with_other_terms(problem).filter(named)),
        };
        if asked.is_some() {
            self.score_test.next_try = looks_again(length);
            self.untried = asked;
        }
    }

    /// The effect of most evidence beside the terms that the law has; `untried_step` becomes by how much its
    /// coefficients are others with it.
    fn lacked_beside_own(&mut self) -> Option<Lacked> {
        let has_effect = self.effect() != 0.0;
        let Segment { score_test: MissingEffects { candidates, own, .. }, run, active, fit, .. } = self;
        own.solve(&run.filter_run.information, active, has_effect.then_some(&run.effect));
        let lacked = candidates.likeliest(own, fit.overdispersion)?;
        candidates.moved(own, &lacked, &mut self.untried_step);
        Some(lacked)
    }

    /// That of a law which does not explain its record, and whose terms may be the wrong ones.
    fn lacked_with_other_terms(&mut self, problem: &Problem) -> Option<Lacked> {
        let terms_may_go = problem.maybe.contains(&true);
        let squares = self.own().iter().map(|value| value * value).sum();
        let Segment { score_test: MissingEffects { candidates, anew, .. }, run, fit, coefficients, all, .. } = self;
        let law = FreeTerms {
            information: &run.filter_run.information,
            coefficients,
            maybe: &problem.maybe,
            squares,
            inertia: (all[problem.inertia], problem.free_inertia()),
            largest: run.largest[0],
            measurements: run.filter_run.track.total(),
            overdispersion: fit.overdispersion,
        };
        let asked = terms_may_go && !fit.explains;
        asked.then(|| candidates.likeliest_anew(&law, anew, &mut self.untried_step)).flatten()
    }

    /// The one that is likelier than the law's own by twenty to one; `step` holds what it makes of the coefficients.
    fn likelier_effect(&mut self) -> Option<Lacked> {
        let likelier = self.score_test.posterior.likelier;
        let likelier = likelier.filter(|likelier| likelier.missing.evidence > TWENTY_TO_ONE);
        likelier.inspect(|_| self.untried_step.copy_from_slice(&self.step))
    }

    /// Whether the law has the right effect; `step` becomes what a likelier one makes of the coefficients.
    fn weigh_effects(&mut self) {
        let squares = self.own().iter().map(|value| value * value).sum();
        let (term, coefficient) = (self.terms[self.terms.len() - 1], self.effect());
        let Segment { score_test, run, active, fit, known, step, .. } = self;
        let effect = (coefficient != 0.0).then_some((&run.effect, term, coefficient));
        let law = LawWithEffect { effect, active, overdispersion: fit.overdispersion, squares, bound: SETTLED_ERROR };
        let MissingEffects { candidates, laws, posterior, .. } = score_test;
        *posterior = candidates.weigh(&law, laws, &[&run.filter_run.information, &known.information], step);
    }

    /// Log-likelihood that the likeliest of the effects that the law lacks gains, named or not, nats.
    pub fn effect_evidence(&self) -> f64 {
        self.score_test.likeliest.map_or(0.0, |lacked| lacked.missing.evidence)
    }

    /// When F acted, by the run that explains the record better with a lag, against the better one without; and by the
    /// same run were the law to have every term that it may have.
    fn tell_lag(&mut self) {
        let Segment { score_test, timing, fit, run, active, .. } = self;
        let MissingEffects { own, in_the_sensors, .. } = score_test;
        let track = &run.filter_run.track;
        run.lag.tell(own, track, fit.overdispersion, &mut timing.told);
        let mut better = (&run.lag, &run.filter_run, fit.overdispersion);
        let InTheSensors { lag, filter_run, told, running, .. } = in_the_sensors;
        if *running && filter_run.track.count == track.count {
            own.solve(&filter_run.information, active, None);
            lag.tell(own, &filter_run.track, 1.0, told);
            if told.with() > timing.told.with() {
                let evidence = told.with() - told.without.max(timing.told.without);
                timing.told.copy_from(told);
                timing.told.lag.evidence = evidence;
                better = (lag, filter_run, 1.0);
            }
        }
        let (lag, filter_run, overdispersion) = better;
        own.solve(&filter_run.information, &[true; Model::MAX_TERMS][..active.len()], None);
        lag.tell(own, &filter_run.track, overdispersion, &mut timing.whole);
    }

    /// What run and prior say together about the coefficients.
    fn gather_information(&mut self, problem: &Problem) {
        self.information.clone_from_slices(&self.run.filter_run.information);
        if self.effect() != 0.0 {
            self.run.effect.leave_open(self.effect(), &mut self.information);
        }
        self.information.merge(&self.known.information);
        if let (Some(index), Some(prior)) = (problem.free_inertia(), self.known.inertia) {
            let (information, score) = prior.about(self.coefficients[index]);
            self.information.matrix[index * problem.n() + index] += information;
            self.information.score[index] += score;
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

    /// What the model lacks is what its law has beside its terms; else what would explain most of what the law does not
    /// explain.
    fn say_effect(&mut self) {
        let found = match self.effect_gain() {
            Some(gain) => Missing::of(self.terms[self.terms.len() - 1], gain),
            None => self.score_test.likeliest.map(|lacked| lacked.missing).filter(|_| !self.fit.explains),
        };
        self.missing = found.filter(Missing::is_named);
    }

    /// Log-likelihood that the effect beside the law's own terms gains, nats; none where it has none.
    pub fn effect_gain(&self) -> Option<f64> {
        let variance = self.fit.overdispersion * self.run.effect.variance(&self.solution, &self.active);
        (self.effect() != 0.0).then_some(0.5 * self.effect() * self.effect() / variance)
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

/// Length of the record from which on a law is tried again.
fn looks_again(length: u64) -> u64 {
    (LOOK_AGAIN * length as f64) as u64
}
