//! Which effect a law lacks whose own terms may be the wrong ones: with each effect they are chosen anew.
//!
//! Terms that were chosen without the effect stand in for it, and what goes along with it may have been left out:
//! beside them it explains nothing. What counts is what the likeliest law with the effect gains over the likeliest
//! without it, each less the prices of its terms ([`TermSelection`]).

use super::information::{Information, Solution};
use super::score_test::{Lacked, Missing, ScoreTest};
use super::term_selection::TermSelection;
use crate::law::{Catalogue, Term};
use serde::{Deserialize, Serialize};

/// Room for the choice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TermsAnew {
    /// What the run says of the law's free terms and, last, of an effect.
    information: Information,
    selection: TermSelection,
    solution: Solution,
    maybe: Vec<bool>,
    active: Vec<bool>,
    values: Vec<f64>,
}

/// Of which law it is asked.
#[derive(Clone, Copy, Debug)]
pub struct FreeTerms<'a> {
    /// What the run says of the free terms, n, about `coefficients`.
    pub information: &'a Information,
    /// The free coefficients, n.
    pub coefficients: &'a [f64],
    /// Which of them may go, n.
    pub maybe: &'a [bool],
    /// Σθ² of its own coefficients, known ones included: beforehand each is normal about what it is, with that
    /// variance.
    pub squares: f64,
    /// Its inertia, and which free coefficient that is.
    pub inertia: (f64, Option<usize>),
    /// The largest |q| of the record.
    pub largest: f64,
    /// Scalar measurements.
    pub measurements: f64,
    /// What its lasting error makes of a nat.
    pub overdispersion: f64,
}

impl TermsAnew {
    /// For laws of `n` free terms.
    pub fn new(n: usize) -> TermsAnew {
        TermsAnew {
            information: Information::none(n + 1),
            selection: TermSelection::new(n + 1),
            solution: Solution::none(n + 1),
            maybe: vec![true; n + 1],
            active: vec![true; n + 1],
            values: vec![0.0; n + 1],
        }
    }

    /// Forgets what was asked: what is made anew at every question takes no room in a saved state.
    fn clear(&mut self) {
        self.information.clear();
        self.solution.solve(&self.information, &self.active);
    }

    /// Twice the log-likelihood of the likeliest law, less the prices of its terms, against the law as it is; with that
    /// effect, or without.
    fn worth(&mut self, law: &FreeTerms, effect: Option<(&[f64], f64, f64)>) -> f64 {
        let n = law.coefficients.len();
        law.information.widen(&mut self.information);
        if let Some((cross, information, score)) = effect {
            self.information.tell_last(cross, information, score);
        }
        self.information.scale(law.overdispersion.max(1.0).recip());
        (0..n).for_each(|index| self.information.add_prior(index, law.squares.recip(), 0.0));
        self.maybe[..n].copy_from_slice(law.maybe);
        self.maybe[n] = effect.is_none();
        self.values[..n].copy_from_slice(law.coefficients);
        self.values[n] = 0.0;
        self.active.fill(true);
        let TermsAnew { information, selection, solution, maybe, active, values } = self;
        selection.select(information, maybe, law.measurements, values, active, solution);
        self.selection.worth
    }

    /// Whether a motion can have the law that was chosen last, with an effect of that entry: its coefficient has a sign
    /// that physics allows, and the inertia, which both make, keeps the law's own sign wherever the motion goes.
    fn is_physical(&self, law: &FreeTerms, entry: usize, term: Term) -> bool {
        let coefficient = self.values[law.coefficients.len()];
        let (own, free) = law.inertia;
        let inertia = free.map_or(own, |index| self.values[index]);
        let keeps = |mass: f64| mass * own > 0.0;
        let at_most = inertia + coefficient * term.mass(law.largest);
        Catalogue::ENTRIES[entry].sign.allows(coefficient) && keeps(inertia) && keeps(at_most)
    }
}

impl ScoreTest {
    /// The effect with which a law whose terms are chosen anew gains most; `step` becomes by how much its free
    /// coefficients, n, are others. None where the candidates have not gone with the whole run.
    pub fn likeliest_anew(&self, law: &FreeTerms, room: &mut TermsAnew, step: &mut [f64]) -> Option<Lacked> {
        if !self.whole {
            return None;
        }
        let price = (self.candidates.len().max(1) as f64).ln();
        let none = room.worth(law, None);
        let mut likeliest: Option<Lacked> = None;
        for candidate in &self.candidates {
            let sums = &candidate.sums;
            let worth = room.worth(law, Some((&sums.cross, sums.information, sums.score)));
            let coefficient = room.values[step.len()];
            let evidence = 0.5 * (worth - none) - price;
            let better = likeliest.is_none_or(|best| best.missing.evidence < evidence);
            if better && room.is_physical(law, candidate.entry, candidate.term) {
                let missing = Missing { entry: candidate.entry, evidence };
                likeliest = Some(Lacked { missing, term: candidate.term, coefficient });
                let changes = room.values.iter().zip(law.coefficients).map(|(value, from)| value - from);
                step.iter_mut().zip(changes).for_each(|(step, change)| *step = change);
            }
        }
        room.clear();
        likeliest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two terms that are 1 and nearly make up an effect of 1 the record says next to nothing beside it, and the law
    /// is the likelier one by what both cost.
    #[test]
    fn two_terms_go_for_the_effect_that_they_stand_in_for() {
        let rows = [([1.0, 0.0], 1.0, 0.0, 1e-4), ([0.0, 1.0], 1.0, 0.0, 1e-4), ([0.0, 0.0], 0.1, 0.1, 1e-2)];
        let (mut information, mut test) = (Information::none(2), ScoreTest::new(&[], 2));
        test.candidates.truncate(1);
        test.whole = true;
        let sums = &mut test.candidates[0].sums;
        for (row, effect, residual, variance) in rows {
            information.add(&row, residual, variance);
            sums.cross.iter_mut().zip(row).for_each(|(cross, own)| *cross += own * effect / variance);
            sums.information += effect * effect / variance;
            sums.score += effect * residual / variance;
        }
        let law = FreeTerms {
            information: &information,
            coefficients: &[1.0, 1.0],
            maybe: &[true; 2],
            squares: 2.0,
            inertia: (1.0, None),
            largest: 1.0,
            measurements: 200.0,
            overdispersion: 1.0,
        };
        let mut step = [0.0; 2];
        let found = test.likeliest_anew(&law, &mut TermsAnew::new(2), &mut step).unwrap();
        assert!((found.coefficient - 1.0).abs() < 0.01 && step == [-1.0, -1.0], "{found:?}, {step:?}");
        assert!((found.missing.evidence - 2.0 * 200_f64.ln()).abs() < 1.0, "{found:?}");
        let impossible = FreeTerms { inertia: (-0.9, None), ..law };
        assert_eq!(test.likeliest_anew(&impossible, &mut TermsAnew::new(2), &mut step), None);
        let fixed = FreeTerms { maybe: &[false; 2], ..law };
        let found = test.likeliest_anew(&fixed, &mut TermsAnew::new(2), &mut step).unwrap();
        assert!(found.missing.evidence < 1.0, "{found:?}");
    }
}
