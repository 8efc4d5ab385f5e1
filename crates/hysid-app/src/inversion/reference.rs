//! The wanted outputs of a table, record by record.

use std::ops::Range;

use hysid::model::Reference;
use hysid_records::{CellNeed, Roles, UnitFactors, column_of, places_of};

use hysid_tables::{CellReader, DecimalSign, Result, Table};

/// The wanted outputs of a table, in the units of the model.
pub struct ReferenceOutputs {
    pub file: String,
    pub lines: Vec<u64>,
    pub records: Vec<WantedRecord>,
    /// How the numbers of the table are written.
    pub sign: DecimalSign,
}

pub struct WantedRecord {
    pub name: String,
    pub rows: Range<usize>,
    /// The wanted output of each row.
    pub wanted: Vec<f64>,
    pub time: Option<Vec<f64>>,
    others: Vec<Vec<f64>>,
}

impl WantedRecord {
    /// The columns of its further inputs.
    pub fn columns(&self) -> Vec<&[f64]> {
        self.others.iter().map(Vec::as_slice).collect()
    }

    /// As the library takes it.
    pub fn reference<'a>(&'a self, others: &'a [&'a [f64]]) -> Reference<'a> {
        Reference { wanted: &self.wanted, others, time: self.time.as_deref() }
    }
}

impl ReferenceOutputs {
    /// Reads the columns of a table.
    pub fn of(table: &Table, roles: &Roles, factors: &UnitFactors) -> Result<Self> {
        let mut cells = CellReader::new(table.numbers());
        let mut read = |name: &String, factor: Option<f64>, kind: CellNeed| -> Result<Vec<f64>> {
            let mut numbers = column_of(table, name, kind, &mut cells)?;
            if let Some(factor) = factor {
                numbers.iter_mut().for_each(|number| *number *= factor);
            }
            Ok(numbers)
        };
        let time = roles.time.as_ref().map(|name| read(name, factors.time, CellNeed::INPUT)).transpose()?;
        let inputs = roles.inputs.iter().zip(&factors.inputs);
        let others: Vec<Vec<f64>> =
            inputs.map(|(name, &factor)| read(name, factor, CellNeed::INPUT)).collect::<Result<_>>()?;
        let wanted = read(&roles.output, factors.output, CellNeed::WANTED)?;
        let record = |place: hysid_records::RecordPlace| {
            let cut = |column: &Vec<f64>| column[place.rows.clone()].to_vec();
            WantedRecord {
                wanted: cut(&wanted),
                time: time.as_ref().map(cut),
                others: others.iter().map(cut).collect(),
                name: place.record,
                rows: place.rows,
            }
        };
        Ok(Self {
            file: table.file.clone(),
            records: places_of(table, roles, time.as_deref())?.into_iter().map(record).collect(),
            lines: table.lines.clone(),
            sign: cells.sign().unwrap_or(DecimalSign::Point),
        })
    }
}
