//! Every pair of candidates beside a law: two effects may explain together what neither does alone.

use super::contest::{ROUNDS, column, eligible, is_allowed, is_within, scale, share};
use super::grid::{Variant, same_effect, variants};
use crate::diagnose::judge::{COUNT, Equation, Folds, HeldOut, PairScreen, Partialled, Record};
use crate::diagnose::scale::Scale;
use crate::law::Term;

/// A law beside which pairs are tried.
pub(in crate::diagnose) struct Pairs<'a> {
    record: &'a Record,
    equation: &'a Equation,
    screen: PairScreen<'a>,
    scale: Scale,
}

/// A variant beside the law.
type Tried = (Variant, Partialled);

impl<'a> Pairs<'a> {
    /// Beside a law with these errors, `floor` what the sensors alone would leave of it.
    pub(in crate::diagnose) fn new(
        record: &'a Record,
        folds: &'a Folds,
        equation: &'a Equation,
        (base, floor): (&HeldOut, [f64; COUNT]),
    ) -> Pairs<'a> {
        let screen = PairScreen::new(folds, equation, share(&floor, base));
        Pairs { record, equation, screen, scale: scale(record) }
    }

    /// The best two variants of every two effects, by what they leave together, the best first.
    pub(in crate::diagnose) fn best(&self) -> Vec<[Term; 2]> {
        let all = self.tried(variants(&eligible(self.record, self.equation), &self.equation.terms, &self.scale));
        let groups: Vec<&[Tried]> = all.chunk_by(|a, b| same_effect(a.0.term, b.0.term)).collect();
        let others = |index: usize| groups[index + 1..].iter();
        let pairs = groups.iter().enumerate().flat_map(|(index, one)| others(index).map(move |other| [*one, *other]));
        let mut found: Vec<(f64, [Variant; 2])> = pairs.filter_map(|pair| self.together(pair)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, pair)| pair.map(|variant| variant.term)).collect()
    }

    /// A pair with the inner parameters near its own that suit both together.
    pub(in crate::diagnose) fn narrowed(&self, pair: [Term; 2]) -> [Term; 2] {
        let spacing = |term: Term| variants(&[term], &[], &self.scale).first().map_or(1.0, |variant| variant.spacing);
        let mut pair = pair.map(|term| Variant { term, spacing: spacing(term) });
        for _ in 0..ROUNDS {
            let near = |variant: Variant| {
                let within = |near: &Variant| near.term == variant.term || is_within(near.term, &self.scale);
                self.tried(variant.neighbours().into_iter().filter(within).collect())
            };
            let [one, other] = pair.map(near);
            let Some((_, best)) = self.together([&one, &other]) else { break };
            pair = best;
        }
        pair.map(|variant| variant.term)
    }

    fn tried(&self, variants: Vec<Variant>) -> Vec<Tried> {
        let own =
            |variant: Variant| (variant, self.screen.partialled(&column(self.record, self.equation, variant.term)));
        variants.into_iter().map(own).collect()
    }

    /// Of two groups the two variants that leave least together, with coefficients whose signs physics allows, and S.
    fn together(&self, groups: [&[Tried]; 2]) -> Option<(f64, [Variant; 2])> {
        let both = groups[0].iter().flat_map(|one| groups[1].iter().map(move |other| [one, other]));
        let scored = both.filter_map(|pair| {
            let found = self.screen.together(&pair[0].1, &pair[1].1)?;
            let variants = pair.map(|(variant, _)| *variant);
            let mut signs = variants.iter().zip(found.coefficients);
            let allowed = signs.all(|(variant, value)| is_allowed(self.equation.target, variant.term, value));
            allowed.then_some((found.score, variants))
        });
        scored.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
