//! Every candidate beside a law: its inner parameters, its errors on what it has not seen, what it is worth.

use super::grid::{Variant, candidates, same_effect, variants};
use crate::diagnose::judge::{
    COUNT, Column, Equation, Folds, HeldOut, Joined, Memory, PRINCIPAL, Record, Role, Screen, Target, role,
};
use crate::diagnose::scale::Scale;
use crate::law::{Catalogue, Effect, Term};

/// Rounds in which the grid of inner parameters is narrowed, a third of the spacing at a time: from a half of a value
/// to a thousandth or two. After three a dead zone in the law was 1 % off, and what that left had a name.
pub(super) const ROUNDS: usize = 5;

/// Effects whose grid is narrowed and whose errors are taken robustly: those that come nearest to being the best.
const CONTENDERS: usize = 8;

/// Share of a candidate that the law's own terms are, from which it cannot be told from them: what little error its
/// readings have is then ten times as large in its coefficient.
pub(in crate::diagnose) const TRAP: f64 = 0.99;

/// A candidate beside a law.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Contender {
    /// It, with the inner parameters that most parts of the record prefer.
    pub(in crate::diagnose) term: Term,
    /// Errors without it …
    pub(in crate::diagnose) before: HeldOut,
    /// … and with it.
    pub(in crate::diagnose) held: HeldOut,
    /// S, against the law without it; of one that was tried on half of the readings, what it would be on all.
    pub(in crate::diagnose) score: f64,
    /// Share of its own rows that the law's columns are: near 1 it cannot be told from them.
    pub(in crate::diagnose) resemblance: f64,
}

/// A variant with its column, and what that is to the target.
type Tried = (Variant, (Column, Role));

/// A law beside which candidates are tried, and its errors.
struct Arena<'a> {
    record: &'a Record,
    folds: &'a Folds,
    equation: &'a Equation,
    base: &'a HeldOut,
    /// What the sensors alone would leave of the law.
    floor: [f64; COUNT],
    scale: Scale,
}

/// All candidates beside a law, the best first, and how many were tried, inner parameters counted apart.
///
/// A candidate that holds q̈ itself has the target's own noise, which would pass for physics: it is tried on the even
/// readings' motion while the target is that of the odd ones, and set against the others by how it stands beside the
/// best of them there: half of the readings are noisier.
pub(in crate::diagnose) fn contest(
    record: &Record,
    folds: &Folds,
    equation: &Equation,
    (base, floor): (&HeldOut, [f64; COUNT]),
) -> (Vec<Contender>, usize) {
    let scale = scale(record);
    let all = variants(&eligible(record, equation), &equation.terms, &scale);
    let is_apart = |variant: &Variant| equation.target == Target::Inertia && record.accelerates(variant.term);
    let (apart, common): (Vec<Variant>, Vec<Variant>) = all.iter().partition(|variant| is_apart(variant));
    let arena = Arena { record, folds, equation, base, floor, scale };
    let mut found = arena.contest(&common);
    let best = found.first().cloned();
    found.extend(arena.contest_apart(&apart, best.as_ref()));
    found.sort_by(|a, b| a.score.total_cmp(&b.score));
    (found, all.len())
}

/// One candidate beside a law.
pub(in crate::diagnose) fn contender(
    record: &Record,
    folds: &Folds,
    equation: &Equation,
    (base, floor): (&HeldOut, [f64; COUNT]),
    term: Term,
) -> Option<Contender> {
    let scale = scale(record);
    let group = variants(&[term], &equation.terms, &scale);
    Arena { record, folds, equation, base, floor, scale }.contest(&group).into_iter().next()
}

