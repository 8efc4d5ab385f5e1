//! The table of a drive: that of the wanted outputs with further columns.

use hysid::Model;
use hysid_records::{IN_MEMORY, check_new_columns, header_line};
use hysid_tables::{Result, Table, push_shortest};

use super::{Inverted, ReferenceOutputs};

/// The columns that are added, by name.
pub struct DriveTable {
    drive: String,
    edges: Vec<String>,
    others: [String; 3],
    delimiter: u8,
}

impl DriveTable {
    /// The drive is named after the input of the model, so that the table can be simulated; if the table has such a
    /// column, `_inverse` is appended.
    pub fn of(model: &Model, table: &Table, has_band: bool) -> Result<Self> {
        let input = &model.names().inputs[0];
        let drive = match table.column(input) {
            None => input.clone(),
            Some(_) => format!("{input}_inverse"),
        };
        let edges = if has_band { vec![format!("{drive}_low"), format!("{drive}_high")] } else { Vec::new() };
        let others =
            [format!("{}_reached", model.names().output), "reach".to_string(), "extrapolated".to_string()];
        let delimiter = table.delimiter().in_a_copy(table.numbers().decimal);
        let names = Self { drive, edges, others, delimiter };
        check_new_columns(&table.file, |name| table.column(name), names.all())?;
        Ok(names)
    }

    fn all(&self) -> impl Iterator<Item = &String> + Clone {
        std::iter::once(&self.drive).chain(&self.edges).chain(&self.others)
    }

    /// The line of the header.
    pub fn header(&self, table: &Table) -> Vec<u8> {
        header_line(self.delimiter, table.header.iter().chain(self.all()).map(String::as_str))
    }

    /// The rows of the table with the columns that are added.
    pub fn rows(&self, table: &Table, wanted: &ReferenceOutputs, inverted: &Inverted) -> Vec<u8> {
        let mut writer = csv::WriterBuilder::new().delimiter(self.delimiter).from_writer(Vec::new());
        let mut number = String::new();
        for (record, inversion) in wanted.records.iter().zip(&inverted.records) {
            for (row, place) in record.rows.clone().enumerate() {
                for column in 0..table.header.len() {
                    writer.write_field(table.cell(place, column)).expect(IN_MEMORY);
                }
                for column in [&inversion.input, &inversion.low, &inversion.high, &inversion.output] {
                    if let Some(&value) = column.get(row) {
                        number.clear();
                        push_shortest(&mut number, value, wanted.sign);
                        writer.write_field(&number).expect(IN_MEMORY);
                    }
                }
                writer.write_field(inversion.reach[row].word()).expect(IN_MEMORY);
                writer
                    .write_field(if inversion.is_extrapolated[row] { "yes" } else { "no" })
                    .expect(IN_MEMORY);
                writer.write_record(None::<&[u8]>).expect(IN_MEMORY);
            }
        }
        writer.into_inner().expect(IN_MEMORY)
    }
}
