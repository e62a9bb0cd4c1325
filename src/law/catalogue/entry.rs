//! What the catalogue says of an effect.

use crate::law::effect::Effect;
use crate::law::inner::InnerParameter;
use crate::law::term::Term;

/// The sign that physics allows a coefficient on the left-hand side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// A negative coefficient would be a source of energy, or no such thing exists.
    Positive,
    /// Either sign.
    Any,
}

impl Sign {
    /// Whether a coefficient may have this value.
    pub fn allows(self, coefficient: f64) -> bool {
        self == Sign::Any || coefficient > 0.0
    }
}

/// An effect of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Its stable id.
    pub id: &'static str,
    /// The term, inner parameters at their defaults.
    pub term: Term,
    /// What stands on the left-hand side behind the coefficient.
    pub equation: &'static str,
    /// The sign that physics allows the coefficient.
    pub sign: Sign,
    /// What a residual looks like that lacks it, one sentence.
    pub residual: &'static str,
    /// Why a system may have it, one sentence.
    pub reason: &'static str,
    /// Where it is described.
    pub reference: &'static str,
    /// Effects that records of small amplitude, few frequencies or much noise cannot tell from it.
    pub look_alikes: &'static [&'static str],
    /// Effects that are this one for a limit of this one's inner parameters.
    pub contains: &'static [&'static str],
}

impl Entry {
    /// The inner parameters.
    pub fn inner(&self) -> &'static [InnerParameter] {
        self.term.effect().map_or(&[], Effect::inner)
    }
}
