//! A diagnosis as JSON.

use super::super::input::Input;
use super::super::output::Pairs;
use super::found::Found;
use super::text;
use crate::diagnose::{Candidate, Clock, Diagnosis, Doubt, StageDiagnosis, Target, WindowError};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Report {
    verdict: &'static str,
    effect: Option<String>,
    explained: f64,
    left: String,
    candidates: Vec<CandidateReport>,
    indistinguishable: Vec<Vec<String>>,
    errors: Vec<WindowReport>,
    period: f64,
    timing: Option<TimingReport>,
    hold: &'static str,
    answer: Vec<String>,
    coefficients: Pairs,
    std: Pairs,
    tried: usize,
    stages: Vec<StageReport>,
}

/// A candidate as JSON; `p_value` is null where it was barred, or the record is too short to tell.
#[derive(Serialize)]
pub(in crate::cli) struct CandidateReport {
    effect: String,
    coefficient: Option<f64>,
    std: Option<f64>,
    unit: Option<String>,
    inner: Pairs,
    error_before: Option<f64>,
    error_after: Option<f64>,
    p_value: Option<f64>,
    score: f64,
    resemblance: f64,
    doubt: Option<&'static str>,
}

/// Errors over windows of one length as JSON; null where nothing can be told.
#[derive(Serialize)]
pub(in crate::cli) struct WindowReport {
    window: f64,
    target: &'static str,
    before: Option<f64>,
    after: Option<f64>,
    floor: Option<f64>,
}

/// How the sensors keep time, s.
#[derive(Serialize)]
pub(in crate::cli) struct TimingReport {
    #[serde(rename = "F_delay")]
    force: Option<f64>,
    #[serde(rename = "F_delay_std")]
    force_std: Option<f64>,
    qd_delay: Option<f64>,
    qd_delay_std: Option<f64>,
    qd_is_derivative: Option<bool>,
    sentences: Vec<String>,
}

#[derive(Serialize)]
struct StageReport {
    data: String,
    start: f64,
    end: f64,
    verdict: Option<&'static str>,
    effect: Option<String>,
    candidates: Vec<CandidateReport>,
    indistinguishable: Vec<Vec<String>>,
    coefficients: Pairs,
    std: Pairs,
}

impl Report {
    pub(super) fn of(found: &Found, input: &Input) -> Report {
        let diagnosis = &found.principal;
        Report {
            verdict: text::verdict(found.finding),
            effect: diagnosis.effect.clone(),
            explained: diagnosis.explained,
            left: diagnosis.left.clone(),
            candidates: CandidateReport::all(diagnosis, input),
            indistinguishable: diagnosis.indistinguishable.clone(),
            errors: WindowReport::all(&diagnosis.errors, diagnosis.base.target),
            period: diagnosis.period,
            timing: found.clock.as_ref().map(TimingReport::of),
            hold: diagnosis.base.timing.hold.id(),
            answer: text::lines(found, input),
            coefficients: Pairs::coefficients(&diagnosis.base),
            std: Pairs::std(&diagnosis.base),
            tried: diagnosis.tried,
            stages: found.stages.iter().map(|stage| StageReport::of(stage, input)).collect(),
        }
    }
}

impl CandidateReport {
    pub(in crate::cli) fn all(diagnosis: &Diagnosis, input: &Input) -> Vec<CandidateReport> {
        diagnosis.candidates.iter().map(|candidate| CandidateReport::of(candidate, input)).collect()
    }

    fn of(candidate: &Candidate, input: &Input) -> CandidateReport {
        let error = candidate.error();
        CandidateReport {
            effect: candidate.effect.clone(),
            coefficient: told(candidate.coefficient),
            std: told(candidate.std),
            unit: input.units.coefficient(candidate.term).map(|unit| unit.symbol),
            inner: Pairs(candidate.inner.clone()),
            error_before: told(error.before),
            error_after: told(error.after),
            p_value: candidate.p_value,
            score: candidate.score,
            resemblance: candidate.resemblance,
            doubt: candidate.doubt.map(id),
        }
    }
}

/// A number, where there is one.
fn told(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

fn id(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::Sign => "sign",
        Doubt::Trap => "cannot_tell",
        Doubt::Uncertain => "uncertain",
        Doubt::Worse => "worse",
        Doubt::Chance => "chance",
    }
}

impl WindowReport {
    pub(in crate::cli) fn all(errors: &[WindowError], target: Target) -> Vec<WindowReport> {
        let target = match target {
            Target::Inertia => "inertia",
            Target::Force => "F",
        };
        let of = |error: &WindowError| WindowReport {
            window: error.window,
            target,
            before: told(error.before),
            after: told(error.after),
            floor: told(error.floor),
        };
        errors.iter().map(of).collect()
    }
}

impl TimingReport {
    pub(in crate::cli) fn of(clock: &Clock) -> TimingReport {
        let first = |pair: Option<[f64; 2]>| pair.and_then(|pair| told(pair[0]));
        let second = |pair: Option<[f64; 2]>| pair.and_then(|pair| told(pair[1]));
        TimingReport {
            force: first(clock.force),
            force_std: second(clock.force),
            qd_delay: first(clock.velocity),
            qd_delay_std: second(clock.velocity),
            qd_is_derivative: clock.is_derivative,
            sentences: clock.sentences(),
        }
    }
}

impl StageReport {
    fn of(stage: &StageDiagnosis, input: &Input) -> StageReport {
        let found = stage.diagnosis.as_ref();
        StageReport {
            data: stage.samples.source().into(),
            start: stage.start,
            end: stage.end,
            verdict: found.map(|found| text::verdict(found.finding)),
            effect: found.and_then(|found| found.effect.clone()),
            candidates: found.map_or_else(Vec::new, |found| CandidateReport::all(found, input)),
            indistinguishable: found.map_or_else(Vec::new, |found| found.indistinguishable.clone()),
            coefficients: found.map_or_else(Pairs::none, |found| Pairs::coefficients(&found.base)),
            std: found.map_or_else(Pairs::none, |found| Pairs::std(&found.base)),
        }
    }
}
