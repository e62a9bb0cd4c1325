//! What the crates in an FMU's binaries are licensed under: name, version, licence, and every licence text once.

use crate::command::{cargo, root};
use crate::error::Error;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// The crates whose dynamic libraries an FMU ships.
const SHIPPED: [&str; 2] = ["switchid-fmu-identifier", "switchid-fmu-plant"];

/// Where the list stands, for the packager to include.
pub fn file() -> PathBuf {
    root().join("fmu/package/assets/third-party-licenses.txt")
}

/// Fails where the list is not that of the crates in use.
///
/// # Errors
/// [`Error::Document`], and what cargo says.
pub fn check() -> Result<(), Error> {
    let path = file();
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    match found == text()? {
        true => Ok(()),
        false => Err(Error::Document { path, text: "is stale: run cargo xtask fmu" }),
    }
}

/// The list as it has to be.
///
/// # Errors
/// What cargo says, and a licence text that cannot be read.
pub fn text() -> Result<String, Error> {
    let metadata = metadata()?;
    let packages = by_id(&metadata);
    let mut crates = String::from("Crates in the binaries of this FMU, and what they are licensed under.\n\n");
    let mut texts: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for id in shipped(&metadata, &packages) {
        let Some(package) = packages.get(id.as_str()) else { continue };
        let field = |name: &str| package[name].as_str().unwrap_or("unknown");
        let named = format!("{} {}", field("name"), field("version"));
        crates += &format!("{named}: {} ({})\n", field("license"), field("repository"));
        let folder = Path::new(field("manifest_path")).parent().unwrap_or(Path::new("")).to_path_buf();
        for licence in licence_files(&folder)? {
            texts.entry(licence).or_default().insert(named.clone());
        }
    }
    let mut texts: Vec<(BTreeSet<String>, String)> = texts.into_iter().map(|(text, of)| (of, text)).collect();
    texts.sort();
    for (of, text) in texts {
        let of: Vec<String> = of.into_iter().collect();
        crates += &format!("\n{}\n{}\n\n{text}\n", "-".repeat(80), of.join(", "));
    }
    Ok(crates)
}

fn metadata() -> Result<Value, Error> {
    let mut command = cargo(&["metadata", "--format-version", "1", "--locked"]);
    let output = command.stderr(Stdio::inherit()).output();
    let output = output.map_err(|source| Error::Start {
        program: "cargo".into(),
        source,
        remedy: "install Rust from https://rustup.rs",
    })?;
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn by_id(metadata: &Value) -> BTreeMap<&str, &Value> {
    let packages = metadata["packages"].as_array().into_iter().flatten();
    packages.filter_map(|package| Some((package["id"].as_str()?, package))).collect()
}

/// The crates of others that end up in the binaries, by name: what the shipped ones need when they run, directly or
/// not. The command line's features are not theirs.
fn shipped(metadata: &Value, packages: &BTreeMap<&str, &Value>) -> Vec<String> {
    let nodes: BTreeMap<&str, &Value> = metadata["resolve"]["nodes"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|node| Some((node["id"].as_str()?, node)))
        .collect();
    let is_ours = |id: &str| packages.get(id).is_some_and(|package| package["source"].is_null());
    let name = |id: &str| packages.get(id).and_then(|package| package["name"].as_str()).unwrap_or_default().to_string();
    let mut open: Vec<String> =
        nodes.keys().filter(|id| SHIPPED.contains(&name(id).as_str())).map(|id| id.to_string()).collect();
    let mut seen = BTreeSet::new();
    while let Some(id) = open.pop() {
        if !seen.insert(id.clone()) {
            continue;
        }
        let dependencies = nodes.get(id.as_str()).and_then(|node| node["deps"].as_array()).into_iter().flatten();
        for dependency in dependencies.filter(|dependency| is_normal(dependency)) {
            let Some(next) = dependency["pkg"].as_str() else { continue };
            let optional = is_ours(&id) && is_optional(packages.get(id.as_str()), &name(next));
            if !optional && !is_macro(packages.get(next)) {
                open.push(next.to_string());
            }
        }
    }
    let mut others: Vec<String> = seen.into_iter().filter(|id| !is_ours(id)).collect();
    others.sort_by_key(|id| name(id));
    others
}

/// A dependency of the running program, for a platform that FMUs are built for.
fn is_normal(dependency: &Value) -> bool {
    dependency["dep_kinds"].as_array().into_iter().flatten().any(|kind| kind["kind"].is_null())
}

/// Procedural macros run in the compiler only.
fn is_macro(package: Option<&&Value>) -> bool {
    let targets = package.and_then(|package| package["targets"].as_array());
    let kinds = targets.into_iter().flatten().filter_map(|target| target["kind"].as_array());
    kinds.flatten().any(|kind| kind == "proc-macro")
}

/// Whether the package asks for it behind a feature, none of which the FMUs turn on.
fn is_optional(package: Option<&&Value>, dependency: &str) -> bool {
    let all = package.and_then(|package| package["dependencies"].as_array()).into_iter().flatten();
    let mut named = all.filter(|own| own["name"] == dependency && own["kind"].is_null());
    named.next().is_some_and(|own| own["optional"] == true)
}

/// The licence texts in a crate's folder, without trailing blanks.
fn licence_files(folder: &Path) -> Result<Vec<String>, Error> {
    let read = |path: &Path| {
        std::fs::read_to_string(path).map_err(|source| Error::File { action: "read", path: path.into(), source })
    };
    let entries =
        std::fs::read_dir(folder).map_err(|source| Error::File { action: "read", path: folder.into(), source })?;
    let mut paths: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| is_licence(path)).collect();
    paths.sort();
    paths.iter().map(|path| Ok(clean(&read(path)?))).collect()
}

fn is_licence(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
    path.is_file()
        && ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"].iter().any(|start| name.starts_with(start))
}

fn clean(text: &str) -> String {
    text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n").trim().to_string()
}
