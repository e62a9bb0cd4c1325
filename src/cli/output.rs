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

/// Prints an error on stderr as one line of JSON; where even that fails there is nobody left to tell.
pub(super) fn complain_in_json(message: &str, exit_status: u8) {
    let document = serde_json::json!({ "error": message.trim_end(), "exit_status": exit_status });
    let _ = writeln!(std::io::stderr(), "{document}");
}

fn json(file: &str, document: &impl Serialize) -> Result<String, CommandError> {
    serde_json::to_string_pretty(document).map_err(|error| CommandError::write(file, error))
}

/// Prints a line on stderr, `switchid: error: …`; where even that fails there is nobody left to tell.
pub(super) fn complain(kind: &str, message: &str) {
    let _ = writeln!(std::io::stderr(), "switchid: {kind}: {}", message.trim_end());
}

/// The files of recordings, of which each may be a section.
pub(super) fn files_of(data: &[String]) -> Result<Vec<PathBuf>, CommandError> {
    let path = |text: &String| Ok(Section::parse(text)?.path);
    data.iter().map(path).collect()
}

/// The files that a command writes: none of them is read by it, none is another one, none is overwritten unasked.
pub(super) struct Targets {
    inputs: Vec<PathBuf>,
    claimed: Vec<(&'static str, PathBuf)>,
    force: bool,
}

impl Targets {
    /// Of a command that reads these files; `force` lets it overwrite others.
    pub(super) fn new(inputs: Vec<PathBuf>, force: bool) -> Targets {
        Targets { inputs, claimed: Vec::new(), force }
    }

    /// One more file that the command reads: no later target may be it.
    pub(super) fn protect(&mut self, input: &Path) {
        self.inputs.push(input.into());
    }

    /// The file of an option, refused before any work where it cannot be written. `-` is standard output.
    ///
    /// # Errors
    /// [`CommandError::Input`], [`CommandError::Twice`], [`CommandError::Exists`]; [`CommandError::Write`] where its
    /// folder is not there.
    pub(super) fn claim(&mut self, option: &'static str, path: &Path) -> Result<Target, CommandError> {
        let file = path.display().to_string();
        if let Some((other, _)) = self.claimed.iter().find(|(_, other)| is_same(other, path)) {
            return Err(CommandError::Twice { option, file, other });
        }
        self.claimed.push((option, path.into()));
        if path == Path::new("-") {
            return Ok(Target(None));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(CommandError::write(&file, format!("there is no folder {}: make it first", folder.display())));
        }
        if path.is_dir() {
            return Err(CommandError::write(&file, "it is a folder: name a file in it"));
        }
        if let Some(input) = self.inputs.iter().find(|input| path.exists() && is_same(input, path)) {
            return Err(CommandError::Input { option, file, input: input.display().to_string() });
        }
        match path.exists() && !self.force {
            true => Err(CommandError::Exists { option, file }),
            false => Ok(Target(Some(path.into()))),
        }
    }
}

/// Whether two paths are one file, there or not yet.
fn is_same(one: &Path, other: &Path) -> bool {
    let whole = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let name = path.file_name().map(|name| folder.canonicalize().unwrap_or_else(|_| folder.into()).join(name));
        path.canonicalize().ok().or(name)
    };
    one == other || whole(one).is_some_and(|one| whole(other) == Some(one))
}

/// Refuses a file on standard output where `--json` prints its document there.
///
/// # Errors
/// [`CommandError::TwoDocuments`].
pub(super) fn one_document(option: &'static str, target: &Target, json: bool) -> Result<(), CommandError> {
    if json && target.is_stdout() { Err(CommandError::TwoDocuments { option }) } else { Ok(()) }
}

/// Where something is written; nowhere but standard output where it has no path.
pub(super) struct Target(Option<PathBuf>);

impl Target {
    /// Writes text.
    ///
    /// # Errors
    /// [`CommandError::Write`].
    pub(super) fn write(&self, text: &str) -> Result<(), CommandError> {
        self.write_bytes(text.as_bytes())
    }

    /// Writes bytes.
    ///
    /// # Errors
    /// [`CommandError::Write`].
    pub(super) fn write_bytes(&self, bytes: &[u8]) -> Result<(), CommandError> {
        let mut sink = self.open()?;
        match sink.write_all(bytes).and_then(|()| sink.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CommandError::write(&self.name(), error)),
            _ => Ok(()),
        }
    }

    /// Writes one JSON document.
    ///
    /// # Errors
    /// [`CommandError::Write`].
    pub(super) fn write_json(&self, document: &impl Serialize) -> Result<(), CommandError> {
        self.write(&(json(&self.name(), document)? + "\n"))
    }

    /// Whether it is standard output.
    pub(super) fn is_stdout(&self) -> bool {
        self.0.is_none()
    }

    fn name(&self) -> String {
        self.0.as_ref().map_or_else(|| "standard output".into(), |path| path.display().to_string())
    }

    fn open(&self) -> Result<Box<dyn Write>, CommandError> {
        Ok(match &self.0 {
            None => Box::new(std::io::stdout()),
            Some(path) => Box::new(File::create(path).map_err(|error| CommandError::write(&self.name(), error))?),
        })
    }
}

/// A CSV file of numbers under a header.
pub(super) struct Table {
    writer: csv::Writer<BufWriter<Box<dyn Write>>>,
    file: String,
}

impl Table {
    /// Creates the file and writes its header.
    pub(super) fn create(target: &Target, header: &[impl AsRef<str>]) -> Result<Table, CommandError> {
        let (created, file) = (target.open()?, target.name());
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
        Pairs(pairs.map(|(term, value)| (term.name(), *value)).collect())
    }

    /// The std of those that were sought.
    pub(super) fn std(law: &Law) -> Pairs {
        let sought = law.terms.iter().zip(&law.std).filter(|(_, std)| **std > 0.0);
        Pairs(sought.map(|(term, std)| (term.name(), *std)).collect())
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
