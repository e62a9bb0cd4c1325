//! Whether the law has switched, and what happens when it has.

use super::{INERTIA_SPREAD, PRIOR_WIDTH, Phase, SWITCH_SIZE, Tracker};
use crate::evidence::{Noise, Suspect};
use crate::identify::identifier::{Output, Status};
use crate::identify::moving::INSTANTS;
use crate::identify::problem::Problem;
use crate::identify::settings::Settings;
use crate::identify::stage::{NOISE_MEMORY, Prior};

/// A law that is known from this many samples at the switch needs twice the evidence: its information is that of a linearisation,
/// whose error falls as the record grows.
const DOUBT: f64 = 2000.0;

/// Neighbouring samples and starts share their noise, and the evidence is a mean over all sizes of a switch: it rises by chance as if one
/// sample in so many were a trial of its own.
const TRIAL: f64 = 85.0;

/// Evidence that chance brings once in some ten thousand samples, nats.
const UNUSUAL: f64 = 5.0;

/// A law that is not vouched for, nor stands its trial, needs this many times the evidence.
const UNPROVEN: f64 = 10.0;

impl Tracker {
    /// The law in use has left what can be computed: everything begins anew with the next samples.
    pub(super) fn lose(&mut self, output: &mut Output) {
        let end = self.window.end();
        (self.live.running, self.unusual_since) = (false, None);
        self.bank.clear();
        self.deviation.clear();
        self.phase = Phase::Gathering;
        self.contest_from(end);
        self.forget_trials(output);
        self.trial_due = Some(end);
        (output.status, output.valid, output.identified_time) = (Status::Acquiring, false, None);
    }

    /// Alarm, suspicion, or neither.
    pub(super) fn judge(&mut self, problem: &Problem, settings: &Settings, suspect: &Suspect, output: &mut Output) {
        let samples = self.stage.length(suspect.start) + self.experience;
        // a stage that does not explain what a law like it did may hold a switch already
        let overdispersion = if self.explained { self.live.overdispersion } else { self.stage.overdispersion };
        let doubt = overdispersion * (1.0 + DOUBT / samples.max(1) as f64);
        let doubt = if output.valid || self.live.proven { doubt } else { UNPROVEN * doubt };
        // what chance brings is known of a law that explains its record; of another all evidence seen counts as its usual one
        let explains = self.explains();
        let trial = if explains { TRIAL } else { 1.0 };
        let level = doubt * (settings.false_alarm_interval / (trial * settings.sample_time)).ln().max(3.0);
        let chance = if explains { -TRIAL.ln() } else { f64::NEG_INFINITY };
        let level = self.usual.level(level, chance);
        if output.valid {
            self.usual.add(suspect.evidence);
        }
        let given = settings.deviation_threshold;
        let deviates = given > 0.0 && self.deviation.is_full(self.now()) && output.deviation > given;
        let unusual = suspect.evidence > (UNUSUAL * doubt).min(0.5 * level);
        self.unusual_since = unusual.then(|| self.unusual_since.unwrap_or(self.window.end()));
        if suspect.evidence > level || deviates {
            match (self.drifted && self.drift.is_moving()) || self.moving.is_following() {
                true => self.begin_drift(output),
                false => self.switch(problem, suspect, level, output),
            }
        } else if output.status == Status::Tracking && suspect.evidence > 0.5 * level {
            output.status = Status::SwitchSuspected;
            if self.renewed {
                (self.suspected, self.renewed) = (self.window.end(), false);
            }
        } else if output.status == Status::SwitchSuspected && suspect.evidence <= 0.5 * level {
            output.status = Status::Tracking;
        }
    }

    /// Whether another law, known by now, explains all of the record, and did so when the law in use had not been left yet.
    fn is_superseded(&self, instant: u64) -> bool {
        self.stage.is_vouched() && self.contradicted_since.is_some_and(|since| since < instant)
    }

