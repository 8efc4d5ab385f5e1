//! Measured data: records and their columns, units, rates, errors, and what to know before they are used.

pub mod column;
pub mod metrics;
pub mod rate;
pub mod record;
pub mod summary;
pub mod turning_points;
pub mod unit;
pub mod warning;

/// Fewest rows with an output that a model is identified from.
pub const FEWEST_ROWS: usize = 10;
