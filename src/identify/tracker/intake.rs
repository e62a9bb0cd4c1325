//! From the stream into the record: what may be a sensor's fault is held until it has a name.

use super::faulted::expected;
use super::state::{Fitting, Intake, Setup, Tracker};
use crate::estimation::{OUTLYING, TWENTY_TO_ONE};
use crate::identify::faults::{Against, Expected, Lateness, Repeat, Stray};
use crate::identify::problem::Problem;
use crate::identify::reading::Reading;
use crate::identify::report::{SensorState, Status};
use crate::identify::sample::Sample;
use crate::identify::settings::Settings;
use crate::law::Hold;

/// Readings that enter the record in a step: what was held is made up for at this pace.
const CATCH_UP: usize = 4;

/// No motion is this many times as large a moment before it becomes known, within some hundred samples.
const ABSURD: f64 = 1e3;

/// Samples within which it is known, unless gaps come between: later on a motion may have decayed.
const BEGINNING: u64 = 300;

/// Samples that tell how large it is by then.
const LATEST: usize = 50;

/// Samples after which a law that gets none is not that of the present any more.
const FRESH: usize = 2;

impl Tracker {
    /// Takes a sample that is a number.
    pub fn step(&mut self, problem: &Problem, settings: &Settings, sample: Sample) {
        let setup = Setup { problem, settings };
        let window = &self.window;
        let mut reading =
            self.intake.excitation.take(sample, self.intake.force.length(), |dt, moved| window.missed(dt, moved));
        self.weigh_stray(problem, &mut reading);
        self.follow_excitation(problem, &mut reading);
        self.hold_against_law(setup, reading);
        for _ in 0..CATCH_UP {
            let Some(reading) = self.intake.quarantine.next() else { break };
            self.take(setup, reading);
        }
        if !self.intake.motion_known && self.intake.quarantine.knows_motion() {
            self.intake.motion_known = true;
            self.judge_beginning();
        }
    }

    /// Readings of the stream's first moment are held against nothing. Where the motion, known by now, was at none of
    /// them the record begins after them.
    fn judge_beginning(&mut self) {
        let window = &self.window;
        let end = window.end();
        let of = |number: u64| [window.sample(number).q, window.sample(number).qd];
        let usual = |channel: usize| {
            let mut sizes: [f64; LATEST] = std::array::from_fn(|back| {
                of((end - 1).saturating_sub(back as u64).max(window.oldest()))[channel].abs()
            });
            sizes.sort_unstable_by(f64::total_cmp);
            sizes[LATEST / 2]
        };
        let size = [usual(0), usual(1)];
        let is_beyond = |value: f64, size: f64| size > 0.0 && value.abs() > ABSURD * size;
        let is_absurd = |number| of(number).into_iter().zip(size).any(|(value, size)| is_beyond(value, size));
        if end <= BEGINNING && !self.monitor.law.running && (window.oldest()..end).any(is_absurd) {
            self.fitting = Fitting::Starting;
            self.intake.quarantine.forget_size();
            self.weak_form.restart();
            self.begin_weak_rows(end);
        }
    }

    /// A burst of F that would have moved q̇ by more than its readings scatter is told by q̇ itself: it acted, or the
    /// motion has been kicked the other way. Of a smaller one nobody knows.
    fn weigh_stray(&mut self, problem: &Problem, reading: &mut Reading) {
        let (ended, law) = (self.intake.excitation.ended(), &self.monitor.law);
        let Some(Stray { readings, square }) = ended.filter(|_| self.tells_readings()) else { return };
        let motion = problem.motion(&law.terms, &law.all);
        let dt = reading.sample.t - self.intake.quarantine.now();
        let push = f64::from(readings) * square * (dt / motion.mass(law.run.filter.mean[0])).powi(2);
        if push < OUTLYING * OUTLYING * law.noise.sensor[1] {
            reading.unseen += square * dt;
            self.intake.excitation.blame();
            if readings > 1 {
                self.leave_open(u64::from(readings - 1), f64::INFINITY, square * dt);
            }
        }
    }

    /// An F that is lost says nothing until it varies again, on its course.
    fn follow_excitation(&mut self, problem: &Problem, reading: &mut Reading) {
        let (run, length, last) = (self.intake.force.run(), self.intake.force.length(), self.intake.quarantine.now());
        let repeat = self.intake.force.take(reading.sample.excitation, f64::INFINITY, 0.0, f64::INFINITY);
        let varies = !matches!(repeat, Repeat::Rare { .. });
        if varies && run > TWENTY_TO_ONE && !self.intake.force_lost {
            self.intake.stood_still = Some([last - length as f64 * self.window.pace(), last]);
        }
        if self.intake.force_lost && problem.channels.excitation {
            reading.unseen += self.unknown_excitation();
            reading.sample.excitation = self.intake.excitation.expected(reading.sample.excitation);
            self.intake.force_lost = !varies || self.intake.excitation.is_away();
            // nothing else says then that it is not what acts
            if !self.monitor.law.running && self.standing_force().is_none() {
                self.intake.force_lost = false;
            }
        }
    }

