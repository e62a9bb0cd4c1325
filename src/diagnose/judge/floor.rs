//! What the sensors alone would leave of a right law, by trial: noise through the smoother, every term and the fit.

use super::driven::Driven;
use super::equation::{Equation, Target};
use super::held_out::Folds;
use super::record::{Column, Record, Timing};
use super::windows::{COUNT, PRINCIPAL};
use crate::diagnose::motion::Motion;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Error ÷ floor below which the noise cannot be what its differences say: they tell it to a factor of two.
const FAR: f64 = 0.5;

/// Times that noise is drawn: over a hundred windows the RMS of one draw is known to 7 %, of two to 5 %.
const DRAWS: u64 = 2;

/// A record whose true motion is known: the smoothed one, read without noise, and read by the sensors again and again
/// (a parametric bootstrap: Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993, sect. 6.5). What smoothing
/// takes of a motion, it takes of this one too.
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
        let draws = (0..DRAWS).filter_map(|seed| record.moved(noisy(&truth, force, Some(seed)))).collect();
        Some(Bootstrap { truth, draws })
    }

    /// Something of every record.
    pub(in crate::diagnose) fn map<T>(&self, of: impl Fn(&Record) -> T) -> Bootstrap<T> {
        Bootstrap { truth: of(&self.truth), draws: self.draws.iter().map(of).collect() }
    }
}

/// The motions of a record as read with the noise of a seed, without any where there is none, and smoothed.
fn noisy(truth: &Record, force: f64, seed: Option<u64>) -> Vec<Motion> {
    let mut random = seed.map(ChaCha8Rng::seed_from_u64);
    let mut add = |values: &mut [f64], std: f64| {
        let Some(random) = &mut random else { return };
        values.iter_mut().for_each(|value| {
            let draw: f64 = StandardNormal.sample(random);
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

/// A law with numbers on a record.
#[derive(Clone, Copy, Debug)]
pub(in crate::diagnose) struct Trial<'a> {
    pub(in crate::diagnose) equation: &'a Equation,
    /// The law's, one for each term.
    pub(in crate::diagnose) coefficients: &'a [f64],
    /// The regression's, by window length.
    pub(in crate::diagnose) solutions: &'a [Vec<f64>; COUNT],
    /// What it leaves, by window length.
    pub(in crate::diagnose) errors: &'a [f64; COUNT],
    /// The parts of the record to which it is fitted in turn; none where its numbers are held.
    pub(in crate::diagnose) folds: Option<&'a Folds>,
}

/// What the sensors alone would leave of a law, by window length, were it right.
///
/// No sensor leaves more than is left: a floor above an error is that error. Where it is far above, the noise was taken
/// for louder than it is (a coarsely sampled motion looks so), and all of it is lowered. NaN where there is no error.
pub(in crate::diagnose) fn floor(trial: &Trial, bootstrap: &Bootstrap<Record>) -> [f64; COUNT] {
    let Bootstrap { truth, draws } = bootstrap.map(|record| trial.on(record));
    let truth = trial.residuals(&truth);
    trial.lowered(draws.iter().map(|draw| less(trial.residuals(draw), &truth)).collect(), [0.0; COUNT])
}

/// The same where the law itself makes the motion: its reversals, stops and steps, which no smoother follows, leave
/// their share too. `force` is the std of the excitation's readings. None where the law does not follow the record.
pub(in crate::diagnose) fn floor_of_law(trial: &Trial, record: &Record, force: f64) -> Option<[f64; COUNT]> {
    let equation = trial.equation;
    let late = equation.delay(&trial.solutions[PRINCIPAL]).map_or(0.0, |(late, _)| late);
    let timing = Timing { delay: equation.timing.delay + late, ..equation.timing };
    let Driven { truth, pull } = Driven::new(record, &equation.terms, trial.coefficients, timing)?;
    let mass = equation.inertia(trial.coefficients)?;
    // what draws the motion along is missing from the force of its equations
    let sign = if equation.target == Target::Inertia { mass.recip() } else { -1.0 };
    let pull = pull.map(|rows| rows.into_iter().map(|value| sign * value).collect());
    // the law's own motion begins with a memory at rest
    let residuals = |record: Record| {
        let Equation { terms, target, timing, .. } = equation;
        trial.residuals(&Equation::from_rest(&record, terms, *target, *timing, trial.folds.is_some()))
    };
    let clean = residuals(truth.moved(noisy(&truth, force, None))?);
    let draws = (0..DRAWS).filter_map(|seed| truth.moved(noisy(&truth, force, Some(seed))));
    let noise = draws.map(|draw| less(residuals(draw), &clean)).collect();
    Some(trial.lowered(noise, trial.left(&[less(clean, &pull)])))
}

fn less(mut rows: Column, other: &Column) -> Column {
    rows.iter_mut().flatten().zip(other.iter().flatten()).for_each(|(value, other)| *value -= other);
    rows
}

impl Trial<'_> {
    /// Its equation on another record.
    fn on(&self, record: &Record) -> Equation {
        Equation::new(record, &self.equation.terms, self.equation.target, self.equation.timing, self.folds.is_some())
    }

    fn residuals(&self, equation: &Equation) -> Column {
        [0, 1, 2].map(|which| {
            super::regression::residuals(&equation.columns(which), &equation.right[which], &self.solutions[which])
        })
    }

    /// Beside what is left without noise.
    fn lowered(&self, noise: Vec<Column>, clean: [f64; COUNT]) -> [f64; COUNT] {
        let noise = self.left(&noise);
        let beyond = |which: usize| (self.errors[which].powi(2) - clean[which].powi(2)).max(0.0).sqrt();
        let ratios = (0..COUNT).map(|which| beyond(which) / noise[which]);
        let lowest = ratios.filter(|ratio| ratio.is_finite() && *ratio > 0.0).fold(1.0, f64::min);
        let loudness = if lowest < FAR { lowest } else { 1.0 };
        std::array::from_fn(|which| match self.errors[which] {
            error if error.is_nan() => f64::NAN,
            error => clean[which].hypot(loudness * noise[which]).min(error),
        })
    }

    /// What is left of residuals, RMS ÷ std of the target: what a fit to the other parts makes of them belongs to the
    /// error of a right law.
    fn left(&self, draws: &[Column]) -> [f64; COUNT] {
        let mut squares = [0.0; COUNT];
        for draw in draws {
            let judged = self.folds.map(|folds| folds.judge(&self.equation.for_rows(draw.clone())).residuals);
            for (sum, left) in squares.iter_mut().zip(judged.as_ref().unwrap_or(draw)) {
                let told: Vec<f64> = left.iter().filter(|value| value.is_finite()).map(|value| value * value).collect();
                *sum += told.iter().sum::<f64>() / told.len().max(1) as f64;
            }
        }
        let count = draws.len().max(1) as f64;
        std::array::from_fn(|which| {
            let scale = self.equation.relative(which, &self.solutions[which]);
            scale * (squares[which] / count).sqrt() / self.equation.spread[which]
        })
    }
}

fn mean_square_difference(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>() / a.len().max(1) as f64
}

/// Propagated noise ÷ signal of the measured inertia term over windows of the principal length.
pub(in crate::diagnose) fn noise_share(bootstrap: &Bootstrap<Record>) -> f64 {
    let Bootstrap { truth, draws } = bootstrap.map(|record| record.measured_inertia()[PRINCIPAL].clone());
    let added = draws.iter().map(|draw| mean_square_difference(draw, &truth));
    let noise = added.sum::<f64>() / draws.len().max(1) as f64;
    (noise / mean_square_difference(&truth, &vec![0.0; truth.len()])).sqrt()
}
