//! What `cargo xtask real` is asked for.

use crate::error::Error;
use std::path::PathBuf;

/// The chore's options.
#[derive(Debug, Default, PartialEq)]
pub struct Options {
    /// The command line to measure; none: built from the sources.
    pub switchid: Option<PathBuf>,
    /// Where to write all that was measured as JSON.
    pub json: Option<PathBuf>,
    /// Whether to write the page of records in place of measuring.
    pub page: bool,
    /// Parts to measure; empty: all.
    pub only: Vec<String>,
}

impl Options {
    /// Reads the arguments; `names` are the parts that `--only` knows.
    ///
    /// # Errors
    /// [`Error::Usage`] names the argument at fault.
    pub fn read(arguments: &[String], names: &[&str]) -> Result<Options, Error> {
        let mut options = Options::default();
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            let mut value = || rest.next().cloned().ok_or_else(|| usage(format!("{argument} needs a value")));
            match argument.as_str() {
                "--switchid" => options.switchid = Some(value()?.into()),
                "--json" => options.json = Some(value()?.into()),
                "--page" => options.page = true,
                "--only" => options.only.push(known(value()?, names)?),
                _ => return Err(usage(format!("real knows no \"{argument}\""))),
            }
        }
        Ok(options)
    }

    /// Whether a part is asked for.
    pub fn wants(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|only| only == name)
    }
}

fn known(name: String, names: &[&str]) -> Result<String, Error> {
    if names.contains(&name.as_str()) {
        return Ok(name);
    }
    Err(usage(format!("--only knows no \"{name}\": {}", names.join(", "))))
}

fn usage(text: String) -> Error {
    Error::Usage { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Options, String> {
        let arguments: Vec<String> = line.split_whitespace().map(String::from).collect();
        Options::read(&arguments, &["one", "two"]).map_err(|error| error.to_string())
    }

    #[test]
    fn only_narrows_what_is_measured() {
        let all = read("").unwrap();
        assert!(all.wants("one") && all.wants("two"));
        let one = read("--only one --json out.json --switchid bin/switchid").unwrap();
        assert!(one.wants("one") && !one.wants("two"));
        assert_eq!((one.json, one.switchid), (Some("out.json".into()), Some("bin/switchid".into())));
        assert!(read("--only one --only two").unwrap().wants("two"));
    }

    #[test]
    fn wrong_arguments_are_named() {
        assert!(read("--only three").unwrap_err().contains("no \"three\": one, two"));
        assert!(read("--json").unwrap_err().contains("--json needs a value"));
        assert!(read("--jsn x").unwrap_err().contains("\"--jsn\""));
    }
}
