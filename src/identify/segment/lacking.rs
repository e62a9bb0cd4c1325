//! What a run says of the effect that the law lacks, and of when F acted.

use super::noise_covariance::UNEXPLAINED;
use super::state::{InTheSensors, MissingEffects, Segment};
use crate::estimation::{FreeTerms, Lacked, LawWithEffect, Missing, TWENTY_TO_ONE};
use crate::identify::problem::Problem;
use crate::law::Model;
use crate::limits::SETTLED_ERROR;

/// A law is tried with what it lacks, and one that does not explain its record with all error in the sensors, when the
/// record has grown by this factor, twice in every doubling: most runs are spared the work.
const LOOK_AGAIN: f64 = 1.4;

impl Segment {
    /// The run has ended: what it says of effects and of when F acted.
    pub(super) fn end_score_test(&mut self, problem: &Problem) {
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

    /// What the model lacks is what its law has beside its terms; else what would explain most of what the law does not
    /// explain.
    pub(super) fn say_effect(&mut self) {
        let found = match self.effect_gain() {
            Some(gain) => Missing::of(self.terms[self.terms.len() - 1], gain),
            None => self.score_test.likeliest.map(|lacked| lacked.missing).filter(|_| !self.fit.explains),
        };
        self.missing = found.filter(Missing::is_named);
    }

    /// Log-likelihood that the effect gains beside any one more term that the law may have, nats; none where it has no
    /// effect. What one of these does in this motion is nothing that the model lacks.
    pub fn effect_gain(&self) -> Option<f64> {
        let variance = self.fit.overdispersion * self.score_test.beside_another;
        (self.effect() != 0.0).then_some(0.5 * self.effect() * self.effect() / variance)
    }
}

/// Length of the record from which on a law is tried again.
fn looks_again(length: u64) -> u64 {
    (LOOK_AGAIN * length as f64) as u64
}
