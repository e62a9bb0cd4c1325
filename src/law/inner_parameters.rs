//! The inner parameters of each effect that has any: names, defaults, units, ranges.

use super::inner::{InnerParameter, InnerRange, InnerUnit};

pub(super) const SPEED: [InnerParameter; 1] = [InnerParameter {
    name: "speed",
    default: 0.1,
    unit: InnerUnit::Velocity,
    range: InnerRange::Positive,
    description: "Stribeck speed, at which the falling part is down to 1/e",
}];

pub(super) const DEAD_ZONE_GAP: [InnerParameter; 1] = [InnerParameter {
    name: "gap",
    default: 0.1,
    unit: InnerUnit::Coordinate,
    range: InnerRange::NotNegative,
    description: "Half the play, the same on both sides",
}];

pub(super) const STOP_GAP: [InnerParameter; 1] = [InnerParameter {
    name: "gap",
    default: 0.1,
    unit: InnerUnit::Coordinate,
    range: InnerRange::NotNegative,
    description: "Displacement at which the stop is met",
}];

pub(super) const POWER: [InnerParameter; 1] = [InnerParameter {
    name: "power",
    default: 3.0,
    unit: InnerUnit::Number,
    range: InnerRange::Either(2.0, 3.0),
    description: "Power of the excitation",
}];

pub(super) const DELAY: [InnerParameter; 1] = [InnerParameter {
    name: "delay",
    default: 0.01,
    unit: InnerUnit::Time,
    range: InnerRange::NotNegative,
    description: "Time by which the excitation acts late",
}];

pub(super) const HYSTERESIS: [InnerParameter; 3] = [
    InnerParameter {
        name: "yield_displacement",
        default: 0.1,
        unit: InnerUnit::Coordinate,
        range: InnerRange::Positive,
        description: "Displacement at which the internal displacement saturates",
    },
    InnerParameter {
        name: "share",
        default: 1.0,
        unit: InnerUnit::Number,
        range: InnerRange::AtLeast(0.5),
        description: "Bouc-Wen's beta / (beta + gamma): 1 is Dahl, 0.5 unloads parallel to the first loading",
    },
    InnerParameter {
        name: "exponent",
        default: 1.0,
        unit: InnerUnit::Number,
        range: InnerRange::AtLeast(1.0),
        description: "Sharpness of the knee",
    },
];

pub(super) const RESONATOR: [InnerParameter; 2] = [
    InnerParameter {
        name: "frequency",
        default: 10.0,
        unit: InnerUnit::AngularFrequency,
        range: InnerRange::Positive,
        description: "Angular frequency of the hidden mass on its spring, the coordinate held still",
    },
    InnerParameter {
        name: "damping_ratio",
        default: 0.02,
        unit: InnerUnit::Number,
        range: InnerRange::NotNegative,
        description: "Damping ratio of the hidden mass on its spring",
    },
];
