//! Challengers of the law that a stage stands on: from the weak rows of its record, and with its error in the sensors.

use super::{INERTIA_SPREAD, PRIOR_WIDTH, Phase, Tracker};
use crate::evidence::Noise;
use crate::identify::identifier::{Output, Status};
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use crate::identify::stage::Prior;

/// Passes after which a challenger that has not settled gives up …
const PATIENCE: u32 = 40;

/// … and one that explains its record where the stage does not.
const LONG_PATIENCE: u32 = 400;

/// Samples from which on the kind of a record's error can be told.
const ENOUGH: u64 = 500;

/// A first law is tried when the weak start predicts its force this well.
const START_ERROR: f64 = 0.3;

/// The same where no displacement is measured: each weak row then has an offset of its own, which the filter does not need.
const START_ERROR_WITHOUT_Q: f64 = 1.0;

/// Samples after which an unvouched law is contested by the latest record alone, and the unit of how long that may take.
const FRESH_START: u64 = 12_000;

/// Overdispersion of a record that is far from explained.
const FAR: f64 = 10.0;

/// What the latest record must explain better than the whole one to replace it, nats per measurement: the noise may have changed …
const CLEARLY: f64 = 0.1;

/// … or, where it explains itself down to the sensors' noise and the whole one does not, in 1 ÷ √ of the number of measurements: the mean
/// of the right law's likelihood scatters by 0.7 of that.
const SURELY: f64 = 2.0;

impl Tracker {
    /// The record from sample `start` on is another law's: the weak rows begin with it, and no challenger is under way.
    pub(super) fn contest_from(&mut self, start: u64) {
        self.start.begin(start);
        (self.challenging, self.challenged_from, self.afresh) = (false, start, 0);
        (self.next_guess, self.next_noise_challenge) = (0, 0);
    }

    /// A record that has grown long without a law to vouch for may hold a switch that nobody saw: the weak rows begin anew, so that
    /// the next challenger knows the latest record alone. How long the law needs nobody knows, nor how long it lasts: the lengths follow the
    /// universal sequence (Luby, Sinclair and Zuckerman, *Information Processing Letters* 47 (1993), 173).
    pub(super) fn begin_afresh(&mut self) {
        let (end, since) = (self.window.end(), self.challenged_from);
        let due = match self.is_mixed() {
            true => since.max(self.doubted_from) + self.acquaintance,
            false => since + FRESH_START * universal(self.afresh + 1),
        };
        if self.challenging || self.phase == Phase::Gathering || end < due {
            return;
        }
        self.start.begin(end);
        (self.challenged_from, self.next_guess, self.afresh) = (end, 0, self.afresh + 1);
    }

    /// Whether the stage's record seems to hold several laws: a law before explained its own down to the sensors' noise, this one does not.
    /// A record that stays so for long and is not far from explained lacks an effect instead.
    pub(super) fn is_mixed(&self) -> bool {
        let short = self.stage.length(self.window.ready()) < FRESH_START;
        self.is_unexplained() && (short || self.stage.overdispersion > FAR)
    }

    /// Whether the stage's law does not explain its record, where one before it did.
    pub(super) fn is_unexplained(&self) -> bool {
        self.explained && self.recognised.is_none() && !self.stage.explains
    }

    /// A law that was vouched for does not explain its record any more, and no switch does: it is contested again.
    pub(super) fn doubt_law(&mut self, output: &mut Output) {
        (self.doubted_from, self.next_guess) = (self.window.end(), 0);
        (output.valid, output.identified_time) = (false, None);
        (output.law_number, output.status) = (None, Status::ReIdentifying);
    }

