//! The identifier's face to its callers.

use super::force_law::ForceTracker;
use super::problem::Problem;
use super::publication::Publication;
use super::saved::{SavedLaws, SavedLawsError};
use super::settings::{Channels, Method, Settings, SettingsError};
use super::tracker::Tracker;
use crate::evidence::Missing;
use crate::law::{Model, ModelError, Term};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// One measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Time, s.
    pub t: f64,
    /// Displacement; ignored where [`super::Channels`] says it is not measured.
    pub q: f64,
    /// Velocity; ignored where it is not measured.
    pub qd: f64,
    /// Excitation; ignored where it is not measured.
    pub excitation: f64,
}

/// Why a sample was not used. Nothing else changes.
#[derive(Clone, Copy, Debug, PartialEq, Error, Serialize, Deserialize)]
pub enum Skipped {
    /// A measured channel is NaN or infinite.
    #[error("the sample at t = {t} s has a {channel} that is no finite number: skipped")]
    NotFinite {
        /// Time of the sample, s.
        t: f64,
        /// The channel at fault: `t`, `q`, `qd` or `F`.
        channel: &'static str,
    },
    /// Time did not advance.
    #[error("the sample at t = {t} s does not come after the one at {previous} s: skipped")]
    NotLater {
        /// Time of the sample, s.
        t: f64,
        /// Time of the last accepted one, s.
        previous: f64,
    },
    /// The stream is faster than `sample_time`; thinned.
    #[error("the sample at t = {t} s comes sooner than sample_time after the last one: thinned")]
    TooSoon {
        /// Time of the sample, s.
        t: f64,
    },
}

/// What the identifier is doing; numbered as in the FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Status {
    /// No law yet.
    Acquiring = 1,
    /// The law explains the data.
    Tracking = 2,
    /// Evidence of a switch is growing.
    SwitchSuspected = 3,
    /// A switch was detected; the new law is being identified.
    ReIdentifying = 4,
}

impl Status {
    /// Every status, in the order of the FMU's enumeration.
    pub const ALL: [Status; 4] = [Status::Acquiring, Status::Tracking, Status::SwitchSuspected, Status::ReIdentifying];

    /// The name used in reports and in the FMU.
    pub fn id(self) -> &'static str {
        match self {
            Status::Acquiring => "acquiring",
            Status::Tracking => "tracking",
            Status::SwitchSuspected => "switch suspected",
            Status::ReIdentifying => "re-identifying",
        }
    }
}

/// A published coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coefficient {
    /// What it multiplies.
    pub term: Term,
    /// Its last known value; 0 before the first, and for a "maybe" term that the law does not have.
    pub value: f64,
    /// Its std; `None` while the coefficient is not known.
    pub std: Option<f64>,
    /// How many more seconds of such a record it needs until it is known as well as a law that is vouched for asks; 0 when it is, `None`
    /// while nothing can be said.
    pub needed: Option<f64>,
}

/// All other outputs after a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Switches detected so far.
    pub switch_count: u32,
    /// Estimated instant at which the present stage began, s.
    pub switch_time: f64,
    /// Its std, s; `None` in the first stage, which no switch opened.
    pub switch_time_std: Option<f64>,
    /// Time of the alarm that ended the last stage, s; `None` in the first one.
    pub detection_time: Option<f64>,
    /// First time at which the present law was vouched for (stated covariance puts e below 0.05²), s.
    pub identified_time: Option<f64>,
    /// Number of the law in use among those that were vouched for, 1 for the first of all; `None` while there is none.
    pub law_number: Option<u32>,
    /// Whether that law was recognised as one seen before, not identified anew.
    pub recognised: bool,
    /// What the identifier is doing.
    pub status: Status,
    /// Whether the present law is validated; every std is known then.
    pub valid: bool,
    /// Whether the coefficients move: they are followed as they go, and vouched for as long as their stated e is below 0.2².
    pub drifting: bool,
    /// Deviation of eq. (4) over T; 0 before the first law.
    pub deviation: f64,
    /// The deviation that is out of the ordinary.
    pub threshold: f64,
    /// Force that the law predicts for this instant; 0 for a law of motion.
    pub prediction_force: f64,
    /// Displacement that the law predicts for this instant.
    pub prediction_q: f64,
    /// Velocity that the law predicts for this instant.
    pub prediction_qd: f64,
    /// The effect of the catalogue that the present law lacks most; `None` where none stands out.
    pub missing: Option<Missing>,
    /// Share of the force's variance that the published coefficients explain: of a law without inertia, and of one of motion where they are
    /// those of the weak form; `None` for a law of motion that states its own std, and while nothing is known.
    pub explained: Option<f64>,
    /// Estimated std of the displacement's sensor noise; `None` while not known or not measured.
    pub noise_q: Option<f64>,
    /// Estimated std of the velocity's sensor noise; `None` while not known or not measured.
    pub noise_qd: Option<f64>,
    /// Estimated std of what the force has besides the law; `None` while not known, and for a law of motion.
    pub noise_force: Option<f64>,
}

