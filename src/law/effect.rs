//! Named physical effects that are no product of powers.
//!
//! Effects that are monomials (`linear_damping` is `qd`) are names of terms: [`super::term::Term::parse`] knows them.
//! An effect carries its inner parameters (gap, delay …) with it, so that it alone says what its coefficient
//! multiplies. The feature of a pointwise effect is a function of (q, q̇, F) at one instant; the others have a memory:
//!
//! - delayed excitation: F(t) − F(t − τ). With coefficient 1 on the left, F(t) on the right becomes F(t − τ).
//! - hysteresis: z with ż = q̇ − (s |q̇| |z|^(n−1) z + (1 − s) q̇ |z|^n) ÷ x_y^n, the Bouc–Wen model (Bouc 1967, Wen
//!   1976) in a form whose z saturates at the yield displacement x_y; s = β ÷ (β + γ), and s = n = 1 is Dahl's model
//!   (1968).
//! - presliding friction: z ÷ x_s with ż = q̇ − |q̇| z ÷ x_s, Dahl's model (1968) with the level of friction as its
//!   coefficient.
//! - friction with backlash: z ÷ x_s with ė = q̇ − |q̇| z ÷ x_s and z = sign(e) max(|e| − g, 0): presliding friction
//!   behind play of ± g, its spring without force within it. g = 0 is presliding friction.
//! - relaxation: w with τ ẇ = q̇ − w, a Maxwell element, whose coefficient is its viscosity, that ÷ τ its stiffness.
//! - actuator lag: F − F_a with τ Ḟ_a = F − F_a. With coefficient 1 on the left, F on the right becomes F_a.
//! - hidden resonator: ÿ with ÿ = Ω² (q − y) + 2ζΩ (q̇ − ẏ), an unmeasured mass on a spring that the coordinate carries
//!   (Den Hartog, Mechanical Vibrations, ch. 3); its coefficient is that mass.

use super::inner::{Inner, InnerError, InnerParameter};
use super::inner_parameters::{
    BACKLASH, COGGING, DEAD_ZONE_GAP, DELAY, DISPLACEMENT_POWER, HYSTERESIS, LAG, POWER, RELAXATION, RESONATOR, SLIP,
    SPEED, STOP_GAP,
};
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
    /// Dry friction that turns over a way, Dahl's z ÷ x_s.
    PreslidingFriction {
        /// x_s, m.
        slip_length: Inner,
    },
    /// Presliding friction behind play.
    FrictionWithBacklash {
        /// x_s, m.
        slip_length: Inner,
        /// Half the play, m.
        gap: Inner,
    },
    /// Damping that differs between the two directions, |q̇|.
    AsymmetricDamping,
    /// Dry friction that grows with the load, |F| sign(q̇).
    LoadDependentFriction,
    /// Dry friction that changes along the way, q sign(q̇) or q² sign(q̇).
    PositionDependentFriction {
        /// 1 or 2.
        power: Inner,
    },
    /// A force that repeats along the way, sin(N q + φ).
    Cogging {
        /// N, rad/m.
        wave_number: Inner,
        /// φ, rad.
        phase: Inner,
    },
    /// A damper and a spring in series (Maxwell): q̇ through a first-order lag.
    Relaxation {
        /// τ, s.
        time: Inner,
    },
    /// An actuator that follows with a first-order lag, F − F_a.
    ActuatorLag {
        /// τ, s.
        time: Inner,
    },
}

const fn default(parameter: &InnerParameter) -> Inner {
    Inner::new(parameter.default)
}

impl Effect {
    /// The most inner parameters that an effect has.
    pub const MAX_INNER: usize = 3;

