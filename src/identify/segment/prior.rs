//! What is known of a segment's coefficients beside its record.

use super::motion_scales::MotionScales;
use crate::estimation::KnownEffect;
use serde::{Deserialize, Serialize};

/// What is known of the free coefficients before any data.
#[derive(Clone, Copy, Debug)]
pub struct Prior<'a> {
    /// Means.
    pub centre: &'a [f64],
    /// Independent stds.
    pub std: &'a [f64],
    /// Std of the logarithm of the inertia, which keeps its sign.
    pub log_inertia: f64,
    /// Which terms the law before had, after a switch.
    pub structure: Option<&'a [bool]>,
    /// How many samples the sensors' variances and the motion's scales are known from.
    pub noise_weight: f64,
    /// Of the effect that the model lacks.
    pub effect: Option<KnownEffect>,
    /// How large the motion was before; counts only as `noise_weight` says.
    pub scales: &'a MotionScales,
}

/// The inertia's prior, normal in its logarithm: as the inertia goes to 0 the law becomes one of first order, whose
/// likelihood over a short record is no worse, and its covariance in the linearisation no longer honest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct InertiaPrior {
    pub(super) centre: f64,
    pub(super) log_std: f64,
}

impl InertiaPrior {
    /// (information, score) about the value m.
    pub(super) fn about(&self, m: f64) -> (f64, f64) {
        let precision = (self.log_std * m).powi(2).recip();
        (precision, -(m / self.centre).ln() * m * precision)
    }
}