/// Why an identifier cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BuildError {
    /// The settings are refused.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The model is refused.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The known laws are refused.
    #[error(transparent)]
    Laws(#[from] SavedLawsError),
    /// A law whose output nobody measured.
    #[error(
        "[terms] has no inertia, so that F is what the law gives, but F is not measured: name its column ([columns] F = \"…\"), or add \
         inertia = \"fit\" for a law of motion"
    )]
    NoForce,
    /// A term of q where q is not measured.
    #[error(
        "[terms]: \"{key}\" depends on q, which is not measured: with F as the output nothing else tells where q began; leave the term out, or \
         measure q"
    )]
    NoDisplacement {
        /// The key of the term.
        key: String,
    },
    /// The publication's method has laws of motion only.
    #[error(
        "[terms] has no inertia: the publication's method identifies laws of motion; leave --method out, or add inertia = \"fit\""
    )]
    PublishedForceLaw,
}

/// The procedure at work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Engine {
    Default(Box<Tracker>),
    Publication(Box<Publication>),
    Force(Box<ForceTracker>),
}

impl Engine {
    fn new(problem: &Problem, settings: &Settings) -> Engine {
        match settings.method {
            _ if problem.is_force_law() => Engine::Force(Box::new(ForceTracker::new(problem, settings))),
            Method::Default => Engine::Default(Box::new(Tracker::new(problem, settings))),
            Method::Publication => Engine::Publication(Box::new(Publication::new(problem, settings))),
        }
    }
}

/// The streaming identifier of one model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identifier {
    settings: Settings,
    problem: Problem,
    engine: Engine,
    potential: Vec<Term>,
    coefficients: Vec<Coefficient>,
    output: Output,
    /// What the caller sees of both.
    shown: (Vec<Coefficient>, Output),
    last: Option<f64>,
}

impl Identifier {
    /// Builds an identifier in its initial state; everything that a step needs is allocated here.
    ///
    /// # Errors
    /// [`BuildError`] when settings or model are refused.
    pub fn new(model: &Model, settings: Settings) -> Result<Identifier, BuildError> {
        check(model, &settings)?;
        let coefficients: Vec<Coefficient> = model
            .terms
            .iter()
            .map(|entry| Coefficient { term: entry.term, value: 0.0, std: None, needed: None })
            .collect();
        let problem = Problem::new(model, &settings);
        let engine = Engine::new(&problem, &settings);
        let potential = model.potential.clone();
        let output = Output {
            switch_count: 0,
            switch_time: 0.0,
            switch_time_std: None,
            detection_time: None,
            identified_time: None,
            law_number: None,
            recognised: false,
            status: Status::Acquiring,
            valid: false,
            drifting: false,
            deviation: 0.0,
            threshold: 0.0,
            prediction_force: 0.0,
            prediction_q: 0.0,
            prediction_qd: 0.0,
            explained: None,
            noise_q: None,
            noise_qd: None,
            noise_force: None,
            missing: None,
        };
        let shown = (coefficients.clone(), output);
        Ok(Identifier { settings, problem, engine, potential, coefficients, output, shown, last: None })
    }

    /// Takes one sample.
    ///
    /// # Errors
    /// [`Skipped`] says why the sample was not used; the identifier goes on unchanged.
    pub fn step(&mut self, sample: Sample) -> Result<(), Skipped> {
        self.accept(&sample)?;
        self.last = Some(sample.t);
        let sample = self.measured(sample);
        let Identifier { settings, problem, engine, coefficients, output, shown, .. } = self;
        match engine {
            Engine::Default(tracker) => tracker.step(problem, settings, sample, coefficients, output),
            Engine::Publication(publication) => publication.step(problem, settings, sample, coefficients, output),
            Engine::Force(tracker) => tracker.step(problem, settings, sample, coefficients, output),
        }
        shown.0.copy_from_slice(coefficients);
        shown.1 = *output;
        if let Engine::Default(tracker) = engine {
            tracker.show(problem, settings, &mut shown.0, &mut shown.1);
        }
        Ok(())
    }

