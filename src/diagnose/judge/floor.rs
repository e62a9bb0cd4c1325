//! What the sensors alone would leave of a right law, by trial: noise added to the readings, through a smoother that follows the motion less
//! far, and every term.

use super::equation::Equation;
use super::record::Record;
use super::windows::{COUNT, PRINCIPAL};
use crate::diagnose::motion::Motion;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Error ÷ floor below which the noise cannot be what its differences say: they tell it to a factor of two.
const FAR: f64 = 0.5;

/// Times that noise is drawn.
const DRAWS: u64 = 2;

/// The record as other draws of the sensors' noise would have shown it, and as a smoother at the likeliest cutoff sees it, without the margin:
/// what that changes is what smoothing may take. `force` is the std of the excitation's readings.
pub(in crate::diagnose) fn disturbed(record: &Record, force: f64) -> Vec<Record> {
    (0..DRAWS).filter_map(|seed| record.moved(noisy(record, force, seed))).collect()
}

fn noisy(record: &Record, force: f64, seed: u64) -> Vec<Motion> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut add = |values: &mut [f64], std: f64| {
        values.iter_mut().for_each(|value| {
            let draw: f64 = StandardNormal.sample(&mut random);
            *value += std * draw;
        });
    };
    let mut motions = record.motions.clone();
    for motion in &mut motions {
        let [q, qd] = motion.sensors.noise;
        let closer = motion.sensors.without_margin();
        for (piece, track) in motion.pieces.iter_mut().zip(&mut motion.tracks) {
            piece.q.iter_mut().for_each(|values| add(values, q));
            piece.qd.iter_mut().for_each(|values| add(values, qd));
            add(&mut piece.excitation, force);
            *track = track.resmoothed(piece, closer);
        }
    }
    motions
}

/// RMS of what the noise adds to a law's residual ÷ std of its target, by window length; `errors` are the law's.
///
/// No sensor leaves more than is left: a floor above an error is that error. Where it is far above, the noise was taken for louder than it is
/// (a coarsely sampled motion looks so), and all of it is lowered. NaN where there is no error.
pub(in crate::diagnose) fn floor(
    equation: &Equation,
    solutions: &[Vec<f64>; COUNT],
    others: &[Equation],
    errors: &[f64; COUNT],
) -> [f64; COUNT] {
    let floors = propagated(equation, solutions, others);
    let ratios = errors.iter().zip(floors).map(|(error, floor)| error / floor).filter(|ratio| ratio.is_finite());
    let lowest = ratios.fold(1.0, f64::min);
    let loudness = if lowest < FAR { lowest } else { 1.0 };
    std::array::from_fn(
        |which| if errors[which].is_nan() { f64::NAN } else { (loudness * floors[which]).min(errors[which]) },
    )
}

fn propagated(equation: &Equation, solutions: &[Vec<f64>; COUNT], others: &[Equation]) -> [f64; COUNT] {
    [0, 1, 2].map(|which| {
        let residual = |equation: &Equation| {
            let columns = equation.columns(which);
            super::regression::residuals(&columns, &equation.right[which], &solutions[which])
        };
        let own = residual(equation);
        let added = others.iter().map(|other| mean_square_difference(&residual(other), &own));
        (added.sum::<f64>() / others.len().max(1) as f64).sqrt() / equation.spread[which]
    })
}

fn mean_square_difference(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>() / a.len().max(1) as f64
}

/// Propagated noise ÷ signal of the measured inertia term over windows of the principal length.
pub(in crate::diagnose) fn noise_share(record: &Record, others: &[Record]) -> f64 {
    let own = &record.measured_inertia()[PRINCIPAL];
    let added = others.iter().map(|other| mean_square_difference(&other.measured_inertia()[PRINCIPAL], own));
    let noise = added.sum::<f64>() / others.len().max(1) as f64;
    (noise / mean_square_difference(own, &vec![0.0; own.len()])).sqrt()
}
