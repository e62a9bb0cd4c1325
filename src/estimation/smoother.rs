//! The motion as all samples together tell it: the Bryson–Frazier smoother over a run of the filter.
//!
//! Bierman, International Journal of Control 18 (1973), 65: the smoothed mean at k is x − P λ with the filtered x and
//! P, and λ goes backward through the measurements, λ ← (I − K H)ᵀ λ − Hᵀ ε ÷ s, and through the intervals, λ ← Aᵀ λ.
//! Nothing is inverted: where a law explains its record the covariance is all but singular, and a smoother that divides
//! by it goes back along the law without the measurements, which a damped motion does not bear.

use super::covariance::Matrix;
use super::filter::{Channel, Filter, Innovation};

/// A sample as the filter saw it.
#[derive(Clone, Copy, Debug)]
pub struct Smoothable<const N: usize = 2> {
    /// ∂x⁺/∂x of the interval before.
    pub transition: Matrix<N>,
    /// What the measurements said that the filter did not expect, by channel.
    pub innovations: [Option<Innovation<N>>; 2],
    /// After them.
    pub filtered: Filter<N>,
}

/// Means at every sample of a run that began with `first`, one step for each sample after.
pub fn smooth<const N: usize>(first: &Filter<N>, steps: &[Smoothable<N>]) -> Vec<[f64; N]> {
    let mut means = vec![first.mean; steps.len() + 1];
    let mut adjoint = [0.0; N];
    for (step, mean) in steps.iter().zip(&mut means[1..]).rev() {
        *mean = moved(&step.filtered, &adjoint);
        for channel in [Channel::Qd, Channel::Q] {
            if let Some(innovation) = &step.innovations[channel as usize] {
                let taken: f64 = innovation.gain.iter().zip(&adjoint).map(|(gain, adjoint)| gain * adjoint).sum();
                adjoint[channel as usize] -= taken + innovation.residual * innovation.precision;
            }
        }
        let back = |column: usize| step.transition.iter().zip(&adjoint).map(|(row, entry)| row[column] * entry).sum();
        adjoint = std::array::from_fn(back);
    }
    means[0] = moved(first, &adjoint);
    means
}

/// x − P λ.
fn moved<const N: usize>(filter: &Filter<N>, adjoint: &[f64; N]) -> [f64; N] {
    let take = |mean: f64, (entry, adjoint): (&f64, &f64)| mean - entry * adjoint;
    std::array::from_fn(|row| filter.covariance[row].iter().zip(adjoint).fold(filter.mean[row], take))
}
