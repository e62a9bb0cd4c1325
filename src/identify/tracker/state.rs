//! All that the identifier holds, in groups of what changes together.

use super::published::Published;
use super::regime::{Event, Regime};
use super::sighting::Library;
use crate::estimation::{DifferenceNoise, KnownEffect};
use crate::evidence::{Bank, INERTIA_SPREAD, SWITCH_SIZE};
use crate::identify::change::{LawInUse, Prediction, false_alarm_level};
use crate::identify::drift::{AugmentedDrift, WeakRowDrift};
use crate::identify::faults::{
    AfterOutage, ExcitationGate, Hindsight, LateChannels, Lateness, Quarantine, Repetition, StandingForce,
};
use crate::identify::functional::WeakForm;
use crate::identify::problem::Problem;
use crate::identify::segment::{MotionScales, Prior, Segment, WeakStart};
use crate::identify::settings::Settings;
use crate::identify::window::Window;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Hypotheses of a switch that are kept: each costs its share of every step.
const HYPOTHESES: usize = 20;

/// A segment with fewer samples than this is young, and refined at the faster pace: its law is not linear within its
/// std yet.
pub(super) const YOUNG: u64 = 5000;

/// Samples after which an unvalidated law is contested by the latest record alone, and the unit of how long that may
/// take.
pub(super) const FRESH_START: u64 = 12_000;

/// After so many runs in a row what a law leaves unexplained is no matter of a fit that has not settled, nor is one
/// that had settled before on its way to anything better.
pub(super) const LASTS: u32 = 3;

/// Std, in the coefficient's own unit, of one of which nothing is known.
pub(super) const NOTHING_KNOWN: f64 = 1e9;

/// Overdispersion of a record that is far from explained: twice that from which on a record counts as unexplained.
const FAR: f64 = 10.0;

/// What is sought, and how: fixed at construction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setup<'a> {
    pub(super) problem: &'a Problem,
    pub(super) settings: &'a Settings,
}

/// The identifier of a law of motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tracker {
    /// Readings that may be a sensor's fault, on their way into the record.
    pub(super) intake: Intake,
    pub(super) window: Window,
    pub(super) regime: Regime,
    pub(super) published: Published,
    /// First coefficients, from weak rows.
    pub(super) start: WeakStart,
    pub(super) schedule: Schedule,
    pub(super) fitting: Fitting,
    pub(super) segment: Segment,
    /// Another fit of the record, or of its later part.
    pub(super) alternative: Segment,
    pub(super) monitor: Monitor,
    pub(super) belief: ChangeBelief,
    pub(super) library: Library,
    pub(super) weak_row_drift: WeakRowDrift,
    pub(super) augmented_drift: AugmentedDrift,
    /// Since which sample coefficients have been said to move, where they have.
    pub(super) drifted: Option<u64>,
    pub(super) history: History,
    /// The law where errors are none of the sensors'.
    pub(super) weak_form: WeakForm,
    /// The sensors' noise before any law.
    pub(super) difference_noise: DifferenceNoise,
}

/// What stands between the stream and the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Intake {
    pub(super) excitation: ExcitationGate,
    pub(super) quarantine: Quarantine,
    /// Whether the motion has been known at some time.
    pub(super) motion_known: bool,
    pub(super) after_outage: AfterOutage,
    pub(super) hindsight: Hindsight,
    /// Since when one comes late, as has just been found.
    pub(super) late: Option<Lateness>,
    /// Whether all that was told so far is of readings that were none.
    pub(super) begin_anew: bool,
    /// Whether an alarm waits for the decision between another law and an offset.
    pub(super) undecided: bool,
    /// How often F repeats its value.
    pub(super) force: Repetition,
    /// First and last time at which it did so last where it varied before, s.
    pub(super) stood_still: Option<[f64; 2]>,
    /// Whether F has been found stuck and has not varied since.
    pub(super) force_lost: bool,
    /// Whether it acts as it is read again all the same.
    pub(super) standing_force: StandingForce,
}

/// How far the fit of the record has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Fitting {
    /// Weak rows are gathered for first coefficients.
    Starting,
    /// The segment is refined.
    Refining,
    /// So is another fit beside it.
    Contested,
}

/// When other fits of the record are begun.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Schedule {
    /// Number of the sample from which on the weak rows are.
    pub(super) rows_from: u64,
    /// How often they have begun anew since the record's beginning.
    pub(super) afresh: u32,
    /// Sample from which on they are asked for coefficients.
    pub(super) next_guess: u64,
    /// Sample from which on a fit with all error in the sensors is tried.
    pub(super) next_sensor_fit: u64,
}

