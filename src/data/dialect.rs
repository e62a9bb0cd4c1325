//! How a text file holds its table: what separates cells, which decimal mark, and where header, units and numbers
//! begin.

use super::cells::Separator;
use super::instant::Instant;
use super::number::{Decimal, number};
use crate::law::Unit;

/// Lines that are looked at.
const LOOKED_AT: usize = 400;

/// Marks that make a line a comment; the last one before the numbers may be the header.
const COMMENTS: [&str; 4] = ["#", "%", "//", "!"];

/// A line of the file that says something, with its number from 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    pub(super) number: u64,
    pub(super) text: &'a str,
}

/// How the table is written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dialect {
    pub(super) separator: Separator,
    pub(super) decimal: Decimal,
    /// Number of the line of the header; none where the table has none.
    pub(super) header: Option<u64>,
    /// Number of the line of units.
    pub(super) units: Option<u64>,
    /// Number of the first line of numbers.
    pub(super) first: u64,
    /// The columns' names, with the units of a line of their own behind them; counted from 1 where there is no header.
    pub(super) headers: Vec<String>,
    /// Cells of the first line of numbers.
    pub(super) sample: Vec<String>,
}

/// The lines of a text, comments and blank ones apart.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let counted = split_lines(text).enumerate().map(|(index, text)| Line { number: index as u64 + 1, text });
    counted.filter(|line| !line.text.trim().is_empty())
}

/// Whether a line is a remark.
pub(super) fn is_comment(text: &str) -> bool {
    COMMENTS.iter().any(|mark| text.trim_start().starts_with(mark))
}

/// Lines ending as on any system; old ones end in a carriage return alone.
pub(super) fn split_lines(text: &str) -> Box<dyn Iterator<Item = &str> + '_> {
    if text.contains('\n') { Box::new(text.lines()) } else { Box::new(text.split_terminator('\r')) }
}

impl Dialect {
    /// The dialect under which most cells are numbers; where the file has no numbers, that of its first line. None
    /// where nothing is a table.
    pub(super) fn of(text: &str) -> Option<Dialect> {
        let looked_at: Vec<Line> = lines(text).take(LOOKED_AT).collect();
        let tried = [Decimal::Point, Decimal::Comma].into_iter().flat_map(|decimal| {
            Separator::ALL.into_iter().filter_map({
                let looked_at = &looked_at;
                move |separator| Shape::of(looked_at, separator, decimal)
            })
        });
        let best = tried.reduce(|best, other| if other.is_better(&best) { other } else { best });
        match best {
            Some(shape) => Some(Dialect::under(&looked_at, shape)),
            None => Dialect::empty(&looked_at),
        }
    }

    fn under(lines: &[Line], shape: Shape) -> Dialect {
        let Shape { separator, decimal, first, .. } = shape;
        let cut = |line: &Line| {
            let mut cells = Vec::new();
            separator.split(uncommented(line.text), &mut cells);
            cells.into_iter().map(String::from).collect::<Vec<String>>()
        };
        let sample = cut(&lines[first]);
        let above = |steps: usize| {
            let line = first.checked_sub(steps).map(|index| &lines[index])?;
            Some((line.number, cut(line))).filter(|(_, cells)| is_heading(cells, sample.len(), decimal))
        };
        let (units, header) = match (above(1), above(2)) {
            (Some(units), Some(header)) if are_units(&units.1) => (Some(units), Some(header)),
            (header, _) => (None, header),
        };
        let names = match &header {
            Some((_, names)) => joined(names, units.as_ref().map_or(&[], |(_, units)| units)),
            None => (1..=sample.len()).map(|position| position.to_string()).collect(),
        };
        Dialect {
            separator,
            decimal,
            header: header.map(|(number, _)| number),
            units: units.map(|(number, _)| number),
            first: lines[first].number,
            headers: without_blank_ends(names),
            sample,
        }
    }