impl Arena<'_> {
    /// The best variant of every effect, the best effect first.
    fn contest(&self, all: &[Variant]) -> Vec<Contender> {
        let screen = self.screen();
        let mut groups: Vec<Vec<Variant>> = Vec::new();
        for variant in all {
            match groups.iter_mut().find(|group| same_effect(group[0].term, variant.term)) {
                Some(group) => group.push(*variant),
                None => groups.push(vec![*variant]),
            }
        }
        let ranked = |mut found: Vec<Contender>| {
            found.sort_by(|a, b| a.score.total_cmp(&b.score));
            found
        };
        let coarse = |group: &Vec<Variant>| self.chosen(&screen, &self.columns(group)).0;
        let found = ranked(groups.iter().map(coarse).collect());
        let narrowed = found.iter().take(CONTENDERS).filter_map(|found| {
            let group = groups.iter().find(|group| same_effect(group[0].term, found.term))?;
            Some(self.narrowed(&screen, self.columns(group)))
        });
        let mut robust = ranked(narrowed.collect());
        robust.extend(found.into_iter().skip(CONTENDERS));
        robust
    }

    /// The same where candidates and target have each half of the readings, beside a rival with all of them.
    fn contest_apart(&self, all: &[Variant], rival: Option<&Contender>) -> Vec<Contender> {
        let Some([even, odd]) = self.record.halves().filter(|_| !all.is_empty()) else { return Vec::new() };
        let (own, even) = (self.equation, even.for_target_of(&odd));
        let equation = Equation::new(&even, &own.terms, own.target, own.timing, true).for_motion(&odd);
        let base = self.folds.judge(&equation);
        let arena = Arena { record: &even, equation: &equation, base: &base, ..*self };
        let lost = rival.map_or(0.0, |rival| rival.score - arena.score(rival.term));
        let with_all = |found: Contender| Contender { score: found.score + lost, ..found };
        arena.contest(all).into_iter().map(with_all).collect()
    }

    fn screen(&self) -> Screen<'_> {
        Screen::new(self.folds, self.equation, share(&self.floor, self.base))
    }

    /// S of one candidate with the inner parameters that it has.
    fn score(&self, term: Term) -> f64 {
        let (column, role) = &column(self.record, self.equation, term);
        let memory = &self.record.memory(&[term]);
        let [before, held] = self.judged(&|_| Some(Joined { column: Some((column, *role)), memory }));
        self.scored(&held, &before, term)
    }

    /// A law's errors without and with what comes to it, by the same equations.
    fn judged<'a>(&self, joining: &dyn Fn(usize) -> Option<Joined<'a>>) -> [HeldOut; 2] {
        let alone = |fold: usize| joining(fold).map(|joined| Joined { column: None, ..joined });
        [self.folds.judge_with(self.equation, &alone), self.folds.judge_with(self.equation, joining)]
    }

    /// S of a candidate's errors; where it holds q̈ none counts lower than the floor.
    fn scored(&self, held: &HeldOut, before: &HeldOut, term: Term) -> f64 {
        if self.record.accelerates(term) { held.no_lower(&self.floor).score(before) } else { held.score(before) }
    }

    /// Variants with their columns, without those that are the target where others are not.
    fn columns(&self, group: &[Variant]) -> Vec<Tried> {
        let with_column = |variant: &Variant| (*variant, column(self.record, self.equation, variant.term));
        let (targets, told): (Vec<Tried>, Vec<Tried>) =
            group.iter().map(with_column).partition(|(_, own)| self.is_target(own));
        if told.is_empty() { targets } else { told }
    }

    /// Whether a column that holds the target is the target: the law is nearly it.
    fn is_target(&self, (column, role): &(Column, Role)) -> bool {
        *role == Role::Holds && self.equation.resemblance(PRINCIPAL, &column[PRINCIPAL]) >= TRAP
    }

    /// What the parts of the record choose among variants of one effect, and which.
    fn chosen(&self, screen: &Screen, tried: &[Tried]) -> (Contender, Vec<usize>) {
        let columns: Vec<&(Column, Role)> = tried.iter().map(|(_, column)| column).collect();
        let allows = |value: f64| is_allowed(self.equation.target, tried[0].0.term, value);
        let (chosen, held) = screen.choose(&columns, &allows);
        let votes = |index: &usize| chosen.iter().filter(|own| *own == index).count();
        let middle = chosen.iter().copied().max_by_key(votes).unwrap_or(0);
        let resemblance = self.equation.resemblance(PRINCIPAL, &columns[middle].0[PRINCIPAL]);
        let term = tried[middle].0.term;
        let (score, before) = (self.scored(&held, self.base, term), self.base.clone());
        (Contender { term, score, before, held, resemblance }, chosen)
    }

    /// The grid narrowed around what the parts of the record prefer, then a robust fit in each part.
    fn narrowed(&self, screen: &Screen, mut tried: Vec<Tried>) -> Contender {
        let (mut found, mut chosen) = self.chosen(screen, &tried);
        let is_trapped = tried.iter().all(|(_, own)| self.is_target(own));
        for _ in 0..ROUNDS {
            let new = self.new_neighbours(&tried, &chosen);
            if new.is_empty() {
                break;
            }
            tried = kept(&tried, &chosen);
            tried.extend(self.columns(&new).into_iter().filter(|(_, own)| is_trapped || !self.is_target(own)));
            (found, chosen) = self.chosen(screen, &tried);
        }
        let remembers = |index: &usize| self.record.memory(&[tried[*index].0.term]);
        let memories: Vec<Memory> = chosen.iter().map(remembers).collect();
        let joining = |fold: usize| {
            let (column, role) = &tried[*chosen.get(fold)?].1;
            Some(Joined { column: Some((column, *role)), memory: memories.get(fold)? })
        };
        let [before, held] = self.judged(&joining);
        Contender { score: self.scored(&held, &before, found.term), before, held, ..found }
    }

    /// Neighbours of what was chosen that were not tried yet.
    fn new_neighbours(&self, tried: &[Tried], chosen: &[usize]) -> Vec<Variant> {
        let near = chosen.iter().flat_map(|index| tried[*index].0.neighbours());
        near.filter(|variant| is_within(variant.term, &self.scale)).fold(
            Vec::new(),
            |mut new: Vec<Variant>, variant| {
                let known = new.iter().chain(tried.iter().map(|(own, _)| own)).any(|own| own.term == variant.term);
                if !known {
                    new.push(variant);
                }
                new
            },
        )
    }
}

