//! A page that stands alone: sentences, tables and figures, with all it needs inside.

use super::figure::Figure;
use super::html::{escaped, html, script};

/// A part of a page.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A heading.
    Heading(String),
    /// A sentence or several.
    Text(String),
    /// Lines as a terminal shows them.
    Verbatim(String),
    /// A law, typeset: terms of a coefficient with its std and a feature, equal to a right-hand side.
    Law {
        /// Coefficient, std and feature of each term.
        terms: Vec<[String; 2]>,
        /// The right-hand side.
        right: String,
    },
    /// A figure.
    Figure(Figure),
}

const STYLE: &str = "body{font-family:system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}\
    h1{font-size:1.6rem}h2{font-size:1.15rem;margin-top:2rem}pre{background:#f5f5f5;padding:.8rem;overflow-x:auto}\
    .law{font-size:1.2rem;font-family:serif;margin:1rem 0}.law i{font-style:italic}.caption{color:#666;font-size:.9rem}";

/// The page.
pub fn page(title: &str, blocks: &[Block]) -> String {
    let figures = blocks.iter().any(|block| matches!(block, Block::Figure(_)));
    let script = if figures { script() } else { String::new() };
    let body: String = blocks.iter().enumerate().map(|(index, block)| part(block, index)).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{STYLE}</style>\n{script}\n</head>\n\
         <body>\n<h1>{0}</h1>\n{body}</body>\n</html>\n",
        escaped(title)
    )
}

fn part(block: &Block, index: usize) -> String {
    match block {
        Block::Heading(text) => format!("<h2>{}</h2>\n", escaped(text)),
        Block::Text(text) => format!("<p>{}</p>\n", escaped(text)),
        Block::Verbatim(text) => format!("<pre>{}</pre>\n", escaped(text)),
        Block::Law { terms, right } => {
            let terms: Vec<String> = terms
                .iter()
                .map(|[value, feature]| format!("{} <i>{}</i>", escaped(&bracketed(value)), raised(feature)))
                .collect();
            format!("<p class=\"law\">{} = <i>{}</i></p>\n", terms.join(" + "), escaped(right))
        }
        Block::Figure(figure) => html(figure, &format!("figure-{index}")),
    }
}

/// A value with its std as one factor.
fn bracketed(value: &str) -> String {
    if value.contains('±') && !value.starts_with('(') { format!("({value})") } else { value.into() }
}

/// `q^3` with its exponent raised.
fn raised(feature: &str) -> String {
    let mut parts = feature.split('^');
    let first = escaped(parts.next().unwrap_or_default());
    parts.fold(first, |text, part| {
        let end = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
        format!("{text}<sup>{}</sup>{}", &part[..end], escaped(&part[end..]))
    })
}
