//! The features of a law where the motion is known as a Gaussian belief: their expectations, and what the belief
//! leaves open of the force.
//!
//! F = Σ θ_j f_j(q, q̇) with (q, q̇) ~ N(x̂, P) has expectation Σ θ_j E f_j and variance Var Σ θ_j f_j. Regressing on
//! E f_j, not on f_j(x̂), leaves no bias by the sensors' noise (regression calibration; Carroll et al., *Measurement
//! Error in Nonlinear Models*, 2006, ch. 4). Expectations are sums over Gauss–Hermite points, exact for powers up to
//! the fifth of q and the ninth of q̇.

use super::super::problem::Problem;
use crate::estimation::Instant;
use crate::law::{Model, State};

/// Points of the displacement in std, and their weights.
const OF_Q: [(f64, f64); 3] =
    [(0.0, 2.0 / 3.0), (1.732_050_807_568_877_2, 1.0 / 6.0), (-1.732_050_807_568_877_2, 1.0 / 6.0)];

/// Points of the velocity in std, and their weights; more of them, since friction jumps there.
const OF_QD: [(f64, f64); 5] = [
    (0.0, 0.533_333_333_333_333_3),
    (1.355_626_179_974_265_8, 0.222_075_922_005_612_63),
    (-1.355_626_179_974_265_8, 0.222_075_922_005_612_63),
    (2.856_970_013_872_805_6, 0.011_257_411_327_720_69),
    (-2.856_970_013_872_805_6, 0.011_257_411_327_720_69),
];

/// Numbers from which on sums of products of four overflow.
const LARGEST: f64 = 1e60;

/// What a law gives at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Expected {
    /// E f_j of every term; 0 behind the last.
    pub features: [f64; Model::MAX_TERMS],
    /// Σ θ_j E f_j.
    pub force: f64,
    /// Var Σ θ_j f_j by the motion's belief, the coefficients known as they are.
    pub of_motion: f64,
}

/// What coefficients of these values and variances give, 0 where the value is exact; none where that is too large to be
/// weighed.
pub fn expect(problem: &Problem, values: &[f64], variances: &[f64], instant: &Instant) -> Option<Expected> {
    let (mut features, mut squares) = ([0.0; Model::MAX_TERMS], [0.0; Model::MAX_TERMS]);
    let (mut mean, mut square) = (0.0, 0.0);
    for (q, qd, weight) in points(instant) {
        let mut force = 0.0;
        for (index, term) in problem.terms.iter().enumerate() {
            let feature = term.force_of(&problem.own, State { q, qd }, 0.0);
            features[index] += weight * feature;
            squares[index] += weight * feature * feature;
            force += values[index] * feature;
        }
        square += weight * force * force;
        mean += weight * force;
    }
    let moments = squares.iter().zip(&features).zip(variances);
    let unknown: f64 = moments.map(|((square, mean), variance)| variance * (square - mean * mean).max(0.0)).sum();
    let of_motion = (square - mean * mean).max(0.0) + unknown;
    let weighable = is_weighable(of_motion) && features.iter().copied().all(is_weighable);
    weighable.then_some(Expected { features, force: mean, of_motion })
}

/// Whether products of the number with its like are numbers too.
pub fn is_weighable(number: f64) -> bool {
    number.abs() < LARGEST
}

/// (q, q̇, weight) of every point.
fn points(instant: &Instant) -> impl Iterator<Item = (f64, f64, f64)> {
    let ([q, qd], [of_q, across, of_qd]) = (instant.state, instant.covariance);
    let std = of_q.max(0.0).sqrt();
    let slope = if of_q > 0.0 { across / of_q } else { 0.0 };
    let rest = (of_qd - slope * across).max(0.0).sqrt();
    OF_Q.into_iter().flat_map(move |(along, share)| {
        OF_QD
            .into_iter()
            .map(move |(beside, weight)| (q + along * std, qd + slope * along * std + beside * rest, share * weight))
    })
}
