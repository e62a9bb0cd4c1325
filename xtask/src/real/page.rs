//! `docs/real-records.md`: every real record with its pictures, our answer and the reference's, the errors before and
//! after.

use super::answer::{Diagnosis, list};
use super::binary::Binary;
use super::reference::Record;
use super::table::{fixed, several, short};
use crate::error::Error;
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Widest line of a document.
const WIDTH: usize = 120;

const HEAD: &str = "# Real records

Twelve records of machines that nobody simulated, taken from public repositories. Each begins with a model that lacks
something; what `switchid` says of it stands beside the answer of an independent weak-form regression and the effects
that an expert would sign. Errors are held-out ones, over windows of 0.1, 0.3 and 1 T₀. `cargo xtask real -- --page`
writes this page and its pictures; the records themselves are not part of the project.
";

/// The page as it grows.
pub struct Page {
    path: PathBuf,
    pictures: PathBuf,
    text: String,
}

impl Page {
    /// A page at that path; its pictures go into the folder of the same name beside it.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn begin(path: &Path) -> Result<Page, Error> {
        let beside = std::path::absolute(path).map_err(file("find", path))?.with_extension("");
        std::fs::create_dir_all(&beside).map_err(file("create", &beside))?;
        Ok(Page { path: path.to_path_buf(), pictures: beside, text: HEAD.into() })
    }

    /// Adds a record, whose file is `data`: its diagnosis, its staircase, and what the improved model leaves.
    ///
    /// # Errors
    /// [`Error::Start`], [`Error::File`].
    pub fn add(&mut self, binary: &Binary, record: &Record, data: &str) -> Result<(), Error> {
        // pictures tell the name that the program was given
        let data = binary.copy(Path::new(data))?;
        let data = data.as_str();
        binary.write("model.toml", &record.model())?;
        let picture = |what: &str| self.pictures.join(format!("{}-{what}.svg", record.name)).display().to_string();
        let (lacks, after) = (picture("lacks"), picture("after"));
        let ask = |arguments: &[&str]| Ok::<_, Error>(binary.ask(arguments)?.document.unwrap_or(Value::Null));
        let found = ask(&["diagnose", data, "--model", "model.toml", "--picture", &lacks, "--force"])?;
        let better = ask(&["improve", data, "--model", "model.toml", "-o", "better.toml", "--force"])?;
        ask(&["compare", data, "--model", "better.toml", "--picture", &after, "--force"])?;
        let folder = self.pictures.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let _ = write!(self.text, "\n## {}\n\n{}\n", record.name, answers(record, &Diagnosis::read(&found), &better));
        for (what, alternative) in
            [("lacks", "What the model leaves over"), ("after", "What the improved model leaves over")]
        {
            let _ = write!(self.text, "\n![{alternative}]({folder}/{}-{what}.svg)\n", record.name);
        }
        Ok(())
    }

    /// Writes the page.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn write(&self) -> Result<(), Error> {
        std::fs::write(&self.path, &self.text).map_err(file("write", &self.path))
    }
}

/// Our answers and the reference's, an item each.
fn answers(record: &Record, found: &Diagnosis, better: &Value) -> String {
    let named = match (&found.effect, found.tie.is_empty()) {
        (None, _) => format!("nothing is named ({})", found.verdict),
        (Some(effect), true) => effect.clone(),
        (Some(effect), false) => format!("{effect}, tied: {}", found.tie.join(", ")),
    };
    let errors = format!("{} → {}", several(&found.before), several(&found.after));
    let left = found.left.as_deref().unwrap_or("nothing");
    let step = |step: &Value| {
        let title = step["effect"].as_str().map_or("as it came".into(), |effect| format!("+ {effect}"));
        format!("{title} {}", fixed(step["error"].as_f64(), 3))
    };
    let steps: Vec<String> = list(&better["steps"]).iter().map(step).collect();
    let reference: Vec<String> =
        record.effects.iter().map(|(effect, error)| format!("{effect} {}", fixed(Some(*error), 3))).collect();
    let right = if record.right.is_empty() { "nothing for sure".into() } else { record.right.join(", ") };
    let own = record.errors.map(Some);
    let items = [
        format!("begins with {}", record.terms.keys().cloned().collect::<Vec<_>>().join(", ")),
        format!("T₀ {} s (the reference: {} s)", short(found.period), short(Some(record.period))),
        format!("**we name** {named}; errors {errors}; {left}"),
        format!(
            "**an expert signs** {right}; the reference's errors {} → {} at 0.3 T₀",
            several(&own),
            reference.join(", ")
        ),
        format!(
            "**step by step** at 0.3 T₀: {}; then {}",
            steps.join(", "),
            better["verdict"].as_str().unwrap_or("no answer")
        ),
    ];
    let timing = found.timing.iter().map(|timing| format!("sensors: {timing}"));
    items.into_iter().chain(timing).map(|item| wrapped(&item)).collect::<Vec<_>>().join("\n")
}

/// An item of a list in lines that fit.
fn wrapped(item: &str) -> String {
    let mut lines = vec![String::from("-")];
    for word in item.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => *line += &format!(" {word}"),
            _ => lines.push(format!("  {word}")),
        }
    }
    lines.join("\n")
}

fn file(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Error {
    let path = path.to_path_buf();
    move |source| Error::File { action, path, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_fit_a_line() {
        let long = wrapped(&"word ".repeat(60));
        assert!(long.lines().all(|line| line.chars().count() <= WIDTH) && long.lines().count() == 3, "{long}");
        assert!(long.starts_with("- word") && long.lines().skip(1).all(|line| line.starts_with("  word")));
    }

    #[test]
    fn a_record_is_told_with_both_answers() {
        let record = &super::super::reference::records().unwrap()[0];
        let found = Diagnosis {
            verdict: "missing".into(),
            effect: Some("coulomb_friction".into()),
            before: [Some(0.2); 3],
            after: [Some(0.04); 3],
            ..Diagnosis::default()
        };
        let better = serde_json::json!({"verdict": "unexplained", "steps": [{"effect": null, "error": 0.2}]});
        let text = answers(record, &found, &better).split_whitespace().collect::<Vec<_>>().join(" ");
        for words in
            ["**we name** coulomb_friction", "0.200/0.200/0.200 → 0.040", "coulomb_friction 0.036", "as it came 0.200"]
        {
            assert!(text.contains(words), "{words}: {text}");
        }
    }
}
