//! What the sensors alone would leave of a right law, by trial: noise through the smoother, every term and the fit.

use super::equation::Equation;
use super::held_out::Folds;
use super::record::Record;
use super::windows::{COUNT, PRINCIPAL};
use crate::diagnose::motion::Motion;
use crate::law::Hold;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Error ÷ floor below which the noise cannot be what its differences say: they tell it to a factor of two.
const FAR: f64 = 0.5;

/// Times that noise is drawn.
const DRAWS: u64 = 2;

/// A record whose true motion is known: the smoothed one, read without noise, and read by the sensors again and again (a parametric
/// bootstrap: Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993, sect. 6.5). What smoothing takes of a motion, it takes of
/// this one too.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Bootstrap<T> {
    /// Without noise.
    pub(in crate::diagnose) truth: T,
    /// As the sensors read and the smoother follows it.
    pub(in crate::diagnose) draws: Vec<T>,
}

impl Bootstrap<Record> {
    /// `force` is the std of the excitation's readings. None where the record can be cut no more.
    pub(in crate::diagnose) fn of(record: &Record, force: f64) -> Option<Bootstrap<Record>> {
        let truth = record.moved(record.motions.iter().map(Motion::as_followed).collect())?;
        let draws = (0..DRAWS).filter_map(|seed| record.moved(noisy(&truth, force, seed))).collect();
        Some(Bootstrap { truth, draws })
    }

    /// Something of every record.
    pub(in crate::diagnose) fn map<T>(&self, of: impl Fn(&Record) -> T) -> Bootstrap<T> {
        Bootstrap { truth: of(&self.truth), draws: self.draws.iter().map(of).collect() }
    }
}

fn noisy(truth: &Record, force: f64, seed: u64) -> Vec<Motion> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut add = |values: &mut [f64], std: f64| {
        values.iter_mut().for_each(|value| {
            let draw: f64 = StandardNormal.sample(&mut random);
            *value += std * draw;
        });
    };
    let mut motions = truth.motions.clone();
    for motion in &mut motions {
        let [q, qd] = motion.sensors.noise;
        for (piece, track) in motion.pieces.iter_mut().zip(&mut motion.tracks) {
            piece.q.iter_mut().for_each(|values| add(values, q));
            piece.qd.iter_mut().for_each(|values| add(values, qd));
            add(&mut piece.excitation, force);
            *track = track.resmoothed(piece, motion.sensors);
        }
    }
    motions
}

/// What the sensors alone would leave of a right law's held-out error, by window length, when it is fitted to each part of the record in
/// turn: `errors` are the law's own. Without `folds` its numbers are held.
///
/// No sensor leaves more than is left: a floor above an error is that error. Where it is far above, the noise was taken for louder than it is
/// (a coarsely sampled motion looks so), and all of it is lowered. NaN where there is no error.
pub(in crate::diagnose) fn floor(
    equation: &Equation,
    solutions: &[Vec<f64>; COUNT],
    bootstrap: &Bootstrap<Equation>,
    errors: &[f64; COUNT],
    folds: Option<&Folds>,
) -> [f64; COUNT] {
    let floors = propagated(equation, solutions, bootstrap, folds);
    let ratios = errors.iter().zip(floors).map(|(error, floor)| error / floor).filter(|ratio| ratio.is_finite());
    let lowest = ratios.fold(1.0, f64::min);
    let loudness = if lowest < FAR { lowest } else { 1.0 };
    std::array::from_fn(
        |which| if errors[which].is_nan() { f64::NAN } else { (loudness * floors[which]).min(errors[which]) },
    )
}

fn propagated(
    equation: &Equation,
    solutions: &[Vec<f64>; COUNT],
    bootstrap: &Bootstrap<Equation>,
    folds: Option<&Folds>,
) -> [f64; COUNT] {
    let Bootstrap { truth, draws } = bootstrap;
    let residual = |equation: &Equation, which: usize| {
        super::regression::residuals(&equation.columns(which), &equation.right[which], &solutions[which])
    };
    let mut squares = [0.0; COUNT];
    for draw in draws {
        let noise = [0, 1, 2].map(|which| {
            let pairs = residual(draw, which).into_iter().zip(residual(truth, which));
            pairs.map(|(draw, truth)| draw - truth).collect::<Vec<f64>>()
        });
        // what a fit to the other parts makes of the noise belongs to the error of a right law
        let left = match folds {
            Some(folds) => folds.judge(&equation.for_rows(noise)).residuals,
            None => noise,
        };
        for (sum, left) in squares.iter_mut().zip(&left) {
            let told: Vec<f64> = left.iter().filter(|value| value.is_finite()).map(|value| value * value).collect();
            *sum += told.iter().sum::<f64>() / told.len().max(1) as f64;
        }
    }
    std::array::from_fn(|which| (squares[which] / draws.len().max(1) as f64).sqrt() / equation.spread[which])
}

fn mean_square_difference(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>() / a.len().max(1) as f64
}

/// Propagated noise ÷ signal of the measured inertia term over windows of the principal length.
pub(in crate::diagnose) fn noise_share(bootstrap: &Bootstrap<Record>) -> f64 {
    let Bootstrap { truth, draws } = bootstrap.map(|record| record.measured_inertia(Hold::Linear)[PRINCIPAL].clone());
    let added = draws.iter().map(|draw| mean_square_difference(draw, &truth));
    let noise = added.sum::<f64>() / draws.len().max(1) as f64;
    (noise / mean_square_difference(&truth, &vec![0.0; truth.len()])).sqrt()
}
