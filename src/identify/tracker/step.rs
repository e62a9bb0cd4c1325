//! What a sample does: the law in use is followed, the segment refined, coefficients that move are tracked.

use super::recognition::TRIAL_BUDGET;
use super::state::{LASTS, Monitor, Setup, Tracker, YOUNG};
use crate::identify::change::{LONGEST_ERROR, SUSPENSE};
use crate::identify::problem::Problem;
use crate::identify::reading::Reading;
use crate::identify::validation::TRUSTED;

/// A hypothesis starts every so many samples.
const SPAWN_EVERY: u64 = 2;

/// Oldest start that is still considered, s ÷ `sample_time`: the record of a switch this old has long been decided on.
const OLDEST: f64 = 8.0;

/// Hypotheses looked at in a step.
const LOOKS: usize = 3;

/// Samples of refinement in a step, while tracking and while the fit has yet to converge: what a law that does not
/// explain its record still gains by more runs is no better law.
const BUDGET: [usize; 2] = [6, TRIAL_BUDGET];

/// Once in so many samples it is asked which lengths of variation are too short for the motion.
const REST_EVERY: u64 = 256;

/// Samples from which on differences tell the sensors' noise to a tenth.
const ROUGHLY: u64 = 500;

impl Tracker {
    /// Takes a reading into the record.
    pub(super) fn take(&mut self, setup: Setup, reading: Reading) {
        let (problem, sample) = (setup.problem, reading.sample);
        if self.window.end() == 0 {
            self.published.switches.time = sample.t;
            self.start.begin(0);
        }
        let switches = self.published.switches.count;
        self.window.push(reading);
        self.weak_form.step(problem, sample);
        if self.window.end().is_multiple_of(REST_EVERY) {
            self.weak_form.rest(problem, setup.first_noise(&self.difference_noise));
        }
        if reading.faulty == [false; 2] {
            self.measure_noise(problem);
        }
        self.follow(setup);
        if self.regime.seeks_constant_law() {
            self.seek_constant_law(setup);
        }
        self.track_augmented(setup);
        self.track_weak_rows(setup);
        if self.published.switches.count != switches {
            self.weak_form.restart();
        }
    }

    /// Before any law the sensors' noise is known from differences.
    fn measure_noise(&mut self, problem: &Problem) {
        let end = self.window.end();
        if end < 4 {
            return;
        }
        let last = [4, 3, 2, 1].map(|back| *self.window.sample(end - back));
        let measured = [last.map(|sample| sample.q), last.map(|sample| sample.qd)];
        self.difference_noise.add(last.map(|sample| sample.t), measured, last.map(|sample| sample.excitation));
        let known = self.published.noise_by_law || end < ROUGHLY;
        if let Some([q, qd]) = self.difference_noise.variance().filter(|_| !known) {
            let channels = problem.channels;
            self.published.noise = [channels.q.then(|| q.sqrt()), channels.qd.then(|| qd.sqrt())];
        }
    }

    /// Runs the law in use over what is new, and weighs the evidence of a switch.
    fn follow(&mut self, setup: Setup) {
        while self.monitor.law.running && self.monitor.law.next < self.window.ready() {
            let number = self.monitor.law.next;
            let observation = self.window.observation(number);
            let monitor = &mut self.monitor;
            let innovations = monitor.law.step(setup.problem, &observation, self.window.shifts(number));
            if !monitor.law.run.filter.state().is_finite() {
                self.lose();
                return;
            }
            monitor.bank.step(&monitor.law.run.map, monitor.law.effect_input(), &innovations);
            self.weigh_faults(setup.problem, number, &observation, &innovations);
            self.weigh_standing_force(setup.problem, &observation, &innovations);
            let (sample, monitor) = (self.window.sample(number), &mut self.monitor);
            monitor.prediction.step(setup.problem, setup.settings, &monitor.law, sample, &observation);
            if number.is_multiple_of(SPAWN_EVERY) {
                self.suppose_switch_after(number);
            }
            let oldest = number.saturating_sub((OLDEST / setup.settings.sample_time) as u64);
            self.monitor.bank.forget_before(oldest.max(self.segment.start));
            self.monitor.bank.look(LOOKS);
            self.monitor.law.next += 1;
            if let Some(suspect) = self.monitor.bank.suspect() {
                self.judge(setup, &suspect);
            }
        }
    }

