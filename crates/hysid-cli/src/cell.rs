//! Numbers in the cells of a table, with decimal points or decimal commas.

/// Reads the cells of one file; all its numbers must have the same decimal sign.
pub struct CellReader {
    commas_separate: bool,
    /// Line of the first decimal comma.
    comma: Option<u64>,
    /// Line of the first decimal point.
    point: Option<u64>,
}

impl CellReader {
    /// A reader of a file with this delimiter.
    pub fn new(delimiter: u8) -> Self {
        Self { commas_separate: delimiter == b',', comma: None, point: None }
    }

    /// The number in a cell, or what is wrong with it.
    pub fn number(&mut self, cell: &str, line: u64) -> Result<f64, String> {
        let text = cell.trim();
        if text.contains(',') && looks_like_a_number(text) {
            return self.with_comma(text, line);
        }
        if text.contains('.') && looks_like_a_number(text) {
            if let Some(other) = self.comma {
                return Err(format!(
                    "\"{text}\" has a decimal point, line {other} a decimal comma (use one of them)"
                ));
            }
            self.point.get_or_insert(line);
        }
        finite(text, text)
    }

    /// True if the file has decimal commas.
    pub fn has_decimal_commas(&self) -> bool {
        self.comma.is_some()
    }

    fn with_comma(&mut self, text: &str, line: u64) -> Result<f64, String> {
        if text.contains('.') || text.matches(',').count() > 1 {
            return Err(format!(
                "\"{text}\" has more than one decimal sign (leave out thousands separators)"
            ));
        }
        if self.commas_separate {
            return Err(format!(
                "\"{text}\" has a decimal comma, but commas separate the columns (use decimal points, or \
                 semicolons between the columns)"
            ));
        }
        if let Some(other) = self.point {
            return Err(format!(
                "\"{text}\" has a decimal comma, line {other} a decimal point (use one of them)"
            ));
        }
        self.comma.get_or_insert(line);
        finite(&text.replace(',', "."), text)
    }
}

/// The shortest text that reads back as the same number.
pub fn shortest(value: f64) -> String {
    // Rust prints as many digits as it takes, in either form.
    let plain = value.to_string();
    let scientific = format!("{value:e}");
    if plain.len() <= scientific.len().max(12) { plain } else { scientific }
}

/// True if every cell is a number, as in a file without a header.
pub fn all_numbers<'a>(mut cells: impl Iterator<Item = &'a str>) -> bool {
    cells.all(|cell| finite(&cell.trim().replace(',', "."), cell).is_ok())
}

fn looks_like_a_number(text: &str) -> bool {
    text.chars().all(|c| c.is_ascii_digit() || "+-.,eE".contains(c))
        && text.contains(|c: char| c.is_ascii_digit())
}

fn finite(text: &str, shown: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) if looks_like_a_number(text) => Err(format!("\"{shown}\" is too large for a number")),
        Ok(number) if number.is_infinite() => Err(format!("\"{shown}\" is not a finite number")),
        _ => Err(format!("\"{shown}\" is not a number")),
    }
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
