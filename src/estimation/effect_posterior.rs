//! Whether a law has the right effect: the posterior of the laws with none, with one, and with one beside its own.
//!
//! Beforehand a law lacks an effect as likely as not, each as likely as another, and its coefficient is normal, of a
//! std that makes the law's own coefficients wrong by all of their size, e = 1 in eq. (8). With i and ĉ the information
//! and the estimate of that coefficient beside the law's own terms and v its variance beforehand, a record makes the
//! effect likelier by exp(½ i ĉ² i v ÷ (1 + i v)) ÷ √(1 + i v): the Bayes factor of a normal mean (Kass and Raftery,
//! *J. Am. Stat. Assoc.* 90 (1995), 773).

use super::added_effect::AddedEffect;
use super::information::Information;
use super::one_more_coefficient::{OwnTerms, Sums};
use super::score_test::{Lacked, Missing, ScoreTest, is_same};
use crate::law::{Catalogue, Sign, Term};
use serde::{Deserialize, Serialize};

/// What a record says of its law's effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EffectPosterior {
    /// Probability that e of the law's own coefficients is above the bound because it has not the right effect.
    pub wrong: f64,
    /// The likeliest effect in the place of the one that the law has: its evidence is the logarithm of the odds between
    /// them. None where the law has none.
    pub likelier: Option<Lacked>,
    /// The logarithm of the odds of the likeliest effect beside the one that the law has, against that alone.
    pub beside: f64,
}

/// Of whose law it is asked.
#[derive(Clone, Copy, Debug)]
pub struct LawWithEffect<'a> {
    /// The effect beside its terms, and its coefficient.
    pub effect: Option<(&'a AddedEffect, Term, f64)>,
    /// Which of its own terms it has, n.
    pub active: &'a [bool],
    /// What its lasting error makes of a nat.
    pub overdispersion: f64,
    /// Σθ² of its own coefficients, known ones included.
    pub squares: f64,
    /// Bound of e.
    pub bound: f64,
}

/// The law's own terms as a run says them of it, and were it to have no effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WithAndWithout {
    with: OwnTerms,
    without: OwnTerms,
    information: Information,
}

/// One effect beside a law: the logarithm of what makes it likelier, and what it makes of the law's own coefficients.
struct Beside {
    evidence: f64,
    coefficient: f64,
    /// Σ of the squares of their changes, against those of the law in use, and the variance of √ of it.
    moved: [f64; 2],
}

/// Laws that exclude each other.
struct Laws {
    /// The largest logarithm of a weight.
    most: f64,
    /// Sum of the weights, and of those of laws by which the law in use is wrong, as parts of the largest.
    all: f64,
    wrong: f64,
}

impl WithAndWithout {
    /// Of `n` free terms of which nothing is known.
    pub fn none(n: usize) -> WithAndWithout {
        WithAndWithout { with: OwnTerms::none(n), without: OwnTerms::none(n), information: Information::none(n) }
    }

    /// Forgets what a run said: what is made anew at every question takes no room in a saved state.
    pub fn clear(&mut self) {
        self.with.clear();
        self.without.clear();
        self.information.clear();
    }

    /// As a run and what was known before it say it of the law.
    fn solve(&mut self, told: &[&Information], law: &LawWithEffect) {
        let WithAndWithout { with, without, information } = self;
        information.clear();
        told.iter().for_each(|told| information.merge(told));
        with.solve(information, law.active, law.effect.map(|(effect, ..)| effect));
        if let Some((effect, _, coefficient)) = law.effect {
            effect.sums.take_out(coefficient, information);
        }
        without.solve(information, law.active, None);
    }

    /// By how much a coefficient is another one without the effect.
    fn moved(&self, row: usize) -> f64 {
        self.without.step(row) - self.with.step(row)
    }

    /// By how much the law's own coefficients, n, are others with that effect in the place of the law's.
    fn change(&self, sums: &Sums, coefficient: f64, step: &mut [f64]) {
        for (row, step) in step.iter_mut().enumerate() {
            *step = self.moved(row) - coefficient * sums.shared(row, &self.without);
        }
    }
}

impl Laws {
    /// One more, with the logarithm of its weight and the probability that the law in use is wrong if it is the right
    /// one.
    fn add(&mut self, weight: f64, wrong: f64) {
        if weight > self.most {
            let fading = (self.most - weight).exp();
            (self.most, self.all, self.wrong) = (weight, self.all * fading, self.wrong * fading);
        }
        let weight = (weight - self.most).exp();
        (self.all, self.wrong) = (self.all + weight, self.wrong + weight * wrong);
    }
}

