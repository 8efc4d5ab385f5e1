//! Numbers in the cells of a table, with decimal points or decimal commas.

mod thousands;

use std::fmt::Write;

use crate::terminal::clipped;
pub use thousands::ThousandsWatch;

/// What stands before the decimals of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecimalSign {
    /// As in 1.5.
    Point,
    /// As in 1,5.
    Comma,
}

/// Reads the cells of one file; all its numbers must have the same decimal sign.
pub struct CellReader {
    commas_separate: bool,
    /// The decimal sign, and the line of the first number that has it.
    sign: Option<(DecimalSign, u64)>,
}

impl CellReader {
    /// A reader of a file with this delimiter.
    pub fn new(delimiter: u8) -> Self {
        Self { commas_separate: delimiter == b',', sign: None }
    }

    /// The number in a cell, or what is wrong with it.
    pub fn number(&mut self, cell: &str, line: u64) -> Result<f64, String> {
        let text = cell.trim();
        // Most numbers have what those before had.
        if self.sign.is_some_and(|(sign, _)| sign == DecimalSign::Point)
            && let Ok(number) = text.parse::<f64>()
            && number.is_finite()
        {
            return Ok(number);
        }
        if text.contains(',') && looks_like_a_number(text) {
            return self.with_comma(text, line);
        }
        if text.contains('.') && looks_like_a_number(text) {
            if let Some((DecimalSign::Comma, other)) = self.sign {
                return Err(format!(
                    "\"{}\" has a decimal point, line {other} a decimal comma (use one of them)",
                    clipped(text)
                ));
            }
            self.sign.get_or_insert((DecimalSign::Point, line));
        }
        finite(text, text)
    }

    /// The decimal sign of the file; `None` as long as all numbers are whole.
    pub fn sign(&self) -> Option<DecimalSign> {
        self.sign.map(|(sign, _)| sign)
    }

    fn with_comma(&mut self, text: &str, line: u64) -> Result<f64, String> {
        if text.contains('.') || text.matches(',').count() > 1 {
            return Err(format!(
                "\"{}\" has more than one decimal sign (remove thousands separators)",
                clipped(text)
            ));
        }
        if self.commas_separate {
            return Err(format!(
                "\"{}\" has a decimal comma, but commas separate the columns (use decimal points, or semicolons \
                 between the columns)",
                clipped(text)
            ));
        }
        if let Some((DecimalSign::Point, other)) = self.sign {
            return Err(format!(
                "\"{}\" has a decimal comma, line {other} a decimal point (use one of them)",
                clipped(text)
            ));
        }
        self.sign.get_or_insert((DecimalSign::Comma, line));
        finite(&text.replace(',', "."), text)
    }
}

/// The shortest text that reads back as the same number.
pub fn shortest(value: f64) -> String {
    let mut text = String::new();
    push_shortest(&mut text, value, DecimalSign::Point);
    text
}

/// A plain number is preferred to one with an exponent up to so many letters.
const PLAIN_LETTERS: usize = 12;

/// Adds the shortest text that reads back as the same number, with this decimal sign.
pub fn push_shortest(text: &mut String, value: f64, sign: DecimalSign) {
    let start = text.len();
    // Rust prints as many digits as it takes.
    let _ = write!(text, "{value:e}");
    let written = text.len() - start;
    let Some(end) = text[start..].find('e').map(|end| start + end) else { return };
    let Ok(exponent) = text[end + 1..].parse::<i32>() else { return };
    let first = start + usize::from(value.is_sign_negative());
    let digits = (end - first).max(2) - 1;
    let point = sign.letter();
    // Digits before the point, if there are that many.
    let before = exponent + 1;
    let letters = match usize::try_from(before) {
        Ok(before) if before >= digits => before,
        Ok(before) if before > 0 => digits + 1,
        _ => 2 + before.unsigned_abs() as usize + digits,
    };
    if first - start + letters > written.max(PLAIN_LETTERS) {
        if digits > 1 {
            text.replace_range(first + 1..first + 2, point);
        }
        return;
    }
    text.truncate(end);
    if digits > 1 {
        text.remove(first + 1);
    }
    match usize::try_from(before) {
        Ok(before) if before >= digits => text.extend(std::iter::repeat_n('0', before - digits)),
        Ok(before) if before > 0 => text.insert_str(first + before, point),
        _ => {
            let zeros = before.unsigned_abs() as usize;
            text.insert_str(first, &"0".repeat(zeros));
            text.insert_str(first, point);
            text.insert(first, '0');
        }
    }
}

impl DecimalSign {
    fn letter(self) -> &'static str {
        match self {
            Self::Point => ".",
            Self::Comma => ",",
        }
    }
}

/// True if every cell is a number, as in a file without a header.
pub fn all_numbers<'a>(mut cells: impl Iterator<Item = &'a str>) -> bool {
    cells.all(|cell| finite(&cell.trim().replace(',', "."), cell).is_ok())
}

fn looks_like_a_number(text: &str) -> bool {
    text.chars().all(|c| c.is_ascii_digit() || "+-.,eE".contains(c))
        && text.contains(|c: char| c.is_ascii_digit())
}

fn finite(text: &str, cell: &str) -> Result<f64, String> {
    let problem = match text.parse::<f64>() {
        Ok(number) if number.is_finite() => return Ok(number),
        Ok(_) if looks_like_a_number(text) => "is too large for a number",
        Ok(number) if number.is_infinite() => "is not a finite number",
        _ => "is not a number",
    };
    Err(format!("\"{}\" {problem}", clipped(cell)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_commas_need_another_delimiter() {
        let mut cells = CellReader::new(b';');
        assert_eq!(cells.number(" -3,14e1 ", 2), Ok(-31.4));
        assert_eq!(cells.number("7", 2), Ok(7.0));
        assert!(cells.number("1.5", 3).unwrap_err().contains("line 2 a decimal comma"));
        assert!(cells.number("1.234,5", 4).unwrap_err().contains("thousands"));
        assert!(CellReader::new(b',').number("3,14", 2).unwrap_err().contains("separate the columns"));
    }

    #[test]
    fn the_shortest_text_is_that_of_rust_s_two_formats() {
        let expected = |value: f64| {
            let (plain, scientific) = (value.to_string(), format!("{value:e}"));
            if plain.len() <= scientific.len().max(PLAIN_LETTERS) { plain } else { scientific }
        };
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        let random = std::iter::repeat_with(|| {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from_bits(bits.rotate_left(17))
        });
        let whole = (0..400).map(|k| 7.0 * 10f64.powi(k % 40 - 20) * f64::from(k));
        let edges =
            [0.0, -0.0, 1.0, -1.5, 0.1, 1e21, 123456789012.0, 1e12, -1e-7, 5e-324, f64::MAX, 0.1 + 0.2];
        for value in random.filter(|value| value.is_finite()).take(20_000).chain(whole).chain(edges) {
            assert_eq!(shortest(value), expected(value), "{value:e}");
            let mut comma = String::from("x");
            push_shortest(&mut comma, value, DecimalSign::Comma);
            assert_eq!(comma[1..], expected(value).replace('.', ","));
        }
    }

    #[test]
    fn words_are_no_numbers() {
        let mut cells = CellReader::new(b',');
        for (text, problem) in [
            ("n/a", "\"n/a\" is not a number"),
            ("NaN", "\"NaN\" is not a number"),
            ("-inf", "\"-inf\" is not a finite number"),
            ("1e999", "\"1e999\" is too large for a number"),
            ("1.2.3", "\"1.2.3\" is not a number"),
        ] {
            assert_eq!(cells.number(text, 1), Err(problem.to_string()));
        }
    }
}
