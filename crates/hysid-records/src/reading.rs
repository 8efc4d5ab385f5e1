//! How tables are read, as options by name: the same on the command line and in the studio.

use hysid_core::words::{Hint, Words};
use hysid_tables::{Delimiter, Problem, Reading, Result, RowSelection};
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, Serialize)]
pub struct ReadingOption {
    /// Its name, in words joined by underscores; the command line joins them by hyphens.
    pub name: &'static str,
    /// Its effect, in a sentence without a full stop.
    pub meaning: &'static str,
    pub values: ReadingValues,
}

/// The valid values of an option of reading tables.
#[derive(Debug, Clone, Copy, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind", content = "names")]
pub enum ReadingValues {
    Names(&'static [&'static str]),
    Text,
    /// Several texts.
    List,
    /// A whole number.
    Count,
    Flag,
}

use ReadingValues::{Count, Flag, List, Names, Text};

const fn option(name: &'static str, meaning: &'static str, values: ReadingValues) -> ReadingOption {
    ReadingOption { name, meaning, values }
}

/// Every option of reading tables. A test of the program compares them with its help.
pub const READING_OPTIONS: [ReadingOption; 11] = [
    option(
        "delimiter",
        "What separates columns: comma, semicolon, tab, bar, blanks or a character",
        Names(&["comma", "semicolon", "tab", "bar", "blanks"]),
    ),
    option("decimal", "Decimal sign: point or comma", Names(&["point", "comma"])),
    option("skip", "Skip the first lines of the file", Count),
    option("no_header", "The table has no names of columns: call them c1, c2 and so on", Flag),
    option("units_row", "Treat the last line of the header as units, even if Hysid does not know them", Flag),
    option("missing", "A cell that stands for a missing value, such as -999", List),
    option("encoding", "Encoding of the text, such as utf-8, windows-1252 or shift_jis", Text),
    option(
        "sheet",
        "Sheet of a spreadsheet or table of a text, by its name or number, or variable of a MATLAB, HDF5, NumPy or JSON file",
        Text,
    ),
    option(
        "rows",
        "Use these rows of each table, counted from 1 after the header: FROM:TO, FROM: or :TO",
        Text,
    ),
    option("every", "Use every N-th row of those that --rows selects", Count),
    option(
        "zero",
        "Subtract from the first input and from the output their means over the first ROWS rows of each record",
        Count,
    ),
];

/// Most rows over which an offset is averaged: that many are held in memory.
pub const MOST_ROWS_OF_ZERO: usize = 4096;

/// Options of reading tables by name; `None` and empty for what is detected.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(missing_docs, reason = "each field is the option of its name")]
pub struct ReadingChoice {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delimiter: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decimal: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skip: Option<usize>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub no_header: bool,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub units_row: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoding: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sheet: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zero: Option<usize>,
}

impl ReadingChoice {
    /// As the reader of tables takes it.
    ///
    /// # Errors
    /// A value that is not valid, or two options that contradict each other.
    pub fn reading(&self) -> Result<Reading> {
        if self.no_header && self.units_row {
            let header = Words::from("a table without a header (") + Hint::Option("no_header");
            let words = Words::from(Hint::Option("units_row")) + ": " + header;
            return Err(Problem::Request(words + ") has no line of units"));
        }
        if self.every == Some(0) {
            return Err(Problem::option("every", "a whole number from 1 is needed"));
        }
        if self.zero.is_some_and(|rows| !(1..=MOST_ROWS_OF_ZERO).contains(&rows)) {
            let needed = format!("a whole number from 1 to {MOST_ROWS_OF_ZERO} is needed");
            return Err(Problem::option("zero", needed));
        }
        let rows = parsed::<RowSelection>("rows", &self.rows)?.unwrap_or_default();
        Ok(Reading {
            delimiter: parsed::<Delimiter>("delimiter", &self.delimiter)?,
            decimal: parsed("decimal", &self.decimal)?,
            skip: self.skip.unwrap_or_default(),
            no_header: self.no_header,
            units_row: self.units_row,
            missing: self.missing.clone(),
            encoding: parsed("encoding", &self.encoding)?,
            sheet: self.sheet.clone(),
            rows: RowSelection { every: self.every.unwrap_or(1), ..rows },
        })
    }
}

fn parsed<T: std::str::FromStr<Err = String>>(
    name: &'static str,
    value: &Option<String>,
) -> Result<Option<T>> {
    let parse = |text: &String| text.parse().map_err(|error| Problem::option(name, error));
    value.as_ref().map(parse).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_value_names_its_option() {
        for (json, option) in [
            (r#"{"rows": "x"}"#, "--rows"),
            (r#"{"zero": 0}"#, "--zero"),
            (r#"{"every": 0}"#, "--every"),
            (r#"{"encoding": "klingon"}"#, "--encoding"),
            (r#"{"no_header": true, "units_row": true}"#, "--units-row"),
        ] {
            let choice: ReadingChoice = serde_json::from_str(json).unwrap();
            let error = choice.reading().unwrap_err().to_string();
            assert!(error.starts_with(option), "{error}");
        }
    }

    #[test]
    fn every_option_of_the_table_is_a_field_and_every_field_an_option() {
        let all = ReadingChoice {
            delimiter: Some("comma".into()),
            decimal: Some("point".into()),
            skip: Some(1),
            no_header: true,
            units_row: true,
            missing: vec!["x".into()],
            encoding: Some("utf-8".into()),
            sheet: Some("1".into()),
            rows: Some("1:".into()),
            every: Some(1),
            zero: Some(1),
        };
        let serde_json::Value::Object(fields) = serde_json::to_value(all).unwrap() else { panic!("a map") };
        let mut named: Vec<&str> = READING_OPTIONS.iter().map(|option| option.name).collect();
        named.sort_unstable();
        let mut fields: Vec<&str> = fields.keys().map(String::as_str).collect();
        fields.sort_unstable();
        assert_eq!(fields, named);
    }
}