impl LawWithEffect<'_> {
    /// An effect of these sums, the score being so much larger where the law's effect is taken out, beside `own`;
    /// `from` is by how much each of these is another coefficient than the law's. None where its sign is not allowed or
    /// the record cannot tell it from the law's own terms.
    fn beside(
        &self,
        sums: &Sums,
        larger: f64,
        own: &OwnTerms,
        from: impl Fn(usize) -> f64,
        sign: Sign,
    ) -> Option<Beside> {
        let (estimate, information) = sums.estimate(own, larger)?;
        let information = information / self.overdispersion.max(1.0);
        let n = self.active.len();
        let size: f64 = (0..n).map(|row| sums.shared(row, own).powi(2)).sum();
        let prior = self.squares / size;
        let part = 1.0 / (1.0 + 1.0 / (information * prior));
        let coefficient = part * estimate;
        let moved = (0..n).map(|row| (from(row) - coefficient * sums.shared(row, own)).powi(2)).sum();
        let evidence = 0.5 * information * part * estimate * estimate - 0.5 * (information * prior).ln_1p();
        let beside = Beside { evidence, coefficient, moved: [moved, part * size / information] };
        sign.allows(coefficient).then_some(beside)
    }

    /// Probability that e is above the bound.
    fn is_wrong(&self, [moved, variance]: [f64; 2]) -> f64 {
        let (bound, moved) = ((self.bound * self.squares).sqrt(), moved.sqrt());
        let tail = |beyond: f64| 0.5 * libm::erfc(beyond / (2.0 * variance).sqrt());
        (tail(bound - moved) + tail(bound + moved)).min(1.0)
    }
}

