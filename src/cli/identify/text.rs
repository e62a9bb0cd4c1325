//! What the identifier found, in words.

use super::found::{Run, noise, stages};
use crate::cli::stage_limit::StageLimit;
use crate::cli::words::{self, digits, percent, quantity, quoted, seconds};
use crate::data::Section;
use crate::identify::{Coefficient, Missing, Stage};
use crate::law::{Term, Units, unit_of};
use std::fmt::Write;

/// Least width of the column of terms.
const TERM: usize = 12;

/// Shortest time that one decimal shows, s.
const SHOWN: f64 = 0.05;

pub(super) fn text(run: &Run) -> String {
    let mut text = head(run);
    text += "\nstage       start           ±         end    detected  identified   s\n";
    for (index, stage) in run.found.stages.iter().enumerate() {
        let (detected, identified) = (time(stage.detected), time(stage.identified));
        let std = stage.start_std.map_or_else(|| "–".into(), |std| format!("{std:.4}"));
        let _ = writeln!(
            text,
            "{:>5} {:>11.3} {std:>11} {:>11.3} {detected:>11} {identified:>11}",
            index + 1,
            stage.start,
            stage.end
        );
    }
    for fault in &run.found.sensors {
        let end = fault.end.map_or_else(|| "the end".into(), |end| format!("{end:.3} s"));
        let _ = writeln!(text, "sensor of {}: {} from {:.3} s to {end}", fault.channel, fault.kind.id(), fault.start);
    }
    for (index, (stage, limit)) in stages(run).enumerate() {
        let law = law(stage, limit, run.settings.channels.excitation, &run.opened.units);
        let drifting = if stage.drifting { " (drifting; its last coefficients)" } else { "" };
        let again = again(&run.found.stages[..index], stage);
        let _ = write!(text, "\nstage {}{again}{drifting}: {law}", index + 1);
        let unexplained = limit.is_some_and(|limit| !limit.explained());
        text += match (unexplained, run.found.has_fault_in(stage)) {
            (_, true) => "  a sensor's fault lies in this stage: no comparison with what any method could reach\n",
            (true, false) => {
                "  the law leaves more than sensor noise: no comparison with what any method could reach\n"
            }
            (false, false) => "",
        };
        text += &match stage.missing {
            Some(missing) => lacks(missing, run, stage),
            None if unexplained => diagnosable(run, stage),
            None => String::new(),
        };
    }
    text
}

/// What the law lacks, and what tells more of it.
fn lacks(missing: Missing, run: &Run, stage: &Stage) -> String {
    let (effect, nats) = (missing.effect().id, missing.evidence);
    format!("  this law lacks {effect} ({nats:.0} nats): run {}\n", diagnose(run, stage))
}

/// Where no effect stands out while the stream goes by, the whole of it may tell.
fn diagnosable(run: &Run, stage: &Stage) -> String {
    format!(
        "  this law lacks something that no single effect explains as the record goes by: run {}\n",
        diagnose(run, stage)
    )
}

/// The command that diagnoses a stage.
fn diagnose(run: &Run, stage: &Stage) -> String {
    let model = quoted(&run.file);
    let source = run.opened.recording.source();
    let data = match run.found.stages.len() {
        1 => source.to_string(),
        _ => format!("{}@{:.3}:{:.3}", file(source), stage.start, stage.end),
    };
    format!("`switchid diagnose {} --model {model}`", quoted(&data))
}

/// A recording's file, without the section that was taken of it.
fn file(source: &str) -> String {
    Section::parse(source).map_or_else(|_| source.into(), |section| section.path.display().to_string())
}

/// ` (law 1 again)` where the law was known when the stage began.
fn again(before: &[Stage], stage: &Stage) -> String {
    let seen = stage.recognised || before.iter().any(|other| other.law_number == stage.law_number);
    stage.law_number.filter(|_| seen).map_or_else(String::new, |number| format!(" (law {number} again)"))
}

fn head(run: &Run) -> String {
    let recording = &run.opened.recording;
    let times = recording.stream(0..recording.count()).map(|sample| sample.t);
    let [first, last] = times.fold([f64::INFINITY, 0.0], |[first, _], t| [t.min(first), t]).map(seconds);
    let (source, count) = (recording.source(), recording.came());
    let mut text = format!("{source}: {count} samples from {first} s to {last} s");
    text += &match recording.incomplete().len() {
        0 => "\n".into(),
        1 => ", one of them without all readings\n".into(),
        lacking => format!(", {lacking} of them without all readings\n"),
    };
    for column in &run.opened.columns {
        let _ = writeln!(text, "  {column}");
    }
    for (name, value) in &run.inner {
        let _ = writeln!(text, "{name}: {}, fitted to the recording as a whole", digits(*value, 4));
    }
    text += &match run.gives_force {
        true => "F is the output: F = law(q, q̇)\n".into(),
        false if run.found.hold == run.settings.hold => {
            format!("between samples: {} ({})\n", run.settings.hold, run.hold_from)
        }
        false => format!(
            "between samples: {}; {} ({}) is not what the motion tells\n",
            run.found.hold, run.settings.hold, run.hold_from
        ),
    };
    let noise = words::noise(&noise(&run.found), &run.opened.units);
    let _ = writeln!(text, "sensor noise (std): {}", if noise.is_empty() { "not known" } else { &noise });
    text
}