    /// Every effect of the catalogue that is no monomial, its inner parameters at their defaults.
    pub const ALL: [Effect; 21] = [
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
        Effect::PreslidingFriction { slip_length: default(&SLIP[0]) },
        Effect::FrictionWithBacklash { slip_length: default(&BACKLASH[0]), gap: default(&BACKLASH[1]) },
        Effect::AsymmetricDamping,
        Effect::LoadDependentFriction,
        Effect::PositionDependentFriction { power: default(&DISPLACEMENT_POWER[0]) },
        Effect::Cogging { wave_number: default(&COGGING[0]), phase: default(&COGGING[1]) },
        Effect::Relaxation { time: default(&RELAXATION[0]) },
        Effect::ActuatorLag { time: default(&LAG[0]) },
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
            Effect::PreslidingFriction { .. } => "presliding_friction",
            Effect::FrictionWithBacklash { .. } => "friction_with_backlash",
            Effect::AsymmetricDamping => "asymmetric_damping",
            Effect::LoadDependentFriction => "load_dependent_friction",
            Effect::PositionDependentFriction { .. } => "position_dependent_friction",
            Effect::Cogging { .. } => "cogging",
            Effect::Relaxation { .. } => "relaxation",
            Effect::ActuatorLag { .. } => "actuator_lag",
        }
    }

    /// An actuator's lag of that time constant, s; none without one.
    pub(crate) fn lag(time: f64) -> Option<Effect> {
        (time > 0.0).then(|| Effect::ActuatorLag { time: Inner::new(time) })
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
            Effect::PreslidingFriction { .. } => &SLIP,
            Effect::FrictionWithBacklash { .. } => &BACKLASH,
            Effect::PositionDependentFriction { .. } => &DISPLACEMENT_POWER,
            Effect::Cogging { .. } => &COGGING,
            Effect::Relaxation { .. } => &RELAXATION,
            Effect::ActuatorLag { .. } => &LAG,
            _ => &[],
        }
    }

    /// The values of the inner parameters, one for each of [`Effect::inner`], in its unit.
    pub fn inner_values(self) -> Vec<f64> {
        let inner: &[Inner] = match &self {
            Effect::StribeckFriction { speed } => &[*speed],
            Effect::DeadZoneStiffness { gap } | Effect::OneSidedStop { gap } => &[*gap],
            Effect::ExcitationGainNonlinearity { power } | Effect::PositionDependentFriction { power } => &[*power],
            Effect::ExcitationDelay { delay } => &[*delay],
            Effect::Hysteresis { yield_displacement, share, exponent } => &[*yield_displacement, *share, *exponent],
            Effect::HiddenResonator { frequency, damping_ratio } => &[*frequency, *damping_ratio],
            Effect::PreslidingFriction { slip_length } => &[*slip_length],
            Effect::FrictionWithBacklash { slip_length, gap } => &[*slip_length, *gap],
            Effect::Cogging { wave_number, phase } => &[*wave_number, *phase],
            Effect::Relaxation { time } | Effect::ActuatorLag { time } => &[*time],
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
            Effect::PreslidingFriction { .. } => Effect::PreslidingFriction { slip_length: value(0) },
            Effect::FrictionWithBacklash { .. } => {
                Effect::FrictionWithBacklash { slip_length: value(0), gap: value(1) }
            }
            Effect::PositionDependentFriction { .. } => Effect::PositionDependentFriction { power: value(0) },
            Effect::Cogging { .. } => Effect::Cogging { wave_number: value(0), phase: value(1) },
            Effect::Relaxation { .. } => Effect::Relaxation { time: value(0) },
            Effect::ActuatorLag { .. } => Effect::ActuatorLag { time: value(0) },
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
            Effect::PreslidingFriction { .. } => "z/x_s",
            Effect::FrictionWithBacklash { .. } => "z_g/x_s",
            Effect::AsymmetricDamping => "|q̇|",
            Effect::LoadDependentFriction => "|F| sign(q̇)",
            Effect::PositionDependentFriction { power } if power.value() == 1.0 => "q sign(q̇)",
            Effect::PositionDependentFriction { .. } => "q² sign(q̇)",
            Effect::Cogging { .. } => "sin(N q + φ)",
            Effect::Relaxation { .. } => "w",
            Effect::ActuatorLag { .. } => "(F − F_a)",
        }
    }

    /// Whether the feature is a function of (q, q̇, F) at one instant.
    #[inline]
    pub fn is_pointwise(self) -> bool {
        self.memory_length() == 0 && !matches!(self, Effect::ExcitationDelay { .. })
    }

    /// Whether the feature depends on the displacement.
    pub(super) fn uses_displacement(self) -> bool {
        !matches!(
            self,
            Effect::CoulombFriction
                | Effect::StribeckFriction { .. }
                | Effect::QuadraticDamping
                | Effect::AsymmetricDamping
                | Effect::LoadDependentFriction
                | Effect::Relaxation { .. }
                | Effect::ActuatorLag { .. }
        )
    }

    /// Whether the feature depends on the excitation.
    pub fn uses_excitation(self) -> bool {
        matches!(
            self,
            Effect::ExcitationGainNonlinearity { .. }
                | Effect::ExcitationDelay { .. }
                | Effect::LoadDependentFriction
                | Effect::ActuatorLag { .. }
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::inner::InnerRange;

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
