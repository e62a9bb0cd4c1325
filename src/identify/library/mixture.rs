//! What speaks against a known law that was recognised, and has not stood its trial yet.
//!
//! Until then the published law is one of three: the recognised one, the next best known one, or one that nobody has
//! seen, which lies about the recognised one as far as a switch goes. The std is that of their mixture.

use super::known_law::KnownLaw;
use serde::{Deserialize, Serialize};

/// Probabilities that the law is another one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mixture {
    /// That nobody has seen it.
    unknown: f64,
    /// That it is the next best known law.
    rival: f64,
    /// That one's place among the known laws.
    place: Option<usize>,
}

impl Mixture {
    /// From the recognised law's log-evidence against any law and against that of the next best known one, nats.
    pub fn of(against_any: f64, rival: Option<(usize, f64)>) -> Mixture {
        let (unknown, other) = ((-against_any).exp(), rival.map_or(0.0, |(_, against)| (-against).exp()));
        let all = 1.0 + unknown + other;
        Mixture { unknown: unknown / all, rival: other / all, place: rival.map(|(place, _)| place) }
    }

    /// What it adds to the variance of a free coefficient of this value, which a switch moves by the std `spread`.
    pub fn variance(&self, laws: &[KnownLaw], free: usize, value: f64, spread: f64) -> f64 {
        let rival = self.place.and_then(|place| laws.get(place)).map_or(value, |law| law.coefficients[free]);
        self.unknown * spread * spread + self.rival * (rival - value).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(value: f64) -> KnownLaw {
        let mut law = KnownLaw::none(1);
        law.coefficients[0] = value;
        law
    }

    #[test]
    fn three_laws_share_the_probability_by_their_evidence() {
        let laws = [law(5.0), law(9.0)];
        let doubt = Mixture::of(2.0_f64.ln(), Some((1, 4.0_f64.ln())));
        let (unknown, rival) = (0.5 / 1.75, 0.25 / 1.75);
        assert!((doubt.variance(&laws, 0, 5.0, 3.0) - (unknown * 9.0 + rival * 16.0)).abs() < 1e-12);
    }

    #[test]
    fn what_is_certain_adds_nothing() {
        assert_eq!(Mixture::of(f64::INFINITY, None).variance(&[law(5.0)], 0, 5.0, 3.0), 0.0);
    }
}
