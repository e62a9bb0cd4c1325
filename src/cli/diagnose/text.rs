//! A diagnosis in words: three lines that answer, then what they rest on.

use super::super::input::Input;
use super::{Answer, Found, StageAnswer};
use crate::cli::words::{chance, effect_of, number, percent};
use crate::diagnose::{Candidate, Decision, Dependence, Diagnosis, Finding, Source};
use crate::law::{Catalogue, SiUnit, Units, equation};
use std::fmt::Write;

/// Chances beyond which another significant candidate is not worth a line.
const LISTED: f64 = 0.01;

pub(in crate::cli) fn verdict(finding: Finding) -> &'static str {
    match finding {
        Finding::Missing => "missing",
        Finding::Adequate => "adequate",
        Finding::Unexplained => "unexplained",
    }
}

pub(super) fn text(found: &Found, input: &Input) -> String {
    let mut text = lines(found, input).join("\n") + "\n\n";
    if found.stages.is_empty() {
        text += &body(&found.principal, input);
    }
    for (index, stage) in found.stages.iter().enumerate() {
        text += &stage_text(index, stage, input);
    }
    if let (Finding::Missing, Some(effect)) = (found.finding, &found.principal.diagnosis.effect) {
        let _ = writeln!(
            text,
            "\nnext: `switchid add {effect} --model {} --data {} -o BETTER.toml`",
            input.file,
            input.named()
        );
    }
    text
}

/// What is missing, how sure, and which further recording would decide.
pub(super) fn lines(found: &Found, input: &Input) -> [String; 3] {
    let mut lines = answer(&found.principal, input);
    if !found.stages.is_empty() {
        lines[0] = over_stages(found);
    }
    lines
}

/// The three lines of one diagnosis.
pub(in crate::cli) fn answer(answer: &Answer, input: &Input) -> [String; 3] {
    [what(answer, input), sure(answer), decides(answer, &input.units)]
}

fn what(answer: &Answer, input: &Input) -> String {
    let diagnosis = &answer.diagnosis;
    match (diagnosis.finding, diagnosis.candidates.first()) {
        (Finding::Missing, Some(best)) => {
            let mut line = format!("missing: {}, {}", best.effect, force(best, diagnosis, input));
            for other in &diagnosis.beside {
                let _ = write!(line, "; and beside it {other}");
            }
            for group in &diagnosis.indistinguishable {
                let one = if group[0] == best.effect { "it" } else { &group[0] };
                let _ = write!(line, "; this record cannot tell {one} from {}", group[1..].join(", "));
            }
            line
        }
        (Finding::Unexplained, _) => {
            let on = answer.dependence.as_ref().map(|found| format!("; it depends on {}", dependence(found)));
            format!("unexplained: something is missing that is not in the catalogue{}", on.unwrap_or_default())
        }
        _ => "nothing is missing: the law explains this record".into(),
    }
}

/// `20.35 ± 0.05 N`, in brackets where a unit follows both.
fn with_unit(candidate: &Candidate, input: &Input) -> String {
    let number = number(candidate.coefficient, candidate.std);
    match input.unit(candidate.term).as_str() {
        "" => number,
        unit => format!("({number}){unit}"),
    }
}

/// `(20.35 ± 0.05) N · sign(q̇) e^(−|q̇|/v), speed 0.02 m/s`.
fn force(candidate: &Candidate, diagnosis: &Diagnosis, input: &Input) -> String {
    let symbol = effect_of(candidate.term, &diagnosis.base.form);
    let force = format!("{} · {symbol}", with_unit(candidate, input));
    let inner = inner(candidate, &input.units).into_iter().map(|one| format!(", {}", one.replace('_', " ")));
    std::iter::once(force).chain(inner).collect()
}

fn sure(answer: &Answer) -> String {
    let diagnosis = &answer.diagnosis;
    let Some(best) = diagnosis.candidates.first() else {
        return "how sure: no candidate could be put into the law".into();
    };
    let tried = format!("{} among {} tried", chance(best.p_value), diagnosis.tried);
    match diagnosis.finding {
        Finding::Missing => {
            let (before, after) = (percent(best.error_before), percent(best.error_after));
            format!("how sure: by chance {tried}; error on held-out data {before} → {after}{}", behind(diagnosis))
        }
        Finding::Adequate => {
            let error = percent(best.error_before);
            format!("how sure: the best candidate, {}, has a chance of {tried}; error {error}", best.effect)
        }
        Finding::Unexplained => {
            let explained = percent(diagnosis.explained);
            let beyond = "the error is beyond the sensors' noise";
            let by =
                answer.dependence.as_ref().map(|found| format!(", the dependence by chance {}", chance(found.p_value)));
            format!("how sure: {beyond}; the catalogue explains {explained} of it at best{}", by.unwrap_or_default())
        }
    }
}

