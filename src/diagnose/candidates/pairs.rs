//! Every pair of candidates beside a law: two effects may explain together what neither does alone.

use super::contest::{column, eligible, scale};
use super::grid::{Variant, same_effect, variants};
use crate::diagnose::judge::{Equation, Folds, PairScreen, Partialled, Record, Target, Together};
use crate::law::{Catalogue, Term};

/// The best two variants of every two effects, by what they leave together, the best first. Coefficients have the signs
/// that physics allows.
pub(in crate::diagnose) fn best_pairs(record: &Record, folds: &Folds, equation: &Equation) -> Vec<[Term; 2]> {
    let all = variants(&eligible(record, equation), &equation.terms, &scale(record));
    let screen = PairScreen::new(folds, equation);
    let tried = |variant: Variant| (variant.term, screen.partialled(&column(record, equation, variant.term)));
    let all: Vec<(Term, Partialled)> = all.into_iter().map(tried).collect();
    let groups: Vec<&[(Term, Partialled)]> = all.chunk_by(|a, b| same_effect(a.0, b.0)).collect();
    let mut found = Vec::new();
    for (index, group) in groups.iter().enumerate() {
        for other in &groups[index + 1..] {
            let both = group.iter().flat_map(|one| other.iter().map(move |two| (one, two)));
            let together = both.filter_map(|(one, two)| {
                let together = screen.together(&one.1, &two.1)?;
                are_allowed(equation.target, [one.0, two.0], &together).then_some((together.score, [one.0, two.0]))
            });
            found.extend(together.min_by(|a, b| a.0.total_cmp(&b.0)));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, terms)| terms).collect()
}

/// Whether physics allows the signs of both: with the inertia as target the regression's are the other way round.
fn are_allowed(target: Target, terms: [Term; 2], together: &Together) -> bool {
    let by = if target == Target::Force { 1.0 } else { -1.0 };
    let allows = |(term, value): (Term, f64)| Catalogue::of(term).is_none_or(|entry| entry.sign.allows(by * value));
    terms.into_iter().zip(together.coefficients).all(allows)
}
