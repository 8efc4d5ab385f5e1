//! Lines of a text that is passed piece by piece.

/// Counts line ends (LF, CR LF or CR), also where CR and LF come in two pieces.
#[derive(Debug, Clone, Copy)]
pub struct LineCounter {
    line: u64,
    /// The last byte was CR.
    is_after_return: bool,
}

impl LineCounter {
    /// Before the first line.
    pub fn new() -> Self {
        Self { line: 1, is_after_return: false }
    }

    /// The line that the next byte is on, counted from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// The line of the first content of a piece, blank lines aside.
    pub fn line_of(mut self, piece: &[u8]) -> u64 {
        let content = piece.iter().take_while(|byte| matches!(byte, b'\n' | b'\r')).count();
        self.pass(&piece[..content]);
        self.line
    }

    /// Goes on behind a piece.
    pub fn pass(&mut self, piece: &[u8]) {
        let Some(last) = piece.last() else { return };
        let count = |end: u8| piece.iter().filter(|&&byte| byte == end).count();
        let mut ends = count(b'\n');
        if self.is_after_return && piece[0] == b'\n' {
            ends -= 1;
        }
        let returns = count(b'\r');
        if returns > 0 {
            ends += returns - piece.windows(2).filter(|pair| *pair == b"\r\n").count();
        }
        self.line += ends as u64;
        self.is_after_return = *last == b'\r';
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_the_same_however_a_text_is_cut() {
        let text = b"a\nb\r\n\r\n\rc\n\nd\r";
        // A line ends with CR already, and LF behind it ends no other.
        let lines = [1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 7, 7, 8];
        for (end, line) in lines.into_iter().enumerate() {
            for cut in 0..=end {
                let mut lines = LineCounter::new();
                lines.pass(&text[..cut]);
                lines.pass(&text[cut..end]);
                assert_eq!(lines.line(), line, "{end} {cut}");
            }
        }
    }
}
