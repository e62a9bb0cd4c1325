//! Other fits of the record: from the weak rows of it or of its later part, and with all error in the sensors.

use super::new_record::PRIOR_WIDTH;
use super::state::{FRESH_START, Fitting, LASTS, NOTHING_KNOWN, Setup, Tracker};
use crate::estimation::{KnownEffect, Noise, TWENTY_TO_ONE};
use crate::identify::change::LONGEST_ERROR;
use crate::identify::problem::Problem;
use crate::identify::segment::{Guess, IN_THE_SENSORS, Prior, Segment};
use crate::law::Compiled;

/// Runs after which a fit that has not settled is given up: nine decades of process noise take six of them.
const PATIENCE: u32 = 40;

/// Samples from which on the kind of a record's error can be told.
const ENOUGH: u64 = 500;

/// A first law is tried when the weak start predicts its force this well.
const START_ERROR: f64 = 0.3;

/// The same where no displacement is measured: each weak row then has an offset of its own, which the filter does not
/// need.
const START_ERROR_WITHOUT_Q: f64 = 1.0;

/// A first law lies within this many stds of the weak rows' coefficients.
const START_STDS: f64 = 10.0;

/// Log-likelihood that an effect must gain to be believed, nats: odds of 22 000 to one after the price of having been
/// chosen among some twenty.
const EFFECT: f64 = 13.0;

/// An effect is believed that leaves less than this part of what the law without it leaves unexplained: one that takes
/// less stands in for something else, for coefficients that drift above all.
const MOST: f64 = 0.5;

/// What the latest record must explain better than the whole one to replace it, nats per measurement: the noise may
/// have changed.
const CLEARLY: f64 = 0.1;

impl Tracker {
    /// A record that has grown long without a validated law may hold a switch that nobody saw: the weak rows begin
    /// anew, so that the next fit knows the latest record alone. How long the law needs nobody knows, nor how long it
    /// lasts: the lengths follow the universal sequence (Luby, Sinclair and Zuckerman, *Information Processing Letters*
    /// 47 (1993), 173). Rows that gave no first law at all are kept for as long as their samples are.
    pub(super) fn begin_afresh(&mut self) {
        let (end, since) = (self.window.end(), self.schedule.rows_from);
        let due = match self.fitting {
            Fitting::Starting => since + self.window.capacity() as u64,
            _ if self.is_mixed() => since.max(self.history.refuted_at) + self.history.convergence_length,
            Fitting::Refining => since + FRESH_START * universal(self.schedule.afresh + 1),
            Fitting::Contested => return,
        };
        if end < due {
            return;
        }
        if self.fitting == Fitting::Contested {
            self.fitting = Fitting::Refining;
        }
        self.start.begin(end);
        self.schedule.rows_from = end;
        self.schedule.next_guess = 0;
        self.schedule.afresh += 1;
    }

    /// Begins a segment, or another fit beside the one there is, from what the weak rows of the record say.
    pub(super) fn guess(&mut self, setup: Setup) {
        let problem = setup.problem;
        if self.start.feed(problem, &self.window, 1) || !self.is_guess_due(setup) {
            return;
        }
        let (end, since) = (self.window.end(), self.schedule.rows_from);
        self.schedule.next_guess = end + (end - since) / 8 + 4;
        let sensor = self.sensor_noise(setup);
        let before = self.follows_a_law().then_some(&self.monitor.law);
        let Some(guess) = self.start.guess(problem, sensor) else { return };
        let Some(inertia) = believable_inertia(problem, &guess, before.map(|law| law.all[problem.inertia])) else {
            return;
        };
        let noise = Noise { sensor, process: guess.force_intensity / (inertia * inertia) + f64::MIN_POSITIVE };
        let (fit, belief) = (guess.fit, &mut self.belief);
        for index in 0..problem.n() {
            belief.spread[index] = fit.reach[index].max(START_STDS * guess.std[index]).min(NOTHING_KNOWN);
            belief.centre[index] = if problem.maybe[index] { 0.0 } else { fit.coefficients[index] };
        }
        let prior = belief.prior(&belief.centre, before.map(|law| law.active.as_slice()));
        let (begun, fitting) = match self.fitting {
            Fitting::Starting => (&mut self.segment, Fitting::Refining),
            Fitting::Refining | Fitting::Contested => (&mut self.alternative, Fitting::Contested),
        };
        begun.begin(problem, &self.window, since, &fit.coefficients, prior, noise);
        self.fitting = fitting;
    }

    /// Whether the weak rows are to be asked: no other fit is under way, they are all of samples that are still there,
    /// and there are enough of them, or an eighth more than at the last time.
    fn is_guess_due(&self, setup: Setup) -> bool {
        let window = &self.window;
        let covered = self.now() - window.sample(window.oldest()).t;
        let free = self.fitting != Fitting::Contested && covered >= setup.settings.initial_window;
        free && window.end() >= self.schedule.next_guess && self.schedule.rows_from >= window.oldest()
    }

