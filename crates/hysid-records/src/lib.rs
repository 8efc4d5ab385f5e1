//! From tables to data: which column is what, where records begin, which units columns have, and what the tables
//! were understood as. Problems name file, line and column, and the option that helps.

// Only the crates of Hysid use this one: what a name says needs no comment.
#![allow(missing_docs)]

mod columns;
mod csv_text;
mod data;
mod reading;
mod record_names;
mod table_overview;
pub mod understanding;
mod units;
mod warnings;

pub use columns::{ColumnChoice, NO_TIME, RateOption, Roles, require};
pub use csv_text::{IN_MEMORY, check_new_columns, csv_text, header_line, named_after};
pub use data::{
    CellNeed, Data, DataSource, RecordPlace, checked, column_of, data_of_text, data_words, equal_stamps,
    explained, offset_of, place_of, places_of,
};
pub use reading::{MOST_ROWS_OF_ZERO, READING_OPTIONS, ReadingChoice, ReadingOption, ReadingValues};
pub use record_names::RecordNames;
pub use table_overview::{ColumnSummary, TableOverview};
pub use units::UnitFactors;
pub use warnings::summarised;
