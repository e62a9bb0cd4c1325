//! A user's own effect as a term of a law: its name, and where its formula stands.

use arrayvec::ArrayString;
use serde::{Deserialize, Serialize};

/// Which of a law's expressions a term is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Own {
    place: u8,
    uses_excitation: bool,
    name: ArrayString<{ Own::LONGEST }>,
}

impl Own {
    /// How many letters a name may have.
    pub const LONGEST: usize = 30;

    /// The expression at that place, from 0; of a longer name the first [`Own::LONGEST`] letters.
    pub fn new(place: usize, name: &str, uses_excitation: bool) -> Own {
        let mut own = Own { place: place.min(usize::from(u8::MAX)) as u8, uses_excitation, name: ArrayString::new() };
        name.chars().take_while(|letter| own.name.try_push(*letter).is_ok()).for_each(drop);
        own
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
}
