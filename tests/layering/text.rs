//! A source as the compiler reads it: without comments, strings and tests; its words; its `use` declarations.

/// The source without comments, doc lines, strings and its `#[cfg(test)]` module: only what the compiler builds.
pub fn code(source: &str) -> String {
    let built = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = built.lines().map(|line| without_strings(line).split("//").next().unwrap_or_default().to_string());
    lines.collect::<Vec<_>>().join("\n")
}

fn without_strings(line: &str) -> String {
    let line = line.replace("\\\"", "").replace("'\"'", "");
    line.split('"').step_by(2).collect::<Vec<_>>().join("\"\"")
}

/// Names, `::` and every other character that is no space, in order.
pub fn words(code: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let length = if is_name(first) {
            rest.find(|c| !is_name(c)).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        if !first.is_whitespace() {
            words.push(rest[..length].to_string());
        }
        rest = &rest[length..];
    }
    words
}

/// One name that a `use` declaration brings: `use a::b as c` brings `c` for `a::b`; the glob of `a` brings `*` for `a`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Import {
    pub name: String,
    pub path: Vec<String>,
    /// Whether it is handed on: `pub use`, also `pub(crate) use`.
    pub is_public: bool,
}

/// What a source imports, and its other words.
pub fn imports(code: &str) -> (Vec<Import>, Vec<String>) {
    let words = words(code);
    let (mut imports, mut body, mut at) = (Vec::new(), Vec::new(), 0);
    while at < words.len() {
        if words[at] != "use" {
            body.push(words[at].clone());
            at += 1;
            continue;
        }
        let before = at.checked_sub(1).map(|before| words[before].as_str());
        let is_public = matches!(before, Some("pub" | ")"));
        let end = at + words[at..].iter().position(|word| word == ";").unwrap_or(words.len() - at);
        let (names, _) = tree(&words[at + 1..end], &[]);
        imports.extend(names.into_iter().map(|(name, path)| Import { name, path, is_public }));
        at = end + 1;
    }
    (imports, body)
}

/// The names that a tree of imports brings with their paths, and how many words it took.
fn tree(words: &[String], prefix: &[String]) -> (Vec<(String, Vec<String>)>, usize) {
    let (mut path, mut at) = (prefix.to_vec(), 0);
    while at < words.len() {
        match words[at].as_str() {
            "," | "}" => break,
            "::" => at += 1,
            "*" => return (vec![("*".to_string(), path)], at + 1),
            "{" => {
                let (names, taken) = group(&words[at + 1..], &path);
                return (names, at + 1 + taken);
            }
            "as" => return (vec![(words[at + 1].clone(), path)], at + 2),
            "self" if !path.is_empty() => at += 1,
            name => {
                path.push(name.to_string());
                at += 1;
            }
        }
    }
    let name = path.last().cloned().unwrap_or_default();
    (vec![(name, path)], at)
}

/// The trees of a group whose opening brace is passed, and the words up to behind its closing one.
fn group(words: &[String], prefix: &[String]) -> (Vec<(String, Vec<String>)>, usize) {
    let (mut names, mut at) = (Vec::new(), 0);
    while at < words.len() && words[at] != "}" {
        if words[at] == "," {
            at += 1;
            continue;
        }
        let (more, taken) = tree(&words[at..], prefix);
        names.extend(more);
        at += taken;
    }
    (names, at + 1)
}

/// The paths of two and more names among the words: `weak::Row::of` in `weak::Row::of(x)`.
pub fn paths(words: &[String]) -> Vec<Vec<String>> {
    let is_name =
        |at: usize| words.get(at).is_some_and(|word| word.starts_with(|c: char| c.is_alphabetic() || c == '_'));
    let (mut found, mut at) = (Vec::new(), 0);
    while at < words.len() {
        let start = at;
        let mut path = Vec::new();
        while is_name(at) {
            path.push(words[at].clone());
            if words.get(at + 1).is_none_or(|word| word != "::") || !is_name(at + 2) {
                break;
            }
            at += 2;
        }
        let is_rooted = start == 0 || words[start - 1] != "::";
        if path.len() > 1 && is_rooted {
            found.push(path);
        }
        at += 1;
    }
    found
}