    /// A header and nothing below.
    fn empty(lines: &[Line]) -> Option<Dialect> {
        let line = lines.first().filter(|_| lines.len() == 1)?;
        let count = |separator: &Separator| line.text.matches(mark_of(*separator)).count();
        let separator = Separator::ALL.into_iter().find(|separator| count(separator) > 0)?;
        let mut cells = Vec::new();
        separator.split(uncommented(line.text), &mut cells);
        let headers: Vec<String> = cells.into_iter().map(String::from).collect();
        if headers.iter().any(String::is_empty) {
            return None;
        }
        let first = line.number + 1;
        let (header, units) = (Some(line.number), None);
        Some(Dialect { separator, decimal: Decimal::Point, header, units, first, headers, sample: Vec::new() })
    }

    /// In words, where it is not the plain one: commas, decimal points, a header in line 1.
    pub(super) fn describe(&self) -> Vec<String> {
        let mut said = Vec::new();
        if self.separator != Separator::Mark(',') {
            said.push(format!("cells between {}", self.separator.name()));
        }
        if self.decimal == Decimal::Comma {
            said.push("decimal commas".into());
        }
        match self.header {
            None => said.push("no header".into()),
            Some(1) => {}
            Some(line) => said.push(format!("header in line {line}")),
        }
        said.extend(self.units.map(|line| format!("units in line {line}")));
        said
    }
}

fn mark_of(separator: Separator) -> char {
    match separator {
        Separator::Mark(mark) => mark,
        Separator::Blanks => ' ',
    }
}

fn uncommented(text: &str) -> &str {
    let text = text.trim();
    COMMENTS.iter().find_map(|mark| text.strip_prefix(mark)).map_or(text, |rest| rest.trim_start_matches('#').trim())
}

/// Names and their units: `Weg` over `mm` is `Weg [mm]`.
fn joined(names: &[String], units: &[String]) -> Vec<String> {
    let is_told = |unit: &&str| !unit.is_empty() && !is_clock_format(unit);
    let unit = |index: usize| units.get(index).map(|unit| bare_unit(unit)).filter(is_told);
    let name = |(index, name): (usize, &String)| match unit(index) {
        Some(unit) if !name.contains(['[', '(']) => format!("{name} [{unit}]"),
        _ => name.clone(),
    };
    names.iter().enumerate().map(name).collect()
}

/// Whether a cell in place of a unit says how clock times are written: `hh:mm:ss.000`.
fn is_clock_format(text: &str) -> bool {
    text.contains(':')
        && text.chars().all(|c| matches!(c.to_ascii_lowercase(), 'h' | 'm' | 's' | 'f' | ':' | '.' | ',' | '0'))
}

/// `[mm]` and `(mm)` are mm.
fn bare_unit(text: &str) -> &str {
    let inside = [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| text.trim().strip_prefix(open)?.strip_suffix(close));
    inside.unwrap_or(text).trim()
}

fn without_blank_ends(mut headers: Vec<String>) -> Vec<String> {
    while headers.last().is_some_and(|header| header.is_empty()) {
        headers.pop();
    }
    headers
}

/// Whether cells are names or units of that many columns and no numbers.
fn is_heading(cells: &[String], columns: usize, decimal: Decimal) -> bool {
    let told = cells.iter().filter(|cell| !cell.is_empty()).count();
    let near = cells.len() + 1 >= columns.min(3) && cells.len() > 1;
    near && told > 0 && !cells.iter().any(|cell| is_value(cell, decimal))
}

/// Whether cells are the units of columns: one at least is one, and so are half of those that are not empty, or stand
/// in brackets; the others may be formats of times (`hh:mm:ss`) and units of no motion (`°C`).
fn are_units(cells: &[String]) -> bool {
    let is_unit = |cell: &&String| Unit::parse(bare_unit(cell)).is_some();
    let is_bracket = |cell: &&String| bare_unit(cell) != cell.trim();
    let told = cells.iter().filter(|cell| !cell.is_empty()).count();
    let units = cells.iter().filter(|cell| is_unit(cell) || is_bracket(cell)).count();
    cells.iter().any(|cell| is_unit(&cell)) && 2 * units >= told
}

/// How well lines are a table under a separator and a decimal mark.
#[derive(Clone, Copy, Debug)]
struct Shape {
    separator: Separator,
    decimal: Decimal,
    columns: usize,
    /// Sum over the rows of the squared share of numbers among their cells.
    score: f64,
    /// Position of the first row.
    first: usize,
}

