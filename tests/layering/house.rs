//! Which file of a crate takes something from which, through re-exports, and whether a folder stands on a circle.

use crate::text::{self, Import};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module by its names from the crate's root down: `law::catalogue` is `[law, catalogue]`, the root is empty.
pub type Module = Vec<String>;

#[derive(Default)]
struct Source {
    imports: Vec<Import>,
    body: Vec<String>,
}

/// One file takes a name from another one.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Arrow {
    pub from: Module,
    pub to: Module,
    pub name: String,
}

/// The files of a crate by their modules.
pub struct House {
    sources: BTreeMap<Module, Source>,
}

/// Where a path ends: at a module, at a name that the file of a module defines, or in another crate.
enum End {
    Module,
    Name(Module, String),
    Outside,
}

/// The module of a file below the crate's source folder; none for the binary's root, which is a crate of its own.
pub fn module_of(inside: &Path) -> Option<Module> {
    let stem = inside.with_extension("");
    let mut names: Module = stem.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    match names.last().map(String::as_str) {
        Some("mod" | "lib") => drop(names.pop()),
        Some("main") if names.len() == 1 => return None,
        _ => {}
    }
    Some(names)
}

impl House {
    /// A house of sources by their paths below the source folder.
    pub fn new<'a>(files: impl IntoIterator<Item = (&'a Path, &'a str)>) -> Self {
        let sources = files.into_iter().filter_map(|(path, source)| {
            let (imports, body) = text::imports(&text::code(source));
            Some((module_of(path)?, Source { imports, body }))
        });
        let mut sources: BTreeMap<Module, Source> = sources.collect();
        let modules: Vec<Module> = sources.keys().cloned().collect();
        for (module, length) in modules.iter().flat_map(|module| (0..module.len()).map(move |length| (module, length)))
        {
            sources.entry(module[..length].to_vec()).or_default();
        }
        Self { sources }
    }

    /// Every arrow between two files. What a file only hands on is no arrow of its own.
    pub fn arrows(&self) -> BTreeSet<Arrow> {
        let mut arrows = BTreeSet::new();
        for (from, source) in &self.sources {
            let imported =
                source.imports.iter().filter(|import| !import.is_public || source.body.contains(&import.name));
            let paths = imported.map(|import| import.path.clone()).chain(text::paths(&source.body));
            for path in paths {
                if let Some(End::Name(to, name)) = self.end(from, &path, 0)
                    && to != *from
                {
                    arrows.insert(Arrow { from: from.clone(), to, name });
                }
            }
            arrows.extend(self.globs(from, source));
        }
        arrows
    }

    /// Names that a file takes from the file of a folder around it, which only hands them on: read by its imports, the
    /// file would stand above the one that defines the name and below the one that hands it on.
    pub fn detours(&self) -> BTreeSet<Arrow> {
        let of = |(from, source): (&Module, &Source)| {
            let paths: Vec<_> = source.imports.iter().map(|import| import.path.clone()).collect();
            let detour = |path: Vec<String>| {
                let (name, folder) = path.split_last()?;
                let to = self.module(from, folder).filter(|to| from != to && from.starts_with(to))?;
                let is_module = self.sources.contains_key(&child(&to, name));
                let handed_on = !is_module && self.sources[&to].imports.iter().any(|import| import.name == *name);
                handed_on.then(|| Arrow { from: from.clone(), to, name: name.clone() })
            };
            paths.into_iter().chain(text::paths(&source.body)).filter_map(detour).collect::<Vec<_>>()
        };
        self.sources.iter().flat_map(of).collect()
    }

    /// A glob that is not handed on may take anything of the module's own file.
    fn globs(&self, from: &Module, source: &Source) -> Vec<Arrow> {
        let globs = source.imports.iter().filter(|import| import.name == "*" && !import.is_public);
        let modules = globs.filter_map(|import| self.module(from, &import.path));
        modules.map(|to| Arrow { from: from.clone(), to, name: "*".to_string() }).collect()
    }

    /// Where a path leads that stands in a module; none outside the crate. `depth` ends circles of re-exports.
    fn end(&self, at: &Module, path: &[String], depth: usize) -> Option<End> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => self.walk(Module::new(), rest, depth),
            "self" => self.walk(at.clone(), rest, depth),
            "super" => {
                let parent = at.split_last()?.1.to_vec();
                if rest.first().is_some_and(|next| next == "super") {
                    self.end(&parent, rest, depth)
                } else {
                    self.walk(parent, rest, depth)
                }
            }
            name if self.sources.contains_key(&child(at, name)) => self.walk(child(at, name), rest, depth),
            name => self.imported(at, name, rest, depth),
        }
    }

    fn walk(&self, at: Module, rest: &[String], depth: usize) -> Option<End> {
        let Some((name, behind)) = rest.split_first() else { return Some(End::Module) };
        let below = child(&at, name);
        let is_module = self.sources.contains_key(&below);
        if is_module && !behind.is_empty() {
            return self.walk(below, behind, depth);
        }
        match self.imported(&at, name, behind, depth) {
            Some(end) => Some(end),
            None if is_module => Some(End::Module),
            None => Some(End::Name(at, name.clone())),
        }
    }

    /// Where a name leads that the module imports, also by a glob.
    fn imported(&self, at: &Module, name: &str, behind: &[String], depth: usize) -> Option<End> {
        let source = self.sources.get(at).filter(|_| depth < 16)?;
        let with = |import: &Import| [&import.path, behind].concat();
        let named = source.imports.iter().find(|import| import.name == name && import.path != [name]);
        named.map(|import| self.end(at, &with(import), depth + 1).unwrap_or(End::Outside))
    }

    fn module(&self, at: &Module, path: &[String]) -> Option<Module> {
        let mut place = at.clone();
        for (index, name) in path.iter().enumerate() {
            match name.as_str() {
                "crate" => place.clear(),
                "self" => {}
                "super" => drop(place.pop()),
                name if index > 0 || self.sources.contains_key(&child(&place, name)) => place.push(name.to_string()),
                _ => return None,
            }
        }
        self.sources.contains_key(&place).then_some(place)
    }
}

