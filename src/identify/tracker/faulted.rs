//! An alarm that is a sensor's fault: evidence against the law that a fault explains as well or better.

use super::regime::Event;
use super::state::{Intake, Tracker};
use crate::estimation::{Channel, Filter, Innovation, Observation, TWENTY_TO_ONE};
use crate::evidence::{INERTIA_SPREAD, Suspect};
use crate::identify::change::LawInUse;
use crate::identify::faults::{
    CERTAIN, DECISIVE, Expected, Found, LateChannels, Lateness, Returned, Standing, StandingForce, delay, settled,
};
use crate::identify::problem::Problem;
use crate::identify::reading::Reading;
use crate::identify::segment::MotionScales;
use crate::law::Hold;

/// A decision between an offset and another law may take this long after an outage, s …
const UNDECIDED: f64 = 3.0;

/// … and is made before with decisive log-odds, for the offset once the motion has turned by so many radians: what that
/// does stays, and until then what another law does may stay too.
const TURNED: f64 = 2.0;

/// The evidence of a switch is linear in what may be no small change, and is right to this part of itself.
const LINEAR: f64 = 0.1;

/// What readings are held against: the law in use, of which `caution` times the evidence is asked, in a motion of these
/// scales and this size.
pub(super) fn expected<'a>(
    problem: &'a Problem,
    law: &'a LawInUse,
    caution: f64,
    scales: &MotionScales,
    size: [f64; 2],
) -> Expected<'a> {
    Expected {
        motion: problem.motion(&law.terms, &law.all),
        noise: law.noise_now(),
        caution,
        switch: [scales.restoring_acceleration(), INERTIA_SPREAD],
        rate: scales.natural_time().recip(),
        size,
        drive: scales.acceleration(),
        unnoticed: 0.0,
        stuck: None,
        parts: law.run.parts,
        lag: problem.timing.lag,
        alone: None,
    }
}

impl Tracker {
    /// Takes what the law in use makes of a sample, number `number`, for the hypotheses of faults that no single
    /// reading shows.
    pub(super) fn weigh_faults(
        &mut self,
        problem: &Problem,
        number: u64,
        observation: &Observation,
        innovations: &[Option<Innovation>; 2],
    ) {
        let caution = self.decision().caution();
        let Tracker { intake, window, monitor, segment, .. } = self;
        if window.ends_outage(number) {
            monitor.law.keep();
        }
        let law = &monitor.law;
        let (state, outage) = (&law.run.filter, window.ends_outage(number));
        let size = intake.quarantine.size();
        let expected = || expected(problem, law, caution, &segment.scales, size);
        let found = intake.quarantine.found_offset();
        match found {
            Some(found) => intake.after_outage.follow(&expected(), state, found),
            None if !law.explains => {}
            None if outage => intake.after_outage.begin(&expected(), state, problem.channels.of_motion()),
            None if intake.after_outage.is_open() => {
                let law = expected();
                let noise = law.noise_with(observation.unseen, state.mean[0]);
                intake.after_outage.take(&Expected { noise, ..law }, observation, state, innovations);
            }
            None => {}
        }
        if problem.channels.excitation && problem.timing.hold != Hold::BandLimited {
            let law = &expected();
            match &mut monitor.late_channels {
                Some(channels) if !outage => channels.follow(law, window),
                begins => *begins = Some(LateChannels::begin(law, window, number, state)),
            }
        }
        if intake.after_outage.is_due() {
            self.take_off_the_rest();
        }
    }

    /// An F that stands still, and is held for lost, acts as it is read where the motion has followed it for a radian,
    /// after the time in which what acts would have gone elsewhere: the drive is off.
    pub(super) fn weigh_standing_force(
        &mut self,
        problem: &Problem,
        observation: &Observation,
        innovations: &[Option<Innovation>; 2],
    ) {
        let Intake { force, force_lost, excitation, .. } = &self.intake;
        if !force_lost || (force.length() as f64) < excitation.pace() {
            self.intake.standing_force = StandingForce::begin(self.monitor.law.run.filter);
            return;
        }
        let caution = self.decision().caution();
        let Tracker { intake, monitor, segment, .. } = self;
        let law = &monitor.law;
        let expected = expected(problem, law, caution, &segment.scales, intake.quarantine.size());
        intake.standing_force.take(&expected, observation, &law.run.filter, innovations);
        intake.force_lost = !intake.standing_force.has_been_followed(segment.scales.natural_time());
    }

    /// What is left of an offset that was found is taken off.
    fn take_off_the_rest(&mut self) {
        if let Some(returned) = self.intake.after_outage.likeliest() {
            self.correct_offset(&returned);
        }
    }