/// The law in use beside the stream, and what speaks against it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Monitor {
    pub(super) law: LawInUse,
    pub(super) bank: Bank,
    pub(super) prediction: Prediction,
    /// Whether channels have begun to come late against it, as long as nothing else has disturbed it.
    pub(super) late_channels: Option<LateChannels>,
    /// Since which sample the evidence of a switch is more than chance brings now and then.
    pub(super) unusual_since: Option<u64>,
    /// Every free term: what a switch may move.
    pub(super) every_term: Vec<bool>,
}

/// What is believed of a law before its record says anything.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ChangeBelief {
    /// τ of each coefficient: how far a switch moves it, std.
    pub(super) spread: Vec<f64>,
    /// The coefficients that a new law is looked for from …
    pub(super) from: Vec<f64>,
    /// … and about.
    pub(super) centre: Vec<f64>,
    /// The effect that the model lacks.
    pub(super) effect: Option<KnownEffect>,
    /// Samples that sensor variances and scales are known from; 0 before there was a law.
    pub(super) samples: f64,
    /// How large the motion was before the last switch.
    pub(super) scales: MotionScales,
}

/// What laws of late were like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct History {
    /// Whether the last law that was validated over a long record explained it.
    pub(super) explained: bool,
    /// Samples that laws of late took to be validated.
    pub(super) convergence_length: u64,
    /// Since which sample a law that was validated is contested again.
    pub(super) refuted_at: u64,
    /// Runs in a row after which the segment seemed to hold several laws.
    pub(super) mixed_runs: u32,
}

impl ChangeBelief {
    /// It as a segment takes it, about `centre`; `structure` are the terms of the law before, where there was one.
    pub(super) fn prior<'a>(&'a self, centre: &'a [f64], structure: Option<&'a [bool]>) -> Prior<'a> {
        Prior {
            centre,
            std: &self.spread,
            log_inertia: INERTIA_SPREAD,
            structure,
            noise_weight: self.samples,
            effect: self.effect,
            scales: &self.scales,
        }
    }
}

impl Monitor {
    /// No law is in use any more.
    pub(super) fn stop(&mut self) {
        (self.law.running, self.unusual_since, self.late_channels) = (false, None, None);
        self.prediction.clear();
    }
}

impl Tracker {
    /// Room for everything.
    pub fn new(problem: &Problem, settings: &Settings) -> Tracker {
        let n = problem.n();
        let capacity = (settings.max_window / settings.sample_time).ceil() as usize;
        Tracker {
            intake: Intake {
                excitation: ExcitationGate::default(),
                quarantine: Quarantine::new(problem.channels.of_motion()),
                motion_known: false,
                after_outage: AfterOutage::new(),
                hindsight: Hindsight::new(),
                late: None,
                begin_anew: false,
                undecided: false,
                force: Repetition::default(),
                stood_still: None,
                force_lost: false,
                standing_force: StandingForce::default(),
            },
            window: Window::new(capacity, problem.channels, problem.timing.hold),
            regime: Regime::Acquiring,
            published: Published::new(problem),
            start: WeakStart::new(problem, capacity),
            schedule: Schedule::default(),
            fitting: Fitting::Starting,
            segment: Segment::new(problem),
            alternative: Segment::new(problem),
            monitor: Monitor {
                law: LawInUse::new(problem),
                bank: Bank::new(n, HYPOTHESES),
                prediction: Prediction::new(settings),
                late_channels: None,
                unusual_since: None,
                every_term: vec![true; n],
            },
            belief: ChangeBelief {
                spread: vec![1.0; n],
                from: vec![0.0; n],
                centre: vec![0.0; n],
                effect: None,
                samples: 0.0,
                scales: MotionScales::new(n),
            },
            library: Library::new(problem),
            weak_row_drift: WeakRowDrift::new(problem, capacity),
            augmented_drift: AugmentedDrift::new(problem),
            drifted: None,
            history: History::default(),
            weak_form: WeakForm::new(problem),
            difference_noise: DifferenceNoise::default(),
        }
    }

    /// Goes to the regime that follows.
    pub(super) fn enter(&mut self, event: Event) {
        self.regime = self.regime.after(event);
        match event {
            event if event.ends_law() => self.published.identified = None,
            Event::LawRecognised(..) | Event::DriftValidated(true) => self.call_valid(),
            _ => {}
        }
    }

