//! The free prediction of eq. (4): the law integrated on its own, and how far the record deviates from it.

use super::law_in_use::LawInUse;
use crate::estimation::Observation;
use crate::identify::deviation::Deviation;
use crate::identify::problem::Problem;
use crate::identify::sample::Sample;
use crate::identify::settings::Settings;
use crate::law::State;
use serde::{Deserialize, Serialize};

/// A deviation this many times the usual one is out of the ordinary: it decides nothing unless the user gives a
/// threshold.
const UNUSUAL: f64 = 4.0;

/// Share of the latest interval in the usual deviation.
const SHARE: f64 = 0.2;

/// A prediction that begins anew at each interval of the deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    state: State,
    since: f64,
    deviation: Deviation,
    usual: f64,
    /// As of the last sample under a law: (q, q̇), …
    pub shown: State,
    /// … the mean deviation, …
    pub shown_deviation: f64,
    /// … and the one that is out of the ordinary.
    pub shown_threshold: f64,
}

impl Prediction {
    /// Nothing predicted yet.
    pub fn new(settings: &Settings) -> Prediction {
        Prediction {
            state: State::default(),
            since: 0.0,
            deviation: Deviation::new(settings.deviation_interval, settings.sample_time),
            usual: 0.0,
            shown: State::default(),
            shown_deviation: 0.0,
            shown_threshold: 0.0,
        }
    }

    /// Goes on from this state at time t.
    pub fn restart(&mut self, state: State, t: f64) {
        (self.state, self.since) = (state, t);
    }

    /// Forgets how far it deviated.
    pub fn clear(&mut self) {
        self.deviation.clear();
    }

    /// Forgets how far predictions usually deviate.
    pub fn forget_usual(&mut self) {
        self.usual = 0.0;
    }

    /// Whether it deviates by more than the user's threshold at time t, where there is one.
    pub fn deviates(&self, settings: &Settings, t: f64) -> bool {
        let given = settings.deviation_threshold;
        given > 0.0 && self.deviation.is_full(t) && self.shown_deviation > given
    }

    /// Predicts a sample under the law in use and takes its deviation.
    pub fn step(
        &mut self,
        problem: &Problem,
        settings: &Settings,
        law: &LawInUse,
        sample: &Sample,
        observation: &Observation,
    ) {
        let motion = problem.motion(&law.terms, &law.all);
        let [from, _, to] = observation.drive.part(0, 1);
        self.state = motion.step_linear(self.state, observation.dt, from, to);
        if !self.state.is_finite() {
            self.restart(law.run.filter.state(), sample.t);
        }
        let weight = |measured: bool, weight: f64| if measured { weight } else { 0.0 };
        let difference = weight(problem.channels.q, settings.weight_q) * (self.state.q - sample.q).abs()
            + weight(problem.channels.qd, settings.weight_qd) * (self.state.qd - sample.qd).abs();
        if difference.is_finite() {
            self.deviation.add(sample.t, difference);
        }
        self.shown = self.state;
        self.shown_deviation = self.deviation.mean();
        self.shown_threshold = self.threshold(settings, law);
        if sample.t - self.since > settings.deviation_interval {
            self.restart(law.run.filter.state(), sample.t);
            self.usual += SHARE * (self.shown_deviation - self.usual);
        }
    }

    /// The given threshold, or [`UNUSUAL`] times the usual deviation under this law and what its noise alone would
    /// give.
    fn threshold(&self, settings: &Settings, law: &LawInUse) -> f64 {
        if settings.deviation_threshold > 0.0 {
            return settings.deviation_threshold;
        }
        let [q, qd] = law.noise.sensor.map(f64::sqrt);
        UNUSUAL * self.usual.max(settings.weight_q * q + settings.weight_qd * qd)
    }
}
