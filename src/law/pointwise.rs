//! Forces of the effects that one instant gives, and their slopes.

use super::effect::Effect;
use super::term::raised;

impl Effect {
    /// The part of the effect that does not multiply q̈, at (q, q̇, F) in m, m/s and N, for a coefficient of 1; NaN for
    /// an effect with memory, whose feature these do not determine.
    #[inline]
    pub fn force(self, q: f64, qd: f64, excitation: f64) -> f64 {
        match self {
            Effect::CoulombFriction => sign(qd),
            Effect::StribeckFriction { speed } => sign(qd) * (-qd.abs() / speed.value()).exp(),
            Effect::QuadraticDamping => qd.abs() * qd,
            Effect::PendulumRestoring => q.sin(),
            Effect::SignedQuadraticStiffness => q.abs() * q,
            Effect::DeadZoneStiffness { gap } => sign(q) * (q.abs() - gap.value()).max(0.0),
            Effect::OneSidedStop { gap } => (q - gap.value()).max(0.0),
            Effect::BilinearStiffness => q.max(0.0),
            Effect::PositionDependentInertia => q * qd * qd,
            Effect::ExcitationGainNonlinearity { power } => excitation.powi(power.value() as i32),
            Effect::AsymmetricDamping => qd.abs(),
            Effect::LoadDependentFriction => excitation.abs() * sign(qd),
            Effect::PositionDependentFriction { power } => raised(q, power.value() as u8) * sign(qd),
            Effect::Cogging { wave_number, phase } => (wave_number.value() * q + phase.value()).sin(),
            _ => f64::NAN,
        }
    }

    /// (∂/∂q, ∂/∂q̇) of [`Effect::force`]; one-sided where it has a kink, 0 at the jump of a sign, NaN for an effect
    /// with memory.
    #[inline]
    pub fn gradient(self, q: f64, qd: f64) -> (f64, f64) {
        match self {
            Effect::CoulombFriction | Effect::ExcitationGainNonlinearity { .. } | Effect::LoadDependentFriction => {
                (0.0, 0.0)
            }
            Effect::StribeckFriction { speed } => {
                let slope = -(-qd.abs() / speed.value()).exp() / speed.value();
                (0.0, if qd == 0.0 { 0.0 } else { slope })
            }
            Effect::QuadraticDamping => (0.0, 2.0 * qd.abs()),
            Effect::PendulumRestoring => (q.cos(), 0.0),
            Effect::SignedQuadraticStiffness => (2.0 * q.abs(), 0.0),
            Effect::DeadZoneStiffness { gap } => (step(q.abs() - gap.value()), 0.0),
            Effect::OneSidedStop { gap } => (step(q - gap.value()), 0.0),
            Effect::BilinearStiffness => (step(q), 0.0),
            Effect::PositionDependentInertia => (qd * qd, 2.0 * q * qd),
            Effect::AsymmetricDamping => (0.0, sign(qd)),
            Effect::PositionDependentFriction { power } => {
                let slope = if power.value() == 1.0 { 1.0 } else { 2.0 * q };
                (slope * sign(qd), 0.0)
            }
            Effect::Cogging { wave_number, phase } => {
                (wave_number.value() * (wave_number.value() * q + phase.value()).cos(), 0.0)
            }
            _ => (f64::NAN, f64::NAN),
        }
    }
}

/// sign(x) with sign(0) = 0, unlike `f64::signum`.
#[inline]
pub(super) fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// 1 for x > 0, else 0.
#[inline]
fn step(x: f64) -> f64 {
    if x > 0.0 { 1.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_those_of_the_forces() {
        let eps = 1e-6;
        for effect in Effect::ALL.into_iter().filter(|effect| effect.is_pointwise()) {
            for (q, qd, excitation) in [(0.7, -0.12, 0.4), (-1.1, 0.3, -0.8), (0.04, 0.05, 0.2)] {
                let (by_q, by_qd) = effect.gradient(q, qd);
                let along_q = effect.force(q + eps, qd, excitation) - effect.force(q - eps, qd, excitation);
                let along_qd = effect.force(q, qd + eps, excitation) - effect.force(q, qd - eps, excitation);
                for (found, difference) in [(by_q, along_q), (by_qd, along_qd)] {
                    assert!((found - difference / (2.0 * eps)).abs() < 1e-7, "{effect:?}: {found} at {q}, {qd}");
                }
            }
        }
    }

    #[test]
    fn kinks_are_one_sided_and_jumps_flat() {
        for effect in Effect::ALL.into_iter().filter(|effect| effect.is_pointwise()) {
            let (by_q, by_qd) = effect.gradient(0.0, 0.0);
            assert!(by_q.is_finite() && by_qd.is_finite(), "{effect:?}");
            assert!(effect.force(0.0, 0.0, 0.0) == 0.0, "{effect:?}");
        }
        let stop = Effect::prototype("one_sided_stop").unwrap().with_inner(&[0.5]).unwrap();
        assert_eq!(stop.gradient(0.5, 0.0), (0.0, 0.0));
        assert_eq!(stop.gradient(0.5 + 1e-9, 0.0), (1.0, 0.0));
        assert_eq!(stop.force(0.75, 0.0, 0.0), 0.25);
    }
}
