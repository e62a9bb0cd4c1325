//! What becomes of the publication's claims about e.

use super::super::figure::Claim;
use super::super::follow::RIGHT;
use super::super::statistics::{factor, falls, percent, share, small};
use super::NOISES;
use super::view::{Method, NOISE, OURS, PUBLISHED, View, by_plant};

/// Little noise, where a short record has its best chance.
const LITTLE: f64 = 0.002;

/// A gain in e below this factor is little.
const LITTLE_GAIN: f64 = 2.0;

/// A law is acceptable where at least this share of the records gives one with e < 0.05².
const ACCEPTABLE: f64 = 0.5;

/// Every claim about e.
pub fn claims(views: &[View]) -> Vec<Claim> {
    vec![rises(views), short(views), two_periods(views), half_a_period(views)]
}

/// Whether something holds for both plants.
fn everywhere(views: &[View], holds: impl Fn(&View) -> bool) -> bool {
    views.iter().all(holds)
}

fn rises(views: &[View]) -> Claim {
    let series = |view: &View, method: Method| -> Vec<f64> {
        let middle = view.plant.intervals()[2];
        NOISES.iter().rev().filter_map(|noise| view.median(method, *noise, middle)).collect()
    };
    // neighbours lie so near that chance may swap them
    let rises = |values: Vec<f64>| {
        (0..2).all(|first| falls(&values.iter().copied().skip(first).step_by(2).collect::<Vec<_>>()))
    };
    let ends = |values: Vec<f64>| format!("{} to {}", small(values[values.len() - 2]), small(values[0]));
    Claim {
        claim: "e rises with noise",
        published: everywhere(views, |view| rises(series(view, PUBLISHED))),
        ours: everywhere(views, |view| rises(series(view, OURS))),
        evidence: by_plant(views, |view| {
            let [ours, published] = [OURS, PUBLISHED].map(|method| ends(series(view, method)));
            format!("median after {} s, σ 0.002 to 0.2: published {published}, ours {ours}", view.plant.intervals()[2])
        }),
    }
}

fn short(views: &[View]) -> Claim {
    let ratio = |view: &View, method: Method| {
        let intervals = view.plant.intervals();
        let [first, last] = [intervals[0], intervals[4]].map(|length| view.median(method, NOISE, length));
        first.zip(last).map(|(first, last)| first / last)
    };
    let falls = |method: Method| everywhere(views, |view| ratio(view, method).is_some_and(|ratio| ratio > LITTLE_GAIN));
    Claim {
        claim: "e falls with the length of the interval",
        published: falls(PUBLISHED),
        ours: falls(OURS),
        evidence: by_plant(views, |view| {
            let [first, .., last] = view.plant.intervals();
            let [ours, published] = [OURS, PUBLISHED].map(|method| factor(ratio(view, method)));
            let limit = factor(view.limit(NOISE, first) / view.limit(NOISE, last));
            format!(
                "from {first} to {last} s at σ = {NOISE} the median falls by a factor {published} (published), {ours} (ours), {limit} (limit)"
            )
        }),
    }
}

fn two_periods(views: &[View]) -> Claim {
    let gain = |view: &View, method: Method| {
        let [two, last] = [2.0 * view.plant.period(), view.longest()].map(|length| view.median(method, NOISE, length));
        two.zip(last).map(|(two, last)| two / last)
    };
    let little = |method: Method| everywhere(views, |view| gain(view, method).is_some_and(|gain| gain < LITTLE_GAIN));
    Claim {
        claim: "little gain beyond two natural periods",
        published: little(PUBLISHED),
        ours: little(OURS),
        evidence: by_plant(views, |view| {
            let two = 2.0 * view.plant.period();
            let [ours, published] = [OURS, PUBLISHED].map(|method| factor(gain(view, method)));
            let limit = factor(view.limit(NOISE, two) / view.limit(NOISE, view.longest()));
            format!(
                "beyond {two:.1} s the median at σ = {NOISE} still falls by {published} (published), {ours} (ours), {limit} (limit)"
            )
        }),
    }
}

fn half_a_period(views: &[View]) -> Claim {
    let right = |view: &View, method: Method| {
        share(&view.errors(method, LITTLE, 0.5 * view.plant.period()), |error| *error < RIGHT)
    };
    let none = |method: Method| everywhere(views, |view| right(view, method) < ACCEPTABLE);
    Claim {
        claim: "no acceptable law below half a natural period",
        published: none(PUBLISHED),
        ours: none(OURS),
        evidence: by_plant(views, |view| {
            let half = 0.5 * view.plant.period();
            let [ours, published] = [OURS, PUBLISHED].map(|method| percent(right(view, method)));
            let limit = small(view.limit(LITTLE, half));
            format!(
                "after {half:.1} s at σ = {LITTLE} e < 0.05² in {published} (published), {ours} (ours) of the records; limit of e {limit}"
            )
        }),
    }
}