impl ScoreTest {
    /// What the run with these candidates, and what was known before it, say of the law's effect; `told` is what both
    /// say of its own terms. `step` becomes by how much the free coefficients, n, are others with the likelier one.
    /// Nothing where the candidates have not gone with the whole run.
    pub fn weigh(
        &self,
        law: &LawWithEffect,
        terms: &mut WithAndWithout,
        told: &[&Information],
        step: &mut [f64],
    ) -> EffectPosterior {
        if !self.whole {
            return EffectPosterior::default();
        }
        terms.solve(told, law);
        let price = -(self.candidates.len().max(1) as f64).ln();
        let mut laws = Laws { most: 0.0, all: 0.0, wrong: 0.0 };
        let none: f64 = (0..law.active.len()).map(|row| terms.moved(row).powi(2)).sum();
        laws.add(0.0, f64::from(none > law.bound * law.squares));
        let own = law.effect.and_then(|(effect, _, coefficient)| {
            let sums = &effect.sums;
            law.beside(sums, coefficient * sums.information, &terms.without, |_| 0.0, Sign::Any)
        });
        let own_weight = own.map_or(0.0, |own| own.evidence + price);
        if law.effect.is_some() {
            laws.add(own_weight, 0.0);
        }
        let (mut likelier, mut most): (Option<Lacked>, f64) = (None, f64::NEG_INFINITY);
        let has = |term: Term| law.effect.is_some_and(|(_, own, _)| is_same(own, term));
        for candidate in self.candidates.iter().filter(|candidate| !has(candidate.term)) {
            let (sums, sign) = (&candidate.sums, Catalogue::ENTRIES[candidate.entry].sign);
            if let Some(beside) = law.beside(sums, 0.0, &terms.with, |_| 0.0, sign) {
                laws.add(own_weight + beside.evidence + price, law.is_wrong(beside.moved));
                most = most.max(beside.evidence + price);
            }
            let Some((_, _, coefficient)) = law.effect else { continue };
            let larger = coefficient * sums.cross[law.active.len()];
            let Some(alone) = law.beside(sums, larger, &terms.without, |row| terms.moved(row), sign) else { continue };
            laws.add(alone.evidence + price, law.is_wrong(alone.moved));
            let missing = Missing { entry: candidate.entry, evidence: alone.evidence + price - own_weight };
            if likelier.is_none_or(|best| best.missing.evidence < missing.evidence) {
                likelier = Some(Lacked { missing, term: candidate.term, coefficient: alone.coefficient });
                terms.change(sums, alone.coefficient, step);
            }
        }
        terms.clear();
        EffectPosterior { wrong: laws.wrong / laws.all, likelier, beside: most }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the law's own terms, an effect that it has and one that it has not make of a reading.
    fn features(k: u32) -> [f64; 4] {
        let phase = 0.37 * f64::from(k);
        let [own, other] = [phase.sin(), phase.cos()];
        [own, other, 0.6 * own + 0.2 * (2.0 * phase).cos(), 0.6 * own + 0.2 * (2.0 * phase).sin()]
    }

    /// What `readings` of 1, 0.3, 0 and that much of the effect that it has not, each with the std 0.1, say about 0, 0
    /// and `with`: of the law's own terms, of its effect, and of the other as a spring of the catalogue.
    fn told(readings: u32, lacked: f64, with: f64) -> (Information, AddedEffect, ScoreTest) {
        let (mut own, mut effect) = (Information::none(2), AddedEffect::new(2));
        let mut candidates = ScoreTest::new(&[Term::Inertia, Term::parse("q").unwrap()], 2);
        candidates.whole = true;
        let spring = candidates.candidates.iter_mut().find(|one| is(one.entry, "quadratic_stiffness")).unwrap();
        for k in 0..readings {
            let at = features(k);
            let residual = at[0] + 0.3 * at[1] - with * at[2] + lacked * at[3];
            own.add(&at[..2], residual, 0.01);
            for (sums, at_its) in [(&mut effect.sums, at[2]), (&mut spring.sums, at[3])] {
                sums.information += at_its * at_its / 0.01;
                sums.score += at_its * residual / 0.01;
                sums.cross.iter_mut().zip(&at).for_each(|(sum, own)| *sum += own * at_its / 0.01);
            }
        }
        (own, effect, candidates)
    }

    fn is(entry: usize, id: &str) -> bool {
        Catalogue::ENTRIES[entry].id == id
    }

    /// What that says of a law, and by how much its own coefficients are others.
    fn weighed(readings: u32, lacked: f64, with: f64) -> (EffectPosterior, [f64; 2]) {
        let (own, effect, candidates) = told(readings, lacked, with);
        let effect = (with != 0.0).then(|| (&effect, Term::parse("cubic_damping").unwrap(), with));
        let law = LawWithEffect { effect, active: &[true; 2], overdispersion: 1.0, squares: 1.09, bound: 0.0025 };
        let (mut laws, mut step) = (WithAndWithout::none(2), [0.0; 2]);
        let posterior = candidates.weigh(&law, &mut laws, &[&own], &mut step);
        (posterior, step)
    }

    #[test]
    fn a_law_is_in_doubt_until_its_record_tells_that_it_lacks_nothing() {
        let wrong = |readings| weighed(readings, 0.0, 0.0).0.wrong;
        assert!(wrong(8) > 3e-3 && wrong(8) > 5.0 * wrong(80), "{} {}", wrong(8), wrong(80));
        assert!(wrong(1500) < 1e-6, "{}", wrong(1500));
        assert!(weighed(1500, 0.0, 0.0).0.likelier.is_none());
    }

    #[test]
    fn a_law_that_lacks_an_effect_is_wrong() {
        let wrong = weighed(1500, 0.3, 0.0).0.wrong;
        assert!(wrong > 0.999, "{wrong}");
        // an effect that makes no more than that of the law's own coefficients lets them be
        let small = weighed(150_000, 0.01, 0.0).0.wrong;
        assert!(small < 1e-6, "{small}");
    }

    #[test]
    fn a_law_with_another_effect_is_wrong_and_the_right_one_is_likelier() {
        let (posterior, step) = weighed(1500, 0.3, 0.2);
        let likelier = posterior.likelier.unwrap();
        assert!(posterior.wrong > 0.999 && is(likelier.missing.entry, "quadratic_stiffness"), "{posterior:?}");
        assert!(likelier.missing.evidence > 20.0, "{likelier:?}");
        assert!((likelier.coefficient - 0.3).abs() < 1e-3, "{likelier:?}");
        // beside the law's effect its own terms are told 1 + 0.6 · 0.3 − 0.6 · 0.3 and 0.3
        let with: f64 = 0.6 * 0.3;
        assert!((step[0] + with).abs() < 0.02 && step[1].abs() < 0.02, "{step:?}");
    }
}
