//! What a platform's binary must be: the standard's functions and no others, nothing of the building machine, no newer
//! C library than promised.

use crate::command::root;
use crate::error::Error;
use object::Object;
use std::path::Path;
use switchid_fmu_slave::host::{ExchangeFunctions, Functions};

/// Refuses a binary that is not as it must be; `glibc` is the newest minor version of the C library, 2.x, that it may
/// need.
///
/// # Errors
/// [`Error::Binary`] says what is wrong.
pub fn inspect(path: &Path, content: &[u8], exchange: bool, glibc: u32) -> Result<(), Error> {
    let wrong = |what: String| Error::Binary { path: path.into(), what };
    let exports = exports(content).map_err(|error| wrong(error.to_string()))?;
    let expected = functions(exchange);
    let others: Vec<&str> = exports.iter().map(String::as_str).filter(|name| !expected.contains(name)).collect();
    let missing: Vec<&str> = expected.into_iter().filter(|name| !exports.iter().any(|own| own == name)).collect();
    if !(others.is_empty() && missing.is_empty()) {
        return Err(wrong(format!("exports {others:?} besides the standard's functions and lacks {missing:?}")));
    }
    if let Some(newest) = newest_glibc(content).filter(|newest| *newest > glibc) {
        return Err(wrong(format!("needs glibc 2.{newest}, not 2.{glibc} or older")));
    }
    match private_paths().into_iter().find(|private| holds(content, private.as_bytes())) {
        Some(private) => Err(wrong(format!("holds the path {private}"))),
        None => Ok(()),
    }
}

/// The functions that a library exports, with or without model exchange.
pub fn functions(exchange: bool) -> Vec<&'static str> {
    Functions::NAMES.iter().chain(ExchangeFunctions::NAMES.iter().filter(|_| exchange)).copied().collect()
}

fn exports(content: &[u8]) -> Result<Vec<String>, object::Error> {
    let exports = object::File::parse(content)?.exports()?;
    Ok(exports.iter().map(|export| String::from_utf8_lossy(export.name()).into_owned()).collect())
}

/// The newest x among the version names GLIBC_2.x that the binary asks for.
fn newest_glibc(content: &[u8]) -> Option<u32> {
    let start = b"GLIBC_2.";
    let names = content.windows(start.len()).enumerate().filter(|(_, window)| window == start);
    let number = |place: usize| {
        let digits = content[place..].iter().take_while(|byte| byte.is_ascii_digit());
        let text: String = digits.map(|byte| char::from(*byte)).collect();
        text.parse::<u32>().ok()
    };
    names.filter_map(|(place, _)| number(place + start.len())).max()
}

fn private_paths() -> Vec<String> {
    let folders = ["HOME", "CARGO_HOME", "RUSTUP_HOME"].iter().filter_map(|name| std::env::var(name).ok());
    folders.chain([root().display().to_string()]).filter(|path| path.len() > 1).collect()
}

fn holds(content: &[u8], part: &[u8]) -> bool {
    content.windows(part.len()).any(|window| window == part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_version_of_the_c_library_is_found() {
        assert_eq!(newest_glibc(b"\0GLIBC_2.2.5\0GLIBC_2.14\0GLIBC_2.3\0"), Some(14));
        assert_eq!(newest_glibc(b"KERNEL32.dll"), None);
    }

    #[test]
    fn a_binary_with_other_functions_is_refused() {
        let own = std::env::current_exe().unwrap();
        let refused = inspect(&own, &std::fs::read(&own).unwrap(), false, 99).unwrap_err().to_string();
        assert!(refused.contains("lacks [\"fmi2GetTypesPlatform\""), "{refused}");
        assert!(inspect(&own, b"no binary", false, 17).is_err());
    }
}
