//! The catalogue of named physical effects that are no product of powers.
//!
//! Effects that are monomials (`linear_damping` is `qd`) are names of terms: [`super::Term::parse`] knows them.

use serde::{Deserialize, Serialize};

/// A physical effect on the left-hand side that is no monomial; `q`, `q̇` in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// Dry friction, sign(q̇).
    CoulombFriction,
    /// Drag, |q̇| q̇.
    QuadraticDamping,
    /// Gravity on a pendulum, sin q.
    PendulumRestoring,
    /// |q| q.
    SignedQuadraticStiffness,
    /// A spring that acts on one side only, max(q, 0).
    BilinearStiffness,
    /// Inertia that grows with displacement, q² q̈ + q q̇² (U₀ = q² q̇² / 2).
    PositionDependentInertia,
}

impl Effect {
    /// Every effect of the catalogue that is no monomial.
    pub const ALL: [Effect; 6] = [
        Effect::CoulombFriction,
        Effect::QuadraticDamping,
        Effect::PendulumRestoring,
        Effect::SignedQuadraticStiffness,
        Effect::BilinearStiffness,
        Effect::PositionDependentInertia,
    ];

    /// The stable id used in model files, JSON and FMU variables.
    pub fn id(self) -> &'static str {
        match self {
            Effect::CoulombFriction => "coulomb_friction",
            Effect::QuadraticDamping => "quadratic_damping",
            Effect::PendulumRestoring => "pendulum_restoring",
            Effect::SignedQuadraticStiffness => "signed_quadratic_stiffness",
            Effect::BilinearStiffness => "bilinear_stiffness",
            Effect::PositionDependentInertia => "position_dependent_inertia",
        }
    }

    /// The effect of that id.
    pub fn from_id(id: &str) -> Option<Effect> {
        Effect::ALL.into_iter().find(|effect| effect.id() == id)
    }

    /// How the effect is written in a printed law.
    pub fn symbol(self) -> &'static str {
        match self {
            Effect::CoulombFriction => "sign(q̇)",
            Effect::QuadraticDamping => "|q̇| q̇",
            Effect::PendulumRestoring => "sin q",
            Effect::SignedQuadraticStiffness => "|q| q",
            Effect::BilinearStiffness => "max(q, 0)",
            Effect::PositionDependentInertia => "(q² q̈ + q q̇²)",
        }
    }

    /// The part of the effect that does not multiply q̈, at (q, q̇).
    #[inline]
    pub fn force(self, q: f64, qd: f64) -> f64 {
        match self {
            Effect::CoulombFriction => sign(qd),
            Effect::QuadraticDamping => qd.abs() * qd,
            Effect::PendulumRestoring => q.sin(),
            Effect::SignedQuadraticStiffness => q.abs() * q,
            Effect::BilinearStiffness => q.max(0.0),
            Effect::PositionDependentInertia => q * qd * qd,
        }
    }

    /// (∂/∂q, ∂/∂q̇) of [`Effect::force`]; one-sided where it has a kink, 0 at the jump of a sign.
    #[inline]
    pub fn gradient(self, q: f64, qd: f64) -> (f64, f64) {
        match self {
            Effect::CoulombFriction => (0.0, 0.0),
            Effect::QuadraticDamping => (0.0, 2.0 * qd.abs()),
            Effect::PendulumRestoring => (q.cos(), 0.0),
            Effect::SignedQuadraticStiffness => (2.0 * q.abs(), 0.0),
            Effect::BilinearStiffness => (if q > 0.0 { 1.0 } else { 0.0 }, 0.0),
            Effect::PositionDependentInertia => (qd * qd, 2.0 * q * qd),
        }
    }
}

/// sign(x) with sign(0) = 0, unlike `f64::signum`.
#[inline]
fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}
