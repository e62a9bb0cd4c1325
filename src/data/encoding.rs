//! The text of a file: UTF-8, UTF-16 with a byte order mark, else the Western European code page of instruments and old
//! spreadsheets.

use std::borrow::Cow;

/// Bytes looked at before a file counts as text.
const LOOKED_AT: usize = 4096;

/// The characters of bytes; none where these are no text.
pub(super) fn decode(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => Cow::Owned(utf16(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] => Cow::Owned(utf16(rest, u16::from_be_bytes)),
        [0xef, 0xbb, 0xbf, rest @ ..] => western(rest),
        _ => western(bytes),
    };
    let looked_at = text.chars().take(LOOKED_AT);
    let is_text = |c: char| !c.is_control() || matches!(c, '\t' | '\n' | '\r' | '\u{c}' | '\u{1a}');
    looked_at.clone().all(is_text).then_some(text)
}

/// UTF-8, else ISO 8859-1: its byte is the character's number.
fn western(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()),
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.as_chunks::<2>().0.iter().map(|pair| unit(*pair));
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn texts_of_every_encoding_are_read() {
        let units = |order: fn(u16) -> [u8; 2]| "t;µ".encode_utf16().flat_map(order).collect::<Vec<u8>>();
        let little = [vec![0xff, 0xfe], units(u16::to_le_bytes)].concat();
        let big = [vec![0xfe, 0xff], units(u16::to_be_bytes)].concat();
        for bytes in [little.as_slice(), &big, "t;µ".as_bytes(), "\u{feff}t;µ".as_bytes(), b"t;\xb5"] {
            assert_eq!(decode(bytes).as_deref(), Some("t;µ"), "{bytes:?}");
        }
        assert_eq!(decode(b"t\x00\x01\x02"), None);
    }
}