/// Whether physics allows a term the sign that it has in the regression: with the inertia as target that is the other
/// way round.
pub(super) fn is_allowed(target: Target, term: Term, value: f64) -> bool {
    let by = if target == Target::Force { 1.0 } else { -1.0 };
    Catalogue::of(term).is_none_or(|entry| entry.sign.allows(by * value))
}

/// Share of the energy that a law leaves that its sensors would.
pub(super) fn share(floor: &[f64; COUNT], base: &HeldOut) -> [f64; COUNT] {
    std::array::from_fn(|which| (floor[which] / base.errors[which]).powi(2).min(1.0))
}

/// What was chosen, each once, at the next spacing.
fn kept(tried: &[Tried], chosen: &[usize]) -> Vec<Tried> {
    chosen.iter().fold(Vec::new(), |mut kept: Vec<Tried>, index| {
        let (variant, column) = &tried[*index];
        if !kept.iter().any(|(own, _)| own.term == variant.term) {
            kept.push((Variant { spacing: variant.spacing.cbrt(), ..*variant }, column.clone()));
        }
        kept
    })
}

pub(super) fn scale(record: &Record) -> Scale {
    let pieces: Vec<_> = record.motions.iter().flat_map(|motion| motion.pieces.iter().cloned()).collect();
    let states: Vec<_> = record.motions.iter().flat_map(|motion| motion.states()).collect();
    let scale = Scale::of(&pieces, &states);
    Scale { frequency: [scale.frequency[0], std::f64::consts::TAU / record.period], ..scale }
}

/// The candidates that make sense beside this law: a delay has its own test, and what depends on the excitation cannot
/// predict it.
pub(super) fn eligible(record: &Record, equation: &Equation) -> Vec<Term> {
    let is_output = !equation.terms.contains(&Term::Inertia) || !record.forced;
    let is_delay =
        |term: &Term| matches!(term, Term::Effect(Effect::ExcitationDelay { .. } | Effect::ActuatorLag { .. }));
    let all = candidates(&record.expressions).into_iter();
    let scales = |term: &Term| !record.forced && *term == Term::Inertia;
    // without a force a velocity less its low-pass is the acceleration that nothing else tells
    let filters = |term: &Term| !record.forced && matches!(term, Term::Effect(Effect::Relaxation { .. }));
    let is_barred =
        |term: &Term| is_delay(term) || scales(term) || filters(term) || is_output && term.uses_excitation();
    all.filter(|term| !is_barred(term)).collect()
}

pub(super) fn column(record: &Record, equation: &Equation, term: Term) -> (Column, Role) {
    (record.term(term, equation.timing), role(record, term, equation.target))
}

pub(super) fn is_within(term: Term, scale: &Scale) -> bool {
    let Term::Effect(effect) = term else { return true };
    let inner = effect.inner_values();
    scale.resolves(effect)
        && inner.iter().enumerate().all(|(index, value)| {
            let [from, to] = scale.limits(effect, index);
            (from..=to).contains(value)
        })
}

impl Contender {
    /// Whether physics allows the sign of this coefficient.
    pub(in crate::diagnose) fn allows(&self, coefficient: f64) -> bool {
        Catalogue::of(self.term).is_none_or(|entry| entry.sign.allows(coefficient))
    }
}
