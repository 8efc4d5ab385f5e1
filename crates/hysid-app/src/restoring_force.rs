//! The measured motion of a mass in a table, and the restoring force that follows from it.

mod acceleration;
mod chart;
mod columns;
mod mass;
mod table;
mod text;
mod units;

use std::ops::Range;

use hysid::error::{DataProblem, MotionColumn, MotionError};
use hysid::restoring_force::{Acceleration, Motion, RestoringForce, restoring_force};
use hysid_document::Problem;
use hysid_document::visible::clipped;
use hysid_records::{column_of, data_words, equal_stamps, offset_of, places_of};
use hysid_tables::{CellReader, DecimalSign, Result, Table, spread_equal};

pub use chart::chart;
pub use columns::MotionChoice;
use columns::{COLUMNS, MotionColumns, kind};
pub use mass::Mass;
pub use table::ForceTable;
pub use text::{PrintedForce, summary, understood, warnings};
use units::MotionUnits;

/// The restoring force of an element from the motion of a mass.
pub struct RestoringForceRequest {
    pub columns: MotionChoice,
    pub mass: Mass,
    /// True to convert no units.
    pub same_units: bool,
    /// Rows of the window of the filter that differentiates; `None` to choose it.
    pub window: Option<usize>,
    /// Over how many rows at the beginning of each record displacement and force are to be zero in the mean.
    pub zero: Option<usize>,
}

pub struct MeasuredMotion {
    names: MotionColumns,
    units: MotionUnits,
    records: Vec<MotionRecord>,
    /// How the numbers of the table are written.
    sign: DecimalSign,
    /// Changes of the data on reading, in words.
    pub warnings: Vec<String>,
    file: String,
    lines: Vec<u64>,
}

/// The motion of a record, in the units of the table.
struct MotionRecord {
    name: String,
    rows: Range<usize>,
    columns: [Option<Vec<f64>>; 6],
}

impl MotionRecord {
    /// Values of a column; none if it is not there.
    fn column(&self, column: MotionColumn) -> Option<&[f64]> {
        let place = COLUMNS.iter().position(|known| *known == column)?;
        self.columns[place].as_deref()
    }
}

impl MeasuredMotion {
    /// Reads the columns of a motion.
    pub fn of(table: &Table, request: &RestoringForceRequest) -> Result<Self> {
        let names = MotionColumns::find(table, &request.columns)?;
        let units = MotionUnits::of(&table.file, &names, &request.mass, request.same_units)?;
        let mut cells = CellReader::new(table.numbers());
        let mut read = |column: MotionColumn| -> Result<Option<Vec<f64>>> {
            names.name_of(column).map(|name| column_of(table, name, kind(column), &mut cells)).transpose()
        };
        let mut columns: Vec<Option<Vec<f64>>> = Vec::with_capacity(COLUMNS.len());
        for column in COLUMNS {
            columns.push(read(column)?);
        }
        let places = places_of(table, &names.roles(), columns[0].as_deref())?;
        let time = columns[0].as_mut().expect("there is a time");
        let spread: usize =
            places.iter().map(|place| spread_equal(&mut time[place.rows.clone()], None, &mut None)).sum();
        let record = |place: hysid_records::RecordPlace| MotionRecord {
            columns: std::array::from_fn(|at| {
                columns[at].as_ref().map(|values| values[place.rows.clone()].to_vec())
            }),
            name: place.record,
            rows: place.rows,
        };
        Ok(Self {
            records: places.into_iter().map(record).collect(),
            warnings: (spread > 0).then(|| equal_stamps(&table.file, spread)).into_iter().collect(),
            sign: cells.sign().unwrap_or(DecimalSign::Point),
            file: table.file.clone(),
            lines: table.lines.clone(),
            names,
            units,
        })
    }

    /// The restoring force, in the unit of the result.
    pub fn restoring_force(&self, request: &RestoringForceRequest) -> Result<RestoringForce> {
        let in_si = |record: &MotionRecord| {
            COLUMNS.map(|column| {
                let factor = self.units.factor(column);
                record
                    .column(column)
                    .map(|values| values.iter().map(|value| factor * value).collect::<Vec<f64>>())
            })
        };
        let columns: Vec<[Option<Vec<f64>>; 6]> = self.records.iter().map(in_si).collect();
        let motions: Vec<Motion<'_>> = columns.iter().map(|columns| self.motion(columns)).collect();
        let mass = request.mass.number * self.units.mass;
        let mut found =
            restoring_force(&motions, mass, request.window).map_err(|error| self.explained(error))?;
        let (force, velocity) = (self.units.force, self.units.velocity());
        for record in &mut found.records {
            record.force.iter_mut().for_each(|r| *r /= force);
            record.velocity.iter_mut().for_each(|v| *v /= velocity);
            if let Some(rows) = request.zero {
                let offset = offset_of(&record.force, rows);
                record.force.iter_mut().for_each(|r| *r -= offset);
            }
        }
        for number in [&mut found.deviation, &mut found.noise, &mut found.smoothing] {
            *number /= force;
        }
        Ok(found)
    }

    /// A record as the library takes it.
    fn motion<'c>(&self, columns: &'c [Option<Vec<f64>>; 6]) -> Motion<'c> {
        let [time, displacement, velocity, acceleration, base, force] =
            std::array::from_fn(|at| columns[at].as_deref());
        Motion {
            time: time.unwrap_or_default(),
            displacement: displacement.unwrap_or_default(),
            velocity,
            acceleration: match acceleration {
                None => Acceleration::Computed,
                Some(values) if self.names.is_absolute => Acceleration::Absolute(values),
                Some(values) => Acceleration::Relative(values),
            },
            base_acceleration: base,
            applied_force: force,
        }
    }

    /// An error of the library in the user's words: file, line, column.
    fn explained(&self, error: hysid::Error) -> Problem {
        let file = &self.file;
        match error {
            hysid::Error::Motion(MotionError { record, row, column, problem }) => {
                let name = clipped(self.names.name_of(column).unwrap_or_else(|| column.name())).into_owned();
                let problem = in_units_of_table(problem, self.units.factor(column));
                let record = &self.records[record];
                match row {
                    Some(row) => {
                        let line = self.lines[record.rows.start + row];
                        Problem::in_cell(file, line, &name, data_words(&problem))
                    }
                    None if self.records.len() > 1 => {
                        hysid_document::problem!(
                            "{file}, record \"{}\": column \"{name}\" {problem}",
                            clipped(&record.name)
                        )
                    }
                    None => Problem::in_file(file, format!("column \"{name}\" {problem}")),
                }
            }
            hysid::Error::Option(error) => Problem::request(error.to_string()),
            other => Problem::in_file(file, other.to_string()),
        }
    }
}

/// A problem with its numbers as they are in the table, not in SI units.
fn in_units_of_table(problem: DataProblem, factor: f64) -> DataProblem {
    match problem {
        DataProblem::ConstantInput(value) => DataProblem::ConstantInput(value / factor),
        DataProblem::TimeNotIncreasing { before, now } => {
            DataProblem::TimeNotIncreasing { before: before / factor, now: now / factor }
        }
        other => other,
    }
}
