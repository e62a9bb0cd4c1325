//! Laws that have a name: choices where no text can be entered.

use super::term::Term;

/// A law by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedLaw {
    /// Its name in one word.
    pub id: &'static str,
    /// What it looks like.
    pub equation: &'static str,
    /// Canonical names of its terms.
    pub terms: &'static [&'static str],
}

impl NamedLaw {
    /// Every one of them, the smaller ones first.
    pub const ALL: [NamedLaw; 6] = [
        NamedLaw { id: "linear", equation: "m q̈ + c q̇ + k q = F", terms: &["qdd", "qd", "q"] },
        NamedLaw { id: "duffing", equation: "m q̈ + c q̇ + k1 q + k3 q³ = F", terms: &["qdd", "qd", "q", "q^3"] },
        NamedLaw {
            id: "helmholtz_duffing",
            equation: "m q̈ + c q̇ + k1 q + k2 q² + k3 q³ = F",
            terms: &["qdd", "qd", "q", "q^2", "q^3"],
        },
        NamedLaw {
            id: "van_der_pol", equation: "L q̈ + α(q² − a)q̇ + q/C = V", terms: &["qdd", "qd", "q", "q^2*qd"]
        },
        NamedLaw {
            id: "rayleigh", equation: "m q̈ + c1 q̇ + c3 q̇³ + k q = F", terms: &["qdd", "qd", "q", "qd^3"]
        },
        NamedLaw {
            id: "duffing_van_der_pol",
            equation: "m q̈ + c q̇ + α q² q̇ + k1 q + k3 q³ = F",
            terms: &["qdd", "qd", "q", "q^3", "q^2*qd"],
        },
    ];

    /// Those whose terms are all among these.
    pub fn among(terms: &[Term]) -> Vec<NamedLaw> {
        let has = |name: &str| Term::parse(name).is_ok_and(|term| terms.contains(&term));
        NamedLaw::ALL.into_iter().filter(|law| law.terms.iter().all(|name| has(name))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::NamedLaw;
    use crate::law::model::Model;
    use crate::law::term::Term;

    #[test]
    fn the_cubic_library_has_them_all_and_a_linear_law_one() {
        let terms = |model: &Model| model.terms.iter().map(|entry| entry.term).collect::<Vec<Term>>();
        let library = Model::cubic_library();
        assert_eq!(NamedLaw::among(&terms(&library)), NamedLaw::ALL);
        let linear = library.with_terms(["qdd", "qd", "q", "qd^2"]).unwrap();
        let names: Vec<&str> = NamedLaw::among(&terms(&linear)).iter().map(|law| law.id).collect();
        assert_eq!(names, ["linear"]);
    }
}
