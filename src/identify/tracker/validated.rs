//! What a segment makes known, once its law is worth showing.

use super::regime::Event;
use super::state::{Setup, Tracker};
use crate::estimation::UNLIKELY;
use crate::identify::problem::Problem;
use crate::identify::validation::{SURE, VALIDATED};

impl Tracker {
    /// Makes the segment's law known; it is validated where it states that it is known well enough, and stands.
    pub(super) fn publish(&mut self, setup: Setup) {
        let problem = setup.problem;
        let physical = self.is_physical(problem, self.segment.all[problem.inertia]);
        let validated = self.segment.is_validated() && physical;
        if self.regime.is_drifting() && !validated {
            return;
        }
        self.publish_coefficients(problem);
        let recognised = self.regime.recognition().is_some();
        // a law that fails the whiteness test, or that several laws share, has no honest std
        if !physical || !(validated || self.segment.is_beyond_doubt() || recognised) {
            self.published.forget_stds(problem);
            return;
        }
        self.publish_noise(problem);
        if validated {
            self.validate(setup);
            if self.segment.settled() && self.is_sure(problem) {
                self.call_valid();
            }
        }
    }

    /// Whether e of what is published is below the bound beyond chance, whatever terms may hide of when F acted. What
    /// chance has left a longer record takes away, and is waited for; an error that lasts it does not.
    fn is_sure(&self, problem: &Problem) -> bool {
        let bound = if self.segment.fit.overdispersion > 1.0 { VALIDATED } else { SURE };
        self.segment.doubt() < UNLIKELY && self.published.stated_error() + self.segment.untold_error(problem) < bound
    }

    /// What the segment says of each coefficient.
    pub(super) fn publish_coefficients(&mut self, problem: &Problem) {
        let Tracker { published, library, segment, belief, regime, .. } = self;
        let recognition = regime.recognition();
        published.set(problem, |free, _| {
            let (std, spread) = (segment.std(free), belief.spread[free]);
            if !segment.active[free] {
                return Some((0.0, library.recognition_std(recognition, free, 0.0, spread)));
            }
            let value = segment.coefficients[free];
            (std < spread).then(|| (value, std.hypot(library.recognition_std(recognition, free, value, spread))))
        });
    }

    /// The sensors' noise as the law's record tells it, or as it has been lately where it has changed.
    fn publish_noise(&mut self, problem: &Problem) {
        let law = &self.monitor.law;
        let std = |channel: usize| {
            let lately = law.adaptive.lately(channel).filter(|_| law.running);
            let louder = lately.map(|lately| lately * law.noise.sensor[channel]);
            louder.unwrap_or(self.segment.noise.sensor[channel]).sqrt()
        };
        let measured = problem.channels.of_motion();
        self.published.noise = [0, 1].map(|channel| measured[channel].then(|| std(channel)));
        self.published.noise_by_law = true;
    }

    fn validate(&mut self, setup: Setup) {
        if self.segment.fit.explains {
            self.augmented_drift.end_trial(self.record_length());
        }
        let number = match self.regime.law() {
            Some(number) => number,
            None => self.number_law(setup.settings),
        };
        self.learn_from_validation();
        self.enter(Event::LawValidated(number));
    }

    /// How long a law takes to be validated, and whether it explains its record then.
    fn learn_from_validation(&mut self) {
        let length = self.record_length();
        let first = !self.regime.is_valid();
        // a law that explained its record and does not any more says nothing against it: the record has changed
        if self.youth() < 1.0 && (self.segment.fit.explains || first) {
            self.history.explained = self.segment.fit.explains;
        }
        if first {
            self.history.convergence_length = length.max(self.history.convergence_length / 2);
        }
    }

    /// Whether the inertia, where it is sought, is one that a motion can have.
    pub(super) fn is_physical(&self, problem: &Problem, inertia: f64) -> bool {
        problem.free_inertia().is_none() || self.weak_form.resolves(inertia)
    }
}
