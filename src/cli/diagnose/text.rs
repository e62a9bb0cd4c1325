//! A diagnosis in words: what it comes to, how sure, what would decide, then what it rests on.

use super::super::input::Input;
use super::found::Found;
use crate::cli::words::{chance, effect_of, inner, percent, quantity, quoted};
use crate::diagnose::{Candidate, Clock, Diagnosis, Doubt, Finding, Law, StageDiagnosis, WORTH};
use crate::law::{Catalogue, equation, unit_of};
use std::fmt::Write;

/// Candidates that are listed, at most.
const LISTED: usize = 6;

pub(in crate::cli) fn verdict(finding: Finding) -> &'static str {
    match finding {
        Finding::Missing => "missing",
        Finding::Adequate => "adequate",
        Finding::Unexplained => "unexplained",
    }
}

pub(in crate::cli) fn text(found: &Found, input: &Input) -> String {
    let mut text = lines(found, input).join("\n") + "\n\n";
    if found.stages.is_empty() {
        text += &body(&found.principal, input);
    }
    for (index, stage) in found.stages.iter().enumerate() {
        text += &stage_text(index, stage, input);
    }
    if let (Finding::Missing, Some(effect)) = (found.finding, &found.principal.effect) {
        let (model, data) = (quoted(&input.file), input.arguments());
        let _ = writeln!(text, "\nnext: `switchid add {effect} --model {model} --data {data} -o BETTER.toml`");
    }
    text
}

/// What is missing, how sure, which further recording would decide, and how the sensors keep time.
pub(super) fn lines(found: &Found, input: &Input) -> Vec<String> {
    let mut lines = answer(&found.principal, found.clock.as_ref(), input);
    if !found.stages.is_empty() {
        lines[0] = over_stages(found);
    }
    lines
}

/// The lines of one diagnosis.
pub(in crate::cli) fn answer(diagnosis: &Diagnosis, clock: Option<&Clock>, input: &Input) -> Vec<String> {
    let mut lines = vec![what(diagnosis, input), sure(diagnosis), format!("decides: {}", decides(diagnosis))];
    let way = if diagnosis.base.terms.contains(&crate::law::Term::Inertia) { None } else { Some(OUTPUT) };
    lines.extend(way.map(String::from));
    lines.extend(biased(diagnosis.improved.as_ref().unwrap_or(&diagnosis.base)));
    lines.extend(clock.into_iter().flat_map(Clock::sentences).map(|sentence| format!("sensors: {sentence}")));
    lines
}

/// Which coefficients least squares would bias.
fn biased(law: &Law) -> Option<String> {
    let names: Vec<String> = law.biased.iter().map(|term| Catalogue::name_of(*term)).collect();
    (!names.is_empty()).then(|| {
        let names = names.join(", ");
        format!("sensors: noise in the readings biases least squares in {names}: the values are those with even and odd readings as instruments")
    })
}

const OUTPUT: &str = "the model has no inertia: F = law(q, qd), F is the output";

fn what(diagnosis: &Diagnosis, input: &Input) -> String {
    match (diagnosis.finding, diagnosis.candidates.first()) {
        (Finding::Missing, Some(best)) => {
            let mut line = format!("missing: {}, {}", best.effect, force(best, &diagnosis.base, input));
            for group in &diagnosis.indistinguishable {
                let _ = write!(line, "; this record cannot tell it from {}", group[1..].join(", "));
            }
            let explained = percent(diagnosis.explained);
            line + &format!(". It explains {explained} of the error at the motion's scale; {}", diagnosis.left)
        }
        (Finding::Adequate, _) => "nothing is missing: what is left is what the sensors alone would leave".into(),
        _ => match trapped(diagnosis) {
            Some(trap) => {
                let share = percent(trap.resemblance);
                format!(
                    "cannot tell whether {} is missing: the model's own terms are {share} of it here; {}",
                    trap.effect, diagnosis.left
                )
            }
            None => format!("unexplained: no effect of the catalogue passes; {}", diagnosis.left),
        },
    }
}

/// The best candidate that the law's own terms nearly are, where it would lower the error.
fn trapped(diagnosis: &Diagnosis) -> Option<&Candidate> {
    let would = |candidate: &&Candidate| candidate.doubt == Some(Doubt::Trap) && candidate.error().ratio() < WORTH;
    diagnosis.candidates.iter().find(would)
}

/// `20.35 ± 0.05 N`, in brackets where a unit follows both.
fn with_unit(candidate: &Candidate, input: &Input) -> String {
    quantity(candidate.coefficient, candidate.std, unit_of(candidate.term, &input.units))
}

/// `(20.35 ± 0.05) N · sign(q̇) e^(−|q̇|/v), speed 0.02 m/s`.
fn force(candidate: &Candidate, law: &Law, input: &Input) -> String {
    let symbol = effect_of(candidate.term, law);
    let force = format!("{} · {symbol}", with_unit(candidate, input));
    let inner = inner(candidate.term, &law.expressions, &input.units)
        .into_iter()
        .map(|one| format!(", {}", one.replace('_', " ")));
    std::iter::once(force).chain(inner).collect()
}

fn sure(diagnosis: &Diagnosis) -> String {
    let [first, .., last] = diagnosis.errors;
    let errors = |pick: fn(&crate::diagnose::WindowError) -> f64| {
        let told = diagnosis.errors.iter().map(pick);
        told.map(|error| if error.is_finite() { percent(error) } else { "–".into() }).collect::<Vec<_>>().join(", ")
    };
    let windows = format!("windows of {:.3} to {:.3} s", first.window, last.window);
    match (diagnosis.finding, diagnosis.candidates.first()) {
        (Finding::Missing, Some(best)) => {
            let chance = match best.p_value {
                Some(p) => format!("by chance {} among {} tried", chance(p), diagnosis.tried),
                None => "too short to be sure: named on its error alone".into(),
            };
            let (before, after) = (errors(|error| error.before), errors(|error| error.after));
            format!("how sure: {chance}; held-out error {before} → {after} ({windows})")
        }
        _ => {
            let floor = errors(|error| error.floor);
            format!("how sure: held-out error {}, the sensors' floor {floor} ({windows})", errors(|error| error.before))
        }
    }
}

