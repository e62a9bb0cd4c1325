//! Where a law fails: in time, in the phase plane, over displacement, amplitude, speed and frequency.
//!
//! The energy of what is left over, its noise taken off, is laid out over bins that the motion visits equally long. The
//! interval of bins that stands out most is a place of failure where it holds much more of the energy than of the time,
//! more than chance and the heavy tails of the energy explain.

use super::force::{Left, Place};
use super::scan::{Bins, Peak, divergence};
use super::spectrum::spectrum;
use crate::estimation::TWENTY_TO_ONE;

/// Bins over a quantity: regions of a twelfth of its range have two …
const BINS: usize = 24;

/// … and over time, where stretches of a twenty-fourth have as many.
const TIME_BINS: usize = 48;

/// Bins along each side of the phase plane: 36 in all, so that each has readings enough.
const SIDE: usize = 6;

/// Share of the evidence of the best place below which another is not worth saying.
const WORTH: f64 = 0.15;

/// Most places that are said: what a reader takes in at a glance.
const MOST: usize = 6;

/// How much better a region of the phase plane must be than an interval of one quantity.
const TWO_SIDED: f64 = 1.3;

/// What the evidence of an interval with two ends counts: it was sought among many more than one that is open.
const CLOSED: f64 = 0.6;

/// Part of the energy per time of the interval that stands out most down to which the error still lasts: the motion
/// shows it more and less.
const LASTING: f64 = 0.05;

/// What the evidence of a band of frequencies counts: the force is a poorer measure of what to expect than time.
const BAND: f64 = 0.1;

/// What a failure is laid out over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Time.
    Time,
    /// Displacement q.
    Displacement,
    /// Distance from the mean position, |q − mean|.
    Excursion,
    /// Velocity q̇.
    Velocity,
    /// Speed |q̇|.
    Speed,
    /// Amplitude of the vibration, √((q − mean)² + (q̇ T/2π)²).
    Amplitude,
    /// A rectangle of q and q̇.
    PhasePlane,
    /// Frequency.
    Frequency,
}

/// An interval; `None` is open.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// From here.
    pub lower: Option<f64>,
    /// To here.
    pub upper: Option<f64>,
}

/// A place where a law fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fail {
    /// What it is laid out over.
    pub over: Over,
    /// Bounds of that quantity (s, Hz, units of q or of q̇); in the phase plane those of q.
    pub bounds: Bounds,
    /// In the phase plane those of q̇.
    pub velocity: Bounds,
    /// In time, the position of the recording.
    pub recording: Option<usize>,
    /// Share of the energy of what is left over, beyond noise.
    pub share: f64,
    /// Share of the time spent there; over frequency, of the driving force's energy.
    pub time_share: f64,
    /// Evidence that it is no chance, nats.
    pub evidence: f64,
}

/// What a search knows of the motion as a whole.
struct Setting {
    mean: f64,
    /// T/2π of the displacement, s.
    radian: f64,
    period: f64,
    /// Independent places, discounted for the noise among them.
    independent: f64,
}

/// Places where the law fails, the one with most evidence first; `period` is that of the displacement, s.
pub fn locate(left: &[Left], period: f64) -> Vec<Fail> {
    let places: Vec<&Place> = left.iter().flat_map(|left| &left.places).collect();
    if places.is_empty() {
        return Vec::new();
    }
    let mean = places.iter().map(|place| place.q).sum::<f64>() / places.len() as f64;
    let setting = Setting { mean, radian: period / std::f64::consts::TAU, period, independent: independent(left) };
    let overs = [Over::Speed, Over::Velocity, Over::Displacement, Over::Excursion, Over::Amplitude];
    let mut fails: Vec<Fail> = overs.into_iter().filter_map(|over| setting.over(over, &places)).collect();
    let best = fails.iter().map(|fail| fail.evidence).fold(0.0, f64::max);
    fails.extend(setting.in_phase_plane(&places).filter(|fail| fail.evidence > TWO_SIDED * best));
    fails.extend(
        (0..=left.iter().map(|left| left.recording).max().unwrap_or(0)).filter_map(|r| setting.in_time(left, r)),
    );
    fails.extend(setting.in_frequency(left));
    fails.retain(|fail| fail.evidence > TWENTY_TO_ONE);
    fails.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    let worth = fails.first().map_or(0.0, |fail| WORTH * fail.evidence);
    fails.retain(|fail| fail.evidence >= worth);
    fails.truncate(MOST);
    fails
}

