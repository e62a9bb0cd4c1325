//! The house rules, read from the sources: no import runs upward, no files stand on a circle, the heart does no I/O,
//! `unsafe` has one home.

#[path = "layering/house.rs"]
mod house;
#[path = "layering/text.rs"]
mod text;

use house::{Arrow, House, circles, module_of, upward};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::slice::from_ref;
use text::{code, words};

/// From the top down; a module imports only from rows below its own, and from itself.
const LAYERS: [&[&str]; 10] = [
    &["cli", "workbench"],
    &["report"],
    &["data", "fmu"],
    &["diagnose"],
    &["identify"],
    &["evidence"],
    &["estimation"],
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

/// Every rule that the arrows of the library break, in words.
fn broken_arrows(arrows: &BTreeSet<Arrow>) -> Vec<String> {
    let between = arrows.iter().filter_map(broken_layer);
    let up = upward(arrows);
    let up = up.iter().map(|arrow| format!("{}, whose file stands above it", told(arrow)));
    let circles = circles(arrows).into_iter().map(|(folder, way)| circle(arrows, &folder, &way));
    between.chain(up).chain(circles).collect()
}

/// What is wrong with an arrow between two of the library's modules.
fn broken_layer(arrow: &Arrow) -> Option<String> {
    let (from, to) = (arrow.from.first()?, arrow.to.first()?);
    match (layer(from), layer(to)) {
        (None, _) => Some(format!("{from} stands in no layer")),
        (Some(own), Some(other)) if from != to && other <= own => {
            Some(format!("{}, and {to} is not below {from}", told(arrow)))
        }
        _ => None,
    }
}

fn told(arrow: &Arrow) -> String {
    let to = if arrow.to.is_empty() { "the crate's root".to_string() } else { arrow.to.join("::") };
    format!("{} takes {} from {to}", arrow.from.join("::"), arrow.name)
}

/// A circle with the arrows that tie it.
fn circle(arrows: &BTreeSet<Arrow>, folder: &[String], way: &[String]) -> String {
    let ties = way.iter().zip(way.iter().cycle().skip(1)).flat_map(|(a, b)| {
        let (a, b) = ([folder, from_ref(a)].concat(), [folder, from_ref(b)].concat());
        arrows.iter().filter(move |arrow| arrow.from.starts_with(&a) && arrow.to.starts_with(&b))
    });
    let ties: Vec<String> = ties.map(|arrow| format!("\n    {}", told(arrow))).collect();
    format!("circle in {}: {}{}", named(folder), way.join(" -> "), ties.concat())
}

fn named(folder: &[String]) -> String {
    if folder.is_empty() { "the source folder".to_string() } else { folder.join("/") }
}

/// Every broken rule of one source of the library that needs no other source, in words.
fn broken(module: &str, source: &str) -> Vec<String> {
    let code = code(source);
    let mut broken = Vec::new();
    if layer(module).is_none() {
        broken.push(format!("{module} stands in no layer"));
    }
    if !OUTSIDE_THE_HEART.contains(&module) {
        let said = FORBIDDEN_IN_THE_HEART.iter().filter(|text| code.contains(**text));
        broken.extend(said.map(|text| format!("{module} is of the heart and says {text}")));
    }
    broken.extend(broken_anywhere(&code));
    broken
}

fn broken_anywhere(code: &str) -> Vec<String> {
    let said = FORBIDDEN_ANYWHERE.iter().filter(|text| code.contains(**text)).map(|text| format!("says {text}"));
    let words = words(code);
    let inline = words.windows(3).filter(|words| words[0] == "mod" && words[2] == "{");
    said.chain(inline.map(|words| format!("has the module {} inside: give it a file", words[1]))).collect()
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

/// The files of a crate, by its folder of sources.
fn house(folder: &str) -> House {
    let folder = root().join(folder);
    let sources = sources(&folder);
    House::new(sources.iter().map(|(path, source)| (path.strip_prefix(&folder).unwrap(), source.as_str())))
}

#[test]
fn no_source_breaks_a_rule() {
    let folder = root().join("src");
    let sources = sources(&folder);
    assert!(sources.len() > 10, "only {} sources found", sources.len());
    let mut complaints = Vec::new();
    for (path, source) in &sources {
        let module = module_of(path.strip_prefix(&folder).unwrap()).and_then(|names| names.first().cloned());
        let broken = match module {
            Some(module) => broken(&module, source),
            None => broken_anywhere(&code(source)),
        };
        complaints.extend(broken.into_iter().map(|rule| format!("{}: {rule}", path.display())));
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn no_import_runs_upward_and_none_in_a_circle() {
    let arrows = house("src").arrows();
    assert!(arrows.len() > 100, "only {} arrows found", arrows.len());
    let broken = broken_arrows(&arrows);
    assert!(broken.is_empty(), "{} broken:\n{}", broken.len(), broken.join("\n"));
}

#[test]
fn names_are_taken_from_the_file_that_defines_them() {
    let detours = house("src").detours();
    let told: Vec<String> = detours.iter().map(told).collect();
    assert!(told.is_empty(), "these go through the file of their own folder:\n{}", told.join("\n"));
}

#[test]
fn a_name_that_is_handed_on_is_seen() {
    let files = [("law/mod.rs", "mod term;\npub use term::Term;"), ("law/term.rs", "pub struct Term;")];
    for (source, detours) in [
        ("use super::Term;", 1),
        ("fn x() -> crate::law::Term {}", 1),
        ("use super::term::Term;", 0),
        ("use super::term;\nfn x() -> term::Term {}", 0),
    ] {
        let files = files.into_iter().chain([("law/model.rs", source)]);
        let house = House::new(files.map(|(path, source)| (Path::new(path), source)));
        assert_eq!(house.detours().len(), detours, "{source}");
    }
}

/// Folders of sources of the workspace's other crates.
const OTHER_CRATES: [&str; 11] = [
    "fmu/check/src",
    "fmu/identifier/src",
    "fmu/package/src",
    "fmu/plant/src",
    "fmu/slave/src",
    "measure/dropbear",
    "measure/effects",
    "measure/figures",
    "measure/known_laws",
    "measure/study",
    "xtask/src",
];

#[test]
fn no_other_crate_has_a_circle_of_files() {
    for folder in OTHER_CRATES {
        assert!(root().join(folder).is_dir(), "{folder} is not there");
        let arrows = house(folder).arrows();
        let told: Vec<String> = circles(&arrows).iter().map(|(inside, way)| circle(&arrows, inside, way)).collect();
        assert!(told.is_empty(), "{folder}: {}", told.join("\n"));
    }
}

#[test]
fn no_example_panics() {
    let examples = sources(&root().join("examples"));
    assert!(examples.len() > 3, "only {} examples found", examples.len());
    for (path, source) in examples {
        assert_eq!(broken_anywhere(&code(&source)), Vec::<String>::new(), "{}", path.display());
    }
}

#[test]
fn only_the_crate_that_speaks_c_is_unsafe() {
    let folders =
        ["src", "examples", "fmu/identifier", "fmu/plant", "fmu/package", "harness/command", "measure", "xtask"];
    for (path, source) in folders.iter().flat_map(|folder| sources(&root().join(folder))) {
        assert!(!says_unsafe(&source), "{} says unsafe", path.display());
    }
}

/// The rules that a small house breaks.
fn broken_house(files: &[(&str, &str)]) -> Vec<String> {
    broken_arrows(&House::new(files.iter().map(|(path, source)| (Path::new(*path), *source))).arrows())
}

#[test]
fn an_upward_import_between_modules_is_seen() {
    for (file, source) in [
        ("law/term.rs", "use crate::identify::Settings;"),
        ("law/mod.rs", "use crate::{weak::Row, law::Term};"),
        ("weak/row.rs", "use crate::{law::{Term, Hold}, simulate::Plant};"),
        ("simulate/mod.rs", "fn x() -> crate::identify::Sample {}"),
        ("identify/mod.rs", "use crate::{\n    law::Term,\n    data::{Section},\n};"),
        ("weak/row.rs", "use super::super::identify::Sample;"),
        ("weak/row.rs", "use crate::identify;\nfn x() -> identify::Sample {}"),
        ("data/mod.rs", "use crate::cli::run;"),
        ("unheard_of.rs", "use crate::law::Term;"),
    ] {
        let others = ["law", "weak", "simulate", "identify", "data", "cli"].map(|name| format!("{name}/hold.rs"));
        let mut files: Vec<(&str, &str)> = others.iter().map(|path| (path.as_str(), "")).collect();
        let roots = ["law", "weak", "simulate", "identify", "data", "cli"].map(|name| format!("{name}/mod.rs"));
        files.extend(roots.iter().map(|path| (path.as_str(), "")));
        files.push((file, source));
        assert_eq!(broken_house(&files).len(), 1, "{file}: {source}");
    }
}

#[test]
fn a_downward_import_is_allowed() {
    for (file, source) in [
        ("identify/mod.rs", "use crate::{law::{Term, Hold}, weak::Row, identify::inner::Sample};"),
        ("cli/mod.rs", "use crate::data::open;\nuse std::fs;"),
        ("law/mod.rs", "// use crate::identify::x;\n/// println!(\"x\")\nconst X: &str = \"crate::cli::x .unwrap()\";"),
        (
            "weak/mod.rs",
            "fn x() {}\n#[cfg(test)]\nmod tests {\n    use crate::identify::x; fn y() { z().unwrap(); }\n}",
        ),
    ] {
        let others = ["law/term.rs", "law/hold.rs", "weak/row.rs", "identify/inner.rs", "data/mod.rs", "cli/x.rs"];
        let files: Vec<(&str, &str)> = others.iter().map(|path| (*path, "")).chain([(file, source)]).collect();
        assert_eq!(broken_house(&files), Vec::<String>::new(), "{file}: {source}");
    }
}

#[test]
fn a_circle_of_files_in_a_folder_is_seen() {
    for (files, folder) in [
        (vec![("law/a.rs", "use super::b::B;"), ("law/b.rs", "use super::a::A;")], "circle in law: a -> b"),
        (vec![("law/a.rs", "use super::B;"), ("law/b.rs", "fn b() -> super::a::A {}")], "circle in law: a -> b"),
        (
            vec![("law/a/x.rs", "use crate::law::b::B;"), ("law/a/y.rs", ""), ("law/b.rs", "use super::a::y::Y;")],
            "circle in law: a -> b",
        ),
        (
            vec![("law/a.rs", "use super::b;\nfn x() { b::y(); }"), ("law/b.rs", "use super::a::*;")],
            "circle in law: a -> b",
        ),
    ] {
        let mut house = vec![("law/mod.rs", "mod a;\nmod b;\npub use a::A;\npub use b::B;")];
        house.extend(files);
        let broken = broken_house(&house);
        assert!(broken.len() == 1 && broken[0].starts_with(folder), "{house:?}: {broken:?}");
    }
}

#[test]
fn an_arrow_up_to_the_file_of_a_folder_is_seen() {
    for (files, arrow) in [
        (vec![("law/mod.rs", "pub struct A;"), ("law/a.rs", "use super::A;")], "law::a takes A from law"),
        (vec![("law/a.rs", "struct A;"), ("law/a/b.rs", "impl super::A {}")], "law::a::b takes A from law::a"),
        (vec![("lib.rs", "struct A;"), ("law/a.rs", "use crate::A;")], "law::a takes A from the crate's root"),
        (vec![("law/mod.rs", "mod a;"), ("law/a.rs", "use super::*;")], "law::a takes * from law"),
    ] {
        let broken = broken_house(&files);
        assert!(broken.len() == 1 && broken[0].starts_with(arrow), "{files:?}: {broken:?}");
    }
}

#[test]
fn what_a_folder_hands_on_is_taken_from_where_it_stands() {
    let house = [
        ("law/mod.rs", "mod a;\nmod b;\nmod c;\npub use a::A;\npub(crate) use b::{self, B as Beta};"),
        ("law/a.rs", "pub struct A;"),
        ("law/b.rs", "use super::A;\nimpl A {}"),
        ("law/c.rs", "use super::{A, Beta};\nfn c() { Beta::new(A::new()); }"),
    ];
    let arrows = House::new(house.iter().map(|(path, source)| (Path::new(*path), *source))).arrows();
    let told: Vec<String> = arrows.iter().map(told).collect();
    assert_eq!(told, ["law::b takes A from law::a", "law::c takes A from law::a", "law::c takes B from law::b"]);
    assert_eq!(broken_arrows(&arrows), Vec::<String>::new());
}

#[test]
fn input_and_output_in_the_heart_are_seen() {
    for source in
        ["use std::fs;", "fn x() { println!(); }", "let t = std::time::Instant::now();", "x.unwrap();", "mod x {}"]
    {
        assert_eq!(broken("weak", source).len(), 1, "{source}");
    }
    assert!(says_unsafe("fn x() { unsafe { y() } }"));
    assert!(!says_unsafe("// unsafe\n#![deny(unsafe_code)]\nlet text = \"unsafe\";"));
}
