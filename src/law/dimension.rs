//! Dimensions of terms: what a coefficient is measured in is the excitation's unit divided by the term's.

use super::effect::Effect;
use super::term::{Monomial, Term};
use serde::{Deserialize, Serialize};

/// \[q\]^coordinate · s^time · \[F\]^excitation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Dimension {
    /// Power of the coordinate's unit.
    pub coordinate: i8,
    /// Power of the second.
    pub time: i8,
    /// Power of the excitation's unit.
    pub excitation: i8,
}

impl Dimension {
    /// The dimension with these powers of \[q\], s and \[F\].
    pub const fn new(coordinate: i8, time: i8, excitation: i8) -> Dimension {
        Dimension { coordinate, time, excitation }
    }
}

impl Term {
    /// The dimension of what the coefficient multiplies; none where it is not known, as of an expression.
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Term::Inertia => Some(Dimension::new(1, -2, 0)),
            Term::Monomial(Monomial { q, qd, excitation }) => {
                let [q, qd, excitation] = [q, qd, excitation].map(|power| power as i8);
                Some(Dimension::new(q + qd, -qd, excitation))
            }
            Term::Effect(effect) => Some(effect.dimension()),
            Term::Expression(_) => None,
        }
    }
}

impl Effect {
    /// The dimension of the feature.
    pub fn dimension(self) -> Dimension {
        match self {
            Effect::CoulombFriction
            | Effect::StribeckFriction { .. }
            | Effect::PreslidingFriction { .. }
            | Effect::FrictionWithBacklash { .. }
            | Effect::PendulumRestoring
            | Effect::Cogging { .. } => Dimension::default(),
            Effect::AsymmetricDamping | Effect::Relaxation { .. } => Dimension::new(1, -1, 0),
            Effect::PositionDependentFriction { power } => Dimension::new(power.value() as i8, 0, 0),
            Effect::QuadraticDamping => Dimension::new(2, -2, 0),
            Effect::SignedQuadraticStiffness => Dimension::new(2, 0, 0),
            Effect::DeadZoneStiffness { .. }
            | Effect::OneSidedStop { .. }
            | Effect::BilinearStiffness
            | Effect::Hysteresis { .. } => Dimension::new(1, 0, 0),
            Effect::PositionDependentInertia => Dimension::new(3, -2, 0),
            Effect::ExcitationGainNonlinearity { power } => Dimension::new(0, 0, power.value() as i8),
            Effect::ExcitationDelay { .. } | Effect::ActuatorLag { .. } | Effect::LoadDependentFriction => {
                Dimension::new(0, 0, 1)
            }
            Effect::HiddenResonator { .. } => Dimension::new(1, -2, 0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Features scale with their dimension when the units of q, time and F change.
    #[test]
    fn forces_scale_with_their_dimension() {
        let (length, second, force) = (2.0_f64, 3.0_f64, 5.0_f64);
        let terms =
            [(3, 2, 1), (0, 0, 0), (0, 5, 0)].map(|(q, qd, excitation)| Term::Monomial(Monomial { q, qd, excitation }));
        let scalable = |effect: &Effect| effect.is_pointwise() && *effect != Effect::PendulumRestoring;
        let effects = Effect::ALL.into_iter().filter(scalable).map(Term::Effect);
        for term in terms.into_iter().chain(effects) {
            let Dimension { coordinate, time, excitation } = term.dimension().unwrap();
            let factor = length.powi(coordinate.into()) * second.powi(time.into()) * force.powi(excitation.into());
            let scaled = rescaled(term, length, second).force(0.7 * length, 0.3 * length / second, 0.4 * force);
            let expected = term.force(0.7, 0.3, 0.4) * factor;
            assert!((scaled / expected - 1.0).abs() < 1e-12, "{term}: {scaled} against {expected}");
        }
    }

    fn rescaled(term: Term, length: f64, second: f64) -> Term {
        use crate::law::inner::InnerUnit;
        let Term::Effect(effect) = term else { return term };
        let scaled = effect.inner().iter().zip(effect.inner_values()).map(|(parameter, value)| match parameter.unit {
            InnerUnit::Coordinate => value * length,
            InnerUnit::Velocity => value * length / second,
            InnerUnit::Time => value * second,
            InnerUnit::AngularFrequency => value / second,
            InnerUnit::WaveNumber => value / length,
            InnerUnit::Number => value,
        });
        Term::Effect(effect.with_inner(&scaled.collect::<Vec<_>>()).unwrap())
    }
}