    /// Sensor variances that a guess is begun with.
    fn sensor_noise(&self, setup: Setup) -> [f64; 2] {
        match self.fitting {
            Fitting::Starting => setup.first_noise(&self.difference_noise),
            _ if self.follows_a_law() => self.monitor.law.noise.sensor,
            _ => self.segment.noise.sensor,
        }
    }

    /// A fit with much process noise may be a maximum of the likelihood without being the largest: the other kind, all
    /// error in the sensors, is tried from the same coefficients each time the record has doubled.
    pub(super) fn try_sensor_fit(&mut self, setup: Setup) {
        let problem = setup.problem;
        let end = self.window.ready();
        let due = end >= self.schedule.next_sensor_fit && self.fitting == Fitting::Refining;
        let doubtful = self.segment.fit.process_matters || self.is_mixed();
        if !due || !doubtful || !self.segment.settled() || self.segment.length(end) < ENOUGH {
            return;
        }
        self.schedule.next_sensor_fit = end + self.segment.length(end);
        let sensor = setup.first_noise(&self.difference_noise);
        let noise = Noise { sensor, process: IN_THE_SENSORS * self.segment.noise.process };
        self.belief.from.copy_from_slice(&self.segment.coefficients);
        self.begin_another_fit(problem, self.segment.known_effect(), noise);
    }

    /// The effect that the law lacks most is tried beside it; a law that explains its record, and against which nothing
    /// speaks, lacks none before the motion has gone there and back.
    pub(super) fn try_effect(&mut self, problem: &Problem) {
        let doubted = !self.segment.fit.explains || self.monitor.unusual_since.is_some();
        let due = (doubted || self.there_and_back(LONGEST_ERROR) < 1.0) && self.fitting == Fitting::Refining;
        let Some(lacked) = self.segment.untried.take().filter(|_| due) else { return };
        let Tracker { segment, alternative, belief, .. } = self;
        alternative.terms.copy_from_slice(&segment.terms);
        alternative.terms[problem.terms.len()] = lacked.term;
        let has_it = segment.effect() != 0.0 && segment.terms == alternative.terms;
        if has_it || Compiled::refused(&alternative.terms).is_some() {
            return;
        }
        for (index, from) in belief.from.iter_mut().enumerate() {
            *from = segment.coefficients[index] + segment.untried_step[index];
        }
        let effect = KnownEffect { term: lacked.term, coefficient: lacked.coefficient, precision: 0.0 };
        self.begin_another_fit(problem, Some(effect), self.segment.noise);
    }

    /// Another fit of the segment's record, from the coefficients believed most.
    fn begin_another_fit(&mut self, problem: &Problem, effect: Option<KnownEffect>, noise: Noise) {
        self.set_spread(problem);
        self.belief.spread.iter_mut().for_each(|spread| *spread *= PRIOR_WIDTH);
        let Tracker { segment, alternative, belief, monitor, window, .. } = self;
        let structure = (belief.samples > 0.0).then_some(monitor.law.active.as_slice());
        let prior = Prior { noise_weight: 0.0, effect, ..belief.prior(&segment.coefficients, structure) };
        alternative.begin(problem, window, segment.start, &belief.from, prior, noise);
        self.fitting = Fitting::Contested;
    }

    /// Whether the other fit has an effect that the segment does not have.
    fn tries_effect(&self) -> bool {
        let [tried, own] = [&self.alternative, &self.segment].map(Segment::known_effect);
        tried.is_some_and(|tried| own.is_none_or(|own| own.term != tried.term))
    }

    /// Whether such an effect may still explain the record.
    pub(super) fn has_effect_on_trial(&self) -> bool {
        self.fitting == Fitting::Contested && self.tries_effect()
    }

    /// Whether that effect gains what it must over the segment and over none, and explains most of what the segment
    /// does not.
    fn explains_by_effect(&self) -> bool {
        let [with, without] = [&self.alternative, &self.segment];
        let gain = 2.0 * with.length(self.window.ready()) as f64 * (with.fit.likelihood - without.fit.likelihood);
        let alone = with.effect_gain().unwrap_or(0.0);
        let least = if without.effect() == 0.0 { EFFECT } else { TWENTY_TO_ONE };
        gain > least && alone > EFFECT && (with.fit.explains || with.noise.process < MOST * without.noise.process)
    }

    /// What later records know of the effect that the model lacks is what this one tells.
    pub(super) fn believe_effect(&mut self) {
        self.belief.effect = self.segment.known_effect();
        self.library.trials.set_effect(self.belief.effect);
    }