impl Setting {
    fn value(&self, over: Over, place: &Place) -> f64 {
        match over {
            Over::Speed => place.qd.abs(),
            Over::Velocity => place.qd,
            Over::Excursion => (place.q - self.mean).abs(),
            Over::Amplitude => (place.q - self.mean).hypot(self.radian * place.qd),
            _ => place.q,
        }
    }

    /// The interval of one quantity that stands out most.
    fn over(&self, over: Over, places: &[&Place]) -> Option<Fail> {
        let values: Vec<f64> = places.iter().map(|place| self.value(over, place)).collect();
        let edges = quantiles(&values, BINS);
        let mut bins = Bins::new(BINS);
        for (value, place) in values.iter().zip(places) {
            bins.add(bin(&edges, *value), excess(place), 1.0);
        }
        let peak = settled(&mut bins).peak(CLOSED)?;
        Some(self.fail(over, &peak, bounds(&edges, peak.from, peak.to)))
    }

    fn in_time(&self, left: &[Left], recording: usize) -> Option<Fail> {
        let places: Vec<&Place> =
            left.iter().filter(|left| left.recording == recording).flat_map(|left| &left.places).collect();
        let times: Vec<f64> = places.iter().map(|place| place.t).collect();
        let edges = quantiles(&times, TIME_BINS);
        let mut bins = Bins::new(TIME_BINS);
        for place in &places {
            bins.add(bin(&edges, place.t), excess(place), 1.0);
        }
        let bins = settled(&mut bins);
        let peak = Some(bins.widened(&bins.peak(1.0)?, LASTING)).filter(Peak::stands_out)?;
        let bounds = bounds(&edges, peak.from, peak.to);
        Some(Fail { recording: Some(recording), ..self.fail(Over::Time, &peak, bounds) })
    }

    /// The rectangle of the phase plane that stands out most, among those that are bounded in both directions.
    fn in_phase_plane(&self, places: &[&Place]) -> impl Iterator<Item = Fail> {
        let values = |over: Over| places.iter().map(|place| self.value(over, place)).collect::<Vec<f64>>();
        let edges = [Over::Displacement, Over::Velocity].map(|over| quantiles(&values(over), SIDE));
        let mut rows: Vec<Bins> = (0..SIDE).map(|_| Bins::new(SIDE)).collect();
        for place in places {
            rows[bin(&edges[0], place.q)].add(bin(&edges[1], place.qd), excess(place), 1.0);
        }
        rows.iter_mut().for_each(|row| {
            settled(row);
        });
        let best = rectangles().map(|range| (range, peak(&rows, range))).filter(|(_, peak)| peak.stands_out());
        let best = best.max_by(|a, b| a.1.divergence.total_cmp(&b.1.divergence));
        let fail = best.map(|([from, to, low, high], peak)| Fail {
            velocity: bounds(&edges[1], low, high),
            ..self.fail(Over::PhasePlane, &peak, bounds(&edges[0], from, to))
        });
        fail.into_iter()
    }

