//! Measured data: records and their columns, units, rates, error metrics, and checks before use.

pub mod column;
pub mod initial_state;
pub mod known_beginning;
pub mod likeness;
pub mod metrics;
pub mod polyline;
pub mod rate;
pub mod record;
pub mod summary;
pub mod turning_points;
pub mod unit;
pub mod usual_role;
pub mod warning;

/// Least number of rows with an output for an identification.
pub const FEWEST_ROWS: usize = 10;
