//! Named physical effects that are no product of powers.
//!
//! Effects that are monomials (`linear_damping` is `qd`) are names of terms: [`super::Term::parse`] knows them. An effect carries its
//! inner parameters (gap, delay …) with it, so that it alone says what its coefficient multiplies. The feature of a
//! pointwise effect is a function of (q, q̇, F) at one instant; the others have a memory:
//!
//! - delayed excitation: F(t) − F(t − τ). With coefficient 1 on the left, F(t) on the right becomes F(t − τ).
//! - hysteresis: z with ż = q̇ − (s |q̇| |z|^(n−1) z + (1 − s) q̇ |z|^n) ÷ x_y^n, the Bouc–Wen model (Bouc 1967, Wen 1976) in a form
//!   whose z saturates at the yield displacement x_y; s = β ÷ (β + γ), and s = n = 1 is Dahl's model (1968).
//! - hidden resonator: ÿ with ÿ = Ω² (q − y) + 2ζΩ (q̇ − ẏ), an unmeasured mass on a spring that the coordinate carries
//!   (Den Hartog, Mechanical Vibrations, ch. 3); its coefficient is that mass.

use super::inner::{Inner, InnerError, InnerParameter};
use super::inner_parameters::{DEAD_ZONE_GAP, DELAY, HYSTERESIS, POWER, RESONATOR, SPEED, STOP_GAP};
use serde::{Deserialize, Serialize};

/// A physical effect on the left-hand side that is no monomial; `q`, `q̇` in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// Dry friction, sign(q̇).
    CoulombFriction,
    /// Dry friction that falls with speed, sign(q̇) e^(−|q̇| ÷ speed).
    StribeckFriction {
        /// Stribeck speed, m/s.
        speed: Inner,
    },
    /// Drag, |q̇| q̇.
    QuadraticDamping,
    /// Gravity on a pendulum, sin q.
    PendulumRestoring,
    /// |q| q.
    SignedQuadraticStiffness,
    /// A spring behind play on both sides, sign(q) max(|q| − gap, 0).
    DeadZoneStiffness {
        /// Half the play, m.
        gap: Inner,
    },
    /// A spring that is met at a displacement, max(q − gap, 0).
    OneSidedStop {
        /// Where it is met, m.
        gap: Inner,
    },
    /// A spring that acts on one side only, max(q, 0).
    BilinearStiffness,
    /// Inertia that grows with displacement, q² q̈ + q q̇² (U₀ = q² q̇² / 2).
    PositionDependentInertia,
    /// An actuator whose gain changes with its load, F² or F³.
    ExcitationGainNonlinearity {
        /// 2 or 3.
        power: Inner,
    },
    /// An actuator that acts late, F(t) − F(t − delay).
    ExcitationDelay {
        /// Delay, s.
        delay: Inner,
    },
    /// Bouc–Wen's or Dahl's internal displacement z.
    Hysteresis {
        /// Displacement at which z saturates, m.
        yield_displacement: Inner,
        /// s = β ÷ (β + γ): 1 for Dahl, 1/2 for unloading parallel to the first loading.
        share: Inner,
        /// n: how sharp the knee is.
        exponent: Inner,
    },
    /// The acceleration of an unmeasured mass on a spring and a damper.
    HiddenResonator {
        /// Angular frequency Ω of the mass on its spring, rad/s.
        frequency: Inner,
        /// Damping ratio ζ of the mass on its spring.
        damping_ratio: Inner,
    },
}

const fn default(parameter: &InnerParameter) -> Inner {
    Inner::new(parameter.default)
}

impl Effect {
    /// The most inner parameters that an effect has.
    pub const MAX_INNER: usize = 3;

    /// Every effect of the catalogue that is no monomial, its inner parameters at their defaults.
    pub const ALL: [Effect; 13] = [
        Effect::CoulombFriction,
        Effect::StribeckFriction { speed: default(&SPEED[0]) },
        Effect::QuadraticDamping,
        Effect::PendulumRestoring,
        Effect::SignedQuadraticStiffness,
        Effect::DeadZoneStiffness { gap: default(&DEAD_ZONE_GAP[0]) },
        Effect::OneSidedStop { gap: default(&STOP_GAP[0]) },
        Effect::BilinearStiffness,
        Effect::PositionDependentInertia,
        Effect::ExcitationGainNonlinearity { power: default(&POWER[0]) },
        Effect::ExcitationDelay { delay: default(&DELAY[0]) },
        Effect::Hysteresis {
            yield_displacement: default(&HYSTERESIS[0]),
            share: default(&HYSTERESIS[1]),
            exponent: default(&HYSTERESIS[2]),
        },
        Effect::HiddenResonator { frequency: default(&RESONATOR[0]), damping_ratio: default(&RESONATOR[1]) },
    ];

