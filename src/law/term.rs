//! One term of a law: the inertia, a product of powers, or a named effect.

use super::effect::Effect;
use super::own::Own;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// `q^q · q̇^qd · F^excitation`; all exponents 0 is the constant 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Monomial {
    /// Exponent of the displacement.
    pub q: u8,
    /// Exponent of the velocity.
    pub qd: u8,
    /// Exponent of the excitation.
    pub excitation: u8,
}

impl Monomial {
    /// The largest exponent that a term may have.
    pub const MAX_POWER: u8 = 9;
}

/// What a coefficient of the law multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Term {
    /// q̈.
    Inertia,
    /// A product of powers.
    Monomial(Monomial),
    /// A named effect that is no monomial.
    Effect(Effect),
    /// A user's own effect: one of [`super::model::Model::expressions`].
    Expression(Own),
}

/// Why a text names no term.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TermError {
    /// Neither a product of powers nor a known effect.
    #[error(
        "unknown term \"{text}\": write a product of powers such as \"q^2*qd\", or one of the effects {}",
        known_effects()
    )]
    Unknown {
        /// The text as given.
        text: String,
    },
    /// An exponent outside 1 … [`Monomial::MAX_POWER`].
    #[error("exponent \"{exponent}\" in term \"{text}\" is not a whole number from 1 to 9")]
    Exponent {
        /// The text as given.
        text: String,
        /// The exponent at fault.
        exponent: String,
    },
}

/// Effect ids that are names of monomials, and the inertia.
const NAMED_TERMS: [(&str, Term); 10] = [
    ("inertia", Term::Inertia),
    ("linear_damping", Term::power(0, 1)),
    ("cubic_damping", Term::power(0, 3)),
    ("van_der_pol_damping", Term::power(2, 1)),
    ("constant_force", Term::power(0, 0)),
    ("linear_stiffness", Term::power(1, 0)),
    ("quadratic_stiffness", Term::power(2, 0)),
    ("cubic_stiffness", Term::power(3, 0)),
    ("quintic_stiffness", Term::power(5, 0)),
    ("qdd", Term::Inertia),
];

fn known_effects() -> String {
    let monomials = NAMED_TERMS.iter().map(|(id, _)| *id).filter(|id| *id != "qdd");
    let effects = Effect::ALL.iter().map(|effect| effect.id());
    monomials.chain(effects).collect::<Vec<_>>().join(", ")
}

impl Term {
    /// The measured excitation itself.
    pub const EXCITATION: Term = Term::Monomial(Monomial { q: 0, qd: 0, excitation: 1 });

    /// The term q^q q̇^qd.
    pub const fn power(q: u8, qd: u8) -> Term {
        Term::Monomial(Monomial { q, qd, excitation: 0 })
    }

    /// Reads a product of powers (`q^2*qd`, `F*q`, `1`, `qdd`) or an effect id.
    ///
    /// # Errors
    /// [`TermError`] names what it could not read.
    pub fn parse(text: &str) -> Result<Term, TermError> {
        let text = text.trim();
        if let Some((_, term)) = NAMED_TERMS.iter().find(|(id, _)| *id == text) {
            return Ok(*term);
        }
        if let Some(effect) = Effect::prototype(text) {
            return Ok(Term::Effect(effect));
        }
        if text == "1" {
            return Ok(Term::power(0, 0));
        }
        parse_product(text).map(Term::Monomial)
    }

    /// The canonical name: `qdd`, `q^2*qd`, `1`, or the effect id, or the user's own name.
    pub fn name(self) -> String {
        match self {
            Term::Inertia => "qdd".into(),
            Term::Effect(effect) => effect.id().into(),
            Term::Expression(own) => own.name().into(),
            Term::Monomial(Monomial { q: 0, qd: 0, excitation: 0 }) => "1".into(),
            Term::Monomial(powers) => {
                let factor = |base: &str, power: u8| match power {
                    0 => None,
                    1 => Some(base.to_string()),
                    _ => Some(format!("{base}^{power}")),
                };
                [factor("F", powers.excitation), factor("q", powers.q), factor("qd", powers.qd)]
                    .into_iter()
                    .flatten()
                    .collect::<Vec<_>>()
                    .join("*")
            }
        }
    }

    /// The name as part of an FMU variable: `q_2_qd`, `const`.
    pub fn fmu_name(self) -> String {
        match self.name().as_str() {
            "1" => "const".into(),
            name => name.replace(['^', '*'], "_"),
        }
    }

    /// How the term is written in a printed law: `q² q̇`, empty for the constant.
    pub fn symbol(self) -> String {
        match self {
            Term::Inertia => "q̈".into(),
            Term::Effect(effect) => effect.symbol().into(),
            Term::Expression(_) => self.name(),
            Term::Monomial(powers) => [("F", powers.excitation), ("q", powers.q), ("q̇", powers.qd)]
                .into_iter()
                .filter(|(_, power)| *power > 0)
                .map(|(base, power)| format!("{base}{}", superscript(power)))
                .collect::<Vec<_>>()
                .join(" "),
        }
    }

