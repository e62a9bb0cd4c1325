//! The house rules, read from the sources: no import runs upward, the heart does no I/O, `unsafe` has one home.

use std::path::{Path, PathBuf};

/// From the top down; a module imports only from rows below its own, and from itself.
const LAYERS: [&[&str]; 8] = [
    &["cli", "workbench", "report"],
    &["data", "fmu"],
    &["diagnose"],
    &["identify"],
    &["evidence"],
    &["weak", "simulate", "limits"],
    &["law"],
    &[],
];

/// Modules that may open files, print and look at the clock.
const OUTSIDE_THE_HEART: [&str; 4] = ["cli", "workbench", "report", "data"];

/// What no module of the heart says.
const FORBIDDEN_IN_THE_HEART: [&str; 15] = [
    "std::fs",
    "std::io",
    "std::net",
    "std::env",
    "std::process",
    "std::thread",
    "std::time",
    "thread_local!",
    "println!",
    "print!",
    "eprintln!",
    "eprint!",
    "dbg!",
    "static mut",
    "OnceLock",
];

/// What no crate of ours says outside tests.
const FORBIDDEN_ANYWHERE: [&str; 6] = [".unwrap()", ".expect(", "panic!(", "todo!(", "unimplemented!(", "#[allow"];

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|row| row.contains(&module))
}

/// The source without comments, doc lines, strings and its `#[cfg(test)]` module: only what the compiler builds.
fn code(source: &str) -> String {
    let built = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = built.lines().map(|line| without_strings(line).split("//").next().unwrap_or_default().to_string());
    lines.collect::<Vec<_>>().join("\n")
}

fn without_strings(line: &str) -> String {
    let line = line.replace("\\\"", "").replace("'\"'", "");
    line.split('"').step_by(2).collect::<Vec<_>>().join("\"\"")
}

/// The modules that a source names behind `crate::`, also in braces: `use crate::{law::Term, weak}`.
fn imports(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for rest in code.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            Some(group) => found.extend(heads(group)),
            None => found.extend(head(rest)),
        }
    }
    found
}

fn head(path: &str) -> Option<String> {
    let name: String = path.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    if name.is_empty() { None } else { Some(name) }
}

/// The first names of each path in a group whose opening brace is already passed.
fn heads(group: &str) -> Vec<String> {
    let (mut depth, mut found, mut start) = (1, Vec::new(), 0);
    for (at, character) in group.char_indices() {
        match character {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 || (depth == 1 && character == ',') {
            found.extend(head(&group[start..at]));
            start = at + 1;
        }
        if depth == 0 {
            break;
        }
    }
    found
}

/// Every broken rule of one source of the library, in words.
fn broken(module: &str, source: &str) -> Vec<String> {
    let code = code(source);
    let mut broken = Vec::new();
    match layer(module) {
        None => broken.push(format!("{module} stands in no layer")),
        Some(own) => {
            let imported = imports(&code).into_iter().filter(|name| name != module);
            let upward = imported.filter(|name| layer(name).is_some_and(|other| other <= own));
            broken.extend(upward.map(|name| format!("{module} imports {name}, which is not below it")));
        }
    }
    if !OUTSIDE_THE_HEART.contains(&module) {
        let said = FORBIDDEN_IN_THE_HEART.iter().filter(|text| code.contains(**text));
        broken.extend(said.map(|text| format!("{module} is of the heart and says {text}")));
    }
    broken.extend(broken_anywhere(&code));
    broken
}

fn broken_anywhere(code: &str) -> Vec<String> {
    FORBIDDEN_ANYWHERE.iter().filter(|text| code.contains(**text)).map(|text| format!("says {text}")).collect()
}

fn says_unsafe(source: &str) -> bool {
    let code = code(source);
    code.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut found = Vec::new();
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() && !path.ends_with("target") {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push((path.clone(), std::fs::read_to_string(&path).unwrap()));
        }
    }
    found
}

/// The module of `src/` to which a file belongs; none for the crate's own roots.
fn module_of(path: &Path) -> Option<String> {
    let inside = path.strip_prefix(root().join("src")).unwrap();
    let first = inside.components().next()?.as_os_str().to_str()?.trim_end_matches(".rs").to_string();
    if ["lib", "main"].contains(&first.as_str()) { None } else { Some(first) }
}

#[test]
fn no_source_breaks_a_rule() {
    let sources = sources(&root().join("src"));
    assert!(sources.len() > 10, "only {} sources found", sources.len());
    let mut complaints = Vec::new();
    for (path, source) in &sources {
        let broken = match module_of(path) {
            Some(module) => broken(&module, source),
            None => broken_anywhere(&code(source)),
        };
        complaints.extend(broken.into_iter().map(|rule| format!("{}: {rule}", path.display())));
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn only_the_crate_that_speaks_c_is_unsafe() {
    let folders = ["src", "fmu/identifier", "fmu/plant", "fmu/package", "harness/command", "xtask"];
    for (path, source) in folders.iter().flat_map(|folder| sources(&root().join(folder))) {
        assert!(!says_unsafe(&source), "{} says unsafe", path.display());
    }
}

#[test]
fn an_upward_import_is_seen() {
    for (module, source) in [
        ("law", "use crate::identify::Settings;"),
        ("law", "use crate::{weak, law::Term};"),
        ("weak", "use crate::{law::{Term, Hold}, simulate::Plant};"),
        ("simulate", "fn x() -> crate::identify::Sample {}"),
        ("identify", "use crate::{\n    law::Term,\n    data::{Section},\n};"),
        ("data", "use crate::cli;"),
        ("unheard_of", ""),
    ] {
        assert_eq!(broken(module, source).len(), 1, "{module}: {source}");
    }
}

#[test]
fn a_downward_import_is_allowed() {
    for (module, source) in [
        ("identify", "use crate::{law::{Term, Hold}, weak::Row, identify::Sample};"),
        ("cli", "use crate::data;\nuse std::fs;"),
        ("law", "// use crate::identify;\n/// println!(\"x\")\nconst X: &str = \"crate::cli .unwrap()\";"),
        ("weak", "fn x() {}\n#[cfg(test)]\nmod tests {\n    use crate::identify; fn y() { z().unwrap(); }\n}"),
    ] {
        assert_eq!(broken(module, source), Vec::<String>::new(), "{module}: {source}");
    }
}

#[test]
fn input_and_output_in_the_heart_are_seen() {
    for source in ["use std::fs;", "fn x() { println!(); }", "let t = std::time::Instant::now();", "x.unwrap();"] {
        assert_eq!(broken("weak", source).len(), 1, "{source}");
    }
    assert!(says_unsafe("fn x() { unsafe { y() } }"));
    assert!(!says_unsafe("// unsafe\n#![deny(unsafe_code)]\nlet text = \"unsafe\";"));
}
