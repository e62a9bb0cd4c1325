//! What any method could have reached on each stage that `identify` found: the Cramér–Rao bound of the stage's law on
//! its samples.

use super::input::is_noiseless;
use crate::diagnose::{Evidence, Fit, Form, is_evident, refit};
use crate::estimation::Noise;
use crate::identify::{Identification, Recording, Settings, Stage, fit_force_law};
use crate::law::{Hold, Model, Term};
use crate::limits::{Bound, Course, Imposed, Law, Sensors, Start, bound, force_bound};

/// Process noise, (m/s²)² s, ÷ variance of the sensors' noise from which its search begins.
const LEAST: f64 = 1e-6;

/// Samples of a stage up to which its limit is formed of all of them: beyond, information grows as the time does.
const ALL: usize = 200_000;

/// Parts that are taken of a longer stage.
const PARTS: usize = 8;

/// The limits of one stage.
pub(super) struct StageLimit {
    law: Law,
    bound: Bound,
    /// Share of the stage's samples that the bound was formed of: variances fall as it grows to 1.
    share: f64,
    explained: bool,
}

impl StageLimit {
    /// Whether the law explains the stage down to its sensors' noise: where it does not, no estimate comes near the
    /// limit.
    pub(super) fn explained(&self) -> bool {
        self.explained
    }

    /// The smallest std of a coefficient that the stage estimated.
    pub(super) fn std(&self, term: Term) -> Option<f64> {
        let row = self.law.sought().iter().position(|index| self.law.terms()[*index] == term)?;
        self.bound.std[row].map(|std| std * self.share.sqrt())
    }

    /// The smallest mean of e.
    pub(super) fn relative_error(&self) -> Option<f64> {
        self.bound.relative_error.map(|error| error * self.share)
    }
}

/// The limits of every stage; none of one without a law, without motion, with a sensor at fault, or whose sensors show
/// no noise.
pub(super) fn stage_limits(
    found: &Identification,
    recording: &Recording,
    settings: &Settings,
) -> Vec<Option<StageLimit>> {
    if is_noiseless([found.noise.q, found.noise.qd], recording).contains(&true) {
        return found.stages.iter().map(|_| None).collect();
    }
    let noise = noise(found);
    let last = found.stages.len().saturating_sub(1);
    let of = |(index, stage): (usize, &Stage)| {
        if found.has_fault_in(stage) {
            return None;
        }
        let range = samples(stage, recording, index == last);
        let parts: Vec<Recording> = parts(&range).into_iter().filter_map(|part| recording.section(part).ok()).collect();
        let taken: usize = parts.iter().map(Recording::count).sum();
        stage_limit(stage, noise, &parts, taken as f64 / range.len() as f64, settings)
    };
    found.stages.iter().enumerate().map(of).collect()
}

/// Where the search for a stage's noise begins: that of the sensors over all, and a law that explains nearly
/// everything.
fn noise(found: &Identification) -> Noise {
    let variance = |std: Option<f64>| std.map_or(f64::MIN_POSITIVE, |std| std * std);
    let sensor = [variance(found.noise.q), variance(found.noise.qd)];
    let process = LEAST * sensor.into_iter().filter(|variance| *variance > f64::MIN_POSITIVE).fold(0.0, f64::max);
    Noise { sensor, process }
}

/// Positions of the stage's samples; the last stage has the record's last one too.
fn samples(stage: &Stage, recording: &Recording, is_last: bool) -> std::ops::Range<usize> {
    let before = |end: f64| recording.t().partition_point(|t| *t < end);
    before(stage.start)..if is_last { recording.count() } else { before(stage.end) }
}

/// The stage itself, or evenly spread parts of a long one.
fn parts(range: &std::ops::Range<usize>) -> Vec<std::ops::Range<usize>> {
    if range.len() <= ALL {
        return vec![range.clone()];
    }
    let start = |part: usize| range.start + (range.len() - ALL / PARTS) * part / (PARTS - 1);
    (0..PARTS).map(|part| start(part)..start(part) + ALL / PARTS).collect()
}

fn stage_limit(
    stage: &Stage,
    noise: Noise,
    parts: &[Recording],
    share: f64,
    settings: &Settings,
) -> Option<StageLimit> {
    let (law, pairs) = known_law(stage)?;
    let (courses, motion) = motion(&pairs, parts, settings, noise)?;
    let channels = parts.first()?.channels();
    let measured = channels.of_motion();
    let sensors = Sensors([0, 1].map(|channel| measured[channel].then_some(motion.noise.sensor[channel].sqrt())));
    let bound = bound(&law, &courses, sensors, Start::Unknown).ok()?;
    Some(StageLimit { law, bound, share, explained: !is_evident(&motion) })
}

/// The motion of a stage as its law and its readings together tell it, and the fit that says so.
fn motion(pairs: &[(Term, f64)], parts: &[Recording], settings: &Settings, noise: Noise) -> Option<(Vec<Course>, Fit)> {
    let (terms, held) = pairs.iter().map(|(term, value)| (*term, Some(*value))).unzip();
    let form = Form::new(terms, held, Vec::new());
    let parts: Vec<(&Recording, Hold)> = parts.iter().map(|part| (part, settings.hold)).collect();
    let evidence = Evidence::new(&parts);
    let coefficients: Vec<f64> = pairs.iter().map(|(_, value)| *value).collect();
    let motion = refit(&form, &evidence.pieces, &coefficients, noise)?;
    let pairs = evidence.pieces.iter().zip(&motion.states);
    let courses = pairs.map(|(piece, states)| piece.course(states)).collect();
    Some((courses, motion))
}

/// The law of a stage with its terms' coefficients; none where nothing was estimated.
fn known_law(stage: &Stage) -> Option<(Law, Vec<(Term, f64)>)> {
    let kept: Vec<(Term, f64, f64)> = stage
        .known()
        .map(|(known, std)| (known.term, known.value, std))
        .filter(|(_, value, std)| *value != 0.0 || *std > 0.0)
        .collect();
    let pairs: Vec<(Term, f64)> = kept.iter().map(|(term, value, _)| (*term, *value)).collect();
    let sought: Vec<usize> = (0..kept.len()).filter(|index| kept[*index].2 > 0.0).collect();
    if sought.is_empty() {
        return None;
    }
    Some((Law::new(&pairs, &sought).ok()?, pairs))
}

/// The limits of the stages of a law that gives F; none of one whose noise is not known, since the law leaves more
/// than that.
pub(super) fn force_limits(model: &Model, found: &Identification, recording: &Recording) -> Vec<Option<StageLimit>> {
    let fit = fit_force_law(model, recording).ok().flatten();
    let limit = |stage: &Stage| {
        let (fit, std) = (fit.as_ref()?, found.noise.force.filter(|_| stage.identified.is_some())?);
        let during = fit.motion.iter().filter(|(t, _)| (stage.start..=stage.end).contains(t));
        let motion: Vec<Imposed> = during.map(|(t, state)| Imposed { t: *t, state: *state }).collect();
        let (law, _) = known_law(stage)?;
        let bound = force_bound(&law, &motion, std).ok()?;
        Some(StageLimit { law, bound, share: 1.0, explained: true })
    };
    found.stages.iter().map(limit).collect()
}
