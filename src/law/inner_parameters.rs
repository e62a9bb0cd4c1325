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

pub(super) const SLIP: [InnerParameter; 1] = [InnerParameter {
    name: "slip_length",
    default: 0.05,
    unit: InnerUnit::Coordinate,
    range: InnerRange::Positive,
    description: "Way after a reversal within which friction has turned but for 2/e of its level",
}];

pub(super) const BACKLASH: [InnerParameter; 2] = [
    InnerParameter {
        name: "slip_length",
        default: 0.05,
        unit: InnerUnit::Coordinate,
        range: InnerRange::Positive,
        description: "Way in contact within which friction is 1/e below its level",
    },
    InnerParameter {
        name: "gap",
        default: 0.05,
        unit: InnerUnit::Coordinate,
        range: InnerRange::NotNegative,
        description: "Half the play, the same on both sides",
    },
];

pub(super) const DISPLACEMENT_POWER: [InnerParameter; 1] = [InnerParameter {
    name: "power",
    default: 2.0,
    unit: InnerUnit::Number,
    range: InnerRange::Either(1.0, 2.0),
    description: "Power of the displacement",
}];

pub(super) const COGGING: [InnerParameter; 2] = [
    InnerParameter {
        name: "wave_number",
        default: 10.0,
        unit: InnerUnit::WaveNumber,
        range: InnerRange::Positive,
        description: "N: 2 pi divided by the displacement from one ripple to the next",
    },
    InnerParameter {
        name: "phase",
        default: 0.0,
        unit: InnerUnit::Number,
        range: InnerRange::Any,
        description: "Angle of the ripple at displacement 0, rad: 0 is sin N q, pi/2 is cos N q",
    },
];

pub(super) const RELAXATION: [InnerParameter; 1] = [InnerParameter {
    name: "time",
    default: 0.1,
    unit: InnerUnit::Time,
    range: InnerRange::Positive,
    description: "Time constant: viscosity divided by stiffness of the element",
}];

pub(super) const LAG: [InnerParameter; 1] = [InnerParameter {
    name: "time",
    default: 0.01,
    unit: InnerUnit::Time,
    range: InnerRange::Positive,
    description: "Time constant of the actuator",
}];