    /// The sample with 0 in the channels that are not measured: whatever stands there must not count.
    fn measured(&self, sample: Sample) -> Sample {
        let channels = self.settings.channels;
        let or_zero = |measured: bool, value: f64| if measured { value } else { 0.0 };
        Sample {
            t: sample.t,
            q: or_zero(channels.q, sample.q),
            qd: or_zero(channels.qd, sample.qd),
            excitation: or_zero(channels.excitation, sample.excitation),
        }
    }

    fn accept(&self, sample: &Sample) -> Result<(), Skipped> {
        let channels = self.settings.channels;
        let values = [
            ("t", true, sample.t),
            ("q", channels.q, sample.q),
            ("qd", channels.qd, sample.qd),
            ("F", channels.excitation, sample.excitation),
        ];
        if let Some((channel, ..)) = values.into_iter().find(|(_, used, value)| *used && !value.is_finite()) {
            return Err(Skipped::NotFinite { t: sample.t, channel });
        }
        let t = sample.t;
        match self.last {
            Some(previous) if t <= previous => Err(Skipped::NotLater { t, previous }),
            Some(previous) if t - previous < 0.5 * self.settings.sample_time => Err(Skipped::TooSoon { t }),
            _ => Ok(()),
        }
    }

    /// The laws that it knows, the present one among them where it is vouched for; none of the publication's method.
    pub fn known_laws(&self) -> SavedLaws {
        match &self.engine {
            Engine::Default(tracker) => tracker.known_laws(&self.problem, &self.output),
            Engine::Publication(_) | Engine::Force(_) => SavedLaws::default(),
        }
    }

    /// The same identifier with laws to recognise, from before its first sample; the publication's method recognises none.
    ///
    /// # Errors
    /// [`SavedLawsError`] where they belong to another model or make no sense.
    pub fn with_known_laws(mut self, saved: &SavedLaws) -> Result<Identifier, SavedLawsError> {
        if let Engine::Default(tracker) = &mut self.engine {
            tracker.learn(&self.problem, saved)?;
        }
        Ok(self)
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The published coefficients, in the order of the model's terms.
    pub fn coefficients(&self) -> &[Coefficient] {
        &self.shown.0
    }

    /// All other outputs after the last step.
    pub fn output(&self) -> &Output {
        &self.shown.1
    }

    /// Log-likelihood per measurement of the present stage's law, to compare settings on one record by; `None` while there is no
    /// law, and for the publication's method, which has none.
    pub fn likelihood(&self) -> Option<f64> {
        match &self.engine {
            Engine::Default(tracker) => tracker.likelihood(),
            Engine::Publication(_) | Engine::Force(_) => None,
        }
    }

    /// What the data since the present stage's start cannot determine: single terms, or combinations such as
    /// `qdd and q together`; and the model's total time derivatives in U₀, which no data can.
    pub fn unidentifiable(&self) -> Vec<String> {
        let from_data = match &self.engine {
            Engine::Default(tracker) => tracker.unidentifiable(&self.problem),
            Engine::Publication(publication) => publication.unidentifiable(&self.problem),
            Engine::Force(tracker) => tracker.unidentifiable(&self.problem),
        };
        let always = self.potential.iter().map(|term| format!("{term} in [potential]"));
        from_data.into_iter().chain(always).collect()
    }
}

/// Checks that the model can be identified sample by sample from what is measured.
pub(super) fn check(model: &Model, settings: &Settings) -> Result<(), BuildError> {
    settings.check()?;
    model.check()?;
    match model.is_force_law() {
        true => check_force_law(model, settings)?,
        false => model.check_inertia()?,
    }
    model.check_streaming()?;
    Ok(model.check_free(settings.channels.excitation)?)
}

/// Checks that a law whose output is F can be identified from what is measured.
fn check_force_law(model: &Model, settings: &Settings) -> Result<(), BuildError> {
    model.check_force_law()?;
    let Channels { q, excitation, .. } = settings.channels;
    if settings.method == Method::Publication {
        return Err(BuildError::PublishedForceLaw);
    }
    if !excitation {
        return Err(BuildError::NoForce);
    }
    match model.terms.iter().find(|entry| !q && entry.term.uses_displacement()) {
        Some(entry) => Err(BuildError::NoDisplacement { key: entry.key.clone() }),
        None => Ok(()),
    }
}
