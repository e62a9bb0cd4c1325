//! Readings that no motion explains: alone, or a burst of a few.

use std::ops::Range;

/// Robust std by which a reading stands off the line over it before it is wild: noise alone never does.
const WILD: f64 = 12.0;

/// Most readings of a burst.
pub(super) const LONGEST: usize = 20;

/// Part of a burst's least distance from the line over it by which the readings before and after it may miss that line.
const CALM: f64 = 0.3;

/// Share of the readings from which on bursts are no faults but how the motion goes: in slips, in blows.
const RARE: f64 = 0.01;

/// Readings that stand alone or in short bursts, off the line between those before and after, which go on along it.
/// A burst is wild only where it leaves the range of all other readings by more than that range; so is a single reading
/// of what is no motion, which may be a blow, and may last.
pub(super) fn wild(t: &[f64], values: &[f64], moves: bool) -> Vec<usize> {
    let found = excursions(t, values);
    let bursts: usize = found.iter().map(ExactSizeIterator::len).filter(|length| *length > 1).sum();
    let rare = bursts as f64 <= RARE * values.len() as f64;
    let far = beyond(values, &found);
    let is_wild = |run: &Range<usize>| match run.len() {
        1 => moves || far(run),
        _ => moves && rare && far(run),
    };
    found.iter().filter(|run| is_wild(run)).cloned().flatten().collect()
}

/// How far a reading stands off the line between its neighbours.
pub(super) fn bend(t: &[f64], values: &[f64], at: usize) -> f64 {
    off_line(t, values, [at - 1, at + 1], at)
}

/// How far a reading stands off the line through two others.
fn off_line(t: &[f64], values: &[f64], ends: [usize; 2], at: usize) -> f64 {
    values[at] - line(t, values, ends, at)
}

/// Where a reading would be on the line through two others.
fn line(t: &[f64], values: &[f64], [from, to]: [usize; 2], at: usize) -> f64 {
    let part = (t[at] - t[from]) / (t[to] - t[from]);
    (1.0 - part) * values[from] + part * values[to]
}

/// The values with those readings on the line between the ones before and after.
pub(super) fn without(t: &[f64], values: &[f64], wild: &[usize]) -> Vec<f64> {
    let mut calm = values.to_vec();
    for run in wild.chunk_by(|one, next| one + 1 == *next) {
        let ends = [run[0] - 1, run[run.len() - 1] + 1];
        run.iter().for_each(|at| calm[*at] = line(t, values, ends, *at));
    }
    calm
}

/// Runs of readings off the line over them. The motion's own curvature takes it off by the square of a run's length.
fn excursions(t: &[f64], values: &[f64]) -> Vec<Range<usize>> {
    let usual = usual_bend(t, values);
    let mut found = Vec::new();
    let mut at = 2;
    while at + 2 < values.len() {
        let longest = LONGEST.min(values.len() - 2 - at);
        let is_excursion = |length: &usize| {
            let least = WILD * usual * (0.5 * (*length as f64 + 1.0)).powi(2);
            stands_off(t, values, at..at + length, least)
        };
        let begins = bend(t, values, at - 1).abs() > usual;
        let length = (1..=longest).filter(|_| begins).find(is_excursion);
        found.extend(length.map(|length| at..at + length));
        at += length.unwrap_or(1);
    }
    found
}

/// Whether all of a run is further than that off the line over it, along which the readings beside it go on.
fn stands_off(t: &[f64], values: &[f64], run: Range<usize>, least: f64) -> bool {
    let ends = [run.start - 1, run.end];
    let off = |at: usize| off_line(t, values, ends, at).abs();
    let nearest = run
        .clone()
        .map(off)
        .take_while(|off| *off > least)
        .fold((f64::INFINITY, 0), |(nearest, count), off| (off.min(nearest), count + 1));
    nearest.1 == run.len() && [run.start - 2, run.end + 1].into_iter().all(|at| off(at) < CALM * nearest.0)
}

/// The robust std of bends, or the smallest step where that is larger.
fn usual_bend(t: &[f64], values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = (1..values.len() - 1).map(|at| bend(t, values, at).abs()).collect();
    let middle = sizes.len() / 2;
    let usual = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 / 0.6745;
    usual.max(smallest_step(values))
}

/// The smallest difference of two readings in a row that is one.
pub(super) fn smallest_step(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    Some(steps.fold(f64::INFINITY, f64::min)).filter(|step| step.is_finite()).unwrap_or(0.0)
}

/// Whether a run leaves the range of all the readings outside those found by more than that range.
fn beyond(values: &[f64], found: &[Range<usize>]) -> impl Fn(&Range<usize>) -> bool {
    let mut starts = found.iter().peekable();
    let outside = (0..values.len()).filter(|at| {
        while starts.next_if(|run| run.end <= *at).is_some() {}
        starts.peek().is_none_or(|run| !run.contains(at))
    });
    let [low, high] =
        outside.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(values[at]), high.max(values[at])]);
    move |run| {
        let far = |value: &f64| *value > high + (high - low) || *value < low - (high - low);
        values[run.clone()].iter().all(far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine() -> (Vec<f64>, Vec<f64>) {
        let t: Vec<f64> = (0..4000).map(f64::from).collect();
        let values = t.iter().map(|t| (0.013 * t).sin()).collect();
        (t, values)
    }

    #[test]
    fn bursts_are_found_and_taken_out() {
        let (t, values) = sine();
        for length in [1, 2, 5, 20] {
            for size in [30.0, 1e9, -1e100] {
                let mut spiked = values.clone();
                (700..700 + length).for_each(|at| spiked[at] = size * (1.0 + 0.1 * (at % 3) as f64));
                let found = wild(&t, &spiked, true);
                assert_eq!(found, (700..700 + length).collect::<Vec<_>>(), "{length} of {size}");
                let calm = without(&t, &spiked, &found);
                assert!(calm.iter().zip(&values).all(|(calm, value)| (calm - value).abs() < 0.02), "{length}");
            }
        }
    }

    #[test]
    fn an_uneven_clock_hides_no_spike() {
        let (mut t, values) = sine();
        t.iter_mut().enumerate().for_each(|(at, t)| *t += 0.4 * (7.0 * at as f64).sin());
        for at in 500..600 {
            let mut spiked = values.clone();
            spiked[at] = 1e9;
            assert_eq!(wild(&t, &spiked, true), [at]);
        }
    }

    /// A motion that rests and slips for some samples now and then is no sensor's fault.
    #[test]
    fn slips_are_a_motion() {
        let (t, _) = sine();
        let slips: Vec<f64> = (0..4000).map(|at| if at % 100 < 10 { 1.0 } else { 0.001 * f64::from(at % 2) }).collect();
        assert!(wild(&t, &slips, true).is_empty());
    }
}