    fn in_frequency(&self, left: &[Left]) -> Option<Fail> {
        let spectrum = spectrum(left, self.period)?;
        let peak = spectrum.bins.peak(1.0)?;
        let peak = Peak { divergence: BAND * peak.divergence, ..peak };
        let edge = |bin: usize| Some((bin as f64 + 0.5) * spectrum.width);
        let upper = edge(peak.to).filter(|_| peak.to < spectrum.bins.energy.len());
        let bounds = Bounds { lower: edge(peak.from).filter(|_| peak.from > 0), upper };
        Some(self.fail(Over::Frequency, &peak, bounds))
    }

    fn fail(&self, over: Over, peak: &Peak, bounds: Bounds) -> Fail {
        Fail {
            over,
            bounds,
            velocity: Bounds::default(),
            recording: None,
            share: peak.share,
            time_share: peak.baseline,
            evidence: self.independent * peak.divergence,
        }
    }
}

/// Energy beyond noise.
fn excess(place: &Place) -> f64 {
    place.residual * place.residual - place.noise
}

/// Bins without negative energies.
fn settled(bins: &mut Bins) -> &mut Bins {
    bins.energy.iter_mut().for_each(|energy| *energy = energy.max(0.0));
    bins
}

/// Inner edges of bins that hold equally many of the values.
fn quantiles(values: &[f64], count: usize) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    (1..count).filter_map(|part| sorted.get(part * sorted.len() / count).copied()).collect()
}

fn bin(edges: &[f64], value: f64) -> usize {
    edges.partition_point(|edge| *edge <= value)
}

fn bounds(edges: &[f64], from: usize, to: usize) -> Bounds {
    let lower = from.checked_sub(1).and_then(|edge| edges.get(edge).copied());
    Bounds { lower, upper: to.checked_sub(1).and_then(|edge| edges.get(edge).copied()) }
}

/// Rectangles of the phase plane that leave out something on both of its sides.
fn rectangles() -> impl Iterator<Item = [usize; 4]> {
    let intervals = || (0..SIDE).flat_map(|from| (from + 1..=SIDE).map(move |to| (from, to)));
    let partial = |(from, to): &(usize, usize)| to - from < SIDE;
    intervals()
        .filter(partial)
        .flat_map(move |(from, to)| intervals().filter(partial).map(move |(low, high)| [from, to, low, high]))
}

fn peak(rows: &[Bins], [from, to, low, high]: [usize; 4]) -> Peak {
    let sum = |values: fn(&Bins) -> &Vec<f64>| {
        let inside: f64 = rows[from..to].iter().flat_map(|row| &values(row)[low..high]).sum();
        inside / rows.iter().flat_map(values).sum::<f64>().max(f64::MIN_POSITIVE)
    };
    let (share, baseline) = (sum(|row| &row.energy), sum(|row| &row.baseline));
    Peak { from, to, share, baseline, divergence: divergence(share, baseline) }
}

/// How many places count as independent: their number, less for what is left over being correlated from one to the next
/// (energies of a Gaussian series correlate as the square of it, and scatter with a variance of 2), less for noise.
fn independent(left: &[Left]) -> f64 {
    let residuals: Vec<Vec<f64>> =
        left.iter().map(|left| left.places.iter().map(|place| place.residual).collect()).collect();
    let count = residuals.iter().map(Vec::len).sum::<usize>() as f64;
    let product = |lag: usize| -> f64 {
        residuals.iter().flat_map(|r| r.iter().zip(r.iter().skip(lag)).map(|(a, b)| a * b)).sum()
    };
    let energy = product(0);
    if energy <= 0.0 {
        return 0.0;
    }
    let longest = residuals.iter().map(Vec::len).max().unwrap_or(0);
    let correlations = (1..longest).map(|lag| product(lag) / energy).take_while(|correlation| *correlation > 0.1);
    let correlated: f64 = correlations.map(|correlation| correlation * correlation).sum();
    let beyond: f64 = left.iter().flat_map(|left| &left.places).map(excess).sum();
    let clear = (beyond / energy).clamp(0.0, 1.0);
    0.5 * count / (1.0 + 2.0 * correlated) * clear * clear
}
