//! Numbers in the cells of a table: decimal points or commas, thousands separators, words for missing values.

mod thousands;

use std::fmt::Write;

use hysid_core::words::{Hint, Words};
use hysid_document::visible::clipped;
pub use thousands::ThousandsWatch;

use crate::problem::CellProblem;

/// Sign before the decimals of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecimalSign {
    Point,
    Comma,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct NumberFormat {
    /// The decimal sign; `None` if the beginning of the file has only whole numbers.
    pub decimal: Option<DecimalSign>,
    /// The user chose the decimal sign.
    pub is_chosen: bool,
    /// The line of the first number that shows the decimal sign.
    pub decimal_line: Option<u64>,
    /// Cells that stand for a missing value besides [`is_missing`].
    pub missing: Vec<String>,
}

/// Reads the numbers of one file; all must have the same decimal sign.
#[derive(Debug)]
pub struct CellReader {
    format: NumberFormat,
    /// Values that stand for a missing one.
    missing: Vec<f64>,
}

impl CellReader {
    /// A reader of a file of this format.
    pub fn new(format: &NumberFormat) -> Self {
        let missing = format.missing.iter().filter_map(|text| parsed(text, format.decimal).ok());
        Self { missing: missing.map(|(value, _)| value).collect(), format: format.clone() }
    }

    /// The number in a cell, NaN for a missing value; or what is wrong with it.
    ///
    /// # Errors
    /// A cell that is no number, or has another decimal sign than those before.
    pub fn number(&mut self, cell: &str, line: u64) -> Result<f64, CellProblem> {
        let text = cell.trim();
        // Most numbers have what those before had.
        let value = match plain(text, self.format.decimal) {
            Some(number) => number,
            None if is_missing(text) || self.format.missing.iter().any(|missing| missing == text) => {
                return Ok(f64::NAN);
            }
            None => self.slowly(text, line)?,
        };
        Ok(if self.missing.contains(&value) { f64::NAN } else { value })
    }

    /// The decimal sign of the file; `None` as long as all numbers are whole.
    pub fn sign(&self) -> Option<DecimalSign> {
        self.format.decimal
    }

    /// The user chose the decimal sign, so that points and commas need no second look.
    pub fn sign_is_chosen(&self) -> bool {
        self.format.is_chosen
    }

    fn slowly(&mut self, text: &str, line: u64) -> Result<f64, CellProblem> {
        let (value, sign) =
            parsed(text, self.format.decimal).map_err(|problem| self.in_words(problem, text))?;
        if let (None, Some(sign)) = (self.format.decimal, sign) {
            (self.format.decimal, self.format.decimal_line) = (Some(sign), Some(line));
        }
        Ok(value)
    }

    fn in_words(&self, problem: NumberProblem, text: &str) -> CellProblem {
        let text = clipped(text);
        let sign = |sign: DecimalSign| if sign == DecimalSign::Point { "point" } else { "comma" };
        CellProblem::NoNumber(match problem {
            NumberProblem::OtherSign(other) => {
                let origin = match self.format.decimal_line {
                    _ if self.format.is_chosen => Words::from(Hint::Option("decimal")) + " chooses",
                    None => "the file has".into(),
                    Some(line) => format!("line {line}").into(),
                };
                let words = Words::from(format!("\"{text}\" has a decimal {}, ", sign(other))) + origin;
                let words = words + format!(" a decimal {}", sign(other.opposite()));
                return CellProblem::Other(words.advised("use one of them"));
            }
            NumberProblem::TooLarge => format!("\"{text}\" is too large for a number"),
            NumberProblem::NotFinite => format!("\"{text}\" is not a finite number"),
            NumberProblem::NotANumber => format!("\"{text}\" is not a number"),
        })
    }
}

/// Digits of a number that is read without allocating.
const MOST_DIGITS: usize = 32;

/// The number of a text without thousands and of this decimal sign; `None` for anything that needs a closer look.
fn plain(text: &str, decimal: Option<DecimalSign>) -> Option<f64> {
    let number = match decimal {
        Some(DecimalSign::Point) => text.parse::<f64>(),
        None if text.contains(['.', ',']) => return None,
        None => text.parse(),
        Some(DecimalSign::Comma) => {
            let mut digits = [0; MOST_DIGITS];
            let digits = digits.get_mut(..text.len())?;
            for (digit, &byte) in digits.iter_mut().zip(text.as_bytes()) {
                *digit = match byte {
                    b'.' => return None,
                    b',' => b'.',
                    other => other,
                };
            }
            std::str::from_utf8(digits).ok()?.parse()
        }
    };
    number.ok().filter(|number| number.is_finite())
}

