//! What the descriptions of our FMUs have in common.

use switchid_fmu_package::variables::{time, units};
use switchid_fmu_slave::{Description, Enumeration, Variable};

/// Communication step that an FMU proposes, s: 1 kHz, at which vibrations are sampled.
const DEFAULT_STEP: f64 = 1e-3;

/// Duration that an FMU proposes, s: the first switch of every built-in scenario lies within.
const DEFAULT_DURATION: f64 = 30.0;

/// An FMU of these variables and the time under a name.
pub(super) fn describe(
    name: &str,
    description: &str,
    enumerations: Vec<Enumeration>,
    mut variables: Vec<Variable>,
) -> Description {
    variables.push(time());
    Description {
        name: name.into(),
        description: description.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        default_step: DEFAULT_STEP,
        default_duration: DEFAULT_DURATION,
        units: units(&variables),
        model_exchange: false,
        enumerations,
        variables,
    }
}
