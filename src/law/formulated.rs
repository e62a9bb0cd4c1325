//! Terms of a law that has formulas of the user's own: which term a formula is, and what it is at a point.

use super::expression::Expression;
use super::motion::State;
use super::own::Own;
use super::term::Term;

impl Expression {
    /// The term that stands for it among a law's expressions, at that place.
    pub fn term(&self, place: usize) -> Term {
        Term::Expression(Own::new(place, self.name(), self.uses("F"), self.values()))
    }
}

impl Term {
    /// [`Term::force`] of a law whose [`Term::Expression`]s count `own`; NaN for one that depends on time.
    #[inline]
    pub fn force_of(self, own: &[Expression], State { q, qd }: State, excitation: f64) -> f64 {
        match self {
            Term::Expression(named) => {
                own.get(named.place()).map_or(f64::NAN, |own| own.value_of(&named, q, qd, excitation, f64::NAN))
            }
            _ => self.force(q, qd, excitation),
        }
    }

    /// (∂/∂q, ∂/∂q̇) of [`Term::force_of`].
    #[inline]
    pub fn gradient_of(self, own: &[Expression], State { q, qd }: State, excitation: f64) -> (f64, f64) {
        match self {
            Term::Expression(named) => {
                own.get(named.place()).map_or((f64::NAN, f64::NAN), |own| own.gradient_of(&named, q, qd, excitation))
            }
            _ => self.gradient(q, qd, excitation),
        }
    }

    /// Inner parameters with their names, of a law whose [`Term::Expression`]s count `own`.
    pub fn inner_named(self, own: &[Expression]) -> Vec<(String, f64)> {
        let names: Vec<String> = match self {
            Term::Effect(effect) => effect.inner().iter().map(|parameter| parameter.name.into()).collect(),
            Term::Expression(named) => own.get(named.place()).map_or_else(Vec::new, |own| own.parameters().to_vec()),
            _ => Vec::new(),
        };
        names.into_iter().zip(self.inner_values()).collect()
    }
}
