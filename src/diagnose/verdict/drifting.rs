//! A displacement whose sensor drifts, seen before any effect is: no effect knows the time.

use super::case::{Case, Standing};
use super::diagnosis::diagnose;
use super::doubt::{LARGE, is_large, may_be};
use super::errors::{TIE, are_adequate};
use crate::diagnose::judge::{COUNT, Drift, drift};
use crate::identify::Recording;
use crate::law::Term;

/// Further looks at a drift, each of which takes most of what the one before has left.
const LOOKS: usize = 4;

/// T₀ that a record must be long at least: its waves of half the record and longer are then slower than the motion.
const LONG: f64 = 10.0;

/// The recordings without the drift that a law of these terms sees in them; none where nothing drifts so much, or an
/// effect explains as much. Where F is the output a drift of q is one of F as well, and none is claimed. `posed` puts
/// recordings under judgement.
pub(super) fn steadied(
    case: &Case,
    recordings: &[&Recording],
    terms: &[Term],
    posed: impl Fn(&[&Recording]) -> Option<Case>,
) -> Option<(Case, Vec<Drift>)> {
    let standing = case.stand(terms)?;
    let long = case.record.duration > LONG * case.record.period && case.record.motions.len() == recordings.len();
    if !long || !terms.contains(&Term::Inertia) || are_adequate(&case.errors_of(&standing)) {
        return None;
    }
    let (mut drifts, ratio) = of(case, &standing)?;
    if ratio > LARGE {
        return None;
    }
    let effects = diagnose(case, terms)?;
    let steady = |drifts: &[Drift]| -> Option<(Case, Standing)> {
        let without: Option<Vec<Recording>> =
            recordings.iter().zip(drifts).map(|(recording, drift)| without(recording, drift)).collect();
        let case = posed(&without?.iter().collect::<Vec<_>>())?;
        let standing = case.stand(terms)?;
        Some((case, standing))
    };
    let (mut steadied, mut stands) = steady(&drifts)?;
    // the law's coefficients were those under the drift: another look with its own, as long as that helps
    for _ in 0..LOOKS {
        let Some((more, _)) = of(&steadied, &stands) else { break };
        let mut sums = drifts.clone();
        sums.iter_mut().zip(more).for_each(|(sum, more)| sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more));
        let Some((case, next)) = steady(&sums).filter(|(_, next)| next.held.score(&stands.held) < -TIE) else { break };
        (steadied, stands, drifts) = (case, next, sums);
    }
    let best = effects.candidates.iter().filter(|candidate| may_be(candidate.doubt)).map(|candidate| candidate.score);
    let beats = stands.held.score(&standing.held) < best.fold(0.0, f64::min) - TIE * COUNT as f64;
    (beats && is_large(&standing.held, &stands.held, &standing.floor)).then_some((steadied, drifts))
}

fn of(case: &Case, standing: &Standing) -> Option<(Vec<Drift>, f64)> {
    drift(&case.record, &standing.equation, &standing.estimate.coefficients)
}

/// A recording whose displacement reads so much less.
fn without(recording: &Recording, drift: &Drift) -> Option<Recording> {
    let has = recording.channels();
    let samples: Vec<_> = (0..recording.count()).map(|index| recording.sample(index)).collect();
    let t = recording.t();
    let [from, to] = [t.first()?, t.last()?];
    let at = |t: f64| {
        let place = 2.0 * (t - from) / (to - from) - 1.0;
        drift.iter().rev().fold(0.0, |sum, coefficient| sum * place + coefficient)
    };
    let q = samples.iter().map(|sample| sample.q - at(sample.t)).collect();
    let qd = has.qd.then(|| samples.iter().map(|sample| sample.qd).collect());
    let excitation = has.excitation.then(|| samples.iter().map(|sample| sample.excitation).collect());
    Recording::new(recording.source(), t.to_vec(), has.q.then_some(q), qd, excitation).ok().filter(|_| has.q)
}

/// How much a displacement wanders over its recording, m.
pub(super) fn wandering(drift: &Drift) -> f64 {
    let at = |step: i32| drift.iter().rev().fold(0.0, |sum, own| sum * (f64::from(step) / 50.0 - 1.0) + own);
    let all = || (0..=100).map(at);
    all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
}
