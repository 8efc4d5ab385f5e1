//! The table of a restoring force, which `hysid fit` reads without options.

use hysid::data::unit;
use hysid::error::MotionColumn;
use hysid::restoring_force::RestoringForce;
use hysid_core::words::Words;
use hysid_document::visible::clipped;
use hysid_records::{IN_MEMORY, header_line, offset_of};
use hysid_tables::{Problem, Result, Table, push_shortest};

use super::MeasuredMotion;
use super::units::named;

/// The columns that are written, by name.
pub struct ForceTable {
    /// Record, if the table has such a column.
    pub record: Option<String>,
    pub time: String,
    pub displacement: String,
    pub velocity: String,
    /// Columns that are copied.
    pub keep: Vec<String>,
    pub force: String,
    delimiter: u8,
}

impl ForceTable {
    /// The names of the columns for a motion from a table.
    pub fn of(table: &Table, motion: &MeasuredMotion) -> Result<Self> {
        let (names, units) = (&motion.names, &motion.units);
        // A name that does not say that it is time would have to be named again.
        let time = match unit::is_time(&names.time) {
            true => names.time.clone(),
            false => named("t", unit::of_column(&names.time).as_deref()),
        };
        let written = Self {
            record: names.record.as_ref().map(|_| "record".to_string()),
            time,
            displacement: names.displacement.clone(),
            velocity: named("velocity", units.velocity_unit().as_deref()),
            keep: names.keep.clone(),
            force: named("restoring_force", units.force_unit.as_deref()),
            delimiter: table.delimiter().in_a_copy(table.numbers().decimal),
        };
        let all: Vec<&String> = written.all().collect();
        for (place, name) in all.iter().enumerate() {
            if all[..place].contains(name) {
                let words = Words::from(format!("there would be two columns \"{}\"", clipped(name)));
                return Err(Problem::in_file(&table.file, words.advised("rename the one in the table")));
            }
        }
        Ok(written)
    }

    fn all(&self) -> impl Iterator<Item = &String> + Clone {
        let first = self.record.iter().chain([&self.time, &self.displacement, &self.velocity]);
        first.chain(&self.keep).chain([&self.force])
    }

    /// The line of the header.
    pub fn header(&self) -> Vec<u8> {
        header_line(self.delimiter, self.all().map(String::as_str))
    }

    /// The rows. With `zero`, the displacement of each record has its mean over so many rows subtracted.
    pub fn rows(
        &self,
        table: &Table,
        motion: &MeasuredMotion,
        found: &RestoringForce,
        zero: Option<usize>,
    ) -> Vec<u8> {
        let mut writer = csv::WriterBuilder::new().delimiter(self.delimiter).from_writer(Vec::new());
        let place = |name: &String| table.column(name);
        let keep: Vec<usize> = self.keep.iter().filter_map(place).collect();
        let mut cell = String::new();
        let mut number = |value: f64| {
            cell.clear();
            if !value.is_nan() {
                push_shortest(&mut cell, value, motion.sign);
            }
            cell.clone()
        };
        for (record, found) in motion.records.iter().zip(&found.records) {
            let column = |of: MotionColumn| record.column(of).unwrap_or_default();
            let offset = zero.map_or(0.0, |rows| offset_of(column(MotionColumn::Displacement), rows));
            for row in 0..record.rows.len() {
                if self.record.is_some() {
                    writer.write_field(&record.name).expect(IN_MEMORY);
                }
                writer.write_field(number(column(MotionColumn::Time)[row])).expect(IN_MEMORY);
                writer
                    .write_field(number(column(MotionColumn::Displacement)[row] - offset))
                    .expect(IN_MEMORY);
                writer.write_field(number(found.velocity[row])).expect(IN_MEMORY);
                for &place in &keep {
                    writer.write_field(table.cell(record.rows.start + row, place)).expect(IN_MEMORY);
                }
                writer.write_field(number(found.force[row])).expect(IN_MEMORY);
                writer.write_record(None::<&[u8]>).expect(IN_MEMORY);
            }
        }
        writer.into_inner().expect(IN_MEMORY)
    }
}
