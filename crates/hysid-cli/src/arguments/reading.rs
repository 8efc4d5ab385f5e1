//! How tables are read, where a file does not tell.

use clap::Args;
use hysid_records::MOST_ROWS_OF_ZERO;
use hysid_tables::{DecimalSign, Delimiter, Reading, RowSelection, TextEncoding};

/// How tables are read.
#[derive(Debug, Clone, Args, Default)]
#[command(next_help_heading = "Reading files")]
pub struct ReadingOptions {
    /// What separates columns: comma, semicolon, tab, bar, blanks or a character [default: detected]
    #[arg(long, value_name = "NAME", hide_short_help = true)]
    pub delimiter: Option<Delimiter>,
    /// Decimal sign: point or comma [default: detected]
    #[arg(long, value_name = "SIGN", hide_short_help = true)]
    pub decimal: Option<DecimalSign>,
    /// Skip the first lines of the file
    #[arg(long, value_name = "LINES", default_value_t = 0, hide_short_help = true)]
    pub skip: usize,
    /// The table has no names of columns: call them c1, c2 and so on
    #[arg(long, hide_short_help = true)]
    pub no_header: bool,
    /// Treat the last line of the header as units, even if Hysid does not know them
    ///
    /// Without this option, a line below the names is taken for units if its cells are known units or in brackets.
    #[arg(long, hide_short_help = true, conflicts_with = "no_header")]
    pub units_row: bool,
    /// A cell that stands for a missing value, such as -999; repeat for several
    #[arg(long, value_name = "CELL", allow_hyphen_values = true, hide_short_help = true, long_help = missing_help("A missing output is not scored; a missing input is an error."))]
    pub missing: Vec<String>,
    /// Encoding of the text, such as utf-8, windows-1252 or shift_jis [default: detected]
    #[arg(long, value_name = "NAME", hide_short_help = true)]
    pub encoding: Option<TextEncoding>,
    /// Sheet of a spreadsheet or table of a text, by its name or number, or variable of a MATLAB, HDF5, NumPy or JSON file [default: those with equal columns that have the most data]
    #[arg(long, value_name = "NAME", hide_short_help = true)]
    pub sheet: Option<String>,
    /// Use these rows of each table, counted from 1 after the header: FROM:TO, FROM: or :TO
    #[arg(long, value_name = "FROM:TO", hide_short_help = true)]
    pub rows: Option<RowSelection>,
    /// Use every N-th row of those that --rows selects
    ///
    /// There is no anti-aliasing filter.
    #[arg(long, value_name = "N", value_parser = at_least_one, default_value_t = 1, hide_short_help = true)]
    pub every: u64,
    /// Subtract from the first input and from the output their means over the first ROWS rows of each record
    #[arg(long, value_name = "ROWS", value_parser = rows_of_zero, hide_short_help = true)]
    pub zero: Option<usize>,
}

impl ReadingOptions {
    /// As the reader of tables takes them.
    pub fn reading(&self) -> Reading {
        Reading {
            delimiter: self.delimiter,
            decimal: self.decimal,
            skip: self.skip,
            no_header: self.no_header,
            units_row: self.units_row,
            missing: self.missing.clone(),
            encoding: self.encoding,
            sheet: self.sheet.clone(),
            rows: RowSelection { every: self.every, ..self.rows.unwrap_or_default() },
        }
    }
}

/// The help of `--missing`, with what a missing value means for a command.
pub fn missing_help(meaning: &str) -> String {
    format!(
        "A cell that stands for a missing value, such as -999; repeat for several\n\nEmpty cells, NaN, NA, N/A, #N/A, null \
         and - are always missing values, in upper or lower case. {meaning}"
    )
}

fn at_least_one(text: &str) -> Result<u64, String> {
    text.parse().ok().filter(|&count| count > 0).ok_or_else(|| "a whole number from 1 is needed".to_string())
}

fn rows_of_zero(text: &str) -> Result<usize, String> {
    let advice = || format!("a whole number from 1 to {MOST_ROWS_OF_ZERO} is needed");
    text.parse().ok().filter(|count| (1..=MOST_ROWS_OF_ZERO).contains(count)).ok_or_else(advice)
}

#[cfg(test)]
mod tests {
    use clap::{Args, Command};
    use hysid_records::READING_OPTIONS;

    use super::*;

    #[test]
    fn the_help_is_that_of_the_table_of_options() {
        let command = ReadingOptions::augment_args(Command::new("test"));
        for option in READING_OPTIONS {
            let flag = option.name.replace('_', "-");
            let argument = command.get_arguments().find(|argument| argument.get_long() == Some(&flag));
            let help = argument.and_then(|argument| argument.get_help()).unwrap().to_string();
            assert!(help.starts_with(option.meaning), "--{flag}: {help}");
        }
        assert_eq!(command.get_arguments().count(), READING_OPTIONS.len());
    }
}
