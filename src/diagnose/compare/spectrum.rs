//! Energy over frequency of what is left over, beside that of the force that drives the motion.
//!
//! The mean of periodograms of overlapping segments under Hann's window (Welch, IEEE Transactions on Audio and
//! Electroacoustics 15 (1967), 70).

use super::force::{Left, Place};
use super::scan::Bins;
use std::f64::consts::TAU;

/// Periods of the motion in a segment.
const PERIODS: f64 = 8.0;

/// Fewest and most places in a segment.
const PLACES: [usize; 2] = [32, 4096];

/// Most frequencies.
const FREQUENCIES: usize = 256;

/// Most segments that are looked at.
const SEGMENTS: usize = 40;

/// Share of the force's energy that is spread evenly over all frequencies, so that none is without.
const EVEN: f64 = 0.02;

/// Energies over frequency bins of one width.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// What is left over against the force.
    pub bins: Bins,
    /// Width of a bin, Hz; bin k is centred on (k + 1) widths.
    pub width: f64,
    /// What of the force's energy in a bin is the even share.
    pub even: f64,
}

/// The spectrum of all pieces whose places lie as close as the first one's; none where they are too short.
pub fn spectrum(left: &[Left], period: f64) -> Option<Spectrum> {
    let interval = left.first()?.interval;
    let alike = |left: &&Left| (left.interval / interval - 1.0).abs() < 0.01;
    let longest = left.iter().filter(alike).map(|left| left.places.len()).max()?;
    let length = ((PERIODS * period / interval) as usize).clamp(PLACES[0], PLACES[1]).min(longest);
    if length < PLACES[0] {
        return None;
    }
    let segments: Vec<&[Place]> =
        left.iter().filter(alike).flat_map(|left| left.places.windows(length).step_by((length / 2).max(1))).collect();
    let mut bins = Bins::new((length / 2).min(FREQUENCIES));
    for segment in segments.iter().step_by(segments.len().div_ceil(SEGMENTS).max(1)) {
        add(segment, &mut bins);
    }
    let floor = EVEN * bins.baseline.iter().sum::<f64>() / bins.baseline.len() as f64;
    bins.baseline.iter_mut().for_each(|force| *force += floor);
    Some(Spectrum { bins, width: 1.0 / (interval * length as f64), even: floor })
}

fn add(segment: &[Place], bins: &mut Bins) {
    let count = segment.len();
    let hann = |k: usize| 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / count as f64).cos();
    let residual: Vec<f64> = segment.iter().enumerate().map(|(k, place)| hann(k) * place.residual).collect();
    let force: Vec<f64> = segment.iter().enumerate().map(|(k, place)| hann(k) * place.force).collect();
    for bin in 0..bins.energy.len() {
        let turn = TAU * (bin + 1) as f64 / count as f64;
        bins.add(bin, power(&residual, turn), power(&force, turn));
    }
}

/// |Σ x_k e^(i turn k)|², by Goertzel's recurrence.
fn power(values: &[f64], turn: f64) -> f64 {
    let factor = 2.0 * turn.cos();
    let (last, before) = values.iter().fold((0.0, 0.0), |(last, before), value| (value + factor * last - before, last));
    last * last + before * before - factor * last * before
}