    /// Adds the hypothesis of a switch after this sample.
    fn suppose_switch_after(&mut self, number: u64) {
        let explains = self.explains();
        let monitor = &mut self.monitor;
        // of a law that came back only its own terms are known from before: to seek the others too would make it look
        // unlikely
        let every = self.regime.recognition().is_none().then_some(monitor.every_term.as_slice());
        let law = monitor.law.as_law(every, explains);
        monitor.bank.spawn(number, &law);
    }

    fn seek_constant_law(&mut self, setup: Setup) {
        self.begin_first_trials(setup);
        let used = self.try_known(setup);
        if !self.regime.is_valid() || self.regime.is_drifting() {
            self.begin_afresh();
            self.guess(setup);
        }
        self.try_effect(setup.problem);
        self.try_sensor_fit(setup);
        self.refine_alternative(setup, BUDGET[1] - used);
        if self.is_refining() {
            self.refine(setup);
        }
    }

    /// Whether what comes after an outage may have an offset: no law must be fitted to that.
    fn may_be_off(&self) -> bool {
        self.intake.after_outage.is_open() && self.regime.law().is_some()
    }

    fn refine(&mut self, setup: Setup) {
        let young = self.regime.law().is_none() || self.record_length() < YOUNG;
        let converging = self.segment.fit.explains && !self.segment.settled();
        let budget = BUDGET[usize::from(young || converging)];
        if self.may_be_off() || !self.segment.refine(setup.problem, setup.settings, &self.window, budget) {
            return;
        }
        if !self.give_up_guess() {
            self.heed_run(setup);
        }
    }

    /// The segment's law has an effect that the one in use lacks: what spoke against that one says nothing of a switch.
    pub(super) fn watch_with_effect(&mut self, setup: Setup) {
        self.monitor.bank.clear();
        self.monitor.unusual_since = None;
        self.heed_run(setup);
    }

    /// What the run that has just closed says is made known, and taken into use where it is worth it.
    fn heed_run(&mut self, setup: Setup) {
        if self.regime.is_moving() {
            if !self.refutes_drift(setup.problem) {
                self.segment.begin_run(&self.window);
                return;
            }
            self.leave_drift();
        }
        let mixed = self.is_mixed();
        let trusted = self.segment.settled() && self.segment.stated_error() < TRUSTED && !mixed;
        // of a law of which nothing is known nobody knows what it lacks
        let is_law = trusted || self.regime.is_valid();
        self.published.missing = self.segment.missing.filter(|_| is_law && self.there_and_back(LONGEST_ERROR) < 1.0);
        self.make_known(setup, trusted);
        let waits = self.monitor.unusual_since.is_some_and(|since| self.window.end() < since + SUSPENSE);
        self.history.mixed_runs = if mixed { self.history.mixed_runs + 1 } else { 0 };
        let lasts = self.history.mixed_runs >= LASTS;
        if lasts && self.regime.is_valid() && !waits && !self.regime.is_drifting() {
            self.refute_law();
        }
        self.take_into_use(setup.problem, trusted, !waits, mixed);
    }

    /// What the run that has just closed says is published; without a law to trust the std of the last one are none of
    /// this one's.
    fn make_known(&mut self, setup: Setup, trusted: bool) {
        if trusted {
            self.set_spread(setup.problem);
            self.publish(setup);
        } else if !self.regime.is_valid() && !self.regime.is_drifting() {
            self.published.forget_stds(setup.problem);
        }
    }

    /// Switches are weighed against the segment's new estimate where it may be `renewed`, and is worth it; else the
    /// next run begins.
    fn take_into_use(&mut self, problem: &Problem, trusted: bool, renewed: bool, mixed: bool) {
        let stands = self.segment.stands();
        let law = &self.monitor.law;
        let proven = self.regime.is_valid() || self.segment.fit.explains && stands;
        // a law that has stood its stability check is not left for one that has not: what happened to it may be a
        // switch
        let later = law.running && law.proven && !proven;
        let worth_monitoring = trusted && stands || law.running && self.segment.is_calm() && !mixed;
        match renewed && !later && worth_monitoring {
            true => self.monitor_new_law(problem, proven),
            false => self.segment.begin_run(&self.window),
        }
    }

