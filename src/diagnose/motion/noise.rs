//! The sensors' noise, from the recording itself.
//!
//! White noise of variance σ² has d-th differences of variance σ² (2d over d); a motion sampled well leaves almost
//! none. What the excitation does between samples does not vanish, so the differences of the velocity are taken beside
//! those of Σ F dt, those of the displacement beside those of ΣΣ F dt². A reading that is rounded to steps of δ errs by
//! δ²/12 at least.

use crate::diagnose::piece::{Piece, usual_step};

/// Orders of differences that are tried; the one that leaves least is kept.
const ORDERS: std::ops::RangeInclusive<usize> = 2..=6;

/// Differences in a block; the median over the blocks does not see jumps and impacts.
const BLOCK: usize = 200;

/// Fewest blocks of which a median is taken.
const BLOCKS: usize = 10;

/// Part of the usual step by which another may differ from it: a clock's jitter, no lost reading.
const UNEVEN: f64 = 0.5;

/// Estimated std of the noise of (q, q̇); 0 for a quantity that is not measured.
pub(in crate::diagnose) fn sensor_noise(pieces: &[Piece]) -> [f64; 2] {
    [0, 1].map(|channel| {
        let smallest = ORDERS.map(|order| of_order(pieces, channel, order)).fold(f64::INFINITY, f64::min);
        if smallest.is_finite() { smallest.max(rounding(pieces, channel)).sqrt() } else { 0.0 }
    })
}

/// Variance from differences of one order; infinite where there are too few.
fn of_order(pieces: &[Piece], channel: usize, order: usize) -> f64 {
    let (mut own, mut driven) = (Vec::new(), Vec::new());
    for piece in pieces {
        if let Some(signal) = piece.measured()[channel] {
            let even = even(&piece.t, order);
            let all = |signal: Vec<f64>| differences(signal, order).into_iter().zip(&even).filter(|(_, even)| **even);
            own.extend(all(signal.to_vec()).map(|(difference, _)| difference));
            driven.extend(all(response(piece, channel)).map(|(difference, _)| difference));
        }
    }
    if own.len() < 4 * order {
        return f64::INFINITY;
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let power = dot(&driven, &driven);
    let slope = if power > 0.0 { dot(&own, &driven) / power } else { 0.0 };
    let squares: Vec<f64> = own.iter().zip(&driven).map(|(own, driven)| (own - slope * driven).powi(2)).collect();
    central_mean(&squares) / central_binomial(order)
}

/// By its first sample, whether a difference is taken over equal steps: across a lost reading the motion itself stands
/// in it. All are where none or too few would be left.
fn even(t: &[f64], order: usize) -> Vec<bool> {
    let usual = usual_step([t].into_iter());
    let is_usual = |pair: &[f64]| (pair[1] - pair[0] - usual).abs() < UNEVEN * usual;
    let even: Vec<bool> = t.windows(order + 1).map(|all| all.windows(2).all(is_usual)).collect();
    let most = 2 * even.iter().filter(|even| **even).count() > even.len();
    if most { even } else { vec![true; even.len()] }
}

/// What the excitation alone does to a unit mass: ΣΣ F dt² in the displacement, Σ F dt in the velocity.
fn response(piece: &Piece, channel: usize) -> Vec<f64> {
    let (mut q, mut qd) = (0.0, 0.0);
    let mut signal = vec![0.0];
    for observation in &piece.observations {
        let [from, middle, to] = observation.drive.part(0, 1);
        q += observation.dt * (qd + observation.dt * (from + 2.0 * middle) / 6.0);
        qd += observation.dt * (from + 4.0 * middle + to) / 6.0;
        signal.push(if channel == 0 { q } else { qd });
    }
    signal
}

fn differences(mut signal: Vec<f64>, order: usize) -> Vec<f64> {
    for _ in 0..order {
        signal = signal.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    signal
}

/// The mean; where there are blocks enough, the median of their means.
fn central_mean(values: &[f64]) -> f64 {
    let mean = |block: &[f64]| block.iter().sum::<f64>() / block.len() as f64;
    if values.len() < BLOCKS * BLOCK {
        return mean(values);
    }
    let mut means: Vec<f64> = values.chunks_exact(BLOCK).map(mean).collect();
    let middle = means.len() / 2;
    *means.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// (2d over d) = Σ_j (d over j)².
fn central_binomial(order: usize) -> f64 {
    (1..=order).map(|j| (order + j) as f64 / j as f64).product()
}

/// Variance of rounding to the smallest step between two readings.
pub(in crate::diagnose) fn rounding(pieces: &[Piece], channel: usize) -> f64 {
    let signals = pieces.iter().filter_map(|piece| piece.measured()[channel]);
    let steps = signals.flat_map(|signal| signal.windows(2)).map(|pair| (pair[1] - pair[0]).abs());
    let smallest = steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest * smallest / 12.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Recording;
    use crate::law::Hold;

    /// Readings of a fast motion, 3 in 100 of which are lost: across a gap the motion itself stands in a difference.
    #[test]
    fn lost_readings_are_no_noise() {
        let whole: Vec<f64> = (0..4000).map(|k| 5e-3 * f64::from(k)).collect();
        let t: Vec<f64> = whole.into_iter().enumerate().filter(|(k, _)| (k * 37) % 100 > 2).map(|(_, t)| t).collect();
        let step = 2e-3;
        let q = t.iter().map(|t| ((30.0 * t).sin() / step).floor() * step).collect();
        let recording = Recording::new("q", t, Some(q), None, None).unwrap();
        let [noise, _] = sensor_noise(&Piece::all(&recording, Hold::Linear));
        let expected = step / 12.0_f64.sqrt();
        assert!((0.7..1.5).contains(&(noise / expected)), "{noise:e} beside {expected:e}");
    }

    #[test]
    fn differences_of_white_noise_have_the_binomial_variance() {
        assert!((central_binomial(3) - 20.0).abs() < 1e-12);
        assert!((central_binomial(4) - 70.0).abs() < 1e-12);
    }
}
