//! Records that switch, diagnosed stage by stage.
//!
//! The judge's equations say where the law may change. What the model lacks can look like a change, so a cut stays only
//! where the two laws beside it, each with the effect that it lacks, leave much less than one law with the effect that
//! it lacks: by the judge's held-out errors, in every window.

use super::diagnosis::{Diagnosis, Finding};
use super::errors::WindowError;
use super::posed::Posed;
use super::timing::Clock;
use crate::diagnose::candidates::same_effect;
use crate::diagnose::judge::COUNT;
use crate::identify::Recording;
use crate::law::{Hold, Model, Term};
use std::ops::Range;

/// Part of the energy beyond the sensors' that two laws leave at most, in every window, where two stages have laws of
/// their own.
const APART: f64 = 0.5;

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
    let known = whole.as_ref().filter(|_| recordings.len() == 1);
    let courses =
        recordings.iter().enumerate().map(|(index, recording)| Course { model, recording, index, hold, known });
    let courses: Vec<(Course, Vec<usize>)> = courses.map(|course| (course, course.cuts())).collect();
    if recordings.len() == 1 && courses.iter().all(|(_, cuts)| cuts.is_empty()) {
        return one(whole);
    }
    let stages: Vec<StageDiagnosis> = courses.iter().flat_map(|(course, cuts)| course.stages(cuts)).collect();
    // recordings of one system may each have been made in another stage
    let alike = stages.len() == recordings.len()
        && whole.as_ref().is_some_and(|whole| left(&stages.iter().collect::<Vec<_>>(), whole) >= APART);
    if alike || stages.len() < 2 { one(whole) } else { Switched { whole, stages, clock } }
}

impl Switched {
    /// What all stages together come to: missing if it is in any.
    pub fn finding(&self) -> Option<Finding> {
        let findings: Vec<Finding> = self.diagnoses().map(|diagnosis| diagnosis.finding).collect();
        let any = |finding: Finding| findings.contains(&finding).then_some(finding);
        any(Finding::Missing).or(any(Finding::Unexplained)).or(any(Finding::Adequate))
    }

    /// The diagnosis that says most: the whole record's, or that of the stage whose error a missing effect makes good
    /// best.
    pub fn principal(&self) -> Option<&Diagnosis> {
        let finding = self.finding();
        let score = |diagnosis: &Diagnosis| diagnosis.candidates.first().map_or(0.0, |candidate| candidate.score);
        let found = self.diagnoses().filter(|diagnosis| Some(diagnosis.finding) == finding);
        found.min_by(|a, b| score(a).total_cmp(&score(b)))
    }

    /// Those of all stages that determine a law; the whole record's where it has no stages.
    pub fn diagnoses(&self) -> impl Iterator<Item = &Diagnosis> {
        let whole = self.whole.iter().filter(|_| self.stages.is_empty());
        whole.chain(self.stages.iter().filter_map(|stage| stage.diagnosis.as_ref()))
    }
}

/// A recording whose law may change on its way.
#[derive(Clone, Copy)]
struct Course<'a> {
    model: &'a Model,
    recording: &'a Recording,
    index: usize,
    hold: Option<Hold>,
    /// The diagnosis of all of it, where that is known.
    known: Option<&'a Diagnosis>,
}

