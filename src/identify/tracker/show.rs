//! What the caller sees, derived from regime and published law; nothing that estimates reads it.

use super::state::{Setup, Tracker};
use crate::identify::problem::Problem;
use crate::identify::report::{ByQuantity, Coefficient, Output};
use crate::identify::segment::GROWTH;
use crate::identify::settings::Settings;
use crate::identify::validation::{DOUBTED, TRUSTED, VALIDATED};
use crate::law::Hold;

impl Tracker {
    /// Writes every output. Of a record whose law cannot state an honest std, the coefficients of the weak form stand
    /// in place of its own: they are not validated; nor is a law of which some std is not known, nor one that moves and
    /// does not state e below the bound.
    pub fn show(&mut self, problem: &Problem, settings: &Settings, shown: &mut [Coefficient], output: &mut Output) {
        self.foretell(problem);
        shown.copy_from_slice(&self.published.coefficients);
        *output = self.output(problem.timing.shown_hold());
        output.valid &= self.is_fresh();
        let unknown = shown.iter().any(|coefficient| coefficient.std.is_none());
        output.valid &= !unknown;
        if output.drifting {
            output.valid &= !self.augmented_drift.is_following() || self.published.stated_error() < VALIDATED;
            return;
        }
        output.valid &= self.segment.doubt() < DOUBTED;
        let stated = problem.free.iter().filter(|index| shown[**index].std.is_some()).count();
        // a law whose innovations are white is on its way to state an std of its own
        let consistent = self.is_refining() && self.segment.fit.explains;
        if stated == 0 && !consistent {
            let sensor = Setup { problem, settings }.first_noise(&self.difference_noise);
            output.explained = self.weak_form.publish(problem, sensor, shown);
        }
    }

    fn output(&self, hold: Hold) -> Output {
        let (published, prediction) = (&self.published, &self.monitor.prediction);
        Output {
            switch_count: published.switches.count,
            switch_time: published.switches.time,
            switch_time_std: published.switches.time_std,
            detection_time: published.switches.detection_time,
            identified_time: published.identified,
            law_number: self.regime.law().filter(|_| published.identified.is_some()),
            recognised: self.regime.recognition().is_some(),
            sensors: self.sensors(),
            named_time: published.switches.named_time,
            status: self.status(),
            valid: self.regime.is_valid() && published.identified.is_some(),
            drifting: self.regime.is_drifting(),
            deviation: prediction.shown_deviation,
            threshold: prediction.shown_threshold,
            prediction: ByQuantity { q: prediction.shown.q, qd: prediction.shown.qd, force: 0.0 },
            missing: published.missing,
            hold,
            explained: None,
            noise: ByQuantity { q: published.noise[0], qd: published.noise[1], force: None },
        }
    }

    /// Says of every coefficient how many more seconds of record it needs.
    fn foretell(&mut self, problem: &Problem) {
        let coefficients = &mut self.published.coefficients;
        coefficients.iter_mut().for_each(|coefficient| coefficient.needed = coefficient.std.map(|_| 0.0));
        if self.published.identified.is_none() {
            for (free, index) in problem.free.iter().enumerate() {
                self.published.coefficients[*index].needed = self.needed(free, self.published.coefficients[*index].std);
            }
        }
    }

    /// Further seconds of record that a free coefficient needs, as of the last run.
    fn needed(&self, free: usize, std: Option<f64>) -> Option<f64> {
        let factor = self.segment.growth_needed(free);
        if self.regime.is_drifting() || !self.is_refining() || !factor.is_finite() {
            return None;
        }
        let time = |number: u64| self.window.sample(number.clamp(self.window.oldest(), self.window.end() - 1)).t;
        let length = time(self.segment.closed_at()) - time(self.segment.start);
        let least = if std.is_some() { 0.0 } else { GROWTH };
        Some((factor - 1.0).max(least) * length)
    }

    /// What the record since the segment's start leaves open: combinations of terms while the weak rows of a first law
    /// are gathered, then single terms whose std is larger than anything plausible.
    pub fn unidentifiable(&self, problem: &Problem) -> Vec<String> {
        let name = |free: &usize| problem.free_terms[*free].name();
        let shown = self.segment.settled() && self.segment.stated_error() < TRUSTED;
        if self.is_refining() && shown {
            let is_open =
                |free: &usize| self.segment.active[*free] && self.segment.std(*free) >= self.belief.spread[*free];
            return (0..problem.n()).filter(is_open).map(|free| name(&free)).collect();
        }
        let directions = self.start.open_directions();
        directions.iter().map(|direction| problem.together(direction)).collect()
    }
}