    /// The part of the term that does not multiply q̈, at (q, q̇, F) in m, m/s and N, for a coefficient of 1; 0 for the
    /// inertia, NaN for an effect with memory and for an expression, which the term alone does not determine.
    #[inline]
    pub fn force(self, q: f64, qd: f64, excitation: f64) -> f64 {
        match self {
            Term::Inertia => 0.0,
            Term::Effect(effect) => effect.force(q, qd, excitation),
            Term::Expression(_) => f64::NAN,
            Term::Monomial(p) => raised(q, p.q) * raised(qd, p.qd) * raised(excitation, p.excitation),
        }
    }

    /// (∂/∂q, ∂/∂q̇) of [`Term::force`].
    #[inline]
    pub fn gradient(self, q: f64, qd: f64, excitation: f64) -> (f64, f64) {
        match self {
            Term::Inertia => (0.0, 0.0),
            Term::Effect(effect) => effect.gradient(q, qd),
            Term::Expression(_) => (f64::NAN, f64::NAN),
            Term::Monomial(p) => {
                let scale = raised(excitation, p.excitation);
                (
                    scale * power_derivative(q, p.q) * raised(qd, p.qd),
                    scale * raised(q, p.q) * power_derivative(qd, p.qd),
                )
            }
        }
    }

    /// What multiplies q̈ in the term at displacement q: 1 for the inertia, q² for a position-dependent one, else 0.
    #[inline]
    pub fn mass(self, q: f64) -> f64 {
        match self {
            Term::Inertia => 1.0,
            Term::Effect(Effect::PositionDependentInertia) => q * q,
            _ => 0.0,
        }
    }

    /// Whether the term multiplies q̈, so that its law is one of motion.
    pub fn is_inertial(self) -> bool {
        self.mass(1.0) != 0.0
    }

    /// Whether the term depends on the displacement, as far as it alone determines its feature.
    pub fn uses_displacement(self) -> bool {
        match self {
            Term::Inertia => false,
            Term::Monomial(powers) => powers.q > 0,
            Term::Effect(effect) => effect.uses_displacement(),
            Term::Expression(_) => true,
        }
    }

    /// ∂/∂q of [`Term::mass`].
    #[inline]
    pub fn mass_gradient(self, q: f64) -> f64 {
        match self {
            Term::Effect(Effect::PositionDependentInertia) => 2.0 * q,
            _ => 0.0,
        }
    }

    /// Values of the term's inner parameters, in their order.
    pub fn inner_values(self) -> Vec<f64> {
        match self {
            Term::Effect(effect) => effect.inner_values(),
            Term::Expression(own) => own.inner().to_vec(),
            _ => Vec::new(),
        }
    }

    /// The same term with these inner parameters; none where they are not allowed.
    pub fn with_inner(self, values: &[f64]) -> Option<Term> {
        match self {
            Term::Effect(effect) => effect.with_inner(values).ok().map(Term::Effect),
            Term::Expression(own) => {
                values.iter().all(|value| value.is_finite()).then(|| Term::Expression(own.with_inner(values)))
            }
            _ => values.is_empty().then_some(self),
        }
    }

    /// The named effect that the term is, if it is one.
    #[inline]
    pub fn effect(self) -> Option<Effect> {
        match self {
            Term::Effect(effect) => Some(effect),
            _ => None,
        }
    }

    /// Whether the term depends on the excitation.
    pub fn uses_excitation(self) -> bool {
        match self {
            Term::Inertia => false,
            Term::Monomial(powers) => powers.excitation > 0,
            Term::Effect(effect) => effect.uses_excitation(),
            Term::Expression(own) => own.uses_excitation(),
        }
    }

    /// Whether [`Term::force`] says all of the term besides what multiplies q̈: false for effects with memory.
    #[inline]
    pub fn is_pointwise(self) -> bool {
        match self {
            Term::Inertia | Term::Monomial(_) => true,
            Term::Effect(effect) => effect.is_pointwise(),
            Term::Expression(_) => false,
        }
    }
}

impl std::fmt::Display for Term {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name())
    }
}

/// base^exponent; the powers of usual laws without a loop.
#[inline]
pub(crate) fn raised(base: f64, exponent: u8) -> f64 {
    match exponent {
        0 => 1.0,
        1 => base,
        2 => base * base,
        3 => base * base * base,
        n => base.powi(i32::from(n)),
    }
}

#[inline]
fn power_derivative(base: f64, exponent: u8) -> f64 {
    match exponent {
        0 => 0.0,
        n => f64::from(n) * raised(base, n - 1),
    }
}

fn superscript(power: u8) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if power == 1 { String::new() } else { DIGITS[usize::from(power % 10)].to_string() }
}

fn parse_product(text: &str) -> Result<Monomial, TermError> {
    let mut powers = Monomial::default();
    for factor in text.split('*') {
        let (base, exponent) = match factor.trim().split_once('^') {
            Some((base, exponent)) => (base.trim(), exponent.trim()),
            None => (factor.trim(), "1"),
        };
        let slot = match base {
            "q" => &mut powers.q,
            "qd" => &mut powers.qd,
            "F" => &mut powers.excitation,
            _ => return Err(TermError::Unknown { text: text.into() }),
        };
        let total = exponent.parse::<u8>().ok().and_then(|n| slot.checked_add(n).filter(|_| n > 0));
        match total {
            Some(total) if total <= Monomial::MAX_POWER => *slot = total,
            _ => return Err(TermError::Exponent { text: text.into(), exponent: exponent.into() }),
        }
    }
    Ok(powers)
}