/// The law on one line, its coefficients with their std, units and what any method could reach, and what is not known.
fn law(stage: &Stage, limit: Option<&StageLimit>, forced: bool, units: &Units) -> String {
    let unknown = "cannot be determined from these data";
    let mut text = stage.law(forced).unwrap_or_else(|| unknown.into()) + "\n";
    let longest = stage.known().map(|(known, _)| known.term.name().chars().count()).max();
    let width = longest.unwrap_or(0).max(TERM);
    let value = |known: &Coefficient, std: f64| match known.value == 0.0 && std == 0.0 {
        true => "0: the record does not speak for it".into(),
        false => quantity(known.value, std, unit_of(known.term, units)),
    };
    let known: Vec<(&Coefficient, f64, String)> =
        stage.known().map(|(known, std)| (known, std, value(known, std))).collect();
    let uncertain = || known.iter().filter_map(|(.., value)| value.split_once('±'));
    let [before, behind] = [
        uncertain().map(|(value, _)| value.chars().count()).max().unwrap_or(0),
        uncertain().map(|(_, std)| std.chars().count()).max().unwrap_or(0),
    ];
    for (known, std, value) in &known {
        let value = match value.split_once('±') {
            Some((value, std)) => format!("{value:>before$}±{std:<behind$}"),
            None => value.clone(),
        };
        let line = format!("  {:<width$} {value}{}", known.term.name(), times_limit(known.term, *std, limit));
        text = text + line.trim_end() + "\n";
    }
    let open: Vec<String> = stage
        .coefficients
        .iter()
        .filter(|entry| entry.std.is_none() && entry.needed.is_none())
        .map(|entry| entry.term.name())
        .collect();
    if !open.is_empty() {
        let _ = writeln!(text, "  not known: {}", open.join(", "));
    }
    text += &lacking(stage);
    text += &explained(stage);
    for combination in &stage.unidentifiable {
        let _ = writeln!(text, "  no data of this stage determine {combination}");
    }
    text
}

/// What share of the force the law explains, and whether it is validated; empty where that is not told.
fn explained(stage: &Stage) -> String {
    let validated = match stage.identified.filter(|_| stage.valid) {
        Some(_) => "",
        None => {
            "; it is not validated: what it leaves is no white noise, or the record too short; the std are those between parts of \
             the record"
        }
    };
    let line = |share: f64| format!("  the law explains {} of the variance of the force{validated}\n", percent(share));
    stage.explained.map_or_else(String::new, line)
}

/// `q^3: not known yet, about 1.4 s more of such motion`, a line for each coefficient that a validated law needs
/// better.
fn lacking(stage: &Stage) -> String {
    let last = stage.lacking().map(|(_, seconds)| seconds).fold(0.0, f64::max);
    let line = |(term, seconds): (Term, f64)| {
        let known = stage.known().any(|(known, _)| known.term == term);
        let what = if known { "not known well yet" } else { "not known yet" };
        format!("  {}: {what}, {} more of such motion\n", term.name(), more(seconds, last))
    };
    stage.lacking().map(line).collect()
}

/// `about 1.4 s`, never 0.0 s: a term that lacks next to nothing waits for the last one, with which the law is known.
fn more(seconds: f64, last: f64) -> String {
    let shown = |seconds: &f64| *seconds >= SHOWN;
    let seconds = Some(seconds).filter(shown).or(Some(last).filter(shown));
    seconds.map_or_else(|| "less than 0.1 s".into(), |seconds| format!("about {seconds:.1} s"))
}

/// `  (1.1 times the limit)`; empty where the limit is not known or the law is not complete.
fn times_limit(term: Term, std: f64, limit: Option<&StageLimit>) -> String {
    let least = limit.filter(|limit| limit.explained()).and_then(|limit| limit.std(term));
    least.map_or_else(String::new, |least| format!("  ({:.2} times the limit)", std / least))
}

fn time(t: Option<f64>) -> String {
    t.map_or_else(|| "–".into(), |t| format!("{t:.3}"))
}

#[cfg(test)]
mod tests {
    use super::more;

    #[test]
    fn what_a_term_lacks_is_never_nothing() {
        assert_eq!([more(1.44, 3.0), more(0.01, 3.0)], ["about 1.4 s", "about 3.0 s"]);
        assert_eq!(more(0.01, 0.04), "less than 0.1 s");
    }
}