/// By how much the next candidate that is no tie is worse.
fn behind(diagnosis: &Diagnosis) -> String {
    let tied = diagnosis.indistinguishable.first();
    let is_tied = |candidate: &&Candidate| tied.is_some_and(|group| group.contains(&candidate.effect));
    let Some(best) = diagnosis.candidates.first() else { return String::new() };
    let gain = best.gain;
    // one that contains the best is a rival only where it gains more
    let rival = |candidate: &&Candidate| {
        !diagnosis.beside.contains(&candidate.effect) && !Catalogue::is_contained(&best.effect, &candidate.effect)
    };
    match diagnosis.candidates.iter().skip(1).filter(rival).find(|candidate| !is_tied(candidate)) {
        Some(next) if gain > next.gain => {
            format!("; {}, the next best, is {:.0} nats behind", next.effect, gain - next.gain)
        }
        _ => String::new(),
    }
}

fn decides(answer: &Answer, units: &Units) -> String {
    let line = match (answer.diagnosis.finding, &answer.decision, &answer.visible) {
        (Finding::Missing, Some(decision), _) => decision_words(decision, units),
        (Finding::Missing, None, _) => match answer.diagnosis.indistinguishable.first() {
            Some(group) => format!("a longer or larger motion, between {} and {}", group[0], group[1]),
            None => "no further recording is needed".into(),
        },
        (Finding::Adequate, _, Some(seen)) => format!(
            "a weaker effect needs a longer or larger motion: this record shows {} from {} of the force on",
            seen.effect,
            percent(seen.share)
        ),
        (Finding::Adequate, ..) => "no further recording is needed for what this one shows".into(),
        (Finding::Unexplained, ..) => further(answer.dependence.as_ref()).into(),
    };
    format!("decides: {line}")
}

fn decision_words(decision: &Decision, units: &Units) -> String {
    let Decision { one, other, apart, needed, longer, motion } = decision;
    let asked = match motion {
        Some(reach) => format!(
            "a recording with |q| up to {:.3}{} and |q̇| up to {:.3}{} ({} times this one)",
            reach.displacement,
            spaced(units.displacement()),
            reach.velocity,
            spaced(units.velocity()),
            reach.scale
        ),
        None if *longer < 1e4 => format!("a recording {longer:.0} times as long as this one"),
        None => "none of this kind of motion; excite it at other frequencies".into(),
    };
    format!("{asked}, between {one} and {other} ({apart:.1} nats apart here, {needed:.0} decide)")
}

fn further(dependence: Option<&Dependence>) -> &'static str {
    match dependence.map(|found| found.source) {
        Some(Source::Drift | Source::StiffnessDrift | Source::DampingDrift) => {
            "the same motion again, an hour later: what drifts has drifted on"
        }
        Some(Source::Line(_)) => "the system at rest, without excitation: the line stays if it comes from elsewhere",
        Some(Source::Parametric(_)) => "a free decay: the coefficient still oscillates if it does so by itself",
        Some(Source::PastDisplacement(_) | Source::PastVelocity(_)) => {
            "slow triangles of several amplitudes, then a free decay: memory shows as loops that depend on the turning points"
        }
        Some(Source::PastExcitation(_) | Source::SquaredExcitation | Source::ExcitationMagnitude) => {
            "the same excitation at half its amplitude: what comes from the input does not fall in proportion"
        }
        None => "one with q and q̇ measured and an excitation that covers more frequencies and amplitudes",
    }
}

/// What the error of a law depends on, in words.
pub(super) fn dependence(found: &Dependence) -> String {
    let relative = |what: &str, verb: &str| match found.relative {
        Some(relative) => {
            let direction = if relative < 0.0 { "falls" } else { "grows" };
            format!("time: the {what} {direction} by {} over the record", percent(relative.abs()))
        }
        None => format!("time: a {what} {verb} by {:.4} over the record", found.amplitude),
    };
    let hertz = |omega: f64| format!("{omega:.4} rad/s, {:.4} Hz", omega / std::f64::consts::TAU);
    match found.source {
        Source::Drift => format!("time: a force that changes by {:.4} over the record", found.amplitude),
        Source::StiffnessDrift => relative("stiffness", "changes"),
        Source::DampingDrift => relative("damping", "changes"),
        Source::Line(omega) => format!(
            "a frequency: {}, a force of amplitude {:.4} that is not in the excitation",
            hertz(omega),
            found.amplitude
        ),
        Source::Parametric(omega) => {
            let by = found.relative.map_or_else(|| format!("{:.4}", found.amplitude), |share| percent(share.abs()));
            format!("a frequency: {}, with which the stiffness oscillates by {by}", hertz(omega))
        }
        Source::PastDisplacement(delay) => format!("memory: the displacement {delay:.4} s ago"),
        Source::PastVelocity(delay) => format!("memory: the velocity {delay:.4} s ago"),
        Source::PastExcitation(delay) => format!("the input: the excitation {delay:.4} s ago"),
        Source::SquaredExcitation => "the input: the square of the excitation".into(),
        Source::ExcitationMagnitude => "the input: the magnitude of the excitation".into(),
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
            let unexplained = |(_, stage): &(usize, &StageAnswer)| {
                stage.answer.as_ref().is_some_and(|answer| answer.diagnosis.finding == Finding::Unexplained)
            };
            let stages: Vec<String> =
                found.stages.iter().enumerate().filter(unexplained).map(|(index, _)| (index + 1).to_string()).collect();
            format!("unexplained in stage {} of {count}: something that is not in the catalogue", stages.join(", "))
        }
        [] => format!("nothing is missing in any of {count} stages: the law switches, its form stays"),
        [one] => format!("missing in stage {} of {count} only: {}", one.0 + 1, one.1),
        several if all_same && several.len() == count => format!("missing in all {count} stages: {}", several[0].1),
        several => format!("missing: {} ({count} stages)", several.iter().map(stage).collect::<Vec<_>>().join(", ")),
    }
}

