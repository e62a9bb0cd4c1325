//! The JSON document of `switchid compare`.

use super::diagnose::WindowReport;
use super::output::Pairs;
use crate::diagnose::{Bounds, Comparison, Error, Fail, Over, Side, Verdict};
use crate::law::{Model, Term};
use serde::Serialize;

/// The document.
#[derive(Serialize)]
pub(super) struct Report {
    verdict: &'static str,
    error: ErrorReport,
    errors: Option<Vec<WindowReport>>,
    coefficients: Pairs,
    std: Pairs,
    /// Inner parameters, those that the model leaves open as the judge found them: `gap of dead_zone_stiffness`.
    inner: Pairs,
    fails: Vec<FailReport>,
    best: SideReport,
    recordings: Vec<RecordingReport>,
}

#[derive(Serialize)]
struct SideReport {
    error: ErrorReport,
    errors: Option<Vec<WindowReport>>,
    coefficients: Pairs,
    std: Pairs,
    undetermined: Vec<String>,
    fails: Vec<FailReport>,
}

#[derive(Serialize)]
struct FailReport {
    kind: &'static str,
    over: &'static str,
    bounds: Vec<BoundsReport>,
    data: Option<String>,
    share: f64,
    time_share: f64,
    evidence: f64,
    sentence: String,
}

#[derive(Serialize)]
struct BoundsReport {
    of: &'static str,
    lower: Option<f64>,
    upper: Option<f64>,
}

#[derive(Serialize)]
struct RecordingReport {
    data: String,
    hold: &'static str,
    noise: Pairs,
    error: ErrorReport,
    best: ErrorReport,
}

#[derive(Serialize)]
struct ErrorReport {
    force_residual: f64,
    window: f64,
    noise_floor: f64,
    ratio: Option<f64>,
    free_run_nrmse: Option<f64>,
    free_run_nrmse_velocity: Option<f64>,
    free_run_diverged: Option<f64>,
    window_rmse: Option<f64>,
    horizon: f64,
}

impl Report {
    /// Of a comparison.
    pub(super) fn of(found: &Comparison, model: &Model) -> Report {
        let error = |error: &Error| ErrorReport::of(error, found);
        let recordings = found.sources.iter().enumerate().map(|(index, source)| RecordingReport {
            data: source.clone(),
            hold: found.holds[index].id(),
            noise: noise(found.noise[index]),
            error: error(&found.given.each[index]),
            best: error(&found.best.each[index]),
        });
        Report {
            verdict: id(found.verdict()),
            error: error(&found.given.error),
            errors: errors(&found.given),
            coefficients: coefficients(&found.given),
            std: std(&found.given),
            inner: inner(found, model),
            fails: found.given.fails.iter().map(|fail| FailReport::of(fail, found)).collect(),
            best: SideReport {
                error: error(&found.best.error),
                errors: errors(&found.best),
                coefficients: coefficients(&found.best),
                std: std(&found.best),
                undetermined: found.best.law.undetermined.iter().map(|term| term.name()).collect(),
                fails: found.best.fails.iter().map(|fail| FailReport::of(fail, found)).collect(),
            },
            recordings: recordings.collect(),
        }
    }
}

impl FailReport {
    fn of(fail: &Fail, found: &Comparison) -> FailReport {
        let over = over(fail.over);
        let one = |of: &'static str, bounds: Bounds| BoundsReport { of, lower: bounds.lower, upper: bounds.upper };
        let bounds = match fail.over {
            Over::PhasePlane => vec![one("q", fail.bounds), one("qd", fail.velocity)],
            _ => vec![one(over, fail.bounds)],
        };
        FailReport {
            kind: if fail.over == Over::Time { "time" } else { "region" },
            over,
            bounds,
            data: fail.recording.and_then(|index| found.sources.get(index).cloned()),
            share: fail.share,
            time_share: fail.time_share,
            evidence: fail.evidence,
            sentence: found.sentence(fail),
        }
    }
}

fn over(over: Over) -> &'static str {
    match over {
        Over::Time => "t",
        Over::Displacement => "q",
        Over::Excursion => "excursion",
        Over::Velocity => "qd",
        Over::Speed => "speed",
        Over::Amplitude => "amplitude",
        Over::PhasePlane => "phase_plane",
        Over::Frequency => "frequency",
    }
}

impl ErrorReport {
    fn of(error: &Error, found: &Comparison) -> ErrorReport {
        ErrorReport {
            force_residual: error.force_residual,
            window: found.window,
            noise_floor: error.noise_floor,
            ratio: Some(error.ratio()).filter(|ratio| ratio.is_finite()),
            free_run_nrmse: error.free_run_nrmse,
            free_run_nrmse_velocity: error.free_run_nrmse_velocity,
            free_run_diverged: error.diverged,
            window_rmse: error.window_rmse,
            horizon: found.horizon,
        }
    }
}

fn errors(side: &Side) -> Option<Vec<WindowReport>> {
    side.judged.as_ref().map(|judged| WindowReport::all(&judged.errors, judged.target))
}

fn id(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::AtNoise => "at_noise",
        Verdict::NumbersOff => "numbers_off",
        Verdict::NumbersOffAndMore => "numbers_off_and_more",
        Verdict::FormWrong => "form_wrong",
    }
}

fn noise(std: [f64; 2]) -> Pairs {
    let channels = ["q", "qd"].into_iter().zip(std).filter(|(_, std)| *std > 0.0);
    Pairs(channels.map(|(channel, std)| (channel.to_string(), std)).collect())
}

fn coefficients(side: &Side) -> Pairs {
    let law = &side.law;
    let known = law.terms.iter().zip(&law.coefficients).filter(|(term, _)| !law.undetermined.contains(term));
    Pairs(known.map(|(term, value)| (term.name(), *value)).collect())
}

fn inner(found: &Comparison, model: &Model) -> Pairs {
    let of = |term: &Term| {
        let named = term.inner_named(&model.expressions).into_iter();
        named.map(|(name, value)| (format!("{name} of {}", term.name()), value)).collect::<Vec<_>>()
    };
    Pairs(found.best.law.terms.iter().flat_map(of).collect())
}

fn std(side: &Side) -> Pairs {
    let pairs = side.law.terms.iter().zip(&side.law.std);
    Pairs(pairs.filter_map(|(term, std)| Some((term.name(), (*std)?))).collect())
}