/// Why a cell is not a valid number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberProblem {
    /// It has this decimal sign, the file another.
    OtherSign(DecimalSign),
    /// It exceeds what a number can hold.
    TooLarge,
    NotFinite,
    /// It is something else.
    NotANumber,
}

/// Cells that many programs write for a missing value, in lower case.
const MISSING: [&str; 20] = [
    "",
    "nan",
    "na",
    "n/a",
    "#n/a",
    "#na",
    "#nv",
    "null",
    "none",
    "-",
    "--",
    "---",
    "?",
    "#value!",
    "#wert!",
    "#div/0!",
    "1.#qnan",
    "-nan",
    "nan(ind)",
    "-nan(ind)",
];

/// True for an empty cell, and for what many programs write in place of a missing value, such as `NaN` and `#N/A`.
pub fn is_missing(cell: &str) -> bool {
    let cell = cell.trim();
    cell.len() <= 9 && MISSING.iter().any(|missing| missing.eq_ignore_ascii_case(cell))
}

/// Characters that separate thousands and are nothing else.
const THOUSANDS: [char; 5] = [' ', '\u{a0}', '\u{202f}', '\'', '’'];

/// The number of a text and the decimal sign that it shows, where `known` is that of the file. A sign that separates
/// groups of three digits is taken for a thousands separator where the decimal sign is another: `1,234.5`, `1 234,5`,
/// and `1,234` among numbers with points. An exponent may have the letter D.
pub fn parsed(text: &str, known: Option<DecimalSign>) -> Result<(f64, Option<DecimalSign>), NumberProblem> {
    let text = text.trim();
    let (mantissa, exponent) = match text.find(['e', 'E', 'd', 'D']) {
        Some(place) => (&text[..place], &text[place + 1..]),
        None => (text, ""),
    };
    let digits = mantissa.strip_prefix(['+', '-', '−']).unwrap_or(mantissa);
    let may_be = |c: char| c.is_ascii_digit() || c == '.' || c == ',' || THOUSANDS.contains(&c);
    let looks_like_one = digits.chars().all(may_be)
        && digits.contains(|c: char| c.is_ascii_digit())
        && exponent.chars().all(|c| c.is_ascii_digit() || c == '+' || c == '-');
    if !looks_like_one {
        let is_infinite = text.parse::<f64>().is_ok_and(f64::is_infinite);
        return Err(if is_infinite { NumberProblem::NotFinite } else { NumberProblem::NotANumber });
    }
    let (sign, separator) = signs(digits, known)?;
    let mut plain = String::with_capacity(text.len());
    if mantissa.starts_with(['-', '−']) {
        plain.push('-');
    }
    for letter in digits.chars().filter(|letter| Some(*letter) != separator) {
        plain.push(if letter == ',' { '.' } else { letter });
    }
    if mantissa.len() < text.len() {
        plain.push('e');
        plain.push_str(exponent);
    }
    match plain.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok((number, sign)),
        Ok(_) => Err(NumberProblem::TooLarge),
        Err(_) => Err(NumberProblem::NotANumber),
    }
}

