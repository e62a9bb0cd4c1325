//! A user's own effect as a term of a law: its name, where its formula stands, and numbers for its inner parameters.

use super::inner::Inner;
use arrayvec::{ArrayString, ArrayVec};
use serde::{Deserialize, Serialize};

/// Which of a law's expressions a term is, and with which inner parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Own {
    place: u8,
    uses_excitation: bool,
    name: Name,
    /// How many of `inner` it has.
    count: u8,
    inner: [Inner; Own::MAX_INNER],
}

/// A short text that a term can hold.
type Name = ArrayString<{ Own::LONGEST }>;

impl Own {
    /// How many letters a name may have.
    pub const LONGEST: usize = 30;

    /// The most inner parameters: more than a record determines beside the coefficients.
    pub const MAX_INNER: usize = 6;

    /// The expression at that place, from 0, with these inner parameters; of a longer name the first [`Own::LONGEST`]
    /// letters.
    pub fn new(place: usize, name: &str, uses_excitation: bool, inner: &[f64]) -> Own {
        let place = place.min(usize::from(u8::MAX)) as u8;
        let none = [Inner::new(0.0); Own::MAX_INNER];
        let mut own = Own { place, uses_excitation, name: ArrayString::new(), count: 0, inner: none };
        name.chars().take_while(|letter| own.name.try_push(*letter).is_ok()).for_each(drop);
        own.with_inner(inner)
    }

    /// The same with these inner parameters.
    pub fn with_inner(mut self, inner: &[f64]) -> Own {
        self.count = inner.len().min(Own::MAX_INNER) as u8;
        self.inner = std::array::from_fn(|index| Inner::new(inner.get(index).copied().unwrap_or_default()));
        self
    }

    /// Its place among the law's expressions.
    pub fn place(self) -> usize {
        usize::from(self.place)
    }

    /// Whether the formula has F.
    pub fn uses_excitation(self) -> bool {
        self.uses_excitation
    }

    /// The user's name for it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Values of its inner parameters, in the order in which the formula has them.
    pub fn inner(&self) -> ArrayVec<f64, { Own::MAX_INNER }> {
        self.inner.iter().take(usize::from(self.count)).map(|inner| inner.value()).collect()
    }
}
