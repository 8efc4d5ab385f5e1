//! Tables of several files side by side: input and output of one test that were written to a file each.

use std::path::Path;

use hysid_core::words::{Hint, Words};
use hysid_document::visible::clipped;
use hysid_document::{Problem, Result};

use crate::layout::distinct;
use crate::number::parsed;
use crate::table::Table;

/// A column of the joined table: its table, its place there, and its name.
struct JoinedColumn {
    table: usize,
    place: usize,
    name: String,
}

impl Table {
    /// The columns of all tables side by side, row by row. A column that another table has too, such as time, comes once.
    /// Columns without a name are called after their file.
    ///
    /// # Errors
    /// Tables with different numbers of rows, or with another decimal sign.
    pub fn joined(tables: &[Self]) -> Result<Self> {
        let [first, others @ ..] = tables else { return Err("no table to join".into()) };
        for other in others {
            if other.rows() != first.rows() {
                let words = format!("has {} rows where {} has {}", other.rows(), first.file, first.rows());
                let advice =
                    Words::from("only equal rows can be joined: choose them with ") + Hint::Option("rows");
                return Err(Problem::in_file(&other.file, Words::from(words).advised(advice)));
            }
            let signs = [first, other].map(|table| table.numbers().decimal);
            if let [Some(sign), Some(another)] = signs
                && sign != another
            {
                let words =
                    format!("has another decimal sign than {}: save both alike", clipped(&first.file));
                return Err(Problem::in_file(&other.file, words));
            }
        }
        let mut columns: Vec<JoinedColumn> = Vec::new();
        for (number, table) in tables.iter().enumerate() {
            for place in 0..table.header.len() {
                let is_known = |known: &JoinedColumn| {
                    known.table < number && equal(&tables[known.table], known.place, table, place)
                };
                if !columns.iter().any(is_known) {
                    columns.push(JoinedColumn { table: number, place, name: String::new() });
                }
            }
        }
        for column in 0..columns.len() {
            columns[column].name = name(tables, &columns, column);
        }
        Ok(Self::of_columns(tables, &columns))
    }

    fn of_columns(tables: &[Self], columns: &[JoinedColumn]) -> Self {
        let names = distinct(columns.iter().map(|column| column.name.clone()).collect());
        let file = tables.iter().map(|table| table.file.as_str()).collect::<Vec<_>>().join(" + ");
        let of = |column: &JoinedColumn| (&tables[column.table].layout, column.place);
        let mut layout = tables[0].layout.clone();
        layout.cell_units =
            columns.iter().map(of).map(|(layout, place)| layout.cell_units[place].clone()).collect();
        layout.stamps = columns.iter().map(of).map(|(layout, place)| layout.stamps[place]).collect();
        layout.names = names;
        layout.numbers.decimal = tables.iter().find_map(|table| table.numbers().decimal);
        let (mut text, mut ends) = (String::new(), Vec::new());
        for row in 0..tables[0].rows() {
            for column in columns {
                text.push_str(tables[column.table].cell(row, column.place));
                ends.push(text.len());
            }
        }
        tables[0].with_cells(file, layout, text, ends)
    }
}

/// The own name of a column, or that of its file; of a column that all tables have, `t`.
fn name(tables: &[Table], columns: &[JoinedColumn], column: usize) -> String {
    let JoinedColumn { table, place, .. } = columns[column];
    let own = &tables[table];
    if !own.layout.header_lines.is_empty() {
        return own.header[place].clone();
    }
    let is_in = |other: &Table| (0..other.header.len()).any(|at| equal(own, place, other, at));
    if tables.len() > 1 && tables.iter().all(is_in) {
        return "t".into();
    }
    let stem = Path::new(&own.file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    match columns.iter().filter(|other| other.table == table).count() {
        1 => stem,
        2 if columns[..column].iter().any(|other| other.name == "t") => stem,
        _ => format!("{stem} {}", own.header[place]),
    }
}

/// True for columns with equal cells or numbers.
fn equal(table: &Table, place: usize, other: &Table, at: usize) -> bool {
    let number = |text: &str| parsed(text.trim(), None).ok().map(|(number, _)| number);
    (0..table.rows()).all(|row| {
        let (cell, another) = (table.cell(row, place).trim(), other.cell(row, at).trim());
        cell == another || number(cell).is_some_and(|found| Some(found) == number(another))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::Reading;

    fn table(file: &str, text: &str) -> Table {
        Table::from_bytes(Path::new(file), text.into(), &Reading::default()).unwrap()
    }

    #[test]
    fn input_and_output_of_two_files_are_one_table() {
        let joined = Table::joined(&[
            table("a/Disp.out", "0.0 1.5\n0.1 2.5\n0.2 3.5\n"),
            table("a/RFrc.out", "0 -3\n0.10 -5\n0.20 -7\n"),
        ]);
        let joined = joined.unwrap();
        assert_eq!(joined.header, ["t", "Disp", "RFrc"]);
        assert_eq!([joined.cell(1, 0), joined.cell(1, 1), joined.cell(1, 2)], ["0.1", "2.5", "-5"]);
        let named =
            Table::joined(&[table("x.csv", "t,x\n0,1\n1,2\n"), table("y.csv", "t,y\n0,3\n1,4\n")]).unwrap();
        assert_eq!(named.header, ["t", "x", "y"]);
        let short = Table::joined(&[table("x.csv", "t,x\n0,1\n1,2\n"), table("y.csv", "t,y\n0,3\n")]);
        assert!(short.unwrap_err().to_string().ends_with("choose them with --rows)"));
    }
}
