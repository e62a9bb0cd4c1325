//! Every candidate beside a law: its inner parameters, its errors on what it has not seen, what it is worth.

use super::grid::{Variant, candidates, same_effect, variants};
use crate::diagnose::judge::{Column, Equation, Folds, HeldOut, PRINCIPAL, Record, Screen, Target};
use crate::diagnose::scale::Scale;
use crate::law::{Catalogue, Effect, Term};

/// Rounds in which the grid of inner parameters is narrowed, a third of the spacing at a time.
const ROUNDS: usize = 3;

/// Effects whose grid is narrowed and whose errors are taken robustly: those that come nearest to being the best.
const CONTENDERS: usize = 8;

/// A candidate beside a law.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Contender {
    /// It, with the inner parameters that most parts of the record prefer.
    pub(in crate::diagnose) term: Term,
    /// Errors with it.
    pub(in crate::diagnose) held: HeldOut,
    /// S, against the law without it.
    pub(in crate::diagnose) score: f64,
    /// Share of its own rows that the law's columns are: near 1 it cannot be told from them.
    pub(in crate::diagnose) resemblance: f64,
}

/// A variant with its column, and whether that holds the target itself.
type Tried = (Variant, (Column, bool));

/// All candidates beside a law, the best first, and how many were tried, inner parameters counted apart.
pub(in crate::diagnose) fn contest(
    record: &Record,
    folds: &Folds,
    equation: &Equation,
    base: &HeldOut,
) -> (Vec<Contender>, usize) {
    let scale = scale(record);
    let all = variants(&eligible(record, equation), &equation.terms, &scale);
    let screen = Screen::new(folds, equation);
    let mut groups: Vec<Vec<Variant>> = Vec::new();
    for variant in &all {
        match groups.iter_mut().find(|group| same_effect(group[0].term, variant.term)) {
            Some(group) => group.push(*variant),
            None => groups.push(vec![*variant]),
        }
    }
    let ranked = |mut found: Vec<Contender>| {
        found.sort_by(|a, b| a.score.total_cmp(&b.score));
        found
    };
    let columns = |group: &[Variant]| -> Vec<Tried> {
        group.iter().map(|variant| (*variant, column(record, equation, variant.term))).collect()
    };
    let found =
        ranked(groups.iter().map(|group| Contender::chosen(&screen, equation, base, columns(group)).0).collect());
    let contenders = found.iter().take(CONTENDERS).filter_map(|found| {
        let group = groups.iter().find(|group| same_effect(group[0].term, found.term))?;
        Some(narrowed(record, (&screen, folds), equation, base, columns(group), &scale))
    });
    let mut robust = ranked(contenders.collect());
    robust.extend(found.into_iter().skip(CONTENDERS));
    (robust, all.len())
}

/// One candidate beside a law.
pub(in crate::diagnose) fn contender(
    record: &Record,
    folds: &Folds,
    equation: &Equation,
    base: &HeldOut,
    term: Term,
) -> Option<Contender> {
    let scale = scale(record);
    let group = variants(&[term], &equation.terms, &scale);
    let screen = Screen::new(folds, equation);
    let tried: Vec<Tried> = group.iter().map(|own| (*own, column(record, equation, own.term))).collect();
    (!tried.is_empty()).then(|| narrowed(record, (&screen, folds), equation, base, tried, &scale))
}

fn scale(record: &Record) -> Scale {
    let pieces: Vec<_> = record.motions.iter().flat_map(|motion| motion.pieces.iter().cloned()).collect();
    let states: Vec<_> = record.motions.iter().flat_map(|motion| motion.states()).collect();
    let scale = Scale::of(&pieces, &states);
    Scale { frequency: [scale.frequency[0], std::f64::consts::TAU / record.period], ..scale }
}