impl Course<'_> {
    /// The first samples after its law may have changed: by the model, or where that shows none by the law with what
    /// one law lacks, for what is lacking may be larger than the change.
    fn cuts(&self) -> Vec<usize> {
        let Some(posed) = Posed::new(self.model, &[self.recording], self.hold) else { return Vec::new() };
        let with_effect = || self.known.and_then(|known| known.improved.as_ref()).map(|law| posed.changes(&law.terms));
        let own = posed.changes(posed.terms());
        let changes = if own.is_empty() { with_effect().unwrap_or_default() } else { own };
        changes.into_iter().map(|elapsed| position(self.recording, elapsed)).collect()
    }

    /// Its stages between those cuts that two laws explain much better than one; the weakest cut goes first.
    fn stages(&self, cuts: &[usize]) -> Vec<StageDiagnosis> {
        let mut edges: Vec<usize> =
            std::iter::once(0).chain(cuts.iter().copied()).chain([self.recording.count()]).collect();
        let mut stages: Vec<StageDiagnosis> =
            edges.windows(2).filter_map(|pair| self.alone(pair[0]..pair[1])).collect();
        if stages.len() + 1 < edges.len() {
            return self.alone(0..self.recording.count()).into_iter().collect();
        }
        let join = |edges: &[usize]| self.alone(edges[0]..edges[2]);
        let mut joined: Vec<Option<StageDiagnosis>> = edges.windows(3).map(join).collect();
        loop {
            let borders = joined.iter().enumerate();
            let whole = |one: &Option<StageDiagnosis>| one.as_ref()?.diagnosis.clone();
            let weights =
                borders.filter_map(|(at, one)| Some((at, left(&[&stages[at], &stages[at + 1]], &whole(one)?))));
            let weakest = weights.max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((at, _)) = weakest.filter(|(_, left)| *left >= APART) else { break };
            let Some(one) = joined.remove(at) else { break };
            stages.splice(at..at + 2, [one]);
            edges.remove(at + 1);
            for border in at.saturating_sub(1)..(at + 1).min(joined.len()) {
                joined[border] = join(&edges[border..]);
            }
        }
        self.rebordered(edges, stages)
    }

    /// The stages with borders where the laws with the effects that they lack tell them: without those an effect's
    /// share blurs the instant.
    fn rebordered(&self, mut edges: Vec<usize>, mut stages: Vec<StageDiagnosis>) -> Vec<StageDiagnosis> {
        for at in 1..stages.len() {
            let found = self.border(edges[at - 1]..edges[at + 1], &stages[at - 1..=at]);
            let Some(edge) = found.filter(|edge| *edge != edges[at]) else { continue };
            if let [Some(before), Some(after)] =
                [edges[at - 1]..edge, edge..edges[at + 1]].map(|range| self.alone(range))
            {
                edges[at] = edge;
                stages.splice(at - 1..=at, [before, after]);
            }
        }
        stages
    }

    /// The first sample of the second of two stages, by a law with what either lacks.
    fn border(&self, range: Range<usize>, stages: &[StageDiagnosis]) -> Option<usize> {
        let laws = stages.iter().filter_map(|stage| stage.diagnosis.as_ref()?.improved.as_ref());
        let lacking: Vec<Term> = laws.filter_map(|law| law.terms.last().copied()).collect();
        let samples = self.recording.section(range.clone()).ok()?;
        let posed = Posed::new(self.model, &[&samples], self.hold)?;
        let terms = lacking.into_iter().fold(posed.terms().to_vec(), |terms, term| {
            if terms.iter().any(|own| same_effect(*own, term)) { terms } else { [terms, vec![term]].concat() }
        });
        Some(range.start + position(&samples, posed.change_of(&terms)?))
    }

    /// A part of it, diagnosed.
    fn alone(&self, range: Range<usize>) -> Option<StageDiagnosis> {
        let known = self.known.filter(|_| range == (0..self.recording.count()));
        let samples = self.recording.section(range).ok()?;
        let own = || Posed::new(self.model, &[&samples], self.hold).and_then(|posed| posed.diagnose());
        let diagnosis = known.cloned().or_else(own);
        let (start, end) = (samples.t()[0], samples.t()[samples.count() - 1]);
        Some(StageDiagnosis { recording: self.index, start, end, samples, diagnosis })
    }
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

/// Energy that the laws of stages leave beyond the sensors', as a part of what one law leaves of all, in the window in
/// which it is most. A stage too short for a law of its own leaves what the one law does. All where that is adequate.
fn left(stages: &[&StageDiagnosis], one: &Diagnosis) -> f64 {
    let one = one.errors;
    let length = |stage: &StageDiagnosis| stage.end - stage.start;
    let ratio = |which: usize| {
        let energy = |stage: &&StageDiagnosis| {
            let own = stage.diagnosis.as_ref().map(|own| own.errors[which]);
            let own = own.filter(|error: &WindowError| error.after.is_finite()).unwrap_or(one[which]);
            length(stage) * own.beyond()
        };
        let duration: f64 = stages.iter().map(|stage| length(stage)).sum();
        stages.iter().map(energy).sum::<f64>() / duration / one[which].beyond()
    };
    let telling = (0..COUNT).filter(|which| one[*which].after > one[*which].limit);
    telling.map(ratio).max_by(f64::total_cmp).unwrap_or(1.0)
}
