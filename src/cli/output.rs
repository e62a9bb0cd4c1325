//! What goes to stdout, to stderr and into files.

use super::error::CommandError;
use crate::data::Section;
use crate::diagnose::Law;
use serde::{Serialize, Serializer};
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Prints text on stdout. A reader that has gone away is no error.
pub(super) fn print(text: &str) -> Result<(), CommandError> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CommandError::write("standard output", error)),
        _ => Ok(()),
    }
}

/// Prints one JSON document on stdout.
pub(super) fn print_json(document: &impl Serialize) -> Result<(), CommandError> {
    print(&(json("standard output", document)? + "\n"))
}

/// Writes one JSON document into a file.
pub(super) fn write_json(path: &Path, document: &impl Serialize) -> Result<(), CommandError> {
    let file = path.display().to_string();
    let text = json(&file, document)? + "\n";
    std::fs::write(path, text).map_err(|error| CommandError::write(&file, error))
}

fn json(file: &str, document: &impl Serialize) -> Result<String, CommandError> {
    serde_json::to_string_pretty(document).map_err(|error| CommandError::write(file, error))
}

/// Prints a line on stderr, `switchid: error: …`; where even that fails there is nobody left to tell.
pub(super) fn complain(kind: &str, message: &str) {
    let _ = writeln!(std::io::stderr(), "switchid: {kind}: {}", message.trim_end());
}

/// Refuses a file that cannot be written, or that the command reads, before any work.
///
/// # Errors
/// [`CommandError::Input`]; [`CommandError::Write`] where its folder is not there.
pub(super) fn check_target(option: &'static str, path: &Path, inputs: &[PathBuf]) -> Result<(), CommandError> {
    let file = path.display().to_string();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(CommandError::write(&file, format!("there is no folder {}: make it first", folder.display())));
    }
    if path.is_dir() {
        return Err(CommandError::write(&file, "it is a folder: name a file in it"));
    }
    let Ok(own) = path.canonicalize() else { return Ok(()) };
    let input = inputs.iter().find(|input| input.canonicalize().is_ok_and(|input| input == own));
    let refused = |input: &PathBuf| CommandError::Input { option, file, input: input.display().to_string() };
    input.map(refused).map_or(Ok(()), Err)
}

/// The files of recordings, of which each may be a section.
pub(super) fn files_of(data: &[String]) -> Result<Vec<PathBuf>, CommandError> {
    let path = |text: &String| Ok(Section::parse(text)?.path);
    data.iter().map(path).collect()
}

/// A text file that overwrites nothing unasked.
pub(super) struct Written<'a> {
    path: &'a Path,
}

impl Written<'_> {
    /// A file to be written later; refused at once where it exists and `force` is not given.
    ///
    /// # Errors
    /// [`CommandError::Exists`].
    pub(super) fn check(path: &Path, force: bool) -> Result<Written<'_>, CommandError> {
        match path.exists() && !force {
            true => Err(CommandError::Exists { file: path.display().to_string() }),
            false => Ok(Written { path }),
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`CommandError::Write`].
    pub(super) fn write(&self, text: &str) -> Result<(), CommandError> {
        std::fs::write(self.path, text).map_err(|error| CommandError::write(&self.path.display().to_string(), error))
    }
}

/// A CSV file of numbers under a header.
pub(super) struct Table {
    writer: csv::Writer<BufWriter<File>>,
    file: String,
}

impl Table {
    /// Creates the file and writes its header.
    pub(super) fn create(path: &Path, header: &[impl AsRef<str>]) -> Result<Table, CommandError> {
        let file = path.display().to_string();
        let created = File::create(path).map_err(|error| CommandError::write(&file, error))?;
        let mut table = Table { writer: csv::Writer::from_writer(BufWriter::new(created)), file };
        let names = header.iter().map(|name| name.as_ref().as_bytes());
        table.writer.write_record(names).map_err(|error| CommandError::write(&table.file, error))?;
        Ok(table)
    }

    /// Writes one line; every number reads back as the same bits.
    pub(super) fn push(&mut self, numbers: &[f64]) -> Result<(), CommandError> {
        let cells = numbers.iter().map(|number| cell(*number));
        self.writer.write_record(cells).map_err(|error| CommandError::write(&self.file, error))
    }

    /// Writes what is still in memory.
    pub(super) fn finish(mut self) -> Result<(), CommandError> {
        self.writer.flush().map_err(|error| CommandError::write(&self.file, error))
    }
}

/// The shortest text that reads back as the same bits: `0`, `0.001`, `1e30`.
fn cell(number: f64) -> String {
    if number.fract() == 0.0 && number.abs() < 1e15 { number.to_string() } else { format!("{number:?}") }
}

/// Pairs that become an object of JSON, in their order.
pub(super) struct Pairs(pub(super) Vec<(String, f64)>);

impl Pairs {
    /// No pairs.
    pub(super) fn none() -> Pairs {
        Pairs(Vec::new())
    }

    /// The coefficients of a law, by term.
    pub(super) fn coefficients(law: &Law) -> Pairs {
        let pairs = law.terms.iter().zip(&law.coefficients);
        Pairs(pairs.map(|(term, value)| (law.term_name(*term), *value)).collect())
    }

    /// The std of those that were sought.
    pub(super) fn std(law: &Law) -> Pairs {
        let sought = law.terms.iter().zip(&law.std).filter(|(_, std)| **std > 0.0);
        Pairs(sought.map(|(term, std)| (law.term_name(*term), *std)).collect())
    }
}

impl Serialize for Pairs {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

#[cfg(test)]
mod tests {
    use super::cell;

    #[test]
    fn cells_are_short_and_exact() {
        let numbers = [0.0, 1.0, -3.0, 0.1 + 0.2, 1e30, 1.5e-9, f64::MAX];
        assert_eq!(numbers.map(cell)[..5], ["0", "1", "-3", "0.30000000000000004", "1e30"]);
        assert!(numbers.iter().all(|number| cell(*number).parse() == Ok(*number)));
    }
}
