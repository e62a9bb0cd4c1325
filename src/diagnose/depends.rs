//! What the error of a law depends on, where no effect of the catalogue explains it.
//!
//! Four kinds of force are put to the score test beside the law: of time (a coefficient that drifts), of a frequency (a line that is not in
//! the excitation, a coefficient that oscillates), of memory (the motion as it was), of the input. Frequencies come from the periodogram of
//! what the law leaves over along its smoothed motion; all that were looked at share the level.

use super::diagnosis::{Diagnosis, Evidence, LEVEL};
use super::fit::Fit;
use super::judge::chance;
use super::piece::Piece;
use super::screen::{self, Gain};
use super::variants::Scale;
use crate::law::{Effect, Inner, State, Term};
use std::f64::consts::PI;

/// Most frequencies that are looked at.
const FREQUENCIES: usize = 1500;

/// Most places at which what is left over is looked at.
const PLACES: usize = 8000;

/// Highest frequency looked at, as a multiple of where the acceleration's power lies.
const HIGHEST: f64 = 6.0;

/// Ratio between delays that are looked at.
const DELAYS: f64 = 1.6;

/// What a force depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A force that grows over the record.
    Drift,
    /// A stiffness that grows over the record.
    StiffnessDrift,
    /// A damping that grows over the record.
    DampingDrift,
    /// A line of this angular frequency, rad/s.
    Line(f64),
    /// A stiffness that oscillates with this angular frequency, rad/s.
    Parametric(f64),
    /// The displacement this long ago, s.
    PastDisplacement(f64),
    /// The velocity this long ago, s.
    PastVelocity(f64),
    /// The excitation this long ago, s.
    PastExcitation(f64),
    /// The square of the excitation.
    SquaredExcitation,
    /// The magnitude of the excitation.
    ExcitationMagnitude,
}

/// What a law's error depends on most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dependence {
    /// On what.
    pub source: Source,
    /// Log-likelihood gained by a force of it, nats.
    pub gain: f64,
    /// Chance of a gain this large, all that were looked at counted.
    pub p_value: f64,
    /// Amplitude of the force; of a drift its change over the record; in units of the coefficient.
    pub amplitude: f64,
    /// Std of it.
    pub std: f64,
    /// The change of a coefficient ÷ the coefficient in the law, where the law has one.
    pub relative: Option<f64>,
}

/// What the error of the law depends on; none where nothing stands out.
pub fn depends_on(diagnosis: &Diagnosis, evidence: &Evidence) -> Option<Dependence> {
    let law = &diagnosis.base;
    let (sources, looked_at) = sources(law, evidence);
    let span = span(evidence);
    let column = |piece: &Piece, states: &[State]| -> Vec<Vec<f64>> {
        sources.iter().flat_map(|source| source.columns(piece, states, span)).collect()
    };
    let gains = screen::screen_columns(law, &evidence.pieces, &column);
    let mut rest = gains.iter();
    let judged = sources.iter().map(|source| judge(law, *source, &mut rest, looked_at));
    let best = judged.max_by(|a, b| a.gain.total_cmp(&b.gain))?;
    (best.p_value < LEVEL).then_some(best)
}

/// Takes the gains of the source's columns: one, or the two phases of a frequency.
fn judge<'a>(law: &Fit, source: Source, gains: &mut impl Iterator<Item = &'a Gain>, looked_at: usize) -> Dependence {
    let own: Vec<&Gain> = gains.by_ref().take(source.width()).collect();
    let gain = own.iter().map(|gain| gain.gain).sum::<f64>();
    let chance = if own.len() == 2 { (-gain).exp() } else { chance(2.0 * gain) };
    let amplitude = match own.as_slice() {
        [one] => one.coefficient,
        several => several.iter().map(|gain| gain.coefficient.powi(2)).sum::<f64>().sqrt(),
    };
    let std = own.iter().map(|gain| gain.std).fold(0.0, f64::max);
    let changed = source.changes().and_then(|term| law.form.terms.iter().position(|other| *other == term));
    let relative = changed.map(|index| amplitude / law.coefficients[index]).filter(|ratio| ratio.is_finite());
    Dependence { source, gain, p_value: (looked_at as f64 * chance).min(1.0), amplitude, std, relative }
}