/// The decimal sign of some digits, and the character that separates their thousands.
fn signs(
    digits: &str,
    known: Option<DecimalSign>,
) -> Result<(Option<DecimalSign>, Option<char>), NumberProblem> {
    let other = digits.chars().find(|letter| THOUSANDS.contains(letter));
    let decimal = match (digits.rfind('.'), digits.rfind(',')) {
        (None, None) => None,
        (Some(_), None) => Some(DecimalSign::Point),
        (None, Some(_)) => Some(DecimalSign::Comma),
        (Some(point), Some(comma)) if point > comma => Some(DecimalSign::Point),
        (Some(_), Some(_)) => Some(DecimalSign::Comma),
    };
    let Some(decimal) = decimal else {
        return match other {
            Some(separator) if !is_grouped(digits, separator) => Err(NumberProblem::NotANumber),
            separator => Ok((None, separator)),
        };
    };
    let (letter, opposite) = (decimal.character(), decimal.opposite().character());
    let separator = other.or_else(|| digits.contains(opposite).then_some(opposite));
    // Such as 1.234.567, and 1.234 where commas are decimal signs.
    let is_only_grouped = separator.is_none() && is_grouped(digits, letter);
    if is_only_grouped && (digits.matches(letter).count() > 1 || known == Some(decimal.opposite())) {
        return Ok((known, Some(letter)));
    }
    let (whole, decimals) = digits.rsplit_once(letter).unwrap_or((digits, ""));
    let is_well_formed = !whole.contains(letter)
        && decimals.chars().all(|digit| digit.is_ascii_digit())
        && separator.is_none_or(|separator| is_grouped(whole, separator));
    if !is_well_formed {
        return Err(NumberProblem::NotANumber);
    }
    match known {
        Some(sign) if sign != decimal => Err(NumberProblem::OtherSign(decimal)),
        _ => Ok((Some(decimal), separator)),
    }
}

/// True for groups of three digits behind a first one of one to three.
fn is_grouped(digits: &str, separator: char) -> bool {
    let mut groups = digits.split(separator);
    let first = groups.next().unwrap_or_default();
    let is_of_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&first.len())
        && is_of_digits(first)
        && groups.all(|group| group.len() == 3 && is_of_digits(group))
}

/// The shortest text that reads back as the same number.
pub fn shortest(value: f64) -> String {
    let mut text = String::new();
    push_shortest(&mut text, value, DecimalSign::Point);
    text
}

/// Most letters of a plain number that is preferred to one with an exponent.
const PLAIN_LETTERS: usize = 12;

/// Digits of the largest whole number that is printed without an exponent, at least.
const MOST_PRINTED: usize = 32;

/// Adds the shortest text that reads back as the same number, with this decimal sign.
pub fn push_shortest(text: &mut String, value: f64, sign: DecimalSign) {
    if !value.is_finite() {
        let _ = write!(text, "{value}");
        return;
    }
    let mut buffer = zmij::Buffer::new();
    let mut digits = [b'0'; MOST_PRINTED];
    let (count, before) = digits_of(buffer.format_finite(value.abs()), &mut digits);
    let digits = std::str::from_utf8(&digits[..count]).unwrap_or_default();
    let (mut whole, mut decimals) = match usize::try_from(before) {
        Ok(before @ 1..) => digits.split_at(before.min(count)),
        _ => ("0", digits),
    };
    // Zeros behind the whole digits, and ahead of the decimals.
    let mut behind = usize::try_from(before).unwrap_or(0).saturating_sub(count);
    let mut ahead = usize::try_from(-before).unwrap_or(0);
    let of_decimals = if decimals.is_empty() { 0 } else { 1 + ahead + decimals.len() };
    let of_sign = usize::from(value.is_sign_negative());
    let exponent = before - 1;
    let with_exponent = of_sign + count + usize::from(count > 1) + 1 + letters(exponent);
    let has_exponent = of_sign + whole.len() + behind + of_decimals > with_exponent.max(PLAIN_LETTERS);
    if has_exponent {
        (whole, decimals) = digits.split_at(1);
        (behind, ahead) = (0, 0);
    }
    text.extend(value.is_sign_negative().then_some('-'));
    text.push_str(whole);
    text.extend(std::iter::repeat_n('0', behind));
    if !decimals.is_empty() {
        text.push_str(sign.letter());
        text.extend(std::iter::repeat_n('0', ahead));
        text.push_str(decimals);
    }
    if has_exponent {
        let _ = write!(text, "e{exponent}");
    }
}

/// Significant digits of a printed number that is not negative, without zeros at the ends; returns how many there are, at least
/// one, and how many of them stand before the point, negative for zeros behind it.
fn digits_of(printed: &str, digits: &mut [u8; MOST_PRINTED]) -> (usize, i32) {
    let (mantissa, exponent) = printed.split_once('e').unwrap_or((printed, "0"));
    let (mut count, mut before, mut is_behind) = (0, exponent.parse::<i32>().unwrap_or(0), false);
    for byte in mantissa.bytes() {
        match byte {
            b'.' => is_behind = true,
            b'0' if count == 0 => before -= i32::from(is_behind),
            digit => {
                if let Some(place) = digits.get_mut(count) {
                    *place = digit;
                }
                count += 1;
                before += i32::from(!is_behind);
            }
        }
    }
    count = count.min(MOST_PRINTED);
    while count > 1 && digits[count - 1] == b'0' {
        count -= 1;
    }
    // Zero has one digit, before the point.
    if count == 0 { (1, 1) } else { (count, before) }
}