    /// Whether what speaks for a switch is a sensor's fault, or may be.
    pub(super) fn is_fault(&mut self, problem: &Problem, suspect: &Suspect) -> bool {
        if !self.monitor.law.explains {
            return false;
        }
        if let Some(readings) = self.misread_excitation() {
            self.lose_excitation(readings);
            return true;
        }
        self.stood_still(suspect) || self.intake.late.is_some() || self.is_late_or_burst(problem, suspect)
    }

    /// Whether F stood still, where it varied before, when what speaks for a switch began: it may have been stuck, and
    /// what acted then is not known.
    fn stood_still(&mut self, suspect: &Suspect) -> bool {
        let began = self.window.sample(suspect.start).t;
        let Some([from, to]) = self.intake.stood_still.filter(|[from, to]| (*from..=*to).contains(&began)) else {
            return false;
        };
        self.intake.stood_still = None;
        let count = self.count_since(from) + self.intake.quarantine.behind() as u64;
        self.leave_open(count, to + 1.5 * self.window.pace(), self.unknown_excitation());
        true
    }

    /// Samples of the window since that time, s.
    fn count_since(&self, time: f64) -> u64 {
        let numbers = (self.window.oldest()..self.window.end()).rev();
        numbers.take_while(|number| self.window.sample(*number).t >= time).count() as u64
    }

    /// Whether channels that have begun to come late, a burst of readings that were not far enough off to be held, or
    /// louder sensors, are as likely as what speaks for a switch, as rare as that: what is a burst's does not count,
    /// and what cannot be told yet waits.
    fn is_late_or_burst(&mut self, problem: &Problem, suspect: &Suspect) -> bool {
        self.monitor.bank.look_at_all();
        let suspect = self.monitor.bank.suspect().unwrap_or(*suspect);
        let caution = self.decision().caution();
        let Tracker { intake, window, monitor, segment, regime, .. } = self;
        let law = &monitor.law;
        let expected = expected(problem, law, caution, &segment.scales, intake.quarantine.size());
        let switch = (suspect.start, suspect.evidence / caution);
        let Found { odds, law, is_burst } = intake.hindsight.weigh(&expected, window, switch);
        let late = monitor.late_channels.map(|channels| channels.weigh(&expected, window, law));
        // a law that may be another one says nothing of when F acted
        let late = late.filter(|_| !regime.is_unconfirmed());
        let late = late.filter(|(late, own)| *own > odds && problem.timing.moved(late, 0).is_some());
        intake.late = late.filter(|(_, odds)| *odds > CERTAIN).map(|(late, _)| late);
        if late.is_none() && odds > TWENTY_TO_ONE {
            if is_burst {
                self.leave_out_burst();
            }
            self.restart_law(self.as_read());
        }
        self.intake.hindsight.clear();
        late.map_or(odds, |(_, odds)| odds) > -TWENTY_TO_ONE
    }

    /// A channel has begun to come late: so it does in the record from then on, and the law stays.
    pub(super) fn begin_late(&mut self, problem: &mut Problem, late: &Lateness) {
        let Some(moved) = problem.timing.moved(late, self.record_length()) else { return };
        let later = late.later;
        // a motion whose readings begin to come late has stood still in them
        let stood_still = delay(problem.timing.lag, later) != 0.0;
        problem.timing = moved;
        self.window.set_later(late.first, later);
        let goes_on = late.first + 1;
        if stood_still && (self.window.oldest()..self.window.end()).contains(&goes_on) {
            self.window.break_off(goes_on);
        }
        let caution = self.decision().caution();
        let Tracker { intake, window, monitor, segment, .. } = self;
        let expected = expected(problem, &monitor.law, caution, &segment.scales, intake.quarantine.size());
        let filter = settled(&expected, window, window.ready());
        monitor.law.forget_lag();
        segment.begin_run(window);
        self.weak_form.restart();
        self.weak_row_drift.restart(self.window.end());
        self.restart_law(filter);
    }

    fn leave_out_burst(&mut self) {
        let Tracker { intake, window, monitor, .. } = self;
        let channels = intake.hindsight.leave_out(window);
        intake.quarantine.blame(channels);
        monitor.law.run.filter = intake.hindsight.filter();
        self.segment.begin_run(&self.window);
    }

    /// For how many readings F is not what acts, where the motion goes its own way as well, so that a fault is as
    /// likely as a switch: F stands still, or it has just left its course.
    fn misread_excitation(&self) -> Option<u64> {
        let Intake { force, force_lost, excitation, .. } = &self.intake;
        let stuck = self.standing_force().map(|_| force.length());
        stuck.or_else(|| excitation.left().map(u64::from)).filter(|_| !force_lost)
    }