    /// Refines the other fit; it takes the segment's place when it explains the record better, or is validated first.
    pub(super) fn refine_alternative(&mut self, setup: Setup, budget: usize) {
        let contested = self.fitting == Fitting::Contested;
        if !contested || !self.alternative.refine(setup.problem, setup.settings, &self.window, budget) {
            return;
        }
        let promising = !self.regime.is_valid() && self.explains_what_the_segment_does_not();
        // of two effects each is judged at its own best, which a fit that does not settle any more has been at
        let at_best = self.segment.runs.restless == 0 || self.segment.runs.restless > LASTS;
        let comparable =
            self.alternative.settled() && (at_best || self.segment.effect() == 0.0 || !self.tries_effect());
        let goes_on = if self.alternative.is_lost() {
            false
        } else if comparable {
            let wins = self.alternative_wins(promising);
            let found_effect = wins && self.tries_effect();
            if wins {
                std::mem::swap(&mut self.alternative, &mut self.segment);
                self.believe_effect();
                if found_effect {
                    self.watch_with_effect(setup);
                }
            }
            promising && !wins
        } else {
            self.alternative.runs.closed <= PATIENCE
        };
        self.fitting = if goes_on { Fitting::Contested } else { Fitting::Refining };
        self.alternative.begin_run(&self.window);
    }

    /// Whether the other fit, settled by now, is to take the segment's place. One that takes that of a law which
    /// explains its record would begin the same law's stability check anew.
    fn alternative_wins(&mut self, promising: bool) -> bool {
        let agrees = self.alternative.agrees_with(&self.segment);
        if agrees {
            self.schedule.next_guess = self.window.end() + self.segment.length(self.window.end());
        }
        let better = self.alternative.fit.likelihood > self.segment.fit.likelihood + self.margin();
        if self.tries_effect() {
            return self.explains_by_effect();
        }
        better && !(agrees && self.segment.fit.explains) || promising && self.alternative.is_validated()
    }

    /// A first guess from which no fit can be begun is forgotten: the weak rows, more of them by now, are asked for
    /// another.
    pub(super) fn give_up_guess(&mut self) -> bool {
        let lost = self.segment.is_lost() && !self.monitor.law.running;
        if lost {
            self.fitting = Fitting::Starting;
        }
        lost
    }

    /// Whether the other fit explains a later record down to the sensors' noise, and the segment not its own.
    fn explains_what_the_segment_does_not(&self) -> bool {
        self.alternative.start > self.segment.start && self.alternative.fit.explains && !self.segment.fit.explains
    }

    /// What the other fit must explain better than the segment, nats per measurement.
    fn margin(&self) -> f64 {
        match self.alternative.start > self.segment.start {
            true => CLEARLY,
            false => TWENTY_TO_ONE / (2.0 * self.alternative.length(self.window.ready()) as f64),
        }
    }
}

/// The inertia of a guess that predicts its force well enough, and that did not turn around since the law before.
fn believable_inertia(problem: &Problem, guess: &Guess, before: Option<f64>) -> Option<f64> {
    let inertia = problem.free_inertia().map_or(problem.known[problem.inertia], |index| guess.fit.coefficients[index]);
    let allowed = if problem.channels.q { START_ERROR } else { START_ERROR_WITHOUT_Q };
    let poor = guess.relative_error > allowed;
    let turned = before.is_some_and(|before| inertia * before < 0.0);
    (!poor && !turned && inertia.is_finite() && inertia != 0.0).then_some(inertia)
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
    use crate::identify::sample::Sample;
    use crate::identify::settings::Settings;
    use crate::law::Model;
    use crate::simulate::{Builtin, record};

    #[test]
    fn the_universal_sequence_is_that_of_the_paper() {
        let first: Vec<u64> = (1..=15).map(universal).collect();
        assert_eq!(first, [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8]);
    }

    /// Segment and other fit begin from coefficients that no run survives.
    fn lead_astray(tracker: &mut Tracker, problem: &Problem) {
        let absurd: Vec<f64> = (0..problem.n()).map(|index| if index == 0 { 0.6 } else { -1e6 }).collect();
        let noise = Noise { sensor: [1e-4; 2], process: 1.0 };
        let (centre, std) = (vec![0.0; problem.n()], vec![1e9; problem.n()]);
        let Tracker { segment, alternative, window, belief, .. } = tracker;
        for fit in [segment, alternative] {
            let (structure, noise_weight, effect, scales) = (None, 0.0, belief.effect, &belief.scales);
            let prior = Prior { centre: &centre, std: &std, log_inertia: 1.0, structure, noise_weight, effect, scales };
            fit.begin(problem, window, 0, &absurd, prior, noise);
        }
        tracker.fitting = Fitting::Contested;
    }

    #[test]
    fn a_first_law_from_which_no_fit_can_be_begun_is_forgotten() {
        let (model, settings) = (Model::cubic_library(), Settings::default());
        let problem = Problem::new(&model, &settings);
        let mut tracker = Tracker::new(&problem, &settings);
        let scenario = Builtin::VanDerPolWhite.random(32).with_noise(0.01);
        for (index, reading) in record(&scenario).unwrap().iter().take(6000).enumerate() {
            if index == 100 {
                lead_astray(&mut tracker, &problem);
            }
            let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
            tracker.step(&problem, &settings, sample);
        }
        assert!(tracker.regime.is_valid(), "{:?}", tracker.regime);
    }
}