/// The candidates that make sense beside this law: a delay has its own test, and what depends on the excitation cannot predict it.
fn eligible(record: &Record, equation: &Equation) -> Vec<Term> {
    let is_output = !equation.terms.contains(&Term::Inertia) || !record.forced;
    let is_delay = |term: &Term| matches!(term, Term::Effect(Effect::ExcitationDelay { .. }));
    let all = candidates(&record.expressions).into_iter();
    let scales = |term: &Term| !record.forced && *term == Term::Inertia;
    all.filter(|term| !is_delay(term) && !scales(term) && !(is_output && record.uses_excitation(*term))).collect()
}

fn column(record: &Record, equation: &Equation, term: Term) -> (Column, bool) {
    let holds_target = match equation.target {
        Target::Inertia => record.accelerates(term),
        Target::Force => record.uses_excitation(term),
    };
    (record.term(term, equation.timing), holds_target)
}

/// The grid narrowed around what the parts of the record prefer, then a robust fit in each part.
fn narrowed(
    record: &Record,
    (screen, folds): (&Screen, &Folds),
    equation: &Equation,
    base: &HeldOut,
    mut tried: Vec<Tried>,
    scale: &Scale,
) -> Contender {
    let (mut found, mut chosen) = Contender::chosen(screen, equation, base, tried.clone());
    for _ in 0..ROUNDS {
        let near: Vec<Variant> = chosen.iter().flat_map(|index| tried[*index].0.neighbours()).collect();
        let inside = |variant: &Variant| is_within(variant.term, scale);
        let new = near.into_iter().filter(inside).fold(Vec::<Variant>::new(), |mut kept, variant| {
            let known = kept.iter().any(|other| other.term == variant.term);
            let known = known || tried.iter().any(|(other, _)| other.term == variant.term);
            if !known {
                kept.push(variant);
            }
            kept
        });
        if new.is_empty() {
            break;
        }
        let keep: Vec<Tried> = chosen.iter().map(|index| tried[*index].clone()).collect();
        tried = keep.into_iter().fold(Vec::new(), |mut kept: Vec<Tried>, own| {
            if !kept.iter().any(|(other, _)| other.term == own.0.term) {
                kept.push((Variant { spacing: own.0.spacing.cbrt(), ..own.0 }, own.1));
            }
            kept
        });
        tried.extend(new.into_iter().map(|variant| (variant, column(record, equation, variant.term))));
        (found, chosen) = Contender::chosen(screen, equation, base, tried.clone());
    }
    let joining = |fold: usize| chosen.get(fold).map(|index| (&tried[*index].1.0, tried[*index].1.1));
    let held = folds.judge_with(equation, &joining);
    Contender { score: held.score(base), held, ..found }
}

fn is_within(term: Term, scale: &Scale) -> bool {
    let Term::Effect(effect) = term else { return true };
    effect.inner_values().iter().enumerate().all(|(index, value)| {
        let [from, to] = scale.limits(effect, index);
        effect.inner()[index].name == "power" || (from..=to).contains(value)
    })
}

impl Contender {
    /// What the parts of the record choose among variants of one effect, and which.
    fn chosen(screen: &Screen, equation: &Equation, base: &HeldOut, tried: Vec<Tried>) -> (Contender, Vec<usize>) {
        let terms: Vec<Term> = tried.iter().map(|(variant, _)| variant.term).collect();
        let columns: Vec<(Column, bool)> = tried.into_iter().map(|(_, column)| column).collect();
        let (chosen, held) = screen.choose(&columns);
        let votes = |index: &usize| chosen.iter().filter(|own| *own == index).count();
        let middle = chosen.iter().copied().max_by_key(votes).unwrap_or(0);
        let resemblance = equation.resemblance(PRINCIPAL, &columns[middle].0[PRINCIPAL]);
        (Contender { term: terms[middle], score: held.score(base), held, resemblance }, chosen)
    }

    /// Whether physics allows the sign of this coefficient.
    pub(in crate::diagnose) fn allows(&self, coefficient: f64) -> bool {
        Catalogue::of(self.term).is_none_or(|entry| entry.sign.allows(coefficient))
    }
}
