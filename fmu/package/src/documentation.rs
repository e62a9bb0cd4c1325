//! The page that an FMU brings along.

use switchid::law::Model;
use switchid_fmu_slave::{Causality, Description, Kind, Variable};

/// The page of an identifier.
pub fn identifier(description: &Description, model: &Model) -> String {
    let terms: Vec<String> = model.terms.iter().map(|entry| entry.term.symbol()).collect();
    let text = format!(
        "<p>Connect <code>q</code>, <code>qd</code> and <code>F</code>. One <code>fmi2DoStep</code> is one sample: the \
         inputs are the sample at the step's start, the outputs hold at its end. Terms stand on the left-hand side, the \
         excitation on the right; this FMU's law may have {}.</p><p>A sample with a NaN is skipped and said in the log. \
         While a coefficient is unknown it keeps its last value and its std is 1e30. Parameters are taken at \
         <code>fmi2ExitInitializationMode</code>; 0 means automatic where the table says so.</p>",
        escape(&terms.iter().filter(|symbol| !symbol.is_empty()).cloned().collect::<Vec<_>>().join(", "))
    );
    page(description, &text)
}

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
    };
    let start = if variable.causality == Causality::Output { String::new() } else { start_text(&variable.kind) };
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

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
