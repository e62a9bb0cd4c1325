//! Units of an FMU's variables, from what the model says of its columns.

use crate::law::{SiUnit, Units};
use switchid_fmu_package::variables::declare_units;
use switchid_fmu_slave::{Description, Unit};

/// Variables that are a displacement, a velocity, an excitation.
const DISPLACEMENTS: [&str; 6] = ["q", "noise.q", "q0", "true.q", "prediction.q", "noise_estimate.q"];
const VELOCITIES: [&str; 7] = ["qd", "noise.qd", "qd0", "true.qd", "der(true.q)", "prediction.qd", "noise_estimate.qd"];
const EXCITATIONS: [&str; 7] =
    ["F", "excitation.F", "excitation.rms", "true.F", "noise.F", "prediction.F", "noise_estimate.F"];

/// Gives every variable its SI unit, where the units are known; `others` knows those of coefficients.
pub(super) fn declare(description: &mut Description, units: &Units, others: impl Fn(&str) -> Option<SiUnit>) {
    declare_units(description, |name| {
        let unit = match name {
            name if DISPLACEMENTS.contains(&name) => units.displacement(),
            name if VELOCITIES.contains(&name) => units.velocity(),
            name if EXCITATIONS.contains(&name) || is_amplitude(name) => units.excitation(),
            name => others(name),
        };
        unit.filter(|unit| unit.symbol != "1").map(|unit| Unit { name: unit.symbol, exponents: unit.exponents })
    });
}

fn is_amplitude(name: &str) -> bool {
    name.starts_with("stage[") && name.ends_with("].P")
}
