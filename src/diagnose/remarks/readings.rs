//! One channel by itself: wild readings, stuck stretches, coarse steps, clipping, an offset.

use super::remark::Remark;
use super::wild::{bend, smallest_step, wild};
use crate::identify::{Recording, Sample};
use crate::law::numerals::{digits, seconds};
use std::ops::Range;

/// Std ÷ step from which on steps are no coarse ones: the rounding error is then below a thousandth of the motion.
const FINE: f64 = 300.0;

/// Share of readings that equal the one before where steps are what limits a sensor.
const REPEATED: f64 = 0.1;

/// Share of readings that equal the one before, while others go on, in a channel that is read less often than they
/// are: between a half, where every second one is read anew, and what coarse steps leave of a motion.
const HELD: f64 = 0.3;

/// Evidence in nats that equal readings are no chance: one in 10¹³.
const STUCK: f64 = 30.0;

/// Readings at an end of the range ÷ those of the nearest other value or 2 % of the range. A turning point has at most
/// 2.4 times as many, since the time that a parabola spends within k steps of its top goes as √k.
const CLIPPED: f64 = 5.0;

/// Fewest stretches at an end, and fewest readings of one.
const STRETCHES: usize = 3;

/// Fewest different values of a signal that is not switched between levels.
const LEVELS: usize = 16;

/// Mean ÷ std about it from which the motion is beside its zero.
const OFFSET: f64 = 3.0;

