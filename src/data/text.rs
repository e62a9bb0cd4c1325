//! A text file, block by block: only its beginning and one block are ever in memory.

use super::content::Content;
use super::encoding::{Encoding, is_text};
use std::io::{self, Read};

/// Bytes that are read at once.
const BLOCK: u64 = 1 << 20;

/// Text of any encoding.
pub(super) struct Text {
    /// Its first lines; all lines of a small file.
    pub(super) head: String,
    /// How many lines there are, about: those of the head, and as many as fit into the rest.
    pub(super) lines: usize,
    encoding: Encoding,
    /// What ends a line.
    end: u8,
    /// Bytes behind the last line of the head.
    pending: Vec<u8>,
    rest: Box<dyn Read>,
}

impl Text {
    /// The text of a file; none where its beginning is no text.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn of(content: Content) -> io::Result<Option<Text>> {
        let Content { head, rest, length } = content;
        let (encoding, mark) = Encoding::of(&head);
        let end = if encoding.behind_last(&head, b'\n').is_some() { b'\n' } else { b'\r' };
        let pending = head.get(mark..).unwrap_or_default().to_vec();
        let mut text = Text { head: String::new(), lines: 0, encoding, end, pending, rest };
        let bytes = text.whole_lines()?;
        let taken = bytes.len().max(1) as f64;
        text.head = encoding.decode(bytes);
        let lines = text.head.bytes().filter(|byte| *byte == end).count() + 1;
        text.lines = (lines as f64 * (length as f64 / taken).max(1.0)) as usize;
        Ok(is_text(&text.head).then_some(text))
    }

    /// The text, in blocks of whole lines; the first one is the head.
    pub(super) fn blocks(mut self) -> impl Iterator<Item = io::Result<String>> {
        let mut head = Some(std::mem::take(&mut self.head));
        std::iter::from_fn(move || match head.take() {
            Some(head) => Some(Ok(head)),
            None => self.block().transpose(),
        })
    }

    fn block(&mut self) -> io::Result<Option<String>> {
        let before = self.pending.len();
        self.rest.by_ref().take(BLOCK).read_to_end(&mut self.pending)?;
        if self.pending.is_empty() {
            return Ok(None);
        }
        let bytes = if self.pending.len() == before { std::mem::take(&mut self.pending) } else { self.whole_lines()? };
        Ok(Some(self.encoding.decode(bytes)))
    }

    /// Takes the whole lines out of the pending bytes, of which more are read until there is one; all at the end of the
    /// file.
    fn whole_lines(&mut self) -> io::Result<Vec<u8>> {
        loop {
            if let Some(at) = self.encoding.behind_last(&self.pending, self.end) {
                let behind = self.pending.split_off(at);
                return Ok(std::mem::replace(&mut self.pending, behind));
            }
            if self.rest.by_ref().take(BLOCK).read_to_end(&mut self.pending)? == 0 {
                return Ok(std::mem::take(&mut self.pending));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Option<String> {
        let text = Text::of(Content::of(bytes.to_vec())).unwrap()?;
        Some(text.blocks().map(Result::unwrap).collect())
    }

    #[test]
    fn texts_of_every_encoding_are_read() {
        let units = |order: fn(u16) -> [u8; 2]| "t;µ".encode_utf16().flat_map(order).collect::<Vec<u8>>();
        let little = [vec![0xff, 0xfe], units(u16::to_le_bytes)].concat();
        let big = [vec![0xfe, 0xff], units(u16::to_be_bytes)].concat();
        for bytes in [little.as_slice(), &big, "t;µ".as_bytes(), "\u{feff}t;µ".as_bytes(), b"t;\xb5"] {
            assert_eq!(read(bytes).as_deref(), Some("t;µ"), "{bytes:?}");
        }
        assert_eq!(read(b"t\x00\x01\x02"), None);
    }

    #[test]
    fn blocks_end_where_lines_do() {
        for end in ["\n", "\r\n", "\r"] {
            let line = |n: usize| format!("{n};µ{}{end}", "9".repeat(n % 50));
            let whole: String = (0..60_000).map(line).collect::<String>() + "last";
            let little: Vec<u8> = whole.encode_utf16().flat_map(u16::to_le_bytes).collect();
            for bytes in [whole.clone().into_bytes(), [vec![0xff, 0xfe], little].concat()] {
                let (head, rest) = bytes.split_at(999);
                let (head, rest, length) = (head.to_vec(), rest.to_vec(), bytes.len() as u64);
                let content = Content { head, rest: Box::new(io::Cursor::new(rest)), length };
                let text = Text::of(content).unwrap().unwrap();
                assert!((50_000..200_000).contains(&text.lines), "{}", text.lines);
                let blocks: Vec<String> = text.blocks().map(Result::unwrap).collect();
                assert!(blocks.len() > 2 && blocks[..blocks.len() - 1].iter().all(|block| block.ends_with(end)));
                assert_eq!(blocks.concat(), whole);
            }
        }
    }
}