/// Letters of a whole number.
fn letters(number: i32) -> usize {
    usize::from(number < 0) + number.unsigned_abs().checked_ilog10().map_or(1, |most| most as usize + 1)
}

impl DecimalSign {
    /// The sign as text.
    pub fn letter(self) -> &'static str {
        match self {
            Self::Point => ".",
            Self::Comma => ",",
        }
    }

    fn character(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }

    pub(crate) fn opposite(self) -> Self {
        match self {
            Self::Point => Self::Comma,
            Self::Comma => Self::Point,
        }
    }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::powi;
    use hysid_document::Face;

    use super::*;

    fn number(text: &str, known: Option<DecimalSign>) -> Result<f64, NumberProblem> {
        parsed(text, known).map(|(value, _)| value)
    }

    #[test]
    fn numbers_are_read_as_countries_write_them() {
        use DecimalSign::{Comma, Point};
        for (text, known, value) in [
            ("1.5", None, 1.5),
            (" -3,14e1 ", None, -31.4),
            ("−2", None, -2.0),
            ("+.5", None, 0.5),
            ("1.5D+03", None, 1500.0),
            ("-2,5d-1", Some(Comma), -0.25),
            ("1,234.5", None, 1234.5),
            ("1.234,5", None, 1234.5),
            ("1.234.567", None, 1_234_567.0),
            ("1,234", Some(Point), 1234.0),
            ("1.234", Some(Comma), 1234.0),
            ("1.234", Some(Point), 1.234),
            ("1,234", None, 1.234),
            ("12 345,75", None, 12_345.75),
            ("12\u{202f}345", None, 12_345.0),
            ("1'234'567.5", None, 1_234_567.5),
        ] {
            assert_eq!(number(text, known), Ok(value), "{text}");
        }
        for text in ["1.2.3", "1,2,3", "1 2", "12,34.5", "1,5.5", "1.5e", "--1", "1-2", "abc", "12:30"] {
            assert_eq!(number(text, None), Err(NumberProblem::NotANumber), "{text}");
        }
        assert_eq!(number("1,5", Some(Point)), Err(NumberProblem::OtherSign(Comma)));
        assert_eq!(number("1.5", Some(Comma)), Err(NumberProblem::OtherSign(Point)));
    }

    #[test]
    fn a_file_has_one_decimal_sign_and_its_own_words_for_missing_values() {
        let format = NumberFormat { missing: vec!["-999".into(), "over".into()], ..NumberFormat::default() };
        let mut cells = CellReader::new(&format);
        assert_eq!(cells.number("7", 2), Ok(7.0));
        assert_eq!(cells.number("1,5", 3), Ok(1.5));
        let problem: Words = cells.number("1.5", 4).unwrap_err().into();
        assert!(Face::Terminal.told(&problem).contains("line 3 a decimal comma"));
        for missing in ["", "NaN", "#N/A", "-", "-999", "-999,0", "over"] {
            assert!(cells.number(missing, 5).unwrap().is_nan(), "{missing}");
        }
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
        let whole = (0..400).map(|k| 7.0 * powi(10.0, k % 40 - 20) * f64::from(k));
        let edges =
            [0.0, -0.0, 1.0, -1.5, 0.1, 1e21, 123456789012.0, 1e12, -1e-7, 5e-324, f64::MAX, 0.1 + 0.2];
        for value in random.filter(|value| value.is_finite()).take(20_000).chain(whole).chain(edges) {
            // Halfway between two texts Rust rounds up, and this one, like Python, to an even digit.
            let (ours, rusts) = (shortest(value), expected(value));
            assert_eq!(ours.parse(), Ok(value), "{value:e}");
            let digits = ours.len() - 1;
            assert!(ours.len() == rusts.len() && ours[..digits] == rusts[..digits], "{ours} {rusts}");
            let mut comma = String::from("x");
            push_shortest(&mut comma, value, DecimalSign::Comma);
            assert_eq!(comma[1..], ours.replace('.', ","));
        }
    }
}