impl Shape {
    fn of(lines: &[Line], separator: Separator, decimal: Decimal) -> Option<Shape> {
        let mut cells = Vec::new();
        let rows: Vec<(usize, usize, f64)> = lines
            .iter()
            .enumerate()
            .filter(|(_, line)| !is_comment(line.text))
            .map(|(index, line)| {
                separator.split(line.text, &mut cells);
                (index, cells.len(), share(&cells, decimal))
            })
            .collect();
        let is_row = |(_, count, share): &&(usize, usize, f64)| *count >= 2 && *share * *count as f64 >= 1.5;
        let score = |columns: usize| {
            rows.iter().filter(is_row).filter(|row| row.1 == columns).map(|row| row.2 * row.2).sum::<f64>()
        };
        let columns = rows.iter().filter(is_row).map(|row| row.1).max_by(|a, b| score(*a).total_cmp(&score(*b)))?;
        let first = rows.iter().position(|row| is_row(&row) && row.1 == columns)?;
        let begun = rows[..first].iter().rev().take_while(|(index, count, _)| {
            separator.split(lines[*index].text, &mut cells);
            *count == columns && is_value(cells[0], decimal) && cells[1..].iter().all(|cell| cell.is_empty())
        });
        let first = rows[first - begun.count()].0;
        Some(Shape { separator, decimal, columns, score: score(columns), first })
    }

    fn is_better(&self, other: &Shape) -> bool {
        let ahead = self.score - other.score;
        ahead > 1e-6 || ahead > -1e-6 && self.columns > other.columns
    }
}

/// Share of the cells that are numbers or instants; an empty last one does not count.
fn share(cells: &[&str], decimal: Decimal) -> f64 {
    let cells = cells.strip_suffix(&[""]).unwrap_or(cells);
    cells.iter().filter(|cell| is_value(cell, decimal)).count() as f64 / cells.len().max(1) as f64
}

fn is_value(cell: &str, decimal: Decimal) -> bool {
    number(cell, decimal).is_some() || Instant::parse(cell).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> (Separator, Decimal, Option<u64>, u64, Vec<String>) {
        let found = Dialect::of(text).unwrap();
        (found.separator, found.decimal, found.header, found.first, found.headers)
    }

    #[test]
    fn the_numbers_tell_the_dialect() {
        use {Decimal::*, Separator::*};
        let cases = [
            ("t,q\n0.1,2\n0.2,3\n", Mark(','), Point, Some(1), 2),
            ("t;q\n0,1;2\n0,2;3\n", Mark(';'), Comma, Some(1), 2),
            ("t,q;r\n1;2\n", Mark(';'), Point, Some(1), 2),
            ("# t q\n0.1 2\n0.2 3\n", Blanks, Point, Some(1), 2),
            ("0,1\t2,5\n0,2\t3,5\n", Mark('\t'), Comma, None, 1),
            ("Rig 3, run 5\nby: M\n\nt|q\ns|mm\n1|2.5\n2|3\n", Mark('|'), Point, Some(4), 6),
            ("\"t\",\"q\"\n\"0,1\",\"2,5\"\n", Mark(','), Comma, Some(1), 2),
            ("t,q\n12:00:00.1,2\n12:00:00.2,3\n", Mark(','), Point, Some(1), 2),
            // the first rows may be times alone
            ("t,q,qd,F\n0,,,\n1,,,\n2,3,4,5\n", Mark(','), Point, Some(1), 2),
        ];
        for (text, separator, decimal, header, first) in cases {
            let found = of(text);
            assert_eq!((found.0, found.1, found.2, found.3), (separator, decimal, header, first), "{text}");
        }
    }

    #[test]
    fn a_line_of_units_joins_the_header() {
        assert_eq!(of("t;q;F\n[s];[mm];\n0;1;2\n1;2;3\n").4, ["t [s]", "q [mm]", "F"]);
        let excel = "Uhrzeit;Weg;Kraft;Temperatur\nhh:mm:ss;mm;kN;°C\n10:00:00,5;1,5;2;21,5\n";
        assert_eq!(of(excel).4, ["Uhrzeit", "Weg [mm]", "Kraft [kN]", "Temperatur [°C]"]);
        assert_eq!(of("Rig;run\nt;q\n0;1\n1;2\n").4, ["t", "q"]);
        assert_eq!(of("1;2\n3;4\n").4, ["1", "2"]);
    }
}
