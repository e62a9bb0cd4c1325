//! Records that switch, diagnosed stage by stage.
//!
//! The streaming identifier says where the law switches. An effect that the model lacks can raise alarms of its own, so the stages are
//! taken only where the coefficients of that law differ between them, and where their laws, each with the effect that it lacks, explain the
//! record better than one law with the effect that it lacks: by likelihood, every coefficient counted with ½ ln N (Schwarz 1978).

use super::diagnosis::{Diagnosis, Evidence, Finding, diagnose_model, is_error};
use super::fit::{Fit, Form, refit, solve};
use super::run::Sums;
use crate::identify::{Recording, Settings, identify_recording, settings_for};
use crate::law::{Given, Hold, Model};

/// What coefficients that differ from stage to stage explain of what one law leaves, at the least: where it leaves much, they follow its error.
const PART: f64 = 0.03;

/// By how much more than the score test says they are taken to explain before a record is looked at for switches: noise is not fitted anew there.
const CAREFUL: f64 = 3.0;

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
}

/// Diagnoses recordings, stage by stage where they switch.
pub fn diagnose_stages(model: &Model, recordings: &[(&Recording, Hold)]) -> Switched {
    let evidence = Evidence::new(recordings);
    let whole = diagnose_model(model, &evidence);
    if whole.as_ref().is_some_and(|whole| !may_differ(last(whole))) {
        return Switched { whole, stages: Vec::new() };
    }
    let stages = stages(model, recordings);
    let is_cut = stages.len() > recordings.len();
    if !is_cut || whole.as_ref().is_some_and(|whole| !differ(last(whole), &stages)) {
        return Switched { whole, stages: Vec::new() };
    }
    let diagnosed: Vec<StageDiagnosis> = stages.into_iter().map(|stage| alone(model, stage)).collect();
    let better = whole.as_ref().is_none_or(|whole| is_better(&diagnosed, whole));
    Switched { whole, stages: if better { diagnosed } else { Vec::new() } }
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
        let gain = |diagnosis: &Diagnosis| diagnosis.candidates.first().map_or(0.0, |candidate| candidate.gain);
        let found = self.diagnoses().filter(|diagnosis| Some(diagnosis.finding) == finding);
        found.max_by(|a, b| gain(a).total_cmp(&gain(b)))
    }

    fn diagnoses(&self) -> impl Iterator<Item = &Diagnosis> {
        let whole = self.whole.iter().filter(|_| self.stages.is_empty());
        whole.chain(self.stages.iter().filter_map(|stage| stage.diagnosis.as_ref()))
    }
}

/// A stage of the recording of that position, with its hold.
struct Found {
    recording: usize,
    hold: Hold,
    samples: Recording,
}

/// The recordings cut where the streaming identifier sees a switch; whole where the model is not for it.
fn stages(model: &Model, recordings: &[(&Recording, Hold)]) -> Vec<Found> {
    let mut free = model.clone();
    free.terms.iter_mut().for_each(|entry| entry.given = Given::Fit);
    let of = |(index, (recording, hold)): (usize, &(&Recording, Hold))| {
        let cuts = cuts(&free, recording, *hold);
        let found = |samples: Recording| Found { recording: index, hold: *hold, samples };
        cuts.into_iter().map(found).collect::<Vec<_>>()
    };
    recordings.iter().enumerate().flat_map(of).collect()
}

fn cuts(model: &Model, recording: &Recording, hold: Hold) -> Vec<Recording> {
    let settings = Settings { hold, ..settings_for(recording, Settings::default()) };
    let found = identify_recording(model, settings, recording, |_, _| {});
    let alarms = found.map(|found| found.stages).unwrap_or_default();
    let starts = alarms.iter().filter(|stage| stage.detected.is_some()).map(|stage| stage.start);
    let at = starts.map(|start| recording.t().partition_point(|t| *t < start));
    let at: Vec<usize> = std::iter::once(0).chain(at).chain([recording.count()]).collect();
    at.windows(2).filter_map(|pair| recording.section(pair[0]..pair[1]).ok()).collect()
}

fn alone(model: &Model, stage: Found) -> StageDiagnosis {
    let Found { recording, hold, samples } = stage;
    let evidence = Evidence::new(&[(&samples, hold)]);
    let diagnosis = diagnose_model(model, &evidence);
    let (start, end) = (samples.t()[0], samples.t()[samples.count() - 1]);
    StageDiagnosis { recording, start, end, samples, diagnosis }
}

/// Whether coefficients that differ from stretch to stretch could explain what [`differ`] asks for, by the score test: where not even they do, the
/// record need not be looked at for switches.
fn may_differ(law: &Fit) -> bool {
    let unknowns = law.unknowns();
    let gain = |sums: &Sums| {
        let count = unknowns.min(sums.score.len());
        let information = sums.information.view((0, 0), (count, count)).into_owned();
        let score = sums.score.rows(0, count).into_owned();
        solve(&information, &score).map_or(f64::INFINITY, |solved| 0.5 * solved.step.dot(&score))
    };
    let gained = CAREFUL * law.by_stretch.iter().map(gain).sum::<f64>();
    law.by_stretch.is_empty() || is_difference(gained, law)
}

/// Whether so much log-likelihood, nats, by coefficients of each stage's own is that of a law that switches.
fn is_difference(gained: f64, law: &Fit) -> bool {
    is_error(gained, law.measurements) && gained > PART * law.lack()
}

/// Whether the law's coefficients, fitted to each stage, explain more than those of the whole record by what would be an error of the law. Noise
/// is each stage's own in both: that a real record's error comes and goes is no switch.
fn differ(law: &Fit, stages: &[Found]) -> bool {
    let held = Form { held: law.coefficients.iter().map(|value| Some(*value)).collect(), ..law.form.clone() };
    let held = Form { open: vec![Vec::new(); held.terms.len()], ..held };
    let gain = |stage: &Found| {
        let pieces = Evidence::new(&[(&stage.samples, stage.hold)]).pieces;
        let [free, held] = [&law.form, &held].map(|form| refit(form, &pieces, &law.coefficients, law.noise));
        free.zip(held).map_or(0.0, |(free, held)| free.log_likelihood - held.log_likelihood)
    };
    is_difference(stages.iter().map(gain).sum(), law)
}

/// Whether the stages' laws explain the record better than one law.
fn is_better(stages: &[StageDiagnosis], whole: &Diagnosis) -> bool {
    let count: usize = stages.iter().map(|stage| stage.samples.count()).sum();
    let one = last(whole);
    let share = |stage: &StageDiagnosis| one.log_likelihood * stage.samples.count() as f64 / count as f64;
    let own = |stage: &StageDiagnosis| stage.diagnosis.as_ref().map_or(share(stage), |found| merit(last(found)));
    stages.iter().map(own).sum::<f64>() > merit(one)
}

fn last(diagnosis: &Diagnosis) -> &Fit {
    diagnosis.improved.as_ref().map_or(&diagnosis.base, |trial| &trial.fit)
}

fn merit(fit: &Fit) -> f64 {
    fit.log_likelihood - 0.5 * fit.coefficients.len() as f64 * fit.measurements.max(1.0).ln()
}
