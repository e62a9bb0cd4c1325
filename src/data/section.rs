//! `DATA@t0:t1`: a file, or a section of it.

use super::error::DataError;
use std::path::PathBuf;

/// What of which file is to be read: t0 ≤ t < t1, s.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The file.
    pub path: PathBuf,
    /// t0, s; −∞ where none is given.
    pub start: f64,
    /// t1, s; ∞ where none is given.
    pub end: f64,
}

impl Section {
    /// Reads `DATA`, `DATA@t0:t1`, `DATA@t0:` or `DATA@:t1`. An `@` without a colon behind it, or in the name of a file
    /// that is there, belongs to the name.
    ///
    /// # Errors
    /// [`DataError::Section`] where a time is no number or t1 does not come after t0.
    pub fn parse(text: &str) -> Result<Section, DataError> {
        let whole = Section { path: text.into(), start: f64::NEG_INFINITY, end: f64::INFINITY };
        if whole.path.exists() {
            return Ok(whole);
        }
        let Some((path, section)) = text.rsplit_once('@').filter(|(_, section)| section.contains(':')) else {
            return Ok(whole);
        };
        let refused = || DataError::Section { data: text.into(), section: section.into() };
        let (start, end) = section.split_once(':').ok_or_else(refused)?;
        let time = |text: &str, open: f64| match text.trim() {
            "" => Some(open),
            number => number.parse::<f64>().ok().filter(|number| number.is_finite()),
        };
        let start = time(start, whole.start).ok_or_else(refused)?;
        let end = time(end, whole.end).ok_or_else(refused)?;
        if start < end { Ok(Section { path: path.into(), start, end }) } else { Err(refused()) }
    }

    /// Whether t belongs to it.
    pub fn contains(&self, t: f64) -> bool {
        self.start <= t && t < self.end
    }

    /// Whether it is the whole file.
    pub fn is_whole(&self) -> bool {
        self.start == f64::NEG_INFINITY && self.end == f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_read() {
        let read = |text: &str| Section::parse(text).map(|section| (section.path, section.start, section.end));
        assert_eq!(read("a.csv@1.5:20").unwrap(), ("a.csv".into(), 1.5, 20.0));
        assert_eq!(read("a.csv@:20").unwrap(), ("a.csv".into(), f64::NEG_INFINITY, 20.0));
        assert_eq!(read("a@b.csv@2:").unwrap(), ("a@b.csv".into(), 2.0, f64::INFINITY));
        assert_eq!(read("a@b.csv").unwrap(), ("a@b.csv".into(), f64::NEG_INFINITY, f64::INFINITY));
        for wrong in ["a.csv@1:x", "a.csv@5:2", "a.csv@nan:2", "a.csv@1:1"] {
            assert!(read(wrong).unwrap_err().to_string().contains(wrong), "{wrong}");
        }
    }
}