fn lacking((index, stage): (usize, &StageAnswer)) -> Option<(usize, &str)> {
    Some((index, stage.answer.as_ref()?.diagnosis.effect.as_deref()?))
}

fn stage_text(index: usize, stage: &StageAnswer, input: &Input) -> String {
    let head = format!("stage {}, {:.3} s to {:.3} s of {}: ", index + 1, stage.start, stage.end, stage.data);
    match &stage.answer {
        None => head + "too short to determine a law\n",
        Some(answer) => head + &what(answer, input) + "\n" + &body(answer, input),
    }
}

fn body(answer: &Answer, input: &Input) -> String {
    let diagnosis = &answer.diagnosis;
    let mut text = law(diagnosis, input);
    text += &candidates(diagnosis, input);
    if diagnosis.finding == Finding::Missing {
        text += &reasons(diagnosis);
    }
    text
}

fn law(diagnosis: &Diagnosis, input: &Input) -> String {
    let fit = &diagnosis.base;
    let std = |index: usize| Some(fit.std(index)).filter(|std| *std > 0.0);
    let terms = fit.form.terms.iter().zip(&fit.coefficients).enumerate();
    let terms: Vec<_> = terms.map(|(index, (term, value))| (*term, *value, std(index))).collect();
    let forced = input.recordings().iter().any(|(recording, _)| recording.channels().excitation);
    format!("law diagnosed: {}\n", equation(&terms, forced))
}

/// The candidates that were tried in the law, as a table; errors are those of windows of one length.
pub(in crate::cli) fn candidates(diagnosis: &Diagnosis, input: &Input) -> String {
    let mut text = format!(
        "{:<30} {:>28} {:>18} {:>10} {:>9}  {}\n",
        "candidate",
        "coefficient",
        format!("error ({:.3} s)", diagnosis.window),
        "chance",
        "explains",
        "sign, others"
    );
    let worth = |index: &usize| *index < 2 || diagnosis.candidates[*index].p_value < LISTED;
    for index in (0..diagnosis.candidates.len()).filter(worth) {
        let candidate = &diagnosis.candidates[index];
        let share = match diagnosis.finding {
            Finding::Adequate => "–".into(),
            _ => percent(candidate.share),
        };
        let errors = format!("{} → {}", percent(candidate.error_before), percent(candidate.error_after));
        let sign = if candidate.physical { "physical" } else { "unphysical" };
        let others = if candidate.plausible { "plausible" } else { "implausible" };
        let _ = writeln!(
            text,
            "{:<30} {:>28} {:>18} {:>10} {:>9}  {sign}, {others}",
            candidate.effect,
            with_unit(candidate, input),
            errors,
            chance(candidate.p_value),
            share
        );
        let inner = inner(candidate, &input.units);
        if !inner.is_empty() {
            let _ = writeln!(text, "  with {}", inner.join(", "));
        }
        if let Some(place) = &candidate.place {
            let _ = writeln!(text, "  {}", place.sentence(&input.units));
        }
    }
    text
}

/// Inner parameters with their units.
fn inner(candidate: &Candidate, units: &Units) -> Vec<String> {
    let described = candidate.term.effect().map_or(&[][..], |effect| effect.inner());
    let pairs = candidate.inner.iter().zip(described);
    pairs
        .map(|((name, value), described)| format!("{name} {value:.4}{}", spaced(units.inner(described.unit))))
        .collect()
}

/// A unit with a space before it; nothing where there is none.
fn spaced(unit: Option<SiUnit>) -> String {
    unit.filter(|unit| unit.symbol != "1").map_or_else(String::new, |unit| format!(" {}", unit.symbol))
}

/// Why the effect may be there, and what it looks like.
fn reasons(diagnosis: &Diagnosis) -> String {
    let Some(entry) = diagnosis.effect.as_deref().and_then(Catalogue::find) else { return String::new() };
    format!("why {}: {}\n  {}\n  {}\n", entry.id, entry.reason, entry.residual, entry.reference)
}
