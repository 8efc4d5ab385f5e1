//! A data set as CSV, which reads back as the same records without any option.

use csv::QuoteStyle;
use hysid_core::data::record::{Dataset, Record};
use hysid_core::data::unit;
use hysid_document::visible::clipped;
use hysid_tables::{Delimiter, Problem, Result, shortest};

/// Why writing rows of equal length cannot fail.
pub const IN_MEMORY: &str = "memory takes every row";

/// The data with a header line. Column `record` distinguishes several records, a blank output is an empty
/// cell, and every number reads back as the same number.
pub fn csv_text(data: &Dataset) -> String {
    let names = data.names();
    let several = data.records().len() > 1;
    let time = data.has_time().then(|| names.time.as_deref().unwrap_or("t"));
    let rate = data.has_given_rate().then(|| names.rate.as_deref().unwrap_or("rate"));
    let inputs = names.inputs.iter().map(String::as_str);
    let header = several.then_some("record").into_iter().chain(time).chain(inputs).chain(rate);

    let header = header_line(b',', header.chain([names.output.as_str()]));
    let mut writer = csv::Writer::from_writer(header);
    for record in data.records() {
        for row in 0..record.len() {
            let name = several.then(|| record.name().to_string());
            writer.write_record(name.into_iter().chain(numbers(record, row))).expect(IN_MEMORY);
        }
    }
    String::from_utf8(writer.into_inner().expect(IN_MEMORY)).expect("names and numbers are text")
}

/// A header line that reads back as these names. All are quoted where the line would be taken for a comment, or another
/// character for the delimiter.
pub fn header_line<'n>(delimiter: u8, names: impl Iterator<Item = &'n str> + Clone) -> Vec<u8> {
    let is_comment = names.clone().next().is_some_and(|name| name.trim_start().starts_with('#'));
    let divides = |letter: char| {
        let other = u8::try_from(letter).ok().filter(|&byte| byte != delimiter);
        other.is_some_and(|byte| Delimiter::ALL.contains(&Delimiter::Character(byte)))
    };
    let style = match is_comment || names.clone().any(|name| name.contains(divides)) {
        true => QuoteStyle::Always,
        false => QuoteStyle::Necessary,
    };
    let mut builder = csv::WriterBuilder::new();
    let mut writer = builder.delimiter(delimiter).quote_style(style).from_writer(Vec::new());
    writer.write_record(names).expect(IN_MEMORY);
    writer.into_inner().expect(IN_MEMORY)
}

/// The numbers of a row in the order of the columns.
fn numbers(record: &Record, row: usize) -> impl Iterator<Item = String> {
    let inputs = record.inputs().iter().map(|input| &**input);
    let columns = record.time().into_iter().chain(inputs).chain(record.given_rate());
    let output = record.output()[row];
    let output = if output.is_nan() { String::new() } else { shortest(output) };
    columns.map(move |column| shortest(column[row])).chain([output])
}

/// The name of a column made of another, in the same unit: `Force_model [kN]` of `Force [kN]`.
pub fn named_after(name: &str, ending: &str) -> String {
    let name = name.trim();
    match unit::split(name) {
        (quantity, Some(_)) if !name[quantity.len()..].starts_with('_') => {
            format!("{quantity}_{ending}{}", &name[quantity.len()..])
        }
        _ => format!("{name}_{ending}"),
    }
}

