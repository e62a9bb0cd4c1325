//! The page that an FMU brings along.

use switchid_fmu_slave::{Causality, Description, Kind, Variable};

/// A page of that text, with a table of every variable.
pub fn page(description: &Description, text: &str) -> String {
    let rows: String = description.variables.iter().map(row).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{name}</title>\n<style>body{{font:1rem/1.5 \
         sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}}td,th{{text-align:left;padding:.2rem \
         .8rem;border-bottom:1px solid #ccc;vertical-align:top}}</style></head>\n<body><h1>{name}</h1>\n<p>{summary}.</p>\n\
         {text}\n<table><tr><th>variable</th><th>kind</th><th>default</th><th>unit</th><th>meaning</th></tr>\n{rows}</table>\n\
         <p>switchid {version}, MIT OR Apache-2.0.</p></body></html>\n",
        name = escape(&description.name),
        summary = escape(&description.description),
        version = escape(&description.version),
    )
}

fn row(variable: &Variable) -> String {
    let causality = match variable.causality {
        Causality::Parameter => "parameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "time",
    };
    let is_given = matches!(variable.causality, Causality::Parameter | Causality::Input);
    let start = if is_given { start_text(&variable.kind) } else { String::new() };
    let unit = match &variable.kind {
        Kind::Real { unit: Some(unit), .. } => unit.as_str(),
        _ => "",
    };
    format!(
        "<tr><td><code>{}</code></td><td>{causality}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        escape(&variable.name),
        escape(&start),
        escape(unit),
        escape(&variable.description)
    )
}

fn start_text(kind: &Kind) -> String {
    match kind {
        Kind::Real { start, .. } => format!("{start:?}"),
        Kind::Integer { start, .. } | Kind::Enumeration { start, .. } => start.to_string(),
        Kind::Boolean { start } => start.to_string(),
        Kind::String { start } => start.clone(),
    }
}

/// A plant and the identifier as two blocks of a diagram, with what goes from one to the other.
pub const PICTURE: &str = include_str!("../assets/connection.svg");

/// A numbered list of what to do.
pub fn quick_start(steps: &[&str]) -> String {
    let items: String = steps.iter().map(|step| format!("<li>{step}</li>\n")).collect();
    format!("<h2>Quick start</h2>\n<ol>\n{items}</ol>\n")
}

/// The text as HTML shows it.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
