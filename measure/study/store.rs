//! Measured points, kept line by line, so that a study that was stopped goes on where it was.
//!
//! A file of points belongs to one state of the library's sources: points that other sources gave are never mixed in.

use super::Failure;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::hash::{DefaultHasher, Hasher};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Outcomes by figure and point.
pub struct Store {
    kept: HashMap<String, Value>,
    file: Mutex<File>,
}

impl Store {
    /// The store in this file, with what is in it; a last line that was cut off is passed over.
    ///
    /// # Errors
    /// What reading or writing the file says.
    pub fn open(path: &Path) -> Result<Store, Failure> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let mut file = OpenOptions::new().create(true).append(true).read(true).open(path)?;
        let text = std::fs::read_to_string(path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            writeln!(file)?;
        }
        let line = |line: &str| serde_json::from_str::<(String, Value)>(line).ok();
        Ok(Store { kept: text.lines().filter_map(line).collect(), file: Mutex::new(file) })
    }

    /// The outcome of a point, where it is known.
    pub fn get<T: DeserializeOwned>(&self, key: &str) -> Option<T> {
        serde_json::from_value(self.kept.get(key)?.clone()).ok()
    }

    /// Keeps an outcome for the next time.
    ///
    /// # Errors
    /// What writing says.
    pub fn put<T: Serialize>(&self, key: &str, outcome: &T) -> Result<(), Failure> {
        let line = serde_json::to_string(&(key, outcome))?;
        let mut file = self.file.lock().map_err(|_| "a thread ended while it wrote a point")?;
        Ok(writeln!(file, "{line}")?)
    }
}

/// The name under which a point of a figure is kept.
///
/// # Errors
/// A point that has no JSON.
pub fn key(figure: &str, point: &impl Serialize) -> Result<String, Failure> {
    Ok(format!("{figure} {}", serde_json::to_string(point)?))
}

/// A number that changes with every source of the folder.
///
/// # Errors
/// What reading says.
pub fn fingerprint(folder: &Path) -> Result<String, Failure> {
    let mut hasher = DefaultHasher::new();
    let mut files = files(folder)?;
    files.sort();
    for path in files {
        hasher.write(path.strip_prefix(folder)?.to_string_lossy().as_bytes());
        hasher.write(&std::fs::read(&path)?);
    }
    Ok(format!("{:016x}", hasher.finish()))
}

fn files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        match path.is_dir() {
            true => found.extend(files(&path)?),
            false => found.push(path),
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_found_again_also_behind_a_line_that_was_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/points.jsonl");
        let outcome = vec![Some(1.5e-300), None, Some(2.0)];
        let (one, two) = (key("delays", &("a", 1)).unwrap(), key("delays", &("a", 2)).unwrap());
        let store = Store::open(&path).unwrap();
        assert_eq!(store.get::<Vec<Option<f64>>>(&one), None);
        store.put(&one, &outcome).unwrap();
        std::fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(b"[\"cut o").unwrap();
        Store::open(&path).unwrap().put(&two, &outcome).unwrap();
        let store = Store::open(&path).unwrap();
        assert_eq!(store.get(&one), Some(outcome.clone()));
        assert_eq!(store.get(&two), Some(outcome));
        assert_eq!(store.get::<String>(&one), None);
    }

    #[test]
    fn another_source_has_another_fingerprint() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("a.rs", "fn a() {}");
        let before = fingerprint(folder.path()).unwrap();
        assert_eq!(before, fingerprint(folder.path()).unwrap());
        write("a.rs", "fn a() { }");
        let changed = fingerprint(folder.path()).unwrap();
        write("b.rs", "");
        let more = fingerprint(folder.path()).unwrap();
        assert!(before != changed && changed != more);
    }
}