    /// From now on switches are weighed against the segment's new estimate. Hypotheses are linear about the old one:
    /// they are carried over only between laws as near to each other as those that have stood their stability check.
    fn monitor_new_law(&mut self, problem: &Problem, proven: bool) {
        let was_running = self.monitor.law.running;
        match was_running {
            true => self.carry_hypotheses(problem, proven),
            false => self.end_post_alarm(),
        }
        let Tracker { monitor, segment, window, .. } = self;
        monitor.law.adopt(segment, window);
        if !was_running {
            monitor.prediction.restart(monitor.law.run.filter.state(), window.sample(window.ready() - 1).t);
        }
        monitor.law.proven = proven;
        self.set_spread(problem);
        self.monitor.bank.set_spread(&self.belief.spread);
    }

    fn carry_hypotheses(&mut self, problem: &Problem, proven: bool) {
        let Tracker { monitor: Monitor { law, bank, .. }, segment, .. } = self;
        match proven
            && !segment.has_left_itself()
            && segment.has_terms_of(&law.terms, law.effect())
            && law.noise.is_near(&segment.noise)
        {
            true => {
                let own = problem.free.iter().zip(&segment.coefficients).map(|(index, value)| value - law.all[*index]);
                bank.shift(own.chain([segment.effect() - law.effect()]));
            }
            false => bank.clear(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::sample::Sample;
    use crate::identify::settings::Settings;
    use crate::identify::tracker::regime::letter;
    use crate::law::{Given, Model};
    use crate::simulate::{Builtin, Scenario, record};

    const A: [f64; 4] = [1.0, 0.3, 4.0, 2.0];
    const B: [f64; 4] = [1.2, 0.5, 5.5, 1.2];

    /// Duffing under a sine, σ = 0.01, with these laws for 8 s each.
    fn scenario(laws: &[[f64; 4]]) -> Scenario {
        let mut scenario = Builtin::DuffingSine.scenario().with_noise(0.01).with_seed(1);
        let first = scenario.stages[0].clone();
        scenario.stages = vec![first; laws.len()];
        for (index, (stage, law)) in scenario.stages.iter_mut().zip(laws).enumerate() {
            (stage.start, stage.coefficients) = (8.0 * index as f64, law.to_vec());
        }
        scenario.duration = 8.0 * laws.len() as f64;
        scenario
    }

    /// The regimes that a record goes through, each once for as long as it lasts.
    fn walk(laws: &[[f64; 4]]) -> String {
        let model = Model::of("Duffing", Builtin::DuffingSine.terms().into_iter().map(|term| (term, Given::Fit)));
        let settings = Settings::default();
        let problem = Problem::new(&model, &settings);
        let mut tracker = Tracker::new(&problem, &settings);
        let mut walked = Vec::new();
        for reading in record(&scenario(laws)).unwrap() {
            let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
            tracker.step(&problem, &settings, sample);
            walked.push(letter(tracker.regime));
        }
        walked.dedup();
        walked.into_iter().collect()
    }

    /// Half of its record was folded into what is known, and the stability check began anew.
    #[test]
    fn a_law_that_has_outgrown_the_window_stands_with_all_of_its_record() {
        let model = Model::of("Duffing", Builtin::DuffingSine.terms().into_iter().map(|term| (term, Given::Fit)));
        let settings = Settings { max_window: 8.0, ..Settings::default() };
        let problem = Problem::new(&model, &settings);
        let mut tracker = Tracker::new(&problem, &settings);
        for (index, reading) in record(&scenario(&[A; 3])).unwrap().iter().enumerate() {
            let sample = Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation };
            tracker.step(&problem, &settings, sample);
            assert!(index < 6000 || tracker.segment.stands(), "at {} s", reading.t);
        }
        let samples = tracker.segment.samples();
        assert!(samples > 2 * tracker.window.capacity() as u64, "{samples}");
    }

    #[test]
    fn a_law_that_switches_and_returns_is_tracked_suspected_identified_anew_and_recognised() {
        let walked = walk(&[A, B, A]);
        assert!(walked.contains('s'), "{walked}");
        let mut settled: Vec<char> = walked.chars().filter(|regime| *regime != 's').collect();
        settled.dedup();
        let settled: String = settled.into_iter().collect();
        // at an alarm a known law may be recognised in the same step
        assert!(["atitir", "atitr"].contains(&settled.as_str()), "{walked}");
    }
}