    /// The law in use never was the record's: the one that is comes into use with its next pass. What spoke against the one before says
    /// nothing of a switch.
    fn supersede(&mut self, output: &mut Output) {
        (self.live.running, self.unusual_since) = (false, None);
        self.bank.clear();
        self.deviation.clear();
        self.usual.clear();
        self.doubt_law(output);
    }

    /// Ends the stage; only data from after the switch enters the new law.
    fn switch(&mut self, problem: &Problem, suspect: &Suspect, level: f64, output: &mut Output) {
        self.bank.look_at_all();
        let suspect = self.bank.suspect().unwrap_or(*suspect);
        let last = self.window.ready() - 1;
        let instant = self.bank.likeliest_start(&suspect, level);
        let start = (self.bank.after(&suspect, level) + 1).min(last);
        let time = |number: u64| self.window.sample(number).t;
        let distance = self.bank.distance_of_switch(time(instant), self.now(), time);
        if self.is_unconfirmed() || self.was_never_right(instant, last, suspect.evidence - level) {
            return self.take_back(problem, output);
        }
        if self.is_superseded(instant) {
            return self.supersede(output);
        }
        self.keep_law(problem, output);
        self.set_spread(problem);
        self.scales.remember(&self.stage.scales, 1.0);
        if output.valid {
            let mut instants = [0; INSTANTS];
            self.bank.likeliest_starts(&mut instants);
            self.try_drift(problem, instants);
        }
        self.bank.change(&suspect, &mut self.change);
        let plausible = self.change.iter().zip(&self.spread).all(|(change, spread)| change.abs() < 2.0 * spread);
        for (index, (change, centre)) in self.change.iter_mut().zip(&mut self.centre).enumerate() {
            *centre = self.live.all[problem.free[index]];
            *change = if plausible { *centre + *change } else { *centre };
        }
        self.begin_new_law(problem, start);
        let sensor = self.live.noise.sensor.map(Some);
        self.trials.begin(&self.known, problem, &self.window, start, sensor);
        self.trials.set_left(output.law_number.and_then(|number| self.known.position(number)));
        (self.recognised, self.confirmed, self.experience) = (None, false, 0);
        self.contest_from(start);
        self.drift.restart(start);
        (self.live.running, self.unusual_since) = (false, None);
        self.linger(instant, output.law_number);
        self.deviation.clear();
        self.usual_deviation = 0.0;
        self.usual.clear();
        output.switch_count += 1;
        output.switch_time = self.window.sample(instant).t;
        output.switch_time_std = distance.map(|distance| distance.hypot(self.last_interval()));
        output.detection_time = Some(self.now());
        output.identified_time = None;
        output.missing = None;
        output.valid = false;
        (output.law_number, output.recognised) = (None, false);
        output.status = Status::ReIdentifying;
    }

    /// Begins the stage of a law that nobody has seen, from `change`, believed to lie about `centre`.
    pub(super) fn begin_new_law(&mut self, problem: &Problem, start: u64) {
        let acceleration = self.stage.scales.restoring_acceleration();
        let process = (SWITCH_SIZE * acceleration).powi(2) * 0.1;
        let noise = Noise { sensor: self.live.noise.sensor, process: process.max(self.live.noise.process) };
        self.spread.iter_mut().for_each(|spread| *spread *= PRIOR_WIDTH);
        keep_inertia(problem, &self.live.all, &mut self.change);
        self.noise_weight = NOISE_MEMORY;
        let prior = Prior {
            centre: &self.centre,
            std: &self.spread,
            log_inertia: INERTIA_SPREAD,
            structure: Some(&self.live.active),
            noise_weight: self.noise_weight,
            scales: &self.scales,
        };
        self.stage.begin(problem, &self.window, start, &self.change, prior, noise);
    }
}

/// A linear estimate of the change may turn the inertia around: it then stays what it was.
fn keep_inertia(problem: &Problem, old: &[f64], new: &mut [f64]) {
    if let Some(index) = problem.free_inertia() {
        let ratio = new[index] / old[problem.inertia];
        if !(0.3..3.0).contains(&ratio) {
            new[index] = old[problem.inertia];
        }
    }
}
