//! A table as it is read: how its file is stored, and what each column is.

use hysid_core::data::unit;
use hysid_core::significant::Significant;
use hysid_core::words::Words;
use hysid_document::Face;
use hysid_document::plain::aligned;
use hysid_tables::{CellReader, ColumnReader, DecimalSign, Table};
use serde::Serialize;

use crate::columns::Roles;
use crate::understanding::labelled;
use hysid_document::visible::clipped;

/// Columns that are shown of many.
const MOST_COLUMNS: usize = 40;

/// A table as it is read.
#[derive(Debug, Serialize)]
pub struct TableOverview {
    file: String,
    stored: String,
    delimiter: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    decimal: Option<&'static str>,
    lines_before: usize,
    header_lines: Vec<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    units_line: Option<u64>,
    rows: usize,
    first_line: u64,
    last_line: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    left_out: Option<String>,
    #[serde(skip)]
    read_as: String,
    pub columns: Vec<ColumnSummary>,
}

#[derive(Debug, Clone, Serialize)]
pub struct ColumnSummary {
    pub name: String,
    /// `time`, `input`, `output`, `rate`, `record`, `unused`; none if the roles are unclear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub role: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The smallest number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum: Option<f64>,
    /// The largest number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub maximum: Option<f64>,
    /// Cells without a number.
    pub missing: usize,
    /// Why it is not used, or what is special.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl TableOverview {
    /// Of a table whose columns have these roles, if they are known.
    pub fn of(table: &Table, roles: Option<&Roles>, face: Face) -> Self {
        let layout = &table.layout;
        Self {
            file: table.file.clone(),
            stored: table.stored.clone(),
            delimiter: layout.delimiter.name(),
            decimal: layout.numbers.decimal.map(|sign| match sign {
                DecimalSign::Point => "point",
                DecimalSign::Comma => "comma",
            }),
            lines_before: layout.preamble,
            header_lines: layout.header_lines.clone(),
            units_line: layout.units_line,
            rows: table.rows(),
            first_line: table.lines.iter().min().copied().unwrap_or_default(),
            last_line: table.lines.iter().max().copied().unwrap_or_default(),
            left_out: table.left_out.described(),
            read_as: table.described(),
            columns: (0..table.header.len())
                .map(|place| ColumnSummary::of(table, place, roles, face))
                .collect(),
        }
    }

    /// The table in words, within 80 columns where the names allow.
    pub fn text(&self) -> String {
        let mut text = labelled("file", &clipped(&self.file)) + &labelled("read as", &self.read_as);
        text +=
            &labelled("rows", &format!("{}, in lines {} to {}", self.rows, self.first_line, self.last_line));
        text += &self.left_out.iter().map(|lines| labelled("left out", lines)).collect::<String>();
        let mut rows =
            vec![["column", "role", "unit", "smallest", "largest", "missing", ""].map(String::from).to_vec()];
        rows.extend(self.columns.iter().take(MOST_COLUMNS).map(ColumnSummary::cells));
        text += "\n";
        for line in aligned(&rows) {
            text += line.trim_end();
            text += "\n";
        }
        if let Some(more) = self.columns.len().checked_sub(MOST_COLUMNS).filter(|&more| more > 0) {
            text += &format!("and {more} more columns\n");
        }
        text
    }
}

impl ColumnSummary {
    fn of(table: &Table, place: usize, roles: Option<&Roles>, face: Face) -> Self {
        let name = table.header[place].clone();
        let mut cells = CellReader::new(table.numbers());
        let mut reader = ColumnReader::new(table, place);
        let mut column = Self {
            role: roles.map(|roles| role(roles, &name)),
            unit: unit::of_column(&name),
            minimum: None,
            maximum: None,
            missing: 0,
            note: roles.and_then(|roles| reason(roles, &name)).map(|reason| face.told(reason)),
            name,
        };
        let mut others = 0;
        for (row, &line) in table.lines.iter().enumerate() {
            match reader.number(table, &mut cells, table.cell(row, place), line) {
                Ok(number) if number.is_nan() => column.missing += 1,
                Ok(number) => {
                    column.minimum = Some(column.minimum.map_or(number, |least| least.min(number)));
                    column.maximum = Some(column.maximum.map_or(number, |most| most.max(number)));
                }
                Err(_) => others += 1,
            }
        }
        if others > 0 && column.note.is_none() && column.role != Some("record") {
            column.note = Some(match others == table.rows() - column.missing {
                true => "text".into(),
                false if others == 1 => "1 cell is not a number".into(),
                false => format!("{others} cells are not numbers"),
            });
        }
        if reader.has_stamps() {
            column.note.get_or_insert_with(|| "from its first stamp".into());
        }
        column
    }

    fn cells(&self) -> Vec<String> {
        let number =
            |value: Option<f64>| value.map_or(String::new(), |value| format!("{:.4}", Significant(value)));
        vec![
            clipped(&self.name).into_owned(),
            self.role.unwrap_or("?").into(),
            clipped(&self.unit.as_deref().map(unit::written).unwrap_or_default()).into_owned(),
            number(self.minimum),
            number(self.maximum),
            self.missing.to_string(),
            self.note.clone().unwrap_or_default(),
        ]
    }
}

fn role(roles: &Roles, name: &String) -> &'static str {
    match name {
        _ if roles.record.as_ref() == Some(name) => "record",
        _ if roles.time.as_ref() == Some(name) => "time",
        _ if roles.rate.as_ref() == Some(name) => "rate",
        _ if roles.inputs.contains(name) => "input",
        _ if roles.output == *name => "output",
        _ => "unused",
    }
}

fn reason<'r>(roles: &'r Roles, name: &String) -> Option<&'r Words> {
    roles.set_aside.iter().find(|(other, _)| other == name).map(|(_, reason)| reason)
}