fn child(module: &[String], name: &str) -> Module {
    let mut below = module.to_vec();
    below.push(name.to_string());
    below
}

/// The arrows that run from a file to the file of a module around it. That file composes what stands below it, so that
/// what it defines stands above.
pub fn upward(arrows: &BTreeSet<Arrow>) -> Vec<&Arrow> {
    arrows.iter().filter(|arrow| arrow.from.starts_with(&arrow.to)).collect()
}

/// The circles among the children of each folder, a child being a file or a folder with all that is in it: the folder
/// and the children's names on the way round.
///
/// A circle of files anywhere is one of these, or takes an [`upward`] arrow: among the children of the innermost folder
/// that holds all its files, or over that folder's own file.
pub fn circles(arrows: &BTreeSet<Arrow>) -> Vec<(Module, Vec<String>)> {
    let mut folders: BTreeMap<Module, BTreeMap<&str, BTreeSet<&str>>> = BTreeMap::new();
    for Arrow { from, to, .. } in arrows {
        let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        if let (Some(below), Some(other)) = (from.get(common), to.get(common)) {
            folders.entry(from[..common].to_vec()).or_default().entry(below).or_default().insert(other);
        }
    }
    folders
        .into_iter()
        .flat_map(|(folder, below)| round(&below).into_iter().map(move |way| (folder.clone(), way)))
        .collect()
}

/// The shortest way from each node back to itself, each circle once.
fn round(below: &BTreeMap<&str, BTreeSet<&str>>) -> Vec<Vec<String>> {
    let mut seen = BTreeSet::new();
    let mut ways = Vec::new();
    for start in below.keys() {
        if let Some(way) = way_back(below, start) {
            let members: BTreeSet<String> = way.iter().cloned().collect();
            if seen.insert(members) {
                ways.push(way);
            }
        }
    }
    ways
}

fn way_back(below: &BTreeMap<&str, BTreeSet<&str>>, start: &str) -> Option<Vec<String>> {
    let mut ways = vec![vec![start.to_string()]];
    let mut reached = BTreeSet::new();
    while !ways.is_empty() {
        let mut longer = Vec::new();
        for way in &ways {
            for next in way.last().and_then(|last| below.get(last.as_str())).into_iter().flatten() {
                if *next == start {
                    return Some(way.clone());
                }
                if reached.insert(*next) {
                    longer.push(child(way, next));
                }
            }
        }
        ways = longer;
    }
    None
}
