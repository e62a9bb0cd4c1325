//! The cells of a line of text.

/// What stands between two cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    Mark(char),
    /// Any number of blanks and tabs.
    Blanks,
}

impl Separator {
    /// Those that are tried, the commoner ones first.
    pub(super) const ALL: [Separator; 5] =
        [Separator::Mark(','), Separator::Mark(';'), Separator::Mark('\t'), Separator::Mark('|'), Separator::Blanks];

    /// Its name in a message.
    pub(super) fn name(self) -> String {
        match self {
            Separator::Mark('\t') => "tabs".into(),
            Separator::Mark(mark) => format!("\"{mark}\""),
            Separator::Blanks => "blanks".into(),
        }
    }

    /// Puts the cells of a line into `cells`, without blanks around them and without their quotes.
    pub(super) fn split<'a>(self, line: &'a str, cells: &mut Vec<&'a str>) {
        cells.clear();
        match self {
            Separator::Mark(mark) if line.contains('"') => quoted(line, mark, cells),
            Separator::Mark(mark) => cells.extend(line.split(mark).map(str::trim)),
            Separator::Blanks => blanks(line, cells),
        }
    }
}

/// Cells of which some stand in quotes, where the mark is an ordinary character.
fn quoted<'a>(line: &'a str, mark: char, cells: &mut Vec<&'a str>) {
    let (mut start, mut inside) = (0, false);
    for (at, c) in line.char_indices() {
        match c {
            '"' => inside = !inside,
            _ if c == mark && !inside => {
                cells.push(bare(&line[start..at]));
                start = at + c.len_utf8();
            }
            _ => {}
        }
    }
    cells.push(bare(&line[start..]));
}

fn bare(cell: &str) -> &str {
    let cell = cell.trim();
    cell.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).map_or(cell, str::trim)
}

/// Words; what stands in brackets or quotes belongs to the word before: `Weg [mm / s]` is one cell.
fn blanks<'a>(line: &'a str, cells: &mut Vec<&'a str>) {
    let mut rest = line.trim();
    while !rest.is_empty() {
        let mut end = word(rest);
        let behind = rest[end..].trim_start();
        if behind.starts_with(['[', '(']) {
            let from = rest.len() - behind.len();
            end = behind.find([']', ')']).map_or(end, |close| from + close + 1);
        }
        cells.push(bare(&rest[..end]));
        rest = rest[end..].trim_start();
    }
}

/// Where the first word ends.
fn word(text: &str) -> usize {
    if let Some(end) = text.strip_prefix('"').and_then(|rest| rest.find('"')) {
        return end + 2;
    }
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    match text[..end].find(['[', '(']) {
        Some(open) if !text[open..end].contains([']', ')']) => {
            text[open..].find([']', ')']).map_or(end, |close| open + close + 1)
        }
        _ => end,
    }
}

#[cfg(test)]
mod tests {
    use super::Separator;

    fn cells(line: &str, separator: Separator) -> Vec<&str> {
        let mut cells = Vec::new();
        separator.split(line, &mut cells);
        cells
    }

    #[test]
    fn lines_are_cut_into_cells() {
        assert_eq!(cells("1, 2 ,3", Separator::Mark(',')), ["1", "2", "3"]);
        assert_eq!(cells("\"0,5\",\"q, mm\",3", Separator::Mark(',')), ["0,5", "q, mm", "3"]);
        assert_eq!(cells("  1  2\t3 ", Separator::Blanks), ["1", "2", "3"]);
        assert_eq!(cells("t Weg [mm / s] F (k N) \"a b\"", Separator::Blanks), ["t", "Weg [mm / s]", "F (k N)", "a b"]);
        assert_eq!(cells("1;;2;", Separator::Mark(';')), ["1", "", "2", ""]);
    }
}