    /// The stable id used in model files, JSON and FMU variables.
    pub fn id(self) -> &'static str {
        match self {
            Effect::CoulombFriction => "coulomb_friction",
            Effect::StribeckFriction { .. } => "stribeck_friction",
            Effect::QuadraticDamping => "quadratic_damping",
            Effect::PendulumRestoring => "pendulum_restoring",
            Effect::SignedQuadraticStiffness => "signed_quadratic_stiffness",
            Effect::DeadZoneStiffness { .. } => "dead_zone_stiffness",
            Effect::OneSidedStop { .. } => "one_sided_stop",
            Effect::BilinearStiffness => "bilinear_stiffness",
            Effect::PositionDependentInertia => "position_dependent_inertia",
            Effect::ExcitationGainNonlinearity { .. } => "excitation_gain_nonlinearity",
            Effect::ExcitationDelay { .. } => "excitation_delay",
            Effect::Hysteresis { .. } => "hysteresis",
            Effect::HiddenResonator { .. } => "hidden_resonator",
        }
    }

    /// The effect of that id, its inner parameters at their defaults.
    pub fn prototype(id: &str) -> Option<Effect> {
        Effect::ALL.into_iter().find(|effect| effect.id() == id)
    }

    /// The inner parameters, in the order of [`Effect::inner_values`].
    pub fn inner(self) -> &'static [InnerParameter] {
        match self {
            Effect::StribeckFriction { .. } => &SPEED,
            Effect::DeadZoneStiffness { .. } => &DEAD_ZONE_GAP,
            Effect::OneSidedStop { .. } => &STOP_GAP,
            Effect::ExcitationGainNonlinearity { .. } => &POWER,
            Effect::ExcitationDelay { .. } => &DELAY,
            Effect::Hysteresis { .. } => &HYSTERESIS,
            Effect::HiddenResonator { .. } => &RESONATOR,
            _ => &[],
        }
    }

    /// The values of the inner parameters, one for each of [`Effect::inner`], in its unit.
    pub fn inner_values(self) -> Vec<f64> {
        let inner: &[Inner] = match &self {
            Effect::StribeckFriction { speed } => &[*speed],
            Effect::DeadZoneStiffness { gap } | Effect::OneSidedStop { gap } => &[*gap],
            Effect::ExcitationGainNonlinearity { power } => &[*power],
            Effect::ExcitationDelay { delay } => &[*delay],
            Effect::Hysteresis { yield_displacement, share, exponent } => &[*yield_displacement, *share, *exponent],
            Effect::HiddenResonator { frequency, damping_ratio } => &[*frequency, *damping_ratio],
            _ => &[],
        };
        inner.iter().map(|inner| inner.value()).collect()
    }

    /// The same effect with these values of its inner parameters.
    ///
    /// # Errors
    /// [`InnerError`] for another number of values, or a value out of its range.
    pub fn with_inner(self, values: &[f64]) -> Result<Effect, InnerError> {
        self.check_inner(values)?;
        let value = |index: usize| Inner::new(values.get(index).copied().unwrap_or_default());
        Ok(match self {
            Effect::StribeckFriction { .. } => Effect::StribeckFriction { speed: value(0) },
            Effect::DeadZoneStiffness { .. } => Effect::DeadZoneStiffness { gap: value(0) },
            Effect::OneSidedStop { .. } => Effect::OneSidedStop { gap: value(0) },
            Effect::ExcitationGainNonlinearity { .. } => Effect::ExcitationGainNonlinearity { power: value(0) },
            Effect::ExcitationDelay { .. } => Effect::ExcitationDelay { delay: value(0) },
            Effect::Hysteresis { .. } => {
                Effect::Hysteresis { yield_displacement: value(0), share: value(1), exponent: value(2) }
            }
            Effect::HiddenResonator { .. } => Effect::HiddenResonator { frequency: value(0), damping_ratio: value(1) },
            _ => self,
        })
    }

    fn check_inner(self, values: &[f64]) -> Result<(), InnerError> {
        let parameters = self.inner();
        if values.len() != parameters.len() {
            let effect = self.id().into();
            return Err(InnerError::Count { effect, expected: parameters.len(), found: values.len() });
        }
        match parameters.iter().zip(values).find(|(parameter, value)| !parameter.range.holds(**value)) {
            None => Ok(()),
            Some((InnerParameter { name, range, .. }, value)) => {
                let (effect, name) = (self.id().into(), (*name).into());
                Err(InnerError::Range { effect, name, value: *value, range: *range })
            }
        }
    }

    /// How the effect is written in a printed law.
    pub fn symbol(self) -> &'static str {
        match self {
            Effect::CoulombFriction => "sign(q̇)",
            Effect::StribeckFriction { .. } => "sign(q̇) e^(−|q̇|/v)",
            Effect::QuadraticDamping => "|q̇| q̇",
            Effect::PendulumRestoring => "sin q",
            Effect::SignedQuadraticStiffness => "|q| q",
            Effect::DeadZoneStiffness { .. } => "sign(q) max(|q| − g, 0)",
            Effect::OneSidedStop { .. } => "max(q − g, 0)",
            Effect::BilinearStiffness => "max(q, 0)",
            Effect::PositionDependentInertia => "(q² q̈ + q q̇²)",
            Effect::ExcitationGainNonlinearity { power } if power.value() == 2.0 => "F²",
            Effect::ExcitationGainNonlinearity { .. } => "F³",
            Effect::ExcitationDelay { .. } => "(F − F(t − τ))",
            Effect::Hysteresis { .. } => "z",
            Effect::HiddenResonator { .. } => "ÿ",
        }
    }

    /// Whether the feature is a function of (q, q̇, F) at one instant.
    #[inline]
    pub fn is_pointwise(self) -> bool {
        !matches!(self, Effect::ExcitationDelay { .. } | Effect::Hysteresis { .. } | Effect::HiddenResonator { .. })
    }

    /// Whether the feature depends on the excitation.
    pub fn uses_excitation(self) -> bool {
        matches!(self, Effect::ExcitationGainNonlinearity { .. } | Effect::ExcitationDelay { .. })
    }

    /// The part of the effect that does not multiply q̈, at (q, q̇, F) in m, m/s and N, for a coefficient of 1; NaN for an effect with memory, whose feature
    /// these do not determine.
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
            Effect::ExcitationDelay { .. } | Effect::Hysteresis { .. } | Effect::HiddenResonator { .. } => f64::NAN,
        }
    }

    /// (∂/∂q, ∂/∂q̇) of [`Effect::force`]; one-sided where it has a kink, 0 at the jump of a sign, NaN for an effect with memory.
    #[inline]
    pub fn gradient(self, q: f64, qd: f64) -> (f64, f64) {
        match self {
            Effect::CoulombFriction | Effect::ExcitationGainNonlinearity { .. } => (0.0, 0.0),
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
            Effect::ExcitationDelay { .. } | Effect::Hysteresis { .. } | Effect::HiddenResonator { .. } => {
                (f64::NAN, f64::NAN)
            }
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
    use crate::law::InnerRange;

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

    #[test]
    fn inner_values_are_set_and_read_in_the_order_of_their_names() {
        for effect in Effect::ALL {
            let defaults: Vec<f64> = effect.inner().iter().map(|parameter| parameter.default).collect();
            assert_eq!(effect.inner_values(), defaults, "{effect:?}");
            assert_eq!(Effect::prototype(effect.id()), Some(effect));
            let others: Vec<f64> = effect.inner().iter().map(other).collect();
            let changed = effect.with_inner(&others).unwrap();
            assert_eq!(changed.inner_values(), others);
            assert_eq!(changed == effect, others.is_empty());
            assert!(effect.inner().len() <= Effect::MAX_INNER);
        }
    }

    fn other(parameter: &InnerParameter) -> f64 {
        match parameter.range {
            InnerRange::Either(one, other) if parameter.default == other => one,
            _ => 1.7 * parameter.default,
        }
    }

    #[test]
    fn impossible_inner_values_are_refused_with_their_range() {
        let refused =
            |id: &str, values: &[f64]| Effect::prototype(id).unwrap().with_inner(values).unwrap_err().to_string();
        assert!(refused("dead_zone_stiffness", &[-0.1]).contains("gap = -0.1"));
        assert!(refused("one_sided_stop", &[f64::NAN]).contains("gap = NaN"));
        assert!(refused("stribeck_friction", &[0.0]).contains("greater than 0"));
        assert!(refused("excitation_gain_nonlinearity", &[4.0]).contains("2 or 3"));
        assert!(refused("hysteresis", &[0.1, 0.2, 1.0]).contains("share = 0.2"));
        assert!(refused("hysteresis", &[0.1]).contains("3 inner parameters"));
        assert!(refused("coulomb_friction", &[0.1]).contains("0 inner parameters"));
    }

    #[test]
    fn an_effect_survives_being_written() {
        for effect in Effect::ALL {
            let text = serde_json::to_string(&effect).unwrap();
            assert_eq!(serde_json::from_str::<Effect>(&text).unwrap(), effect, "{text}");
            let bytes = postcard::to_stdvec(&effect).unwrap();
            assert_eq!(postcard::from_bytes::<Effect>(&bytes).unwrap(), effect);
        }
    }
}
