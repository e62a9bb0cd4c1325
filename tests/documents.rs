//! House rules of the documents and of the comments in sources: no line is too long to be read in a terminal; every
//! link of a document leads somewhere.

use std::path::{Path, PathBuf};

/// Characters in a line.
const LONGEST: usize = 120;

/// Documents lie at the root and under here.
const FOLDER: &str = "docs";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Folders of sources.
const SOURCES: [&str; 7] = ["src", "tests", "examples", "fmu", "harness", "measure", "xtask"];

/// The files of a folder with that extension, and with `deep` of the folders in it.
fn files(folder: &Path, extension: &str, deep: bool) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() && deep {
            found.extend(files(&path, extension, deep));
        } else if path.extension().is_some_and(|own| own == extension) {
            found.push(path);
        }
    }
    found
}

fn all_documents() -> Vec<(PathBuf, String)> {
    let paths = [files(root(), "md", false), files(&root().join(FOLDER), "md", true)].concat();
    read(paths)
}

fn read(paths: Vec<PathBuf>) -> Vec<(PathBuf, String)> {
    paths.into_iter().map(|path| (path.clone(), std::fs::read_to_string(&path).unwrap())).collect()
}

/// Numbers of the lines that are too long.
fn long_lines(text: &str) -> Vec<usize> {
    let lines = text.lines().enumerate();
    lines.filter(|(_, line)| line.chars().count() > LONGEST).map(|(number, _)| number + 1).collect()
}

/// The comments of a source, other lines empty; rows of tables, which cannot be broken, left out.
fn comments(source: &str) -> String {
    let comment = |line: &&str| {
        let text = line.trim_start();
        text.starts_with("//") && !text.trim_start_matches(['/', '!']).trim_start().starts_with('|')
    };
    source.lines().map(|line| Some(line).filter(comment).unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The text without its fenced blocks: what they hold is no Markdown.
fn prose(text: &str) -> String {
    let mut fenced = false;
    let mut kept = Vec::new();
    for line in text.lines() {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        if !fenced && !fence {
            kept.push(line);
        }
    }
    kept.join("\n")
}

/// What the links lead to, those out of the project left out.
fn targets(prose: &str) -> Vec<&str> {
    let inline = prose.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let references =
        prose.lines().filter_map(|line| line.strip_prefix('[')?.split_once("]: ").map(|(_, to)| to.trim()));
    inline.chain(references).filter(|to| !to.contains("://")).collect()
}

/// The name by which a heading is linked to: lower case, spaces as hyphens, other marks left out.
fn anchor(heading: &str) -> String {
    let kept =
        heading.trim().to_lowercase().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>();
    kept.replace(' ', "-")
}

fn has_anchor(text: &str, wanted: &str) -> bool {
    let prose = prose(text);
    prose.lines().filter(|line| line.starts_with('#')).any(|line| anchor(line.trim_start_matches('#')) == wanted)
}

/// The links of a document that lead nowhere.
fn broken_links(path: &Path, text: &str) -> Vec<String> {
    let leads = |to: &str| {
        let (file, part) = to.split_once('#').unwrap_or((to, ""));
        let file = if file.is_empty() { path.to_path_buf() } else { path.parent().unwrap().join(file) };
        file.exists() && (part.is_empty() || has_anchor(&std::fs::read_to_string(&file).unwrap(), part))
    };
    targets(&prose(text)).into_iter().filter(|to| !leads(to)).map(String::from).collect()
}

#[test]
fn no_line_is_longer_than_a_terminal() {
    let documents = all_documents();
    assert!(documents.len() > 10, "only {} documents found", documents.len());
    let sources = read(SOURCES.iter().flat_map(|folder| files(&root().join(folder), "rs", true)).collect());
    assert!(sources.len() > 100, "only {} sources found", sources.len());
    let comments = sources.into_iter().map(|(path, source)| (path, comments(&source)));
    let texts: Vec<(PathBuf, String)> = documents.into_iter().chain(comments).collect();
    let long = texts.iter().flat_map(|(path, text)| {
        long_lines(text).into_iter().map(move |line| format!("{}:{line} is longer than {LONGEST}", path.display()))
    });
    let long: Vec<String> = long.collect();
    assert!(long.is_empty(), "{}", long.join("\n"));
}

#[test]
fn every_link_leads_somewhere() {
    let broken = all_documents().into_iter().flat_map(|(path, text)| {
        let links = broken_links(&path, &text);
        links.into_iter().map(move |to| format!("{}: {to} is not there", path.display()))
    });
    let broken: Vec<String> = broken.collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn a_long_line_is_seen_and_characters_are_counted() {
    let text = format!("{}\n{}\nshort\n{}\n", "q̇".repeat(60), "θ".repeat(120), "x".repeat(121));
    assert_eq!(long_lines(&text), [3 + 1]);
    let long = "x".repeat(121);
    let source = format!("let x = \"{long}\";\n    /// {long}\n//! | {long} |\n// short");
    assert_eq!(long_lines(&comments(&source)), [2]);
}

#[test]
fn a_link_that_leads_nowhere_is_seen() {
    let text =
        "# A b, c's\n[here](#a-b-cs) [x](documents.rs) [y](https://a.b/c)\n```\n[z](nowhere)\n```\n[r]: gone.md\n";
    let path = root().join("tests/documents.md");
    assert_eq!(broken_links(&path, text), ["#a-b-cs", "gone.md"], "a document that is not there has no headings");
    assert!(has_anchor(text, "a-b-cs") && !has_anchor(text, "a-b"));
}
