//! Why there is no limit.

use thiserror::Error;

/// Why a law has no limit here.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LimitsError {
    /// A term that its state does not give.
    #[error(
        "\"{term}\" depends on more than q, q̇ and F of one instant: limits are known for laws without effects with memory, \
         delays and expressions; leave it out of the model"
    )]
    NotPointwise {
        /// The term.
        term: String,
    },
    /// No inertia, or one that the motion meets as zero or less.
    #[error(
        "the law has no positive inertia ({mass} at q = {q}): give it the term \"inertia\" with a positive coefficient"
    )]
    NoInertia {
        /// What multiplies q̈.
        mass: f64,
        /// Where, m.
        q: f64,
    },
    /// A coefficient that is no number.
    #[error("the coefficient of \"{term}\" is {value}: it must be a finite number")]
    Coefficient {
        /// The term.
        term: String,
        /// Its coefficient.
        value: f64,
    },
    /// A sensor without noise: every limit would be 0.
    #[error("the sensor noise of {channel} is {std}: limits need a positive std of every measured quantity")]
    Noise {
        /// Which quantity.
        channel: &'static str,
        /// Its std.
        std: f64,
    },
    /// No sensor.
    #[error("neither q nor qd is measured: one of them is needed")]
    NothingMeasured,
}
