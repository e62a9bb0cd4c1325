//! The table that the benchmark prints.

use super::benchmark::{Answer, Outcome, Secret, Setting};
use std::fmt;

/// Counts of answers under one heading.
#[derive(Clone, Debug, Default)]
struct Row {
    name: String,
    /// Right, tied, wrong, adequate, unexplained, no law.
    answers: [usize; 6],
    ties: usize,
    invisible: usize,
    ratios: Vec<f64>,
    seconds: Vec<f64>,
    /// Records that show a switch, and those whose switch alone was found.
    switches: [usize; 2],
}

/// Rows by problem, by noise, and of all.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Row>,
}

impl Table {
    /// Sums up outcomes.
    pub fn new<'a>(outcomes: impl Iterator<Item = (&'a Setting, &'a Outcome)>) -> Table {
        let all: Vec<(&Setting, &Outcome)> = outcomes.collect();
        let mut table = Table::default();
        let headings: [&dyn Fn(&Setting) -> String; 4] = [
            &|setting| row_name(&setting.secret),
            &|setting| format!("{}, noise {} %", group(&setting.secret), 100.0 * setting.noise),
            &|setting| format!("{}, strength {} %", group(&setting.secret), 100.0 * setting.strength),
            &|setting| format!("{}, all", group(&setting.secret)),
        ];
        for heading in headings {
            let start = table.rows.len();
            all.iter().for_each(|(setting, outcome)| table.count(start, heading(setting), outcome));
        }
        table
    }

    fn count(&mut self, start: usize, name: String, outcome: &Outcome) {
        let found = self.rows[start..].iter().position(|row| row.name == name);
        let index = found.map_or(self.rows.len(), |found| start + found);
        if index == self.rows.len() {
            self.rows.push(Row { name, ..Row::default() });
        }
        self.rows[index].count(outcome);
    }
}

impl Row {
    fn count(&mut self, outcome: &Outcome) {
        self.seconds.push(outcome.seconds);
        self.switches[0] += usize::from(outcome.switch.is_some());
        self.switches[1] += usize::from(outcome.switch == Some(true));
        if !outcome.visible {
            self.invisible += 1;
            return;
        }
        self.answers[outcome.answer as usize] += 1;
        self.ties += usize::from(outcome.tie);
        self.ratios.extend(outcome.ratio);
    }
}

fn row_name(secret: &Secret) -> String {
    match secret {
        Secret::Missing(ids) if ids.len() > 1 => "two effects".into(),
        other => other.name(),
    }
}

fn group(secret: &Secret) -> &'static str {
    match secret {
        Secret::Missing(ids) if ids.len() > 1 => "two effects",
        Secret::Missing(_) => "one effect",
        Secret::Complete(_) => "complete models",
        Secret::Outside(_) => "outside the catalogue",
    }
}

const HEAD: &str = "| hidden | seen | right | first or tied | in a tie | wrong effect | \"adequate\" | \"unexplained\" | no law | not visible | error ÷ floor | CPU, s | switch found |\n\
    |---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(HEAD)?;
        self.rows.iter().try_for_each(|row| writeln!(f, "{row}"))
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seen: usize = self.answers.iter().sum();
        let share = |count: usize| match seen {
            0 => "–".into(),
            _ => format!("{:.1} %", 100.0 * count as f64 / seen as f64),
        };
        let of = |answer: Answer| self.answers[answer as usize];
        let either = of(Answer::Right) + of(Answer::Tied);
        let middle =
            |values: &[f64], digits: usize| median(values).map_or("–".into(), |middle| format!("{middle:.digits$}"));
        write!(f, "| {} | {seen} | {} | {} | {} ", self.name, share(of(Answer::Right)), share(either), self.ties)?;
        let [wrong, adequate] = [of(Answer::Wrong), of(Answer::Adequate)];
        write!(f, "| {wrong} | {adequate} | {} | {} ", of(Answer::Unexplained), of(Answer::NoLaw))?;
        write!(f, "| {} | {} | {} ", self.invisible, middle(&self.ratios, 3), middle(&self.seconds, 2))?;
        match self.switches {
            [0, _] => write!(f, "| – |"),
            [all, found] => write!(f, "| {:.1} % of {all} |", 100.0 * found as f64 / all as f64),
        }
    }
}

fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}
