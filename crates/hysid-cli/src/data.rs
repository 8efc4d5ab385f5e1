//! Tables as data, and what is to be said on stderr of how they became so.

use std::path::PathBuf;

use anyhow::Result;
use hysid::model::Model;
use hysid_records::{Data, Roles, UnitFactors};
use hysid_tables::Table;

use crate::arguments::{ColumnOptions, ReadingOptions};
use crate::messages::{note, warning_words};

pub fn read_tables(paths: &[PathBuf], options: &ReadingOptions) -> Result<Vec<Table>> {
    let reading = options.reading();
    Ok(paths.iter().map(|path| Table::read(path, &reading)).collect::<Result<_, _>>()?)
}

/// The data in tables whose roles are found by options and names.
pub fn data_of(tables: Vec<Table>, options: &ColumnOptions) -> Result<Data> {
    let roles = Roles::detect(&tables[0], &options.choice())?;
    data_with(tables, roles, options.reading.zero)
}

/// The data in tables whose roles are known; `zero` is as in [`Data::new`].
pub fn data_with(tables: Vec<Table>, roles: Roles, zero: Option<usize>) -> Result<Data> {
    let data = Data::new(tables, roles, zero)?;
    data.warnings.iter().for_each(warning_words);
    Ok(data)
}

/// Factors to the units of a model, as [`UnitFactors::of`] finds them.
pub fn factors(
    model: &Model,
    roles: &Roles,
    file: &str,
    is_scored: bool,
    are_the_same: bool,
) -> Result<UnitFactors> {
    let factors = UnitFactors::of(model, roles, file, is_scored, are_the_same)?;
    factors.conversions.iter().for_each(|conversion| note(format_args!("{conversion}")));
    Ok(factors)
}