    /// Begins a stage, or a challenger of the one there is, from what the weak rows of its record say.
    pub(super) fn challenge(&mut self, problem: &Problem, settings: &Settings) {
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
            Phase::Gathering => self.first_noise(settings),
            Phase::Refining if self.noise_weight > 0.0 => self.live.noise.sensor,
            Phase::Refining => self.stage.noise.sensor,
        };
        let Some(guess) = self.start.guess(problem, sensor) else { return };
        let inertia =
            problem.free_inertia().map_or(problem.known[problem.inertia], |index| guess.fit.coefficients[index]);
        let allowed = if problem.channels.q { START_ERROR } else { START_ERROR_WITHOUT_Q };
        let turned = self.noise_weight > 0.0 && inertia * self.live.all[problem.inertia] < 0.0;
        if guess.relative_error > allowed || !(inertia.is_finite() && inertia != 0.0) || turned {
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
            scales: &self.scales,
        };
        challenger.begin(problem, window, since, &fit.coefficients, prior, noise);
        self.challenging = self.phase == Phase::Refining;
        self.phase = Phase::Refining;
    }

    /// A fit with much process noise may be a maximum of the likelihood without being the largest: the other kind, all error in
    /// the sensors, is tried from the same coefficients each time the record has doubled.
    pub(super) fn challenge_noise(&mut self, problem: &Problem, settings: &Settings) {
        let end = self.window.ready();
        let due = end >= self.next_noise_challenge && self.phase == Phase::Refining && !self.challenging;
        let doubtful = self.stage.process_matters || self.is_mixed();
        if !due || !doubtful || !self.stage.settled() || self.stage.length(end) < ENOUGH {
            return;
        }
        self.next_noise_challenge = end + self.stage.length(end);
        let sensor = self.first_noise(settings);
        let noise = Noise { sensor, process: 1e-6 * self.stage.noise.process };
        self.set_spread(problem);
        self.spread.iter_mut().for_each(|spread| *spread *= PRIOR_WIDTH);
        let prior = Prior {
            centre: &self.stage.coefficients,
            std: &self.spread,
            log_inertia: INERTIA_SPREAD,
            structure: (self.noise_weight > 0.0).then_some(self.live.active.as_slice()),
            noise_weight: 0.0,
            scales: &self.scales,
        };
        self.challenger.begin(problem, &self.window, self.stage.start, &self.stage.coefficients, prior, noise);
        self.challenging = true;
    }

    /// Refines the challenger; it takes the stage's place when it explains the record better, or is vouched for first.
    pub(super) fn refine_challenger(&mut self, problem: &Problem, settings: &Settings, budget: usize, valid: bool) {
        if !self.challenging || !self.challenger.refine(problem, settings, &self.window, budget) {
            return;
        }
        let promising = !valid && self.explains_what_the_stage_does_not();
        if self.challenger.is_lost() {
            self.challenging = false;
        } else if self.challenger.settled() {
            let agrees = self.challenger.agrees_with(&self.stage);
            if agrees {
                self.next_guess = self.window.end() + self.stage.length(self.window.end());
            }
            let better = self.challenger.likelihood > self.stage.likelihood + self.margin();
            // one that takes the place of a law which explains its record would begin the same law's trial anew
            let wins = better && !(agrees && self.stage.explains) || promising && self.challenger.is_vouched();
            if wins {
                std::mem::swap(&mut self.challenger, &mut self.stage);
            }
            self.challenging = promising && !wins;
        } else if self.challenger.passes > PATIENCE {
            self.challenging = promising && self.challenger.passes < LONG_PATIENCE;
        }
        self.challenger.begin_pass(problem, &self.window);
    }

    /// A first guess from which no fit can be begun is forgotten: the weak rows, more of them by now, are asked for another.
    pub(super) fn give_up_guess(&mut self) -> bool {
        let lost = self.stage.is_lost() && !self.live.running;
        if lost {
            (self.phase, self.challenging) = (Phase::Gathering, false);
        }
        lost
    }

    /// Whether the challenger explains a later record down to the sensors' noise, and the stage not its own.
    fn explains_what_the_stage_does_not(&self) -> bool {
        self.challenger.start > self.stage.start && self.challenger.explains && !self.stage.explains
    }

    /// What the challenger must explain better than the stage, nats per measurement.
    fn margin(&self) -> f64 {
        let measurements = 2.0 * self.challenger.length(self.window.ready()) as f64;
        match self.challenger.start > self.stage.start {
            true if self.explains_what_the_stage_does_not() => (SURELY / measurements.sqrt()).min(CLEARLY),
            true => CLEARLY,
            false => 3.0 / measurements,
        }
    }

    /// Sensor variances before any law: as set, or from differences.
    pub(super) fn first_noise(&self, settings: &Settings) -> [f64; 2] {
        let found = self.roughness.variance().unwrap_or([0.0; 2]);
        let given = [settings.noise_q, settings.noise_qd];
        [0, 1].map(|index| match given[index] {
            0.0 => found[index] + f64::MIN_POSITIVE,
            std => std * std,
        })
    }
}

/// The universal sequence 1, 1, 2, 1, 1, 2, 4, … from its first on.
fn universal(number: u32) -> u64 {
    let number = u64::from(number.max(1));
    let full = (number + 1).next_power_of_two();
    if full == number + 1 { full / 2 } else { universal((number - (full / 2 - 1)) as u32) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::{Identifier, Sample};
    use crate::law::Model;
    use crate::simulate::{Builtin, record};

    #[test]
    fn the_universal_sequence_is_that_of_the_paper() {
        let first: Vec<u64> = (1..=15).map(universal).collect();
        assert_eq!(first, [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8]);
    }

    /// Stage and challenger begin from coefficients that no run survives.
    fn lead_astray(tracker: &mut Tracker, problem: &Problem) {
        let absurd: Vec<f64> = (0..problem.n()).map(|index| if index == 0 { 0.6 } else { -1e6 }).collect();
        let noise = Noise { sensor: [1e-4; 2], process: 1.0 };
        let (centre, std) = (vec![0.0; problem.n()], vec![1e9; problem.n()]);
        let Tracker { stage, challenger, window, scales, .. } = tracker;
        for stage in [stage, challenger] {
            let (structure, noise_weight) = (None, 0.0);
            let prior = Prior { centre: &centre, std: &std, log_inertia: 1.0, structure, noise_weight, scales };
            stage.begin(problem, window, 0, &absurd, prior, noise);
        }
        (tracker.phase, tracker.challenging) = (Phase::Refining, true);
    }

    #[test]
    fn a_first_law_from_which_no_fit_can_be_begun_is_forgotten() {
        let (model, settings) = (Model::cubic_library(), Settings::default());
        let blank = Identifier::new(&model, settings).unwrap();
        let (mut output, mut published) = (*blank.output(), blank.coefficients().to_vec());
        let problem = Problem::new(&model, &settings);
        let mut tracker = Tracker::new(&problem, &settings);
        let scenario = Builtin::VanDerPolWhite.random(32).with_noise(0.01);
        for (index, reading) in record(&scenario).unwrap().iter().take(6000).enumerate() {
            if index == 100 {
                lead_astray(&mut tracker, &problem);
            }
            let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
            tracker.step(&problem, &settings, sample, &mut published, &mut output);
        }
        assert!(output.valid, "{output:?}");
    }
}