impl Source {
    fn width(self) -> usize {
        if matches!(self, Source::Line(_) | Source::Parametric(_)) { 2 } else { 1 }
    }

    /// The term whose coefficient it changes.
    fn changes(self) -> Option<Term> {
        match self {
            Source::StiffnessDrift | Source::Parametric(_) => Some(Term::power(1, 0)),
            Source::DampingDrift => Some(Term::power(0, 1)),
            _ => None,
        }
    }

    /// Its mean forces over a piece's intervals; `span` is the time from the first to the last sample of all.
    fn columns(self, piece: &Piece, states: &[State], span: [f64; 2]) -> Vec<Vec<f64>> {
        let at = |value: &dyn Fn(usize, f64) -> f64| {
            let half = |k: usize| 0.5 * (value(k, piece.t[k]) + value(k + 1, piece.t[k + 1]));
            (0..piece.len() - 1).map(half).collect::<Vec<f64>>()
        };
        let share = |t: f64| (t - span[0]) / (span[1] - span[0]) - 0.5;
        match self {
            Source::Drift => vec![at(&|_, t| share(t))],
            Source::StiffnessDrift => vec![at(&|k, t| share(t) * states[k].q)],
            Source::DampingDrift => vec![at(&|k, t| share(t) * states[k].qd)],
            Source::Line(omega) => vec![at(&|_, t| (omega * t).cos()), at(&|_, t| (omega * t).sin())],
            Source::Parametric(omega) => {
                vec![at(&|k, t| states[k].q * (omega * t).cos()), at(&|k, t| states[k].q * (omega * t).sin())]
            }
            Source::PastDisplacement(delay) => vec![past(piece, states, delay, |state| state.q)],
            Source::PastVelocity(delay) => vec![past(piece, states, delay, |state| state.qd)],
            Source::PastExcitation(delay) => {
                let term = Term::Effect(Effect::ExcitationDelay { delay: Inner::new(delay) });
                screen::columns(&[term], &[], piece, states)
            }
            Source::SquaredExcitation => vec![at(&|k, _| piece.excitation[k].powi(2))],
            Source::ExcitationMagnitude => vec![at(&|k, _| piece.excitation[k].abs())],
        }
    }
}

/// The mean of a state's value over every interval, a time ago; before the record its first value stood.
fn past(piece: &Piece, states: &[State], delay: f64, value: fn(&State) -> f64) -> Vec<f64> {
    let at = |time: f64| {
        let k = piece.t.partition_point(|other| *other <= time).clamp(1, piece.len() - 1);
        let part = ((time - piece.t[k - 1]) / (piece.t[k] - piece.t[k - 1])).clamp(0.0, 1.0);
        (1.0 - part) * value(&states[k - 1]) + part * value(&states[k])
    };
    (0..piece.len() - 1).map(|k| at(0.5 * (piece.t[k] + piece.t[k + 1]) - delay)).collect()
}

fn span(evidence: &Evidence) -> [f64; 2] {
    let times = || evidence.pieces.iter().flat_map(|piece| [piece.t[0], piece.t[piece.len() - 1]]);
    [times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max)]
}