    /// F, where it repeats exactly and varied before. A motion that has followed an F that stands still for a radian,
    /// after the time in which what acts would have gone elsewhere, says that it is what acts: the drive is off.
    pub(super) fn standing_force(&self) -> Option<Standing> {
        let Intake { force, excitation, .. } = &self.intake;
        let [since, pace] = [force.length() as f64, excitation.pace()].map(|samples| samples * self.window.pace());
        let may_be_stuck = force.run() > TWENTY_TO_ONE && since - pace < self.segment.scales.natural_time();
        may_be_stuck.then_some(Standing { since, pace })
    }

    /// F has not been what acts for so many readings, so that it is not known.
    pub(super) fn lose_excitation(&mut self, readings: u64) {
        self.intake.force_lost = true;
        self.leave_open(readings, f64::INFINITY, self.unknown_excitation());
    }

    /// F over the last so many intervals, up to time `until`, was not what was read, but for a white force of that
    /// intensity, N² s.
    pub(super) fn leave_open(&mut self, count: u64, until: f64, unseen: f64) {
        let excitation = self.intake.excitation;
        let open = |Reading { sample, unseen: open, .. }: &mut Reading| {
            if sample.t <= until {
                *open += unseen;
                sample.excitation = excitation.expected(sample.excitation);
            }
        };
        let recorded = self.intake.quarantine.amend(count, open);
        self.window.amend(recorded, open);
        self.segment.begin_run(&self.window);
        self.restart_law(self.as_read());
    }

    /// Intensity of the white force, N² s, that an excitation of which nothing is known is like.
    pub(super) fn unknown_excitation(&self) -> f64 {
        let force = self.intake.excitation.size();
        2.0 * force * force * self.segment.scales.natural_time().min(1.0)
    }

    /// Whether one offset since the last outage explains what several coefficients would have to change for: what an
    /// outage brings may be the one as well as the other, and until that is decided there is no alarm.
    pub(super) fn is_offset(&mut self, suspect: &Suspect) -> bool {
        // what an outage brought is not followed under a law that does not explain its record
        let asked = self.intake.after_outage.likeliest().filter(|_| self.monitor.law.explains);
        let Some(returned) = asked else { return false };
        let odds = (returned.evidence - (1.0 - LINEAR) * suspect.evidence).min(returned.odds);
        let has_turned = returned.since > TURNED * self.segment.scales.natural_time();
        let told = self.intake.after_outage.is_found() || has_turned && returned.against_other > DECISIVE;
        let open = odds.abs() < DECISIVE || odds > 0.0 && !told;
        self.intake.undecided = open && returned.since < UNDECIDED;
        if self.intake.undecided || odds < 0.0 {
            return self.intake.undecided;
        }
        self.correct_offset(&returned);
        true
    }

    fn correct_offset(&mut self, returned: &Returned) {
        let Returned { channel, offset, since, .. } = *returned;
        let is_first = !self.intake.after_outage.is_found();
        self.intake.after_outage.correct(returned);
        self.take_off(channel, offset, since);
        self.segment.begin_run(&self.window);
        if is_first {
            self.monitor.law.forget_since_outage();
        }
        self.restart_law(returned.filter);
    }

    /// Takes an offset off what was read since an outage, `since` s ago; returns the number of the first sample after.
    fn take_off(&mut self, channel: Channel, offset: f64, since: f64) -> u64 {
        self.intake.quarantine.take_off(channel, offset);
        let count = self.count_since(self.now() - since - 0.5 * self.window.pace());
        let take_off = |Reading { sample, .. }: &mut Reading| match channel {
            Channel::Q => sample.q -= offset,
            Channel::Qd => sample.qd -= offset,
        };
        self.intake.quarantine.amend(u64::MAX, take_off);
        self.window.amend(count, take_off);
        self.window.end() - count
    }

    /// Where the law seems to have switched after an offset was told, and another law since the outage is as likely as
    /// that: the outage brought the law and no offset. Returns the number of the first sample after it.
    pub(super) fn take_back_offset(&mut self) -> Option<u64> {
        let (channel, taken, since) = self.intake.after_outage.in_doubt()?;
        Some(self.take_off(channel, -taken, since))
    }

    /// What spoke for a switch was a fault: the law in use goes on from a state that the fault did not touch.
    fn restart_law(&mut self, filter: Filter) {
        self.clear_suspicion();
        self.monitor.law.run.filter = filter;
        self.monitor.late_channels = None;
        self.monitor.prediction.restart(filter.state(), self.window.sample(self.window.ready() - 1).t);
    }

    /// The state of the law in use, of which no more is known than was read last.
    fn as_read(&self) -> Filter {
        let Filter { mean, covariance: [[qq, _], [_, vv]] } = self.monitor.law.run.filter;
        let [q, qd] = self.monitor.law.noise.sensor;
        Filter::begin(mean, [qq.max(q), vv.max(qd)])
    }

    fn clear_suspicion(&mut self) {
        self.intake.undecided = false;
        self.monitor.bank.clear();
        self.monitor.unusual_since = None;
        self.enter(Event::SuspicionCleared);
    }
}
