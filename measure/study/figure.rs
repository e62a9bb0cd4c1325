//! What a figure of the study is: points to be measured, one at a time, and what all of them together say.

use super::Failure;
use serde::Serialize;
use serde::de::DeserializeOwned;
use switchid::report::Panel;

/// A figure of the study.
pub trait Figure {
    /// Its name on the command line.
    const NAME: &'static str;
    /// Whether its points are measured one after the other, with nothing beside them: it looks at the clock.
    const ALONE: bool = false;
    /// What is measured at a time.
    type Point: Serialize + Send + Sync;
    /// What comes of it.
    type Outcome: Serialize + DeserializeOwned + Send;

    /// Every point; `seeds` at each setting of the figures of e, and as many as go with that at the others.
    fn points(seeds: u64) -> Vec<Self::Point>;

    /// Measures a point.
    ///
    /// # Errors
    /// A plant that does not move, a sample that was not accepted.
    fn measure(point: &Self::Point) -> Result<Self::Outcome, Failure>;

    /// What all points say.
    ///
    /// # Errors
    /// What computing limits says.
    fn section(measured: &[(Self::Point, Self::Outcome)]) -> Result<Section, Failure>;
}

/// A part of the page.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Its heading.
    pub title: &'static str,
    /// Markdown.
    pub text: String,
    /// Its pictures, below the text.
    pub pictures: Vec<Picture>,
    /// What it says of the publication's claims.
    pub claims: Vec<Claim>,
}

/// A picture of the page.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Name of its file, without ending.
    pub name: String,
    /// What it shows, in words.
    pub caption: String,
    /// Its panels, one below the other.
    pub panels: Vec<Panel>,
}

/// A claim of the publication, and what became of it.
#[derive(Clone, Debug)]
pub struct Claim {
    /// The claim.
    pub claim: &'static str,
    /// Whether the published method bears it out.
    pub published: bool,
    /// Whether ours does.
    pub ours: bool,
    /// The figures that say so.
    pub evidence: String,
}

/// A table too wide for a page, in two: both begin with the same first `keys` columns, the second goes on at column
/// `at`.
pub fn split_table(keys: usize, at: usize, head: &[&str], rows: &[Vec<String>]) -> String {
    let part = |from: usize, to: usize| {
        let head: Vec<&str> = [&head[..keys], &head[from..to]].concat();
        table(&head, rows.iter().map(|row| [&row[..keys], &row[from..to]].concat()))
    };
    format!("{}\n{}", part(keys, at), part(at, head.len()))
}

/// A table in Markdown; every row has as many cells as the head.
pub fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|cell| cell.to_string()).collect();
    let rule = format!("|{}\n", "---|".repeat(head.len()));
    let body: String = rows.into_iter().map(|row| line(&row)).collect();
    format!("{}{rule}{body}", line(&head))
}