    /// The present law is valid from now on, where it has not been before.
    pub(super) fn call_valid(&mut self) {
        self.published.identified = self.published.identified.or(Some(self.now()));
    }

    /// Log-likelihood per measurement of the present segment; none before its first run.
    pub fn likelihood(&self) -> Option<f64> {
        let known = self.is_refining() && self.segment.fit.likelihood.is_finite();
        known.then_some(self.segment.fit.likelihood)
    }

    /// Whether the segment has a law that is being refined.
    pub(super) fn is_refining(&self) -> bool {
        self.fitting != Fitting::Starting
    }

    /// Time of the last sample, s.
    pub(super) fn now(&self) -> f64 {
        self.window.sample(self.window.end() - 1).t
    }

    /// Time between the last two samples, s: it hides when in it a law switched.
    pub(super) fn last_interval(&self) -> f64 {
        self.now() - self.window.sample(self.window.end().max(2) - 2).t
    }

    /// Samples in the segment's record.
    pub(super) fn record_length(&self) -> u64 {
        self.segment.length(self.window.ready())
    }

    /// Evidence that chance reaches once in the false-alarm interval, nats, were every sample a trial of its own.
    pub(super) fn false_alarm_level(&self, settings: &Settings) -> f64 {
        false_alarm_level(settings, self.window.pace())
    }

    /// Time in which the motion goes there and back, a natural period, as a part of the record; so many samples where
    /// the law has hardly a stiffness. From 1 on it has not shown what the law lacks, or would be with others of its
    /// coefficients.
    pub(super) fn there_and_back(&self, longest: f64) -> f64 {
        let first = self.window.sample(self.segment.start.max(self.window.oldest())).t;
        (longest * self.window.pace()).min(TAU * self.segment.scales.natural_time()) / (self.now() - first)
    }

    /// The same of the record that the law in use is known from; 0 of a law that came back.
    pub(super) fn youth(&self) -> f64 {
        if self.regime.recognition().is_some() { 0.0 } else { self.there_and_back(YOUNG as f64) }
    }

    /// Whether the law explains its record down to the sensors' noise, and that is long enough to tell.
    pub(super) fn explains(&self) -> bool {
        !self.segment.fit.process_matters && self.youth() < 1.0
    }

    /// Whether the segment's law does not explain its record, where one before it did.
    pub(super) fn is_unexplained(&self) -> bool {
        self.history.explained && self.regime.recognition().is_none() && !self.segment.fit.explains
    }

    /// Whether the segment's record seems to hold several laws: a law before explained its own down to the sensors'
    /// noise, this one does not. A record that stays so for long and is not far from explained lacks an effect instead.
    pub(super) fn is_mixed(&self) -> bool {
        let short = self.record_length() < FRESH_START;
        self.is_unexplained() && (short || self.segment.fit.overdispersion > FAR)
    }

    /// Whether there was a law before: the next one has its sensors, and is looked for about it.
    pub(super) fn follows_a_law(&self) -> bool {
        self.belief.samples > 0.0
    }

    /// τ of each coefficient: a change whose force moves the acceleration by [`SWITCH_SIZE`] of its RMS.
    pub(super) fn set_spread(&mut self, problem: &Problem) {
        let scales = &self.segment.scales;
        for index in 0..problem.n() {
            let slope = scales.slope(index);
            let acceleration = match problem.free_inertia() == Some(index) {
                true => scales.acceleration(),
                false => scales.restoring_acceleration(),
            };
            self.belief.spread[index] = if slope > 0.0 { SWITCH_SIZE * acceleration / slope } else { NOTHING_KNOWN };
        }
    }
}

impl Setup<'_> {
    /// Sensor variances before any law: as set, or from differences.
    pub(super) fn first_noise(&self, differences: &DifferenceNoise) -> [f64; 2] {
        self.known_noise(differences).unwrap_or_else(|| self.noise_or([0.0; 2]))
    }

    /// The same; none before there are enough differences.
    pub(super) fn known_noise(&self, differences: &DifferenceNoise) -> Option<[f64; 2]> {
        differences.variance().map(|found| self.noise_or(found))
    }

    fn noise_or(&self, found: [f64; 2]) -> [f64; 2] {
        let given = self.settings.given_noise();
        [0, 1].map(|index| given[index].unwrap_or(found[index] + f64::MIN_POSITIVE))
    }
}
