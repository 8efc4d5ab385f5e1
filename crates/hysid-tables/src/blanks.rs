//! Text with blanks between its cells as text with tabs.

use std::io::{self, Read};

/// Gives the text of a reader with one tab in place of blanks and tabs one after another, and none at the ends of lines.
/// Text in quotation marks stays as it is.
pub struct TabsForBlanks<R> {
    reader: R,
    /// Bytes that were read and not given yet.
    pending: Vec<u8>,
    given: usize,
    is_quoted: bool,
    /// The line has a cell already, and blanks stand behind it.
    has_cell: bool,
    has_blank: bool,
}

impl<R: Read> TabsForBlanks<R> {
    /// Of a text that begins with a line.
    pub fn new(reader: R) -> Self {
        Self { reader, pending: Vec::new(), given: 0, is_quoted: false, has_cell: false, has_blank: false }
    }

    fn take(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            match byte {
                b' ' | b'\t' if !self.is_quoted => self.has_blank = self.has_cell,
                b'\n' | b'\r' if !self.is_quoted => {
                    (self.has_cell, self.has_blank) = (false, false);
                    self.pending.push(byte);
                }
                _ => {
                    if self.has_blank {
                        self.pending.push(b'\t');
                    }
                    (self.has_cell, self.has_blank) = (true, false);
                    self.is_quoted ^= byte == b'"';
                    self.pending.push(byte);
                }
            }
        }
    }
}

impl<R: Read> Read for TabsForBlanks<R> {
    fn read(&mut self, room: &mut [u8]) -> io::Result<usize> {
        while self.given == self.pending.len() {
            (self.pending, self.given) = (Vec::with_capacity(room.len()), 0);
            let mut block = [0; 1 << 14];
            let read = self.reader.read(&mut block)?;
            if read == 0 {
                return Ok(0);
            }
            self.take(&block[..read]);
        }
        let some = room.len().min(self.pending.len() - self.given);
        room[..some].copy_from_slice(&self.pending[self.given..self.given + some]);
        self.given += some;
        Ok(some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_become_one_tab_between_cells() {
        let text = "  0.5   1\t 2  \r\n\"a  b\" 3\n\n 4";
        let mut found = String::new();
        TabsForBlanks::new(text.as_bytes()).read_to_string(&mut found).unwrap();
        assert_eq!(found, "0.5\t1\t2\r\n\"a  b\"\t3\n\n4");
    }
}
