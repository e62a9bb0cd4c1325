//! The characters of a text's bytes: UTF-8, UTF-16 with a byte order mark, else the Western European code page of
//! instruments and old spreadsheets.

/// Characters looked at before a file counts as text.
const LOOKED_AT: usize = 4096;

/// How characters are bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// UTF-8; where bytes are none, ISO 8859-1.
    Western,
    /// UTF-16, the lower byte first.
    Utf16Little,
    /// UTF-16, the higher byte first.
    Utf16Big,
}

impl Encoding {
    /// The encoding that a byte order mark names, and how many bytes that takes.
    pub(super) fn of(head: &[u8]) -> (Encoding, usize) {
        match head {
            [0xff, 0xfe, ..] => (Encoding::Utf16Little, 2),
            [0xfe, 0xff, ..] => (Encoding::Utf16Big, 2),
            [0xef, 0xbb, 0xbf, ..] => (Encoding::Western, 3),
            _ => (Encoding::Western, 0),
        }
    }

    /// The characters of bytes that end where a character does.
    pub(super) fn decode(self, bytes: Vec<u8>) -> String {
        match self {
            Encoding::Western => western(bytes),
            Encoding::Utf16Little => utf16(&bytes, u16::from_le_bytes),
            Encoding::Utf16Big => utf16(&bytes, u16::from_be_bytes),
        }
    }

    /// Position behind the last of these marks, an ASCII character, among the bytes.
    pub(super) fn behind_last(self, bytes: &[u8], mark: u8) -> Option<usize> {
        let unit = match self {
            Encoding::Western => return bytes.iter().rposition(|byte| *byte == mark).map(|at| at + 1),
            Encoding::Utf16Little => [mark, 0],
            Encoding::Utf16Big => [0, mark],
        };
        bytes.as_chunks::<2>().0.iter().rposition(|pair| *pair == unit).map(|at| 2 * (at + 1))
    }
}

/// Whether a beginning has the characters of a text only.
pub(super) fn is_text(beginning: &str) -> bool {
    let is_text = |c: char| !c.is_control() || matches!(c, '\t' | '\n' | '\r' | '\u{c}' | '\u{1a}');
    beginning.chars().take(LOOKED_AT).all(is_text)
}

/// UTF-8, else ISO 8859-1: its byte is the character's number.
fn western(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap_or_else(|error| error.as_bytes().iter().map(|byte| char::from(*byte)).collect())
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.as_chunks::<2>().0.iter().map(|pair| unit(*pair));
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}
