//! The catalogue of physical effects: what each one is, what it looks like when a model lacks it, and what may be taken
//! for it.

mod entries;
mod entry;

pub use entry::{Entry, Sign};

use super::term::Term;

/// The catalogue.
#[derive(Clone, Copy, Debug)]
pub struct Catalogue;

impl Catalogue {
    /// Every effect.
    pub const ENTRIES: &'static [Entry] = &entries::ENTRIES;

    /// The effect of that id.
    pub fn find(id: &str) -> Option<&'static Entry> {
        Catalogue::ENTRIES.iter().find(|entry| entry.id == id)
    }

    /// The effect that a term is, whatever its inner parameters.
    pub fn of(term: Term) -> Option<&'static Entry> {
        match term {
            Term::Effect(effect) => Catalogue::find(effect.id()),
            _ => Catalogue::ENTRIES.iter().find(|entry| entry.term == term),
        }
    }

    /// The effect id of a term; its name where it is none of the catalogue.
    pub fn name_of(term: Term) -> String {
        Catalogue::of(term).map_or_else(|| term.name(), |entry| entry.id.into())
    }

    /// Whether the first effect is a limiting case of the second.
    pub fn is_contained(smaller: &str, larger: &str) -> bool {
        Catalogue::find(larger).is_some_and(|entry| entry.contains.contains(&smaller))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::effect::Effect;
    use crate::law::inner::Inner;
    use crate::law::term::Monomial;

    #[test]
    fn every_effect_stands_once_under_its_own_id() {
        for (index, entry) in Catalogue::ENTRIES.iter().enumerate() {
            assert_eq!(Term::parse(entry.id), Ok(entry.term), "{}", entry.id);
            assert!(Catalogue::ENTRIES[..index].iter().all(|other| other.term != entry.term), "{}", entry.id);
            assert!(entry.term.dimension().is_some());
        }
        for effect in Effect::ALL {
            assert_eq!(Catalogue::of(Term::Effect(effect)).unwrap().id, effect.id());
        }
        assert_eq!(Catalogue::ENTRIES.len(), 30);
    }

    #[test]
    fn what_is_named_beside_an_effect_is_in_the_catalogue_and_mutual() {
        for entry in Catalogue::ENTRIES {
            for other in entry.look_alikes {
                let other = Catalogue::find(other).unwrap_or_else(|| panic!("{}: {other}", entry.id));
                assert!(other.look_alikes.contains(&entry.id), "{} and {}", entry.id, other.id);
                assert_ne!(other.id, entry.id);
            }
            assert!(entry.contains.iter().all(|other| Catalogue::find(other).is_some() && *other != entry.id));
        }
    }

    #[test]
    fn sentences_are_sentences() {
        for entry in Catalogue::ENTRIES {
            for text in [entry.residual, entry.reason, entry.reference] {
                assert!(text.ends_with('.') && text.len() > 20, "{}: {text}", entry.id);
            }
        }
    }

    /// The limiting case has the feature of the larger effect at an extreme of its inner parameters, up to a factor.
    #[test]
    fn contained_effects_are_limits() {
        let at = |effect: Effect| effect.force(0.7, -0.3, 0.4);
        assert!((at(Effect::StribeckFriction { speed: Inner::new(1e9) }) - at(Effect::CoulombFriction)).abs() < 1e-8);
        assert_eq!(at(Effect::OneSidedStop { gap: Inner::new(0.0) }), at(Effect::BilinearStiffness));
        assert_eq!(at(Effect::DeadZoneStiffness { gap: Inner::new(0.0) }), 0.7);
        assert!(Catalogue::is_contained("coulomb_friction", "stribeck_friction"));
        assert!(!Catalogue::is_contained("stribeck_friction", "coulomb_friction"));
    }

    #[test]
    fn a_term_is_found_whatever_its_inner_parameters() {
        let gap = Effect::OneSidedStop { gap: Inner::new(0.37) };
        assert_eq!(Catalogue::of(Term::Effect(gap)).unwrap().id, "one_sided_stop");
        assert_eq!(Catalogue::of(Term::power(2, 1)).unwrap().id, "van_der_pol_damping");
        assert_eq!(Catalogue::of(Term::Monomial(Monomial { q: 1, qd: 0, excitation: 1 })), None);
        assert!(Sign::Any.allows(-1.0) && !Sign::Positive.allows(-1.0));
    }
}
