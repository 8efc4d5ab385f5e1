//! Tables of measurements as instruments and tools write them.
//!
//! ```text
//! file, standard input ─► container ─► layout ─► rows ─► numbers
//!                         gzip, encoding, spreadsheet, MATLAB, HDF5, NumPy, JSON
//! ```
//!
//! A container gives text in UTF-8, whatever a file is. The layout of its first lines gives the delimiter, the names and
//! units of the columns, and how numbers are written. Rows are read one after another, so that memory does not grow
//! with the file. [`Reading`] overrides what is detected.

// Only the crates of Hysid use this one: what a name says needs no comment.
#![allow(missing_docs)]

mod blanks;
mod column;
mod container;
mod head;
mod join;
mod layout;
mod left_out;
mod line_counter;
mod number;
mod problem;
mod reading;
mod rows;
mod several;
mod stamp;
mod table;
mod time;

pub use column::ColumnReader;
pub use container::{THREAD as CONTAINER_THREAD, is_model, other_kind};
pub use head::Head;
pub use hysid_document::{Problem, Result};
pub use layout::{Layout, is_record};
pub use left_out::LeftOut;
pub use number::{CellReader, DecimalSign, NumberFormat, is_missing, push_shortest, shortest};
pub use problem::CellProblem;
pub use reading::{Delimiter, Reading, RowSelection, TextEncoding};
pub use rows::{Row, Rows};
pub use several::are_branches;
pub use table::{Table, TableOrigin};
pub use time::{spread_equal, starts_again};
