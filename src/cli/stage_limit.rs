//! What any method could have reached on each stage that `identify` found: the Cramér–Rao bound of the stage's law on its samples.

use super::input::is_noiseless;
use crate::diagnose::{Evidence, Fit, Form, is_evident, refit};
use crate::estimation::Noise;
use crate::identify::{Identification, Recording, Settings, Stage, fit_force_law};
use crate::law::{Model, Term};
use crate::limits::{Bound, Course, Imposed, Law, Sensors, Start, bound, force_bound};

/// Process noise, (m/s²)² s, ÷ variance of the sensors' noise from which its search begins.
const LEAST: f64 = 1e-6;

/// The limits of one stage.
pub(super) struct StageLimit {
    law: Law,
    bound: Bound,
    explained: bool,
}

impl StageLimit {
    /// Whether the law explains the stage down to its sensors' noise: where it does not, no estimate comes near the limit.
    pub(super) fn explained(&self) -> bool {
        self.explained
    }

    /// The smallest std of a coefficient that the stage estimated.
    pub(super) fn std(&self, term: Term) -> Option<f64> {
        let row = self.law.sought().iter().position(|index| self.law.terms()[*index] == term)?;
        self.bound.std[row]
    }

    /// The smallest mean of e.
    pub(super) fn relative_error(&self) -> Option<f64> {
        self.bound.relative_error
    }
}

/// The limits of every stage; none of one without a law, without motion, or whose sensors show no noise.
pub(super) fn stage_limits(
    found: &Identification,
    recording: &Recording,
    settings: &Settings,
) -> Vec<Option<StageLimit>> {
    if is_noiseless([found.noise_q, found.noise_qd], recording).contains(&true) {
        return found.stages.iter().map(|_| None).collect();
    }
    let noise = noise(found);
    let last = found.stages.len().saturating_sub(1);
    let of = |(index, stage): (usize, &Stage)| {
        let range = samples(stage, recording, index == last);
        stage_limit(stage, noise, &recording.section(range).ok()?, settings)
    };
    found.stages.iter().enumerate().map(of).collect()
}

/// Where the search for a stage's noise begins: that of the sensors over all, and a law that explains nearly everything.
fn noise(found: &Identification) -> Noise {
    let variance = |std: Option<f64>| std.map_or(f64::MIN_POSITIVE, |std| std * std);
    let sensor = [variance(found.noise_q), variance(found.noise_qd)];
    let process = LEAST * sensor.into_iter().filter(|variance| *variance > f64::MIN_POSITIVE).fold(0.0, f64::max);
    Noise { sensor, process }
}

/// Positions of the stage's samples; the last stage has the record's last one too.
fn samples(stage: &Stage, recording: &Recording, is_last: bool) -> std::ops::Range<usize> {
    let before = |end: f64| recording.t().partition_point(|t| *t < end);
    before(stage.start)..if is_last { recording.count() } else { before(stage.end) }
}

fn stage_limit(stage: &Stage, noise: Noise, section: &Recording, settings: &Settings) -> Option<StageLimit> {
    let (law, pairs) = known_law(stage)?;
    let (courses, motion) = motion(&pairs, section, settings, noise)?;
    let measured = [section.channels().q, section.channels().qd];
    let sensors = Sensors([0, 1].map(|channel| measured[channel].then_some(motion.noise.sensor[channel].sqrt())));
    let bound = bound(&law, &courses, sensors, Start::Unknown).ok()?;
    Some(StageLimit { law, bound, explained: !is_evident(&motion) })
}

/// The motion of a stage as its law and its readings together tell it, and the fit that says so.
fn motion(pairs: &[(Term, f64)], section: &Recording, settings: &Settings, noise: Noise) -> Option<(Vec<Course>, Fit)> {
    let (terms, held) = pairs.iter().map(|(term, value)| (*term, Some(*value))).unzip();
    let form = Form::new(terms, held, Vec::new());
    let evidence = Evidence::new(&[(section, settings.hold)]);
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
        let (fit, std) = (fit.as_ref()?, found.noise_force.filter(|_| stage.identified.is_some())?);
        let during = fit.motion.iter().filter(|(t, _)| (stage.start..=stage.end).contains(t));
        let motion: Vec<Imposed> = during.map(|(t, state)| Imposed { t: *t, state: *state }).collect();
        let (law, _) = known_law(stage)?;
        let bound = force_bound(&law, &motion, std).ok()?;
        Some(StageLimit { law, bound, explained: true })
    };
    found.stages.iter().map(limit).collect()
}
