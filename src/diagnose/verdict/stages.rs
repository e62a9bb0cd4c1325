//! Records that switch, diagnosed stage by stage.
//!
//! The judge's equations say where the law may change. What the model lacks can look like a change, so the stages are
//! taken only where their laws, each with the effect that it lacks, leave much less of the record than one law with the effect that it
//! lacks: by the judge's held-out errors, in every window.

use super::diagnosis::{Diagnosis, Finding};
use super::errors::WindowError;
use super::posed::Posed;
use super::timing::Clock;
use crate::diagnose::judge::COUNT;
use crate::identify::Recording;
use crate::law::{Hold, Model};

/// Ratio of errors, in every window, below which a record's stages are laws of their own: half the error's energy.
const APART: f64 = 0.7;

/// One stage of a recording, diagnosed alone.
#[derive(Clone, Debug)]
pub struct StageDiagnosis {
    /// Position of the recording.
    pub recording: usize,
    /// Its beginning, s.
    pub start: f64,
    /// Its end, s.
    pub end: f64,
    /// Its samples.
    pub samples: Recording,
    /// What it lacks; none where it is too short to determine a law.
    pub diagnosis: Option<Diagnosis>,
}

/// The diagnosis of a set of recordings.
#[derive(Clone, Debug)]
pub struct Switched {
    /// Of everything under one law; none where the record determines no law.
    pub whole: Option<Diagnosis>,
    /// Of each stage, in the order of recordings and time; empty where one law is the better explanation.
    pub stages: Vec<StageDiagnosis>,
    /// How the sensors keep time, as the law of the whole record has it.
    pub clock: Option<Clock>,
}

/// Diagnoses recordings, stage by stage where they switch.
pub fn diagnose_stages(model: &Model, recordings: &[&Recording], hold: Option<Hold>) -> Switched {
    let posed = Posed::new(model, recordings, hold);
    let whole = posed.as_ref().and_then(Posed::diagnose);
    let last = whole.as_ref().map(|whole| whole.improved.as_ref().unwrap_or(&whole.base));
    let clock = posed.as_ref().zip(last).map(|(posed, law)| posed.clock(law));
    let one = |whole| Switched { whole, stages: Vec::new(), clock };
    if whole.as_ref().is_some_and(|whole| whole.finding == Finding::Adequate || whole.is_down_to_sensors()) {
        return one(whole);
    }
    let cuts: Vec<(usize, Recording)> = recordings
        .iter()
        .enumerate()
        .flat_map(|(index, recording)| cuts(model, recording, hold).into_iter().map(move |stage| (index, stage)))
        .collect();
    if cuts.len() <= recordings.len() {
        return one(whole);
    }
    let stages: Vec<StageDiagnosis> = cuts.into_iter().map(|(index, stage)| alone(model, index, stage, hold)).collect();
    match whole.as_ref().is_none_or(|whole| are_apart(&stages, whole)) {
        true => Switched { whole, stages, clock },
        false => one(whole),
    }
}

impl Switched {
    /// What all stages together come to: missing if it is in any.
    pub fn finding(&self) -> Option<Finding> {
        let findings: Vec<Finding> = self.diagnoses().map(|diagnosis| diagnosis.finding).collect();
        let any = |finding: Finding| findings.contains(&finding).then_some(finding);
        any(Finding::Missing).or(any(Finding::Unexplained)).or(any(Finding::Adequate))
    }

    /// The diagnosis that says most: the whole record's, or that of the stage whose error a missing effect makes good best.
    pub fn principal(&self) -> Option<&Diagnosis> {
        let finding = self.finding();
        let score = |diagnosis: &Diagnosis| diagnosis.candidates.first().map_or(0.0, |candidate| candidate.score);
        let found = self.diagnoses().filter(|diagnosis| Some(diagnosis.finding) == finding);
        found.min_by(|a, b| score(a).total_cmp(&score(b)))
    }

    fn diagnoses(&self) -> impl Iterator<Item = &Diagnosis> {
        let whole = self.whole.iter().filter(|_| self.stages.is_empty());
        whole.chain(self.stages.iter().filter_map(|stage| stage.diagnosis.as_ref()))
    }
}

/// The recording cut where its law may have changed.
fn cuts(model: &Model, recording: &Recording, hold: Option<Hold>) -> Vec<Recording> {
    let changes = Posed::new(model, &[recording], hold).map(|posed| posed.changes()).unwrap_or_default();
    let at = changes.into_iter().map(|elapsed| position(recording, elapsed));
    let at: Vec<usize> = std::iter::once(0).chain(at).chain([recording.count()]).collect();
    at.windows(2).filter_map(|pair| recording.section(pair[0]..pair[1]).ok()).collect()
}

/// The first sample after so much recorded time, s.
fn position(recording: &Recording, elapsed: f64) -> usize {
    let t = recording.t();
    let mut before = 0.0;
    for piece in recording.pieces() {
        let length = t[piece.end - 1] - t[piece.start];
        if elapsed <= before + length {
            return piece.start + t[piece.clone()].partition_point(|own| *own - t[piece.start] < elapsed - before);
        }
        before += length;
    }
    recording.count()
}

fn alone(model: &Model, recording: usize, samples: Recording, hold: Option<Hold>) -> StageDiagnosis {
    let diagnosis = Posed::new(model, &[&samples], hold).and_then(|posed| posed.diagnose());
    let (start, end) = (samples.t()[0], samples.t()[samples.count() - 1]);
    StageDiagnosis { recording, start, end, samples, diagnosis }
}

/// Whether the stages' laws leave much less of the record than one law. A stage too short for a law of its own leaves what the whole does.
fn are_apart(stages: &[StageDiagnosis], whole: &Diagnosis) -> bool {
    let duration: f64 = stages.iter().map(|stage| stage.end - stage.start).sum();
    (0..COUNT).filter(|which| !whole.errors[*which].after.is_nan()).all(|which| {
        let left = |stage: &StageDiagnosis| {
            let own = stage.diagnosis.as_ref().map(|own| own.errors[which]);
            let own = own.filter(|error: &WindowError| error.after.is_finite()).unwrap_or(whole.errors[which]);
            (stage.end - stage.start) * own.after * own.after
        };
        let energy: f64 = stages.iter().map(left).sum();
        (energy / duration).sqrt() < APART * whole.errors[which].after
    })
}
