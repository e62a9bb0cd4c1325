//! The identifier: which procedure is at work, what a sample is checked for, what the caller sees.

use super::check::{BuildError, check};
use super::faults::{Clock, Sender};
use super::force_law::ForceTracker;
use super::library::{SavedLaws, SavedLawsError};
use super::problem::Problem;
use super::published_method::Publication;
use super::report::{Coefficient, Output, SensorState};
use super::sample::{Sample, Skipped};
use super::settings::{Method, Settings};
use super::timing::Alignment;
use super::tracker::Tracker;
use crate::law::{Model, Term};
use serde::{Deserialize, Serialize};

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
    clock: Clock,
    /// A sample after a gap, which is read once the next one comes later.
    waiting: Option<Sample>,
    sender: Sender,
    alignment: Alignment,
}

impl Identifier {
    /// Builds an identifier in its initial state; everything that a step needs is allocated here.
    ///
    /// # Errors
    /// [`BuildError`] when settings or model are refused.
    pub fn new(model: &Model, settings: Settings) -> Result<Identifier, BuildError> {
        check(model, &settings)?;
        let coefficients = model.terms.iter().map(|entry| Coefficient::unknown(entry.term)).collect();
        let problem = Problem::new(model, &settings);
        let engine = Engine::new(&problem, &settings);
        let potential = model.potential.clone();
        let output = Output { hold: settings.hold, ..Output::default() };
        let (clock, sender, alignment) = (Clock::default(), Sender::default(), Alignment::default());
        let waiting = None;
        Ok(Identifier { settings, problem, engine, potential, coefficients, output, clock, waiting, sender, alignment })
    }

    /// Takes one sample. One that comes after a gap is used with the next one, which tells whether its stamp was right.
    ///
    /// # Errors
    /// [`Skipped`] says why the sample, or the one before it, was not used; the identifier goes on unchanged.
    pub fn step(&mut self, sample: Sample) -> Result<(), Skipped> {
        let measured = self.measured(sample);
        self.accept(&measured).map_err(|skipped| self.skip(&measured, skipped))?;
        let waited = self.end_waiting(&measured);
        waited.and(self.take(measured))
    }

    /// Time stamp, s, of a sample that came after a gap and waits for the next one.
    pub fn waiting(&self) -> Option<f64> {
        self.waiting.map(|sample| sample.t)
    }

    /// What waits is used if the next sample comes later.
    fn end_waiting(&mut self, next: &Sample) -> Result<(), Skipped> {
        let Some(waiting) = self.waiting.take() else { return Ok(()) };
        if waiting.t > next.t {
            return Err(self.clock.ahead(waiting.t));
        }
        let t = self.accept(&waiting)?;
        self.read(Sample { t, ..waiting })
    }

    fn take(&mut self, measured: Sample) -> Result<(), Skipped> {
        let t = self.accept(&measured).map_err(|skipped| self.skip(&measured, skipped))?;
        if self.clock.is_after_gap(t) {
            self.wait(measured);
            return Ok(());
        }
        self.read(Sample { t, ..measured })
    }

    /// Until the next sample has come nothing that is said holds for the present.
    fn wait(&mut self, measured: Sample) {
        self.waiting = Some(measured);
        self.output.valid = false;
        let missing = self.output.sensors.iter_mut().filter(|sensor| **sensor == SensorState::Missing);
        missing.for_each(|sensor| *sensor = SensorState::Ok);
    }

    /// Uses a sample whose time is that of the record.
    fn read(&mut self, sample: Sample) -> Result<(), Skipped> {
        self.clock.advance(sample.t);
        let read = self.sender.read(sample)?;
        let Some(sample) = read.and_then(|sample| self.alignment.align(self.problem.timing.lag, sample)) else {
            return Ok(());
        };
        let Identifier { settings, problem, engine, coefficients, output, .. } = self;
        match engine {
            Engine::Default(tracker) => {
                tracker.step(problem, settings, sample);
                tracker.correct_timing(problem);
                tracker.show(problem, settings, coefficients, output);
                problem.timing.say_late(output.valid, problem.channels, &mut output.sensors);
            }
            Engine::Publication(publication) => publication.step(problem, settings, sample, coefficients, output),
            Engine::Force(tracker) => tracker.step(problem, settings, sample, coefficients, output),
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

    /// What is published does not hold for the present once samples are missing.
    fn skip(&mut self, sample: &Sample, skipped: Skipped) -> Skipped {
        if self.clock.is_stale(sample.t) {
            self.output.valid = false;
            let varies = self.sender.varies();
            let lacking = [sample.q, sample.qd, sample.excitation].map(|value| !value.is_finite());
            for (index, sensor) in self.output.sensors.iter_mut().enumerate() {
                match skipped {
                    Skipped::NotFinite { .. } if lacking[index] => *sensor = SensorState::Missing,
                    Skipped::NotFinite { .. } if *sensor == SensorState::Missing => *sensor = SensorState::Ok,
                    Skipped::Repeated { .. } if varies[index] => *sensor = SensorState::Stuck,
                    _ => {}
                }
            }
        }
        skipped
    }

    /// The time in the record of a sample as it was measured.
    fn accept(&mut self, sample: &Sample) -> Result<f64, Skipped> {
        let &Sample { t, q, qd, excitation } = sample;
        let values = [("t", t), ("q", q), ("qd", qd), ("F", excitation)];
        match values.into_iter().find(|(_, value)| !value.is_finite()) {
            Some((channel, _)) => Err(Skipped::NotFinite { t, channel }),
            None => {
                let time = self.clock.time(t, self.settings.sample_time)?;
                if self.sender.repeats(sample) { Err(Skipped::Repeated { t }) } else { Ok(time) }
            }
        }
    }

    /// The laws that it knows, the present one among them where it is validated; none of the publication's method.
    pub fn known_laws(&self) -> SavedLaws {
        match &self.engine {
            Engine::Default(tracker) => tracker.known_laws(&self.problem),
            Engine::Publication(_) | Engine::Force(_) => SavedLaws::default(),
        }
    }

    /// The same identifier with laws to recognise, from before its first sample; the publication's method recognises
    /// none.
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
        &self.coefficients
    }

    /// All other outputs after the last step.
    pub fn output(&self) -> &Output {
        &self.output
    }

    /// Log-likelihood per measurement of the present stage's law, to compare settings on one record by; `None` while
    /// there is no law, and for the publication's method, which has none.
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