/// Refuses names of further columns for a table that has such a column, which `place` gives the place of.
pub fn check_new_columns<'n>(
    file: &str,
    place: impl Fn(&str) -> Option<usize>,
    names: impl IntoIterator<Item = &'n String>,
) -> Result<()> {
    match names.into_iter().find(|name| place(name).is_some()) {
        Some(name) => {
            let words = format!("there is already a column \"{}\" (rename or remove it)", clipped(name));
            Err(Problem::in_file(file, words))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use hysid_core::data::record::ColumnNames;
    use hysid_specimens::{Specimen, with_noise};
    use hysid_tables::{Reading, Table};

    use super::*;
    use crate::{ColumnChoice, Data, RateOption};

    /// The data as they are read from a file.
    fn read_back(data: &Dataset, columns: &ColumnChoice) -> Dataset {
        let text = csv_text(data).into_bytes();
        let table = Table::from_bytes(Path::new("only.csv"), text, &Reading::default()).unwrap();
        Data::of_tables(vec![table], columns, None).unwrap().set
    }

    fn bits(record: &Record) -> Vec<Vec<u64>> {
        let columns =
            record.inputs().iter().map(|input| &**input).chain(record.time()).chain(record.given_rate());
        columns.chain([record.output()]).map(|column| column.iter().map(|v| v.to_bits()).collect()).collect()
    }

    fn check(data: &Dataset, read: &Dataset) {
        assert_eq!(read.names(), data.names());
        assert_eq!(read.records().len(), data.records().len());
        for (read, record) in read.records().iter().zip(data.records()) {
            // Alone in its file a record is named after the file.
            let name = if data.records().len() > 1 { record.name() } else { "only" };
            assert_eq!(read.name(), name);
            assert!(bits(read) == bits(record), "{name}");
        }
    }

    #[test]
    fn every_specimen_reads_back_to_the_last_bit() {
        for specimen in Specimen::all() {
            let noisy = with_noise(&specimen.train(), 3.0, 5).unwrap();
            for data in [specimen.train(), specimen.test(), noisy] {
                check(&data, &read_back(&data, &ColumnChoice::default()));
            }
        }
    }

    #[test]
    fn names_of_simulated_columns_keep_their_unit_at_the_end() {
        for (name, simulated) in [
            ("Force [kN]", "Force_model [kN]"),
            ("Load (N)", "Load_model (N)"),
            ("Force, kN", "Force_model, kN"),
            ("x / mm", "x_model / mm"),
            ("y", "y_model"),
            ("displacement_um", "displacement_um_model"),
        ] {
            assert_eq!(named_after(name, "model"), simulated);
        }
    }

    #[test]
    fn every_header_line_reads_back() {
        for names in [["# t", "x", "y"], [" #t", "x\n", "\"y\""], ["a;b", "c\td", "e,f"], ["t", "x", "y"]] {
            for delimiter in ['\t', ';', ',', '|'] {
                let header = header_line(delimiter as u8, names.into_iter());
                let rows = format!("\"1;2\"{delimiter}3{delimiter}4\n").repeat(4).into_bytes();
                let table =
                    Table::from_bytes(Path::new("f"), [header, rows].concat(), &Reading::default()).unwrap();
                assert_eq!(table.header, names.map(str::trim), "{delimiter:?}");
            }
        }
        let plain = header_line(b',', ["t", "x"].into_iter());
        assert_eq!(plain, b"t,x\n");
    }

    #[test]
    fn awkward_names_and_numbers_read_back_too() {
        let names = ColumnNames {
            time: Some("Time, since start (s)".into()),
            inputs: vec!["x; \"left\"".into(), "other".into()],
            rate: Some("v_mm_s".into()),
            output: "F_N".into(),
        };
        let record = |name: &str, sign: f64| {
            let inputs = vec![vec![0.1 + 0.2, -0.0, 5e-324], vec![sign, 1e99, 1.0 / 3.0]];
            let record = Record::new(name, inputs, vec![f64::NAN, -1e-300, 12345678.9]).unwrap();
            record.with_time(vec![-0.5, 1e-9, 1e15]).unwrap().with_given_rate(vec![sign, 0.0, 2e-17]).unwrap()
        };
        let data = Dataset::new(names, vec![record("first, \"quoted\"", 1.0), record("2", -1.0)]).unwrap();
        let columns = ColumnChoice {
            time: Some("Time, since start (s)".into()),
            rate: RateOption::Column("v_mm_s".into()),
            ..ColumnChoice::default()
        };
        check(&data, &read_back(&data, &columns));
    }
}