/// Which further recording would tell more.
fn decides(diagnosis: &Diagnosis) -> String {
    if let Some(group) = diagnosis.indistinguishable.first() {
        return format!("a longer or larger motion, between {} and {}", group[0], group[1]);
    }
    if let Some(trap) = trapped(diagnosis) {
        return format!(
            "a recording in which {} goes its own way: several speeds and amplitudes, reversals, an excitation that does not \
             follow the motion",
            trap.effect
        );
    }
    match diagnosis.finding {
        Finding::Missing if diagnosis.is_down_to_sensors() => "no further recording is needed".into(),
        Finding::Missing => "add it and diagnose again: what is left is more than the sensors'".into(),
        Finding::Adequate => "no further recording is needed for what this one shows".into(),
        Finding::Unexplained if !diagnosis.is_testable => "a longer recording: this one is too short to be sure".into(),
        Finding::Unexplained => "a recording at other speeds, amplitudes and frequencies, with q and q̇ measured".into(),
    }
}

/// The first line where a record switches.
fn over_stages(found: &Found) -> String {
    let missing: Vec<(usize, &str)> = found.stages.iter().enumerate().filter_map(lacking).collect();
    let names: Vec<&str> = missing.iter().map(|(_, effect)| *effect).collect();
    let all_same = names.windows(2).all(|pair| pair[0] == pair[1]);
    let count = found.stages.len();
    let stage = |(index, effect): &(usize, &str)| format!("{effect} in stage {}", index + 1);
    match missing.as_slice() {
        [] if found.finding == Finding::Unexplained => {
            format!("unexplained: no effect of the catalogue passes in any of {count} stages")
        }
        [] => format!("nothing is missing in any of {count} stages: the law switches, its form stays"),
        [one] => format!("missing in stage {} of {count} only: {}", one.0 + 1, one.1),
        several if all_same && several.len() == count => {
            let all = if count == 2 { "both".into() } else { format!("all {count}") };
            format!("missing in {all} stages: {}", several[0].1)
        }
        several => format!("missing: {} ({count} stages)", several.iter().map(stage).collect::<Vec<_>>().join(", ")),
    }
}

fn lacking((index, stage): (usize, &StageDiagnosis)) -> Option<(usize, &str)> {
    Some((index, stage.diagnosis.as_ref()?.effect.as_deref()?))
}

fn stage_text(index: usize, stage: &StageDiagnosis, input: &Input) -> String {
    let source = stage.samples.source();
    let head = format!("stage {}, {:.3} s to {:.3} s of {source}: ", index + 1, stage.start, stage.end);
    match &stage.diagnosis {
        None => head + "too short to determine a law\n",
        Some(diagnosis) => head + &what(diagnosis, input) + "\n" + &body(diagnosis, input),
    }
}

fn body(diagnosis: &Diagnosis, input: &Input) -> String {
    let mut text = format!("law diagnosed: {}\n", law(&diagnosis.base, input));
    text += &candidates(diagnosis, input);
    if diagnosis.finding == Finding::Missing {
        text += &reasons(diagnosis);
    }
    text
}

/// A law on one line.
fn law(law: &Law, input: &Input) -> String {
    let terms = law.terms.iter().zip(&law.coefficients).zip(&law.std);
    let terms: Vec<_> =
        terms.map(|((term, value), std)| (*term, *value, Some(*std).filter(|std| *std > 0.0))).collect();
    equation(&terms, input.forced())
}

/// The candidates as a table; errors are those of windows of 0.3 T₀.
pub(in crate::cli) fn candidates(diagnosis: &Diagnosis, input: &Input) -> String {
    let window = diagnosis.errors[1].window;
    let mut text = format!(
        "{:<30} {:>28} {:>20} {:>10}  {}\n",
        "candidate",
        "coefficient",
        format!("error ({window:.3} s)"),
        "chance",
        "not named because"
    );
    for candidate in diagnosis.candidates.iter().take(LISTED) {
        let error = candidate.error();
        let errors = format!("{} → {}", percent(error.before), percent(error.after));
        let chance = candidate.p_value.map_or_else(|| "–".into(), chance);
        let why = candidate.doubt.map_or("", why);
        let _ = writeln!(
            text,
            "{:<30} {:>28} {errors:>20} {chance:>10}  {why}",
            candidate.effect,
            with_unit(candidate, input)
        );
        let inner = inner(candidate.term, &input.model.expressions, &input.units);
        if !inner.is_empty() {
            let _ = writeln!(text, "  with {}", inner.join(", "));
        }
    }
    text
}

fn why(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::Sign => "physics forbids its sign",
        Doubt::Trap => "the model's own terms nearly are it",
        Doubt::Uncertain => "its coefficient is within its uncertainty",
        Doubt::Worse => "it makes the error worse, or leaves all",
        Doubt::Chance => "its gain may be chance, or is too small",
    }
}

/// Why the effect may be there, and what it looks like.
fn reasons(diagnosis: &Diagnosis) -> String {
    let Some(entry) = diagnosis.effect.as_deref().and_then(Catalogue::find) else { return String::new() };
    format!("why {}: {}\n  {}\n  {}\n", entry.id, entry.reason, entry.residual, entry.reference)
}