/// Remarks on every channel; `calm` is the recording without its wild readings.
pub(super) fn remarks(recording: &Recording, calm: &Recording) -> Vec<Remark> {
    let channels = ["q", "qd", "F"];
    let signals = channels.map(|channel| Some((channel, recording.signal(channel)?)));
    let signals: Vec<(&'static str, &[f64])> = signals.into_iter().flatten().collect();
    let t = recording.t();
    let mut said = Vec::new();
    for (channel, values) in &signals {
        said.extend(missing_words(recording, channel).map(|sentence| Remark::new(channel, "missing", sentence)));
        let moves = *channel != "F";
        let wild = wild(t, values, moves);
        said.extend(wild_words(t, values, &wild).map(|sentence| Remark::new(channel, "wild", sentence)));
        let run = stuck_in(calm, channel, 0..calm.count());
        said.extend(run.map(|run| Remark::new(channel, "stuck", stuck_words(t, values, &run))));
        said.extend(clipped(values).map(|sentence| Remark::new(channel, "clipped", sentence)));
        if moves {
            said.extend(coarse(values).map(|sentence| Remark::new(channel, "coarse", sentence)));
            said.extend(beside(values).map(|sentence| Remark::new(channel, "offset", sentence)));
            let others: Vec<&[f64]> = signals.iter().filter(|other| other.0 != *channel).map(|other| other.1).collect();
            said.extend(held(values, &others).map(|sentence| Remark::new(channel, "held", sentence)));
        }
    }
    said
}

/// How often a sensor gave no reading.
fn missing_words(recording: &Recording, channel: &str) -> Option<String> {
    let value = |sample: &Sample| match channel {
        "q" => sample.q,
        "qd" => sample.qd,
        _ => sample.excitation,
    };
    let mut lacking = recording.incomplete().iter().filter(|sample| value(sample).is_nan());
    let first = seconds(lacking.next()?.t);
    Some(match lacking.count() {
        0 => format!("has no value at {first} s: that sample says nothing of the motion"),
        others => {
            let (count, of) = (others + 1, recording.came());
            format!("has no value in {count} of {of} samples, the first at {first} s: they say nothing of the motion")
        }
    })
}

fn wild_words(t: &[f64], values: &[f64], found: &[usize]) -> Option<String> {
    let size = |at: usize| bend(t, values, at).abs();
    let largest = found.iter().copied().max_by(|a, b| size(*a).total_cmp(&size(*b)))?;
    let at = format!("{} at {} s", digits(values[largest], 4), seconds(t[largest]));
    Some(match found.len() {
        1 => format!("one reading stands far off its neighbours, {at}: correct or delete it"),
        count => {
            format!("{count} readings stand far off their neighbours, the largest {at}: correct or delete them")
        }
    })
}

/// The runs of equal readings, as positions of their first and last.
fn runs(values: &[f64]) -> impl Iterator<Item = (usize, usize)> {
    let begins = move |at: &usize| *at == 0 || values[*at] != values[at - 1];
    let starts = (0..values.len()).filter(begins);
    let ends = (0..values.len()).filter(move |at| at + 1 == values.len() || begins(&(at + 1)));
    starts.zip(ends)
}

/// The longest run of equal readings of a channel in a part of a recording, where it is stuck.
pub(super) fn stuck_in(recording: &Recording, channel: &str, part: Range<usize>) -> Option<Range<usize>> {
    let others = ["q", "qd", "F"].into_iter().filter(|other| *other != channel);
    let others: Vec<&[f64]> = others.filter_map(|other| Some(&recording.signal(other)?[part.clone()])).collect();
    stuck(&recording.signal(channel)?[part.clone()], &others)
}

/// The longest run of equal readings, where chance does not explain it and another channel goes on meanwhile as it does
/// elsewhere. At an end of the range a sensor is clipped, not stuck.
fn stuck(values: &[f64], others: &[&[f64]]) -> Option<Range<usize>> {
    let (start, end) = runs(values).max_by_key(|(start, end)| end - start)?;
    let length = end - start;
    let repeats = values.len() - runs(values).count() - length;
    let rate = (repeats as f64 + 1.0) / (values.len() - length).max(2) as f64;
    let goes_on = |other: &&[f64]| {
        let part = &other[start..=end];
        let [low, high] = ends(part);
        spread(other) > 0.0 && high - low > spread(other) && runs(part).count() > part.len() / 2
    };
    let at_end = ends(values).contains(&values[start]);
    let is_stuck = length as f64 * -rate.ln() >= STUCK && !at_end && others.iter().any(goes_on);
    is_stuck.then_some(start..end + 1)
}

fn stuck_words(t: &[f64], values: &[f64], run: &Range<usize>) -> String {
    let [from, to] = [run.start, run.end - 1].map(|at| seconds(t[at]));
    let (value, count) = (digits(values[run.start], 4), run.len());
    format!(
        "reads {value} without a change from {from} s to {to} s ({count} samples) while others go on: stuck; leave that stretch out, \
         with DATA@…:{from} and DATA@{to}:…"
    )
}

pub(super) fn ends(values: &[f64]) -> [f64; 2] {
    [values.iter().copied().fold(f64::INFINITY, f64::min), values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().map(|value| value / values.len() as f64).sum()
}

/// Std about the mean.
fn spread(values: &[f64]) -> f64 {
    let mean = mean(values);
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Many readings at an end of the range, in several stretches, and few next to it.
fn clipped(values: &[f64]) -> Option<String> {
    let [low, high] = ends(values);
    let at_end = |end: f64, inwards: f64| {
        let stretches = runs(values).filter(|(from, to)| values[*from] == end && to - from + 1 >= STRETCHES);
        let lengths: Vec<usize> = stretches.map(|(from, to)| to - from + 1).collect();
        let distance = |value: &f64| (value - end) * inwards;
        let nearest = values.iter().map(distance).filter(|distance| *distance > 0.0).fold(f64::INFINITY, f64::min);
        let reach = nearest.max(0.02 * (high - low));
        let beside = values.iter().map(distance).filter(|distance| *distance > 0.0 && *distance <= reach).count();
        let held: usize = lengths.iter().sum();
        (lengths.len() >= STRETCHES && held as f64 > CLIPPED * beside as f64).then_some((end, held))
    };
    let found: Vec<(f64, usize)> = [at_end(low, 1.0), at_end(high, -1.0)].into_iter().flatten().collect();
    if found.is_empty() || has_few_levels(values) {
        return None;
    }
    let at: Vec<String> = found.iter().map(|(end, _)| digits(*end, 4)).collect();
    let share = found.iter().map(|(_, held)| held).sum::<usize>() as f64 / values.len() as f64;
    Some(format!(
        "stays at {} in {:.1} % of the samples: clipped; what lies beyond is lost, take a wider range",
        at.join(" and "),
        100.0 * share
    ))
}

/// Whether a signal switches between a few levels.
fn has_few_levels(values: &[f64]) -> bool {
    let mut levels: Vec<f64> = Vec::new();
    for value in values {
        if !levels.contains(value) {
            levels.push(*value);
        }
        if levels.len() > LEVELS {
            return false;
        }
    }
    true
}

/// Steps so large that readings repeat, all differences being multiples of one.
fn coarse(values: &[f64]) -> Option<String> {
    let step = smallest_step(values);
    let (spread, count) = (spread(values), values.len() as f64);
    let repeated = values.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64 / count;
    let whole = |pair: &&[f64]| {
        let steps = (pair[1] - pair[0]) / step;
        (steps - steps.round()).abs() < 0.05
    };
    let is_stepped = values.windows(2).filter(whole).count() as f64 > 0.95 * (count - 1.0);
    (step > 0.0 && spread < FINE * step && repeated > REPEATED && is_stepped).then(|| {
        format!(
            "is read in steps of {}, 1/{:.0} of its std: the rounding is noise that is no white one at slow motion",
            digits(step, 3),
            spread / step
        )
    })
}

/// In how many samples a channel is read anew that is read less often than the others.
fn held(values: &[f64], others: &[&[f64]]) -> Option<String> {
    let read = values.windows(2).filter(|pair| pair[0] != pair[1]).count();
    is_held(values, others).then(|| {
        format!(
            "is read anew in {:.0} % of the samples and repeats itself in the others: `identify` leaves these out; for \
             `compare`, `diagnose` and `improve` keep the samples in which every channel is read",
            100.0 * read as f64 / values.len() as f64
        )
    })
}

/// Whether a channel is read less often than the others: it repeats itself while they go on, and not because it is
/// rounded, as one is whose changes are mostly a single step.
pub(super) fn is_held(values: &[f64], others: &[&[f64]]) -> bool {
    let repeats = |values: &[f64], at: usize| values[at] == values[at - 1];
    let alone = |at: &usize| repeats(values, *at) && others.iter().any(|other| !repeats(other, *at));
    if (1..values.len()).filter(alone).count() as f64 <= HELD * values.len() as f64 {
        return false;
    }
    let mut changes: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    changes.retain(|change| *change > 0.0);
    changes.sort_unstable_by(f64::total_cmp);
    let [small, usual] = [10, 2].map(|part| changes.get(changes.len() / part).copied().unwrap_or(0.0));
    small < 0.5 * usual
}

/// A mean far from 0 of what swings.
fn beside(values: &[f64]) -> Option<String> {
    let (mean, spread) = (mean(values), spread(values));
    (mean.abs() > OFFSET * spread).then(|| {
        let (spread, mean) = (digits(spread, 3), digits(mean, 3));
        format!("swings by {spread} (std) about {mean}: subtract the offset, or give the law a constant_force")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine() -> Vec<f64> {
        (0..4000).map(|n| (0.013 * f64::from(n)).sin()).collect()
    }

    #[test]
    fn a_clean_signal_is_not_remarked_on() {
        let (t, values): (Vec<f64>, Vec<f64>) = ((0..4000).map(f64::from).collect(), sine());
        let cosine: Vec<f64> = t.iter().map(|t| (0.013 * t).cos()).collect();
        assert_eq!((wild(&t, &values, true), stuck(&values, &[&cosine]), clipped(&values)), (vec![], None, None));
        assert_eq!((coarse(&values), beside(&values)), (None, None));
        let rounded: Vec<f64> = values.iter().map(|value| (value * 50.0).round() / 50.0).collect();
        assert_eq!((wild(&t, &rounded, true), clipped(&rounded)), (vec![], None));
        assert!(coarse(&rounded).unwrap().contains("steps of 0.0200"));
        let square: Vec<f64> = values.iter().map(|value| value.signum()).collect();
        assert_eq!((wild(&t, &square, true), clipped(&square)), (vec![], None));
    }

    #[test]
    fn a_channel_is_held_where_it_repeats_itself_at_any_speed() {
        let (t, values): (Vec<f64>, Vec<f64>) = ((0..4000).map(f64::from).collect(), sine());
        let held = |every: usize| (0..4000).map(|at| values[at / every * every]).collect::<Vec<f64>>();
        let rounded = |step: f64| values.iter().map(|value| (value / step).round() * step).collect::<Vec<f64>>();
        assert_eq!([1, 2, 3, 10].map(|every| is_held(&held(every), &[&t])), [false, true, true, true]);
        assert_eq!([0.001, 0.01, 0.02, 0.1].map(|step| is_held(&rounded(step), &[&t])), [false; 4]);
        // what rests with all others is read
        assert!(!is_held(&held(2), &[&held(2)]));
    }

    #[test]
    fn faults_are_seen() {
        let (t, values): (Vec<f64>, Vec<f64>) = ((0..4000).map(f64::from).collect(), sine());
        let cosine: Vec<f64> = t.iter().map(|t| (0.013 * t).cos()).collect();
        for size in [0.3, 1e6, 1e308] {
            let mut spiked = values.clone();
            spiked[700] = size;
            assert_eq!(wild(&t, &spiked, true), [700], "{size}");
            assert!(wild_words(&t, &spiked, &[700]).unwrap().contains("at 700 s"), "{size}");
            assert_eq!(wild(&t, &spiked, false).is_empty(), size < 3.0, "{size}");
        }
        let mut held = values.clone();
        held[1000..1400].fill(values[1000]);
        let run = stuck(&held, &[&cosine]).unwrap();
        assert_eq!(run, 1000..1400);
        assert!(stuck_words(&t, &held, &run).contains("from 1000 s to 1399 s (400 samples)"));
        // A sensor at the end of its range is clipped.
        held[1000..1400].fill(2.0);
        assert_eq!(stuck(&held, &[&cosine]), None);
        let cut: Vec<f64> = values.iter().map(|value| value.clamp(-0.8, 2.0)).collect();
        assert!(clipped(&cut).unwrap().contains("stays at -0.8000 in"));
        assert!(beside(&values.iter().map(|value| value + 9.0).collect::<Vec<_>>()).is_some());
    }
}
