//! What a simulated record holds: measured values alone.

use serde::{Deserialize, Serialize};

/// What the sensors and the actuator show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Time, s.
    pub t: f64,
    /// Displacement with its sensor noise, m.
    pub q: f64,
    /// Velocity with its sensor noise, m/s.
    pub qd: f64,
    /// The excitation that is held from this instant on, with its sensor noise, N.
    pub excitation: f64,
}

/// The columns t, q, q̇ and F of a record, each with one value a reading, SI units.
pub fn columns(record: &[Reading]) -> [Vec<f64>; 4] {
    let column = |value: fn(&Reading) -> f64| record.iter().map(value).collect();
    [column(|own| own.t), column(|own| own.q), column(|own| own.qd), column(|own| own.excitation)]
}
