//! A diagnosis as JSON.

use super::super::input::Input;
use super::super::output::Pairs;
use super::text;
use super::{Answer, Found, StageAnswer};
use crate::diagnose::{Candidate, Dependence, Source};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Report {
    verdict: &'static str,
    effect: Option<String>,
    candidates: Vec<CandidateReport>,
    indistinguishable: Vec<Vec<String>>,
    beside: Vec<String>,
    answer: [String; 3],
    decides: Option<DecisionReport>,
    visible: Option<VisibleReport>,
    depends_on: Option<DependenceReport>,
    tried: usize,
    explained: f64,
    window: f64,
    stages: Vec<StageReport>,
}

/// A candidate as JSON.
#[derive(Serialize)]
pub(in crate::cli) struct CandidateReport {
    effect: String,
    coefficient: f64,
    std: f64,
    unit: Option<String>,
    inner: Pairs,
    error_before: f64,
    error_after: f64,
    p_value: f64,
    gain: f64,
    share: f64,
    physical: bool,
    plausible: bool,
    place: Option<String>,
}

#[derive(Serialize)]
struct DecisionReport {
    between: [String; 2],
    apart: f64,
    needed: f64,
    scale: Option<f64>,
    displacement: Option<f64>,
    velocity: Option<f64>,
    longer: Option<f64>,
}

#[derive(Serialize)]
struct VisibleReport {
    effect: String,
    share: f64,
}

#[derive(Serialize)]
struct DependenceReport {
    on: &'static str,
    omega: Option<f64>,
    delay: Option<f64>,
    amplitude: f64,
    std: f64,
    relative: Option<f64>,
    gain: f64,
    p_value: f64,
    sentence: String,
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
        let Answer { diagnosis, decision, visible, dependence } = &found.principal;
        let decides = decision.as_ref().map(|decision| DecisionReport {
            between: [decision.one.clone(), decision.other.clone()],
            apart: decision.apart,
            needed: decision.needed,
            scale: decision.motion.map(|motion| motion.scale),
            displacement: decision.motion.map(|motion| motion.displacement),
            velocity: decision.motion.map(|motion| motion.velocity),
            longer: Some(decision.longer).filter(|longer| longer.is_finite()),
        });
        Report {
            verdict: text::verdict(found.finding),
            effect: diagnosis.effect.clone(),
            candidates: diagnosis.candidates.iter().map(|candidate| CandidateReport::of(candidate, input)).collect(),
            indistinguishable: diagnosis.indistinguishable.clone(),
            beside: diagnosis.beside.clone(),
            answer: text::lines(found, input),
            decides,
            visible: visible.as_ref().map(|seen| VisibleReport { effect: seen.effect.clone(), share: seen.share }),
            depends_on: dependence.as_ref().map(DependenceReport::of),
            tried: diagnosis.tried,
            explained: diagnosis.explained,
            window: diagnosis.window,
            stages: found.stages.iter().map(|stage| StageReport::of(stage, input)).collect(),
        }
    }
}

impl CandidateReport {
    pub(in crate::cli) fn of(candidate: &Candidate, input: &Input) -> CandidateReport {
        CandidateReport {
            effect: candidate.effect.clone(),
            coefficient: candidate.coefficient,
            std: candidate.std,
            unit: input.units.coefficient(candidate.term).map(|unit| unit.symbol),
            inner: Pairs(candidate.inner.clone()),
            error_before: candidate.error_before,
            error_after: candidate.error_after,
            p_value: candidate.p_value,
            gain: candidate.gain,
            share: candidate.share,
            physical: candidate.physical,
            plausible: candidate.plausible,
            place: candidate.place.map(|place| place.sentence(&input.units)),
        }
    }
}

impl DependenceReport {
    fn of(dependence: &Dependence) -> DependenceReport {
        let (on, omega, delay) = match dependence.source {
            Source::Drift | Source::StiffnessDrift | Source::DampingDrift => ("time", None, None),
            Source::Line(omega) | Source::Parametric(omega) => ("frequency", Some(omega), None),
            Source::PastDisplacement(delay) | Source::PastVelocity(delay) => ("memory", None, Some(delay)),
            Source::PastExcitation(delay) => ("input", None, Some(delay)),
            Source::SquaredExcitation | Source::ExcitationMagnitude => ("input", None, None),
        };
        let Dependence { amplitude, std, relative, gain, p_value, .. } = *dependence;
        let sentence = text::dependence(dependence);
        DependenceReport { on, omega, delay, amplitude, std, relative, gain, p_value, sentence }
    }
}

impl StageReport {
    fn of(stage: &StageAnswer, input: &Input) -> StageReport {
        let found = stage.answer.as_ref().map(|answer| &answer.diagnosis);
        StageReport {
            data: stage.data.clone(),
            start: stage.start,
            end: stage.end,
            verdict: found.map(|found| text::verdict(found.finding)),
            effect: found.and_then(|found| found.effect.clone()),
            candidates: found
                .iter()
                .flat_map(|found| &found.candidates)
                .map(|candidate| CandidateReport::of(candidate, input))
                .collect(),
            indistinguishable: found.map_or_else(Vec::new, |found| found.indistinguishable.clone()),
            coefficients: found.map_or_else(Pairs::none, |found| Pairs::coefficients(&found.base)),
            std: found.map_or_else(Pairs::none, |found| Pairs::std(&found.base)),
        }
    }
}