/// The sources that are put to the test, and the number that were looked at to choose them.
fn sources(law: &Fit, evidence: &Evidence) -> (Vec<Source>, usize) {
    let scale = Scale::of(&evidence.pieces, &law.states);
    let mut sources = vec![Source::Drift, Source::StiffnessDrift, Source::DampingDrift];
    let longest = 2.0 * PI / scale.frequency[0];
    let delays = std::iter::successors(Some(2.0 * scale.sample_time), |delay| Some(DELAYS * delay));
    let delays: Vec<f64> = delays.take_while(|delay| *delay < longest).collect();
    sources.extend(delays.iter().flat_map(|delay| [Source::PastDisplacement(*delay), Source::PastVelocity(*delay)]));
    if evidence.forced() {
        sources.extend(delays.iter().map(|delay| Source::PastExcitation(*delay)));
        sources.extend([Source::SquaredExcitation, Source::ExcitationMagnitude]);
    }
    let grid = grid(&scale, span(evidence));
    let looked_at = sources.len() + 2 * grid.len();
    sources.extend(strongest(law, evidence, &grid));
    (sources, looked_at)
}

/// Angular frequencies at half the distance that the record resolves.
fn grid(scale: &Scale, span: [f64; 2]) -> Vec<f64> {
    let spacing = PI / (span[1] - span[0]);
    let highest = (HIGHEST * scale.frequency[1]).min(0.5 * PI / scale.sample_time);
    let count = ((highest / spacing) as usize).min(FREQUENCIES);
    (2..count.max(2)).map(|index| index as f64 * spacing).collect()
}

/// The frequency that explains most of what is left over as a line, and as an oscillating stiffness.
fn strongest(law: &Fit, evidence: &Evidence, grid: &[f64]) -> Vec<Source> {
    let left = left_over(law, evidence);
    let line = |omega: f64| explained(&left, omega, |_| 1.0);
    let parametric = |omega: f64| explained(&left, omega, |place| place.q);
    let best = |value: &dyn Fn(f64) -> f64| {
        grid.iter().map(|omega| (*omega, value(*omega))).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(omega, _)| omega)
    };
    let line = best(&line).map(Source::Line);
    line.into_iter().chain(best(&parametric).map(Source::Parametric)).collect()
}

/// What is left over of the force at an instant.
struct Place {
    t: f64,
    q: f64,
    residual: f64,
}

/// Energy of what is left over that a force `feature · (a cos Ωt + b sin Ωt)` explains.
fn explained(left: &[Place], omega: f64, feature: impl Fn(&Place) -> f64) -> f64 {
    let [mut cosine, mut sine, mut energy] = [0.0; 3];
    for place in left {
        let value = feature(place);
        let (sin, cos) = (omega * place.t).sin_cos();
        cosine += place.residual * value * cos;
        sine += place.residual * value * sin;
        energy += value * value;
    }
    if energy > 0.0 { 2.0 * (cosine * cosine + sine * sine) / energy } else { 0.0 }
}

/// F less the law along the smoothed motion, at most [`PLACES`] of it, each the mean of its neighbours.
fn left_over(law: &Fit, evidence: &Evidence) -> Vec<Place> {
    let samples: usize = evidence.pieces.iter().map(Piece::len).sum();
    let stride = samples.div_ceil(PLACES).max(1);
    let mut left = Vec::new();
    for (piece, states) in evidence.pieces.iter().zip(&law.states) {
        let columns = screen::columns(&law.form.terms, &law.form.expressions, piece, states);
        let residual = |k: usize| {
            let force: f64 = columns.iter().zip(&law.coefficients).map(|(column, value)| column[k] * value).sum();
            0.5 * (piece.excitation[k] + piece.excitation[k + 1]) - force
        };
        let residuals: Vec<f64> = (0..piece.len() - 1).map(residual).collect();
        let place = |(index, chunk): (usize, &[f64])| {
            let middle = index * stride + chunk.len() / 2;
            let residual = chunk.iter().sum::<f64>() / chunk.len() as f64;
            Place { t: 0.5 * (piece.t[middle] + piece.t[middle + 1]), q: states[middle].q, residual }
        };
        left.extend(residuals.chunks(stride).enumerate().map(place).filter(|place| place.residual.is_finite()));
    }
    left
}