    /// A validated law that explains its record says what a reading can be, and what F did, unless it may be another
    /// one since an outage, or a sensor may have come back off: nothing is held until that is twenty times less likely.
    fn tells_readings(&self) -> bool {
        let law = &self.monitor.law;
        let is_known = self.regime.law().is_some() && !self.regime.is_unconfirmed();
        let is_as_before = !self.intake.undecided && self.intake.after_outage.lead() < -TWENTY_TO_ONE;
        law.running && law.explains && is_known && is_as_before
    }

    /// What may be a sensor's fault is held against such a law, or without one against the motion itself.
    fn hold_against_law(&mut self, setup: Setup, reading: Reading) {
        let Setup { problem, .. } = setup;
        let known = self.tells_readings().then(|| self.decision().caution());
        let stuck = self.standing_force().filter(|_| !self.intake.force_lost);
        let noise = setup.known_noise(&self.difference_noise);
        let Tracker { intake, monitor, window, segment, regime, .. } = self;
        let law = &monitor.law;
        let size = intake.quarantine.size();
        let force = if problem.channels.excitation { intake.excitation.size() } else { 0.0 };
        let expected = known.map(|caution| expected(problem, law, caution, &segment.scales, size));
        let expected = expected.map(|expected| Expected { stuck, ..expected });
        let against = match (&expected, noise) {
            _ if problem.timing.hold == Hold::BandLimited => Against::Nothing,
            (Some(expected), _) => Against::Law(expected, law.run.filter),
            (None, Some(noise)) => Against::Motion(noise, force),
            (None, None) => Against::Nothing,
        };
        let by_law = matches!(against, Against::Law(..));
        intake.quarantine.take(reading, problem.timing.hold, window.pace(), against);
        let (in_doubt, is_stuck) = (intake.quarantine.is_in_doubt(), intake.quarantine.found_stuck_force());
        if let Some((later, since)) = intake.quarantine.found_late() {
            let first = (window.end() + intake.quarantine.behind() as u64).saturating_sub(since as u64);
            intake.late = Some(Lateness { later: later.into(), first });
        }
        let unread = intake.quarantine.found_unread();
        if unread != [false; 2] {
            window.leave_out_repeated(unread);
            segment.begin_run(window);
            // what looks like a motion that comes late has made the first law of such a record
            intake.begin_anew = regime.law().is_none();
        }
        let kicked = intake.quarantine.found_kick() && !by_law;
        match intake.excitation.left().filter(|_| !intake.force_lost) {
            Some(readings) if by_law && in_doubt => {
                intake.quarantine.settle();
                self.lose_excitation(u64::from(readings));
            }
            // without a law F as it is read may act in many ways, but not where it left its course beside a kick
            Some(readings) if kicked => self.leave_open(u64::from(readings), f64::INFINITY, self.unknown_excitation()),
            _ if is_stuck => self.lose_excitation(self.intake.force.length()),
            _ => {}
        }
    }

    /// What the sensors of q, q̇ and F do.
    pub(super) fn sensors(&self) -> [SensorState; 3] {
        let Intake { excitation, quarantine, force, force_lost, .. } = &self.intake;
        let [q, qd, kicked] = quarantine.sensors();
        let force = match (force_lost, excitation.is_faulty()) {
            (true, _) if force.length() > 0 || !excitation.is_away() => SensorState::Stuck,
            (true, _) | (false, true) => SensorState::Outlier,
            (false, false) => kicked,
        };
        [q, qd, force]
    }

    /// Whether the law in use has been held against the last samples, of which readings counted and F was known, and
    /// nothing is as likely as it.
    pub(super) fn is_fresh(&self) -> bool {
        let Intake { quarantine, force_lost, undecided, .. } = &self.intake;
        let silence = (FRESH as f64 + 0.5) * self.window.pace();
        quarantine.behind() <= FRESH && quarantine.silence() < silence && !force_lost && !undecided
    }

    /// The status with what is being held: a switch is suspected as soon as that speaks for one.
    pub(super) fn status(&self) -> Status {
        match self.regime.status() {
            Status::Tracking if self.intake.quarantine.suspects_law() => Status::SwitchSuspected,
            status => status,
        }
    }
}
