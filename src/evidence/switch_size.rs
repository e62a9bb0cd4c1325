//! How large a switch is before the record speaks, as stds.

/// A switch moves a coefficient's force by this part of the acceleration's (of the law's force, where F is what it
/// gives): large enough that few are larger, small enough that one of a tenth loses 0.7 nats
/// (docs/decisions/switch-evidence.md).
pub const SWITCH_SIZE: f64 = 0.3;

/// Of the logarithm of an inertia: after a switch it is 0.6 to 1.6 times what it was.
pub const INERTIA_SPREAD: f64 = 0.5;
