//! The JSON document of `switchid identify`.

use super::found::{Run, missing, noise, stages};
use crate::cli::output::Pairs;
use crate::cli::stage_limit::StageLimit;
use crate::identify::{Missing, SensorFault, Stage};
use crate::law::{Units, unit_of};
use serde::Serialize;
use std::collections::BTreeMap;

/// The JSON document of `switchid identify`.
#[derive(Serialize)]
pub(super) struct Report {
    /// What the law gives: `F`, or the motion.
    output: &'static str,
    /// The effect that a stage's law lacks most evidently; null where none does.
    missing: Option<&'static str>,
    stages: Vec<StageReport>,
    noise: Pairs,
    sensors: Vec<SensorReport>,
    hold: &'static str,
    /// Inner parameters that the model left open, fitted to the recording as a whole.
    inner: Pairs,
    gaps: Vec<[f64; 2]>,
    skipped: usize,
}

#[derive(Serialize)]
struct StageReport {
    start: f64,
    /// s; null where no switch began the stage.
    start_std: Option<f64>,
    end: f64,
    detected: Option<f64>,
    /// When the alarm had its name, no sensor's fault, s.
    named: Option<f64>,
    identified: Option<f64>,
    /// The same whenever a law returns; null where no law was validated.
    law_number: Option<u32>,
    recognised: bool,
    /// Whether the law was validated at the stage's end.
    valid: bool,
    law: Option<String>,
    coefficients: Pairs,
    std: Pairs,
    /// Further seconds of such motion by term, of those that are not known well enough, where something can be said of
    /// them.
    needed: Pairs,
    /// By term, where known.
    units: BTreeMap<String, String>,
    /// Share of the force's variance that the coefficients explain; null for a law of motion that states its own std.
    explained: Option<f64>,
    /// What the law lacks at the stage's end; null where no evidence stands out.
    missing: Option<MissingReport>,
    /// Whether the coefficients were moving at the stage's end.
    drifting: bool,
    unidentifiable: Vec<String>,
    /// What any method could reach on this stage; null where that is not known.
    limit: Option<LimitReport>,
}

/// An effect that a law lacks.
#[derive(Serialize)]
struct MissingReport {
    effect: &'static str,
    /// Log-likelihood that it would gain, less that of chance, nats.
    evidence: f64,
}

impl MissingReport {
    fn of(missing: Missing) -> MissingReport {
        MissingReport { effect: missing.effect().id, evidence: missing.evidence }
    }
}

/// A sensor's fault.
#[derive(Serialize)]
struct SensorReport {
    channel: &'static str,
    kind: &'static str,
    start: f64,
    /// s; null where the record ends before.
    end: Option<f64>,
}

impl SensorReport {
    fn of(fault: &SensorFault) -> SensorReport {
        let SensorFault { channel, kind, start, end } = *fault;
        SensorReport { channel, kind: kind.id(), start, end }
    }
}

#[derive(Serialize)]
struct LimitReport {
    /// Smallest std by term.
    coefficient_std: Pairs,
    relative_error: Option<f64>,
    /// Whether the law explains the stage down to its sensors' noise.
    explained: bool,
    /// Stated std ÷ smallest std.
    std_to_limit: Pairs,
}

impl Report {
    pub(super) fn of(run: &Run) -> Report {
        let Run { opened, settings, found, .. } = run;
        let forced = settings.channels.excitation;
        Report {
            output: if run.gives_force { "F" } else { "motion" },
            missing: missing(found).map(|(_, missing)| missing.effect().id),
            stages: stages(run).map(|(stage, limit)| StageReport::of(stage, limit, forced, &opened.units)).collect(),
            noise: Pairs(noise(found)),
            sensors: found.sensors.iter().map(SensorReport::of).collect(),
            hold: found.hold.id(),
            inner: Pairs(run.inner.clone()),
            gaps: opened.recording.silences().into_iter().map(|gap| [gap.start, gap.end]).collect(),
            skipped: found.skipped.len(),
        }
    }
}

impl StageReport {
    fn of(stage: &Stage, limit: Option<&StageLimit>, forced: bool, units: &Units) -> StageReport {
        StageReport {
            start: stage.start,
            start_std: stage.start_std,
            end: stage.end,
            detected: stage.detected,
            named: stage.named,
            identified: stage.identified,
            law_number: stage.law_number,
            recognised: stage.recognised,
            valid: stage.valid,
            law: stage.law(forced),
            coefficients: Pairs(stage.known().map(|(known, _)| (known.term.name(), known.value)).collect()),
            std: Pairs(stage.known().map(|(known, std)| (known.term.name(), std)).collect()),
            needed: Pairs(stage.lacking().map(|(term, seconds)| (term.name(), seconds)).collect()),
            units: stage
                .known()
                .filter_map(|(known, _)| Some((known.term.name(), unit_of(known.term, units)?)))
                .collect(),
            explained: stage.explained,
            missing: stage.missing.map(MissingReport::of),
            drifting: stage.drifting,
            unidentifiable: stage.unidentifiable.clone(),
            limit: limit.map(|limit| LimitReport::of(stage, limit)),
        }
    }
}

impl LimitReport {
    fn of(stage: &Stage, limit: &StageLimit) -> LimitReport {
        let smallest =
            || stage.known().filter_map(|(known, std)| Some((known.term.name(), std, limit.std(known.term)?)));
        LimitReport {
            coefficient_std: Pairs(smallest().map(|(name, _, least)| (name, least)).collect()),
            relative_error: limit.relative_error(),
            explained: limit.explained(),
            std_to_limit: Pairs(smallest().map(|(name, std, least)| (name, std / least)).collect()),
        }
    }
}
