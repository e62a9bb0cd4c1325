//! From `fmuResourceLocation` to a directory, whatever form the host writes it in.
//!
//! Seen in the field: `file:///p` percent-encoded, `file:///p/`, `file:////p` with raw spaces and UTF-8, `file:/p`,
//! `file://localhost/p`, `FILE:///p`, a bare path.

use std::path::PathBuf;

/// The directories that the location may mean, most likely first: percent-decoded, then as written.
pub fn candidates(location: &[u8]) -> [PathBuf; 2] {
    let raw = strip_scheme(location);
    [to_path(percent_decode(raw)), to_path(raw.to_vec())]
}

fn strip_scheme(location: &[u8]) -> &[u8] {
    let Some(rest) = strip_word(location, b"file:") else { return location };
    let rest = strip_word(rest, b"//localhost").unwrap_or(rest);
    let slashes = rest.iter().take_while(|byte| **byte == b'/').count();
    let drive = cfg!(windows) && rest.get(slashes + 1) == Some(&b':');
    &rest[if drive { slashes } else { slashes.saturating_sub(1) }..]
}

/// What follows the word, in small or capital letters.
fn strip_word<'a>(text: &'a [u8], word: &[u8]) -> Option<&'a [u8]> {
    let (start, rest) = text.split_at_checked(word.len())?;
    start.eq_ignore_ascii_case(word).then_some(rest)
}

fn percent_decode(text: &[u8]) -> Vec<u8> {
    let mut decoded = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((first, tail)) = rest.split_first() {
        match (*first, hex_pair(tail)) {
            (b'%', Some(byte)) => {
                decoded.push(byte);
                rest = &tail[2..];
            }
            (byte, _) => {
                decoded.push(byte);
                rest = tail;
            }
        }
    }
    decoded
}

fn hex_pair(text: &[u8]) -> Option<u8> {
    let digit = |byte: u8| char::from(byte).to_digit(16);
    let (high, low) = (digit(*text.first()?)?, digit(*text.get(1)?)?);
    Some((high * 16 + low) as u8)
}

#[cfg(unix)]
fn to_path(bytes: Vec<u8>) -> PathBuf {
    use std::os::unix::ffi::OsStringExt;
    std::ffi::OsString::from_vec(bytes).into()
}

#[cfg(not(unix))]
fn to_path(bytes: Vec<u8>) -> PathBuf {
    String::from_utf8_lossy(&bytes).into_owned().into()
}

#[cfg(all(test, unix))]
mod tests {
    use super::candidates;
    use std::path::Path;

    fn decoded(location: &str) -> String {
        candidates(location.as_bytes())[0].to_string_lossy().into_owned()
    }

    #[test]
    fn every_form_seen_in_the_field_is_read() {
        for (location, path) in [
            ("file:///opt/a%20b/resources", "/opt/a b/resources"),
            ("file:///opt/resources/", "/opt/resources/"),
            ("file:////opt/a b/größe", "/opt/a b/größe"),
            ("file:/opt/resources", "/opt/resources"),
            ("file://localhost/opt/r", "/opt/r"),
            ("FILE:///opt/R", "/opt/R"),
            ("File://LOCALHOST/opt/r", "/opt/r"),
            ("fil", "fil"),
            ("/opt/gr%C3%B6%C3%9Fe", "/opt/größe"),
            ("file:///opt/100%", "/opt/100%"),
            ("file:///opt/%zz", "/opt/%zz"),
        ] {
            assert_eq!(decoded(location), path, "{location}");
        }
    }

    #[test]
    fn a_literal_percent_stays_reachable() {
        assert_eq!(candidates(b"file:///opt/a%20b")[1], Path::new("/opt/a%20b"));
    }
}
